//! How large a payload is, with its interval.

use haptical_effects::force::PAYLOAD;

use super::columns::Columns;
use super::folds::{Fitted, Folds};
use crate::force::along::Along;
use crate::thresholds::payload::{CERTAIN, FIXED_MASS, LEVER};

/// A payload's numbers.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::force) struct Size {
    /// Mass \[kg\], below zero where it was put down, with its 95 % interval.
    pub(in crate::force) mass_kg: f64,
    pub(in crate::force) ci95_kg: [f64; 2],
    /// First moment about the link's origin \[kg m\] with its 95 % interval; none at the flange.
    pub(in crate::force) moment_kg_m: Option<(f64, [f64; 2])>,
    /// Distances of the mass from the link's origin \[m\] that its interval assumes; none where the torques fix the mass.
    pub(in crate::force) lever_m: Option<[f64; 2]>,
    /// What a fit can tell of it, over its standard deviation.
    deviations: f64,
}

impl Size {
    /// Whether the interval leaves out zero, by much.
    pub(super) fn is_certain(&self) -> bool {
        self.deviations >= CERTAIN
    }
}

/// The half of an interval's width for a standard deviation from as many folds (Student's t with nine degrees of freedom).
const HALF: f64 = 2.26;

/// A mean's standard deviation from the values without each fold (Tukey's jackknife).
fn jackknife(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let count = values.len().max(2) as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (square * (count - 1.0) / count).sqrt()
}

/// The number of each column.
type Numbers<'n> = &'n dyn Fn(usize) -> f64;

/// The mass by what a fit says of it, or within what a mass of that moment can be.
pub(super) fn size(
    along: &Along<'_>,
    columns: &Columns,
    folds: &Folds,
    link: Option<usize>,
    fitted: &Fitted,
) -> Size {
    // what the folds differ by, and what none of them can tell: the torques' scales, the place of a flange's mass
    let sd_of = |value: &dyn Fn(Numbers<'_>) -> f64, sum: &[(usize, f64)]| {
        let each = (0..fitted.without.len()).map(|fold| value(&|column| fitted.nth(fold, column)));
        jackknife(each).hypot(1.96 / HALF * folds.prior_sd(fitted, sum))
    };
    let known = |value: f64, sd: f64| {
        let half = (HALF * sd).hypot(1.96 * PAYLOAD.law_error.amplitude * value);
        [value - half, value + half]
    };
    let Some(link) = link else {
        let mass = columns.flange.start;
        let mass_kg = fitted.number(mass);
        let sd_kg = sd_of(&|number| number(mass), &[(mass, 1.0)]);
        return Size {
            mass_kg,
            ci95_kg: known(mass_kg, sd_kg),
            moment_kg_m: None,
            lever_m: None,
            deviations: mass_kg.abs() / sd_kg.max(1e-300),
        };
    };
    let column = |number: usize| {
        let mut own = columns.links[link].iter();
        own.find(|(_, other)| *other == number)
            .map(|(column, _)| *column)
    };
    let moment_of = |of: &dyn Fn(usize) -> f64| {
        let square = (1..4).filter_map(column).map(|column| of(column).powi(2));
        square.sum::<f64>().sqrt()
    };
    let moment = moment_of(&|column| fitted.number(column));
    let along_it = (1..4).filter_map(column).map(|column| {
        let factor = fitted.number(column) / moment.max(1e-300);
        (column, factor)
    });
    let moment_sd = sd_of(&moment_of, &along_it.collect::<Vec<_>>());
    let sign = sign(fitted, &column);
    let deviations = moment / moment_sd.max(1e-300);
    let [low, high] = known(moment, moment_sd);
    let moment_kg_m = Some((moment, [low.max(0.0), high]));
    if let Some(mass) = column(0) {
        let mass_kg = fitted.number(mass);
        let sd_kg = sd_of(&|number| number(mass), &[(mass, 1.0)]);
        if sd_kg < FIXED_MASS * mass_kg.abs() {
            return Size {
                mass_kg,
                ci95_kg: known(mass_kg, sd_kg),
                moment_kg_m,
                lever_m: None,
                // of a link that the axes behind it leave free, no moment along them is seen
                deviations: deviations.max(mass_kg.abs() / sd_kg.max(1e-300)),
            };
        }
    }
    // the drives see the moment alone: of the mass no more than what fits between the axis and the end of the link
    let reach_m = longest_m(along);
    let [least, most] = LEVER.map(|share| share * reach_m);
    let ends = [low.max(0.0) / most, high / least];
    let mass_kg = moment / (least * most).sqrt();
    let ci95_kg = match sign < 0.0 {
        true => [-ends[1], -ends[0]],
        false => ends,
    };
    Size {
        mass_kg: sign * mass_kg,
        ci95_kg,
        moment_kg_m,
        lever_m: Some([least, most]),
        deviations,
    }
}

/// Whether a mass was put on or down: its inertia is above or below zero.
fn sign(fitted: &Fitted, column: &dyn Fn(usize) -> Option<usize>) -> f64 {
    let trace = |of: &dyn Fn(usize) -> f64| (4..7).filter_map(column).map(of).sum::<f64>();
    let all = trace(&|column| fitted.number(column));
    if all < 0.0 { -1.0 } else { 1.0 }
}

/// Longest row of the chain \[m\].
fn longest_m(along: &Along<'_>) -> f64 {
    let links = along.recorded.context.device.links.iter();
    links
        .map(|link| link.a_m.hypot(link.d_m))
        .fold(0.0, f64::max)
}
