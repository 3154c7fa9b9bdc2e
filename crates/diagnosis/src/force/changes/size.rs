//! How large a payload is, with its interval.

use haptical_effects::force::PAYLOAD;

use super::columns::Columns;
use super::folds::Fitted;
use crate::force::along::Along;
use crate::thresholds::payload::{CERTAIN, FIXED_MASS, LEVER};

/// A payload's numbers.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::force) struct Size {
    /// Mass \[kg\], below zero where it was put down, with its 95 % interval.
    pub(in crate::force) mass_kg: f64,
    pub(in crate::force) ci95_kg: [f64; 2],
    /// First moment about the link's origin \[kg m\] with its standard deviation; none at the flange.
    pub(in crate::force) moment_kg_m: Option<(f64, f64)>,
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

/// The mass by what a fit says of it, or within what a mass of that moment can be.
pub(super) fn size(
    along: &Along<'_>,
    columns: &Columns,
    link: Option<usize>,
    fitted: &Fitted,
) -> Size {
    let device = along.recorded.context.device;
    let scales = device.joints.iter().map(|joint| joint.torque_scale_sd);
    // torques in newton metres are known to their scale alone, and so is what they hold
    let relative = scales
        .fold(0.0, f64::max)
        .hypot(PAYLOAD.law_error.amplitude);
    let known = |mass_kg: f64, sd_kg: f64| {
        let half = (HALF * sd_kg).hypot(1.96 * relative * mass_kg);
        [mass_kg - half, mass_kg + half]
    };
    let Some(link) = link else {
        let mass = columns.flange.start;
        let (mass_kg, sd_kg) = (fitted.number(mass), jackknife(fitted.each(mass)));
        return Size {
            mass_kg,
            ci95_kg: known(mass_kg, sd_kg),
            moment_kg_m: None,
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
    let each = (0..fitted.without.len())
        .map(|fold| moment_of(&|column| fitted.each(column).nth(fold).unwrap_or(0.0)));
    let moment_sd = jackknife(each);
    let sign = sign(fitted, &column);
    let deviations = moment / moment_sd.max(1e-300);
    let moment_kg_m = Some((moment, moment_sd.hypot(relative * moment)));
    if let Some(mass) = column(0) {
        let (mass_kg, sd_kg) = (fitted.number(mass), jackknife(fitted.each(mass)));
        if sd_kg < FIXED_MASS * mass_kg.abs() {
            return Size {
                mass_kg,
                ci95_kg: known(mass_kg, sd_kg),
                moment_kg_m,
                deviations,
            };
        }
    }
    // the drives see the moment alone: of the mass no more than what fits between the axis and the end of the link
    let reach_m = longest_m(along);
    let [least, most] = LEVER.map(|share| share * reach_m);
    let ends = [
        (moment - HALF * moment_sd).max(0.0) / most,
        (moment + HALF * moment_sd) / least,
    ];
    let mass_kg = moment / (least * most).sqrt();
    let ci95_kg = match sign < 0.0 {
        true => [-ends[1], -ends[0]],
        false => ends,
    };
    Size {
        mass_kg: sign * mass_kg,
        ci95_kg,
        moment_kg_m,
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
