//! What may lie between motor and link: columns of a joint's rows, and names.

use super::rows::JointRows;
use crate::thresholds::between::{LEAST_DELAY_STEPS, LEAST_NATS, LEAST_PLAY};

/// Half the width of a play from its side: what yields beyond it counts from no load, its side from the least load that says it.
pub(super) fn half_play(side: f64, beyond: f64, flight_nm: f64) -> f64 {
    side - flight_nm * beyond.max(0.0)
}

/// What a gear that hardens yields, times its stiffness at rest: the x of `x (1 + share (x / load_nm)^2) = load`, the one real root of the
/// cubic.
pub(super) fn yielded(load: f64, share: f64, load_nm: f64) -> f64 {
    let root = (3.0 * share).sqrt();
    let inner = 1.5 * load / load_nm * root;
    2.0 * load_nm / root * (inner.asinh() / 3.0).sinh()
}

/// A term of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Term {
    /// The link's encoder is late by its coefficient \[s\].
    Delay,
    /// The gear yields: its coefficient is one over the stiffness \[rad/(N m)\].
    Spring,
    /// The gear yields the less, the more it has: `tau = k x (1 + h (k x / load)^2)`, h its share and `load` \[N m\] the root mean square
    /// of the load. Its coefficient is one over the stiffness k at rest.
    Hardening { share: f64, load_nm: f64 },
    /// Half a play, on the side that the load pushes to, and what yields beyond it, unless that is left out. Below this load the link may
    /// be anywhere in it \[N m\].
    Play { flight_nm: f64, yields: bool },
    /// A ratio that is off and a drum that runs out: calibration, no gap.
    Shape,
}

impl Term {
    /// Numbers that it fits, a shape's included.
    pub(super) fn numbers(self) -> usize {
        match self {
            Self::Delay | Self::Spring => 1,
            Self::Play { yields: false, .. } | Self::Hardening { .. } => 2,
            Self::Play { yields: true, .. } | Self::Shape => 3,
        }
    }

    /// Any play.
    pub(super) const PLAY: Self = Self::Play {
        flight_nm: 0.0,
        yields: false,
    };

    /// Number of its columns.
    pub(super) fn columns_count(self) -> usize {
        match self {
            Self::Delay
            | Self::Spring
            | Self::Hardening { .. }
            | Self::Play { yields: false, .. } => 1,
            Self::Play { yields: true, .. } => 2,
            Self::Shape => 3,
        }
    }

    /// What it must explain beyond its numbers \[nats\]: a play with what yields beyond it and a spring that hardens are a spring and
    /// more, so that they have to be better by as much as a further term.
    pub(super) fn handicap(self) -> f64 {
        match self {
            Self::Play { .. } | Self::Hardening { .. } => LEAST_NATS,
            Self::Delay | Self::Spring | Self::Shape => 0.0,
        }
    }

    /// Whether it is of the same kind.
    pub(super) fn is_like(self, other: Self) -> bool {
        core::mem::discriminant(&self) == core::mem::discriminant(&other)
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Delay => "external-encoder-latency",
            Self::Spring | Self::Hardening { .. } => "capstan-compliance",
            Self::Play { .. } => "backlash",
            Self::Shape => "drum-eccentricity",
        }
    }

    /// Its columns.
    pub(super) fn columns(self, rows: &JointRows) -> Vec<Vec<f64>> {
        let of = |own: &[f64], law: fn(f64) -> f64| own.iter().map(|x| law(*x)).collect();
        match self {
            Self::Delay => vec![of(&rows.speed, |v| -v)],
            Self::Spring => vec![of(&rows.load, |load| -load)],
            Self::Hardening { share, load_nm } => {
                vec![rows.of_load(|load| -yielded(load, share, load_nm))]
            }
            Self::Play { flight_nm, yields } => {
                let side = rows.of_load(|load| -(load / flight_nm).clamp(-1.0, 1.0));
                let beyond = || rows.of_load(|load| load.clamp(-flight_nm, flight_nm) - load);
                std::iter::once(side).chain(yields.then(beyond)).collect()
            }
            Self::Shape => vec![
                rows.angle.clone(),
                of(&rows.angle, f64::sin),
                of(&rows.angle, f64::cos),
            ],
        }
    }

    /// Share of each row in which its law does not say where in the play the link is.
    pub(super) fn flight(self, rows: &JointRows) -> Option<Vec<f64>> {
        match self {
            Self::Play { flight_nm, .. } => {
                Some(rows.of_load(|load| f64::from(load.abs() < flight_nm)))
            }
            _ => None,
        }
    }

    /// Whether nature allows these coefficients of a joint's rows.
    pub(super) fn is_possible(self, rows: &JointRows, coefficients: &[f64]) -> bool {
        match self {
            Self::Spring | Self::Hardening { .. } => coefficients[0] > 0.0,
            Self::Play { flight_nm, .. } => {
                // what yields beyond a play may be a little below nothing by chance
                let beyond = coefficients.get(1).copied().unwrap_or(0.0);
                half_play(coefficients[0], beyond, flight_nm)
                    > LEAST_PLAY * beyond.abs() * rows.load_sd
            }
            Self::Delay => coefficients[0].abs() > LEAST_DELAY_STEPS * rows.step_s,
            Self::Shape => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thresholds::between::HARDENING_SHARES;

    #[test]
    fn what_yields_solves_its_cubic() {
        for share in HARDENING_SHARES {
            for load in [-700.0, -3.0, 0.0, 40.0, 2000.0] {
                let x = yielded(load, share, 120.0);
                let again = x * (1.0 + share * (x / 120.0).powi(2));
                assert!(
                    (again - load).abs() < 1e-9 * (1.0 + load.abs()),
                    "{share} {load}: {again}"
                );
            }
        }
    }
}
