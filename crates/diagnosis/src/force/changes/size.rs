//! How large a payload is, with its interval.

use haptical_effects::force::PAYLOAD;
use haptical_linalg::jackknife_sd;

use super::columns::{Columns, Place};
use super::folds::{Fitted, Folds};
use crate::force::along::Along;
use crate::thresholds::payload::{
    CERTAIN, FIXED_MASS, FOLDS, FOLDS_HALF_WIDTH, KNOWN_INERTIA, LEVER, SESSION_FACTOR,
};

/// A payload's numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Size {
    /// Mass \[kg\], below zero where it was put down, with its 95 % interval.
    pub(super) mass_kg: f64,
    pub(super) ci95_kg: [f64; 2],
    /// First moment about the link's origin \[kg m\] with its 95 % interval; none at the flange.
    pub(super) moment_kg_m: Option<(f64, [f64; 2])>,
    /// Distances of the mass from the link's origin \[m\] that its interval assumes; none where the torques fix the mass.
    lever_m: Option<[f64; 2]>,
    /// What a fit can tell of it, over its standard deviation.
    deviations: f64,
}

impl Size {
    /// Whether the interval leaves out zero, by much.
    pub(super) fn is_certain(&self) -> bool {
        self.deviations >= CERTAIN
    }

    /// What the mass depends on that the torques do not fix.
    pub(super) fn warning(&self, run: usize, link: Option<usize>) -> Option<String> {
        let ([least, most], link) = (self.lever_m?, link? + 1);
        Some(format!(
            "payload from run {}: the torques fix its moment about link {link}, mass times distance, and not its mass; the \
             interval of mass_kg is what the moment gives at distances of {least:.3} m to {most:.3} m",
            run + 1
        ))
    }
}

type Numbers<'n> = &'n dyn Fn(usize) -> f64;

/// The mass by what a fit says of it, or within what a mass of that moment can be.
pub(super) fn size(
    along: &Along<'_>,
    columns: &Columns,
    folds: &Folds,
    place: &Place,
    fitted: &Fitted,
) -> Size {
    // what the folds differ by, and what none of them can tell: the torques' scales, the place of a flange's mass
    let sd_of = |value: &dyn Fn(Numbers<'_>) -> f64, sum: &[(usize, f64)]| {
        let each = (0..FOLDS).map(|fold| value(&|column| fitted.nth(fold, column)));
        jackknife_sd(each).hypot(1.96 / FOLDS_HALF_WIDTH * folds.prior_sd(fitted, sum))
    };
    let known = |value: f64, sd: f64| {
        let half = (FOLDS_HALF_WIDTH * sd).hypot(1.96 * PAYLOAD.law_error.amplitude * value);
        [value - half, value + half]
    };
    // takes the number of a column as a mass, with its standard deviation
    let by_column = |mass: usize| {
        let mass_kg = fitted.number(mass);
        let sd_kg = sd_of(&|number| number(mass), &[(mass, 1.0)]);
        let size = Size {
            mass_kg,
            ci95_kg: known(mass_kg, sd_kg),
            moment_kg_m: None,
            lever_m: None,
            deviations: mass_kg.abs() / sd_kg.max(1e-300),
        };
        (size, sd_kg)
    };
    if place.link.is_none() {
        return by_column(place.numbers[0].0).0;
    }
    let column = |number: usize| place.column(number);
    let number = |place: usize| column(place).map_or(0.0, |column| fitted.number(column));
    let moment_of = |of: Numbers<'_>| {
        let square = (1..4).filter_map(column).map(|column| of(column).powi(2));
        square.sum::<f64>().sqrt()
    };
    let moment = moment_of(&|column| fitted.number(column));
    let direction = [1, 2, 3].map(|place| number(place) / moment.max(1e-300));
    let along_it = (1..4).filter_map(|place| Some((column(place)?, direction[place - 1])));
    let moment_sd = sd_of(&moment_of, &along_it.collect::<Vec<_>>());
    let deviations = moment / moment_sd.max(1e-300);
    let [low, high] = known(moment, moment_sd);
    let of_link = |size: Size| Size {
        moment_kg_m: Some((moment, [low.max(0.0), high])),
        // the torques do not show a moment along the axes that carry the link: its mass may be more certain
        deviations: deviations.max(size.deviations),
        ..size
    };
    let by_mass = column(0).map(by_column);
    if let Some((size, _)) = by_mass.filter(|(size, sd)| *sd < FIXED_MASS * size.mass_kg.abs()) {
        return of_link(size);
    }
    let by_inertia = by_inertia((along, columns), folds, (place, &direction), fitted);
    let (mass_kg, ci95_kg, lever_m) = match by_inertia {
        Some((mass_kg, ci95_kg)) => (mass_kg, ci95_kg, None),
        None => {
            // the drives see the moment alone: the mass is anywhere between the axis and the end of the link
            let reach_m = longest_m(along);
            let [least, most] = LEVER.map(|share| share * reach_m);
            let ends = [low.max(0.0) / most, high / least];
            let mass_kg = moment / (least * most).sqrt();
            let lever_m = Some([least, most]);
            // the sign of its inertia says whether it was put on or down
            match (4..7).map(number).sum::<f64>() < 0.0 {
                true => (-mass_kg, [-ends[1], -ends[0]], lever_m),
                false => (mass_kg, ends, lever_m),
            }
        }
    };
    of_link(Size {
        mass_kg,
        ci95_kg,
        moment_kg_m: None,
        lever_m,
        deviations,
    })
}

/// The mass of a point along a direction from the link's origin: `(m b)^2 / (m b^2)`, its moment's square over its inertia
/// (docs/diagnosis-force.md). Its interval holds what offsets, friction and, within what is stated of them, scales of the torques move
/// it by that may have changed with it, as they do from one session to the next (assumption A180). None where the inertia hardly
/// shows.
fn by_inertia(
    (along, columns): (&Along<'_>, &Columns),
    folds: &Folds,
    (place, direction): (&Place, &[f64; 3]),
    fitted: &Fitted,
) -> Option<(f64, [f64; 2])> {
    let numbers = &place.numbers;
    let [x, y, z] = *direction;
    // 1 - d d^T: the inertia of 1 kg at 1 m about the origin
    let shape = [
        y * y + z * z,
        x * x + z * z,
        x * x + y * y,
        -x * y,
        -x * z,
        -y * z,
    ];
    let sums = [(1, direction.as_slice()), (4, &shape)].map(|(first, factors)| {
        let factor = |number: usize| factors.get(number.checked_sub(first)?).copied();
        let terms = numbers
            .iter()
            .filter_map(|&(column, number)| Some((column, factor(number)?)));
        (terms.collect(), f64::INFINITY, None)
    });
    let mut with = folds.clone();
    let [moment, inertia] = *with.add_sums(&sums).first_chunk::<2>()?;
    let is_other = |column: &&usize| !numbers.iter().any(|(number, _)| number == *column);
    let common: Vec<usize> = fitted.columns.iter().filter(is_other).copied().collect();
    let found = with.fit(&[common.as_slice(), &[moment, inertia]].concat());
    let mass_of = |number: Numbers<'_>| {
        let (moment, inertia) = (number(moment), number(inertia));
        (inertia != 0.0).then(|| moment * moment / inertia)
    };
    let mass_kg = mass_of(&|column| found.number(column))?;
    // logarithms: a ratio of two numbers is no normal one
    let log_ratio = |other: f64| (other * mass_kg > 0.0).then(|| (other / mass_kg).ln());
    let parts = (0..FOLDS).map(|fold| log_ratio(mass_of(&|column| found.nth(fold, column))?));
    let of_folds = SESSION_FACTOR * jackknife_sd(parts.collect::<Option<Vec<_>>>()?.into_iter());
    // scales within what is stated of them, offsets and friction as they like
    for (gain, sd) in columns.every(2).into_iter().zip(along.scale_sds()) {
        with.knowing(gain, sd);
    }
    let mut all = [common, columns.drives.concat().concat()].concat();
    all.sort_unstable();
    all.dedup();
    let changed = with.fit(&[all.as_slice(), &[moment, inertia]].concat());
    let of_drives = log_ratio(mass_of(&|column| changed.number(column))?)?;
    let slopes = [
        (moment, 2.0 / changed.number(moment)),
        (inertia, -1.0 / changed.number(inertia)),
    ];
    let of_scales = with.prior_sd(&changed, &slopes);
    let half = (FOLDS_HALF_WIDTH * of_folds)
        .hypot(1.96 * PAYLOAD.law_error.amplitude)
        .hypot(1.96 * of_drives)
        .hypot(1.96 * of_scales);
    let ends = [mass_kg * (-half).exp(), mass_kg * half.exp()];
    let ci95_kg = [ends[0].min(ends[1]), ends[0].max(ends[1])];
    (half < KNOWN_INERTIA).then_some((mass_kg, ci95_kg))
}

/// Longest row of the chain \[m\].
fn longest_m(along: &Along<'_>) -> f64 {
    let links = along.recorded.context.device.links.iter();
    let lengths = links.map(|link| link.a_m.hypot(link.d_m));
    lengths.fold(0.0, f64::max)
}
