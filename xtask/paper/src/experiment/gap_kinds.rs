//! Effects that could explain the authors' 96.6 %, each with the one size that is varied.

use haptical_model::Recording;
use haptical_simulator::{Driver, Effect};
use xtask_blind::Random;

/// What a kind adds at a size.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Change {
    /// An effect of the catalogue.
    Effect(fn(f64) -> Effect),
    /// White noise of the cable encoder: no effect, but what a worn one would show.
    CableNoise,
}

/// One kind with its size.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kind {
    /// Joint from 1, where it has one.
    pub(crate) joint: Option<usize>,
    /// Name.
    pub(crate) name: &'static str,
    /// Parameter of the catalogue that is varied.
    pub(crate) parameter: &'static str,
    /// Unit in which it is shown, and how many of them one SI unit is.
    pub(crate) unit: (&'static str, f64),
    /// Smallest and largest size that is tried (SI), the one that does least first.
    pub(crate) sizes: [f64; 2],
    pub(crate) change: Change,
}

impl Kind {
    /// `backlash@3`.
    pub(crate) fn label(&self) -> String {
        match self.joint {
            Some(joint) => format!("{}@{joint}", self.name),
            None => self.name.to_owned(),
        }
    }

    /// Whether it is noise and no effect.
    pub(crate) fn is_noise(&self) -> bool {
        matches!(self.change, Change::CableNoise)
    }

    /// Effects of the simulator at a size.
    pub(crate) fn effects(&self, size: f64) -> Vec<Effect> {
        match self.change {
            Change::Effect(make) => vec![make(size)],
            Change::CableNoise => Vec::new(),
        }
    }

    /// What the simulator does not add itself.
    pub(crate) fn disturb(&self, recording: &mut Recording, size: f64, seed: u64) {
        if !self.is_noise() {
            return;
        }
        let mut random = Random::new(seed, 3);
        if let Some(Some(cable)) = recording.cable_m.first_mut() {
            for distance in cable {
                *distance += size * random.normal();
            }
        }
    }
}

const fn at_joint(
    joint: usize,
    name: &'static str,
    parameter: &'static str,
    unit: (&'static str, f64),
    sizes: [f64; 2],
    make: fn(f64) -> Effect,
) -> Kind {
    Kind {
        joint: Some(joint),
        ..device(name, parameter, unit, sizes, make)
    }
}

const fn device(
    name: &'static str,
    parameter: &'static str,
    unit: (&'static str, f64),
    sizes: [f64; 2],
    make: fn(f64) -> Effect,
) -> Kind {
    Kind {
        joint: None,
        name,
        parameter,
        unit,
        sizes,
        change: Change::Effect(make),
    }
}

const MRAD: (&str, f64) = ("mrad", 1e3);
const MS: (&str, f64) = ("ms", 1e3);
const MM: (&str, f64) = ("mm", 1e3);
const STIFFNESS: (&str, f64) = ("N m/rad", 1.0);

/// The middle of the motion, where counts are lost \[s\].
pub(crate) const LOSS_S: f64 = 50.0;

/// White noise of the cable.
pub(crate) const CABLE_NOISE: Kind = Kind {
    joint: None,
    name: "noise of the cable",
    parameter: "",
    unit: MM,
    sizes: [1e-9, 0.02],
    change: Change::CableNoise,
};

/// Every effect that the simulator knows, and the cable's noise.
pub(crate) const KINDS: [Kind; 20] = [
    at_joint(
        2,
        "capstan-compliance",
        "stiffness_nm_per_rad",
        STIFFNESS,
        [1e5, 3.0],
        |size| Effect::CapstanCompliance {
            joint: 2,
            stiffness_nm_per_rad: size,
        },
    ),
    at_joint(
        2,
        "joint-compliance",
        "stiffness_nm_per_rad",
        STIFFNESS,
        [1e5, 3.0],
        |size| Effect::JointCompliance {
            joint: 2,
            stiffness_nm_per_rad: size,
        },
    ),
    at_joint(3, "backlash", "width_rad", MRAD, [1e-5, 0.2], |size| {
        Effect::Backlash {
            joint: 3,
            width_rad: size,
            driven_by: Driver::Hand,
        }
    }),
    at_joint(
        2,
        "hysteresis",
        "amplitude_rad",
        MRAD,
        [1e-5, 0.1],
        |size| Effect::Hysteresis {
            joint: 2,
            amplitude_rad: size,
            transition_rad: 0.02,
            driven_by: Driver::Hand,
        },
    ),
    at_joint(2, "viscous-lag", "delay_s", MS, [1e-5, 0.1], |size| {
        Effect::ViscousLag {
            joint: 2,
            delay_s: size,
        }
    }),
    at_joint(
        1,
        "encoder-count-loss",
        "counts",
        ("counts", 1.0),
        [1.0, 3000.0],
        |size| Effect::EncoderCountLoss {
            joint: 1,
            counts: size.round(),
            time_s: LOSS_S,
        },
    ),
    at_joint(
        2,
        "joint-drift",
        "rad_per_s",
        ("mrad/min", 6e4),
        [1e-8, 1e-3],
        |size| Effect::JointDrift {
            joint: 2,
            rad_per_s: Some(size),
            rad_per_degc: None,
        },
    ),
    at_joint(
        2,
        "axis-wobble",
        "amplitude_rad",
        MRAD,
        [1e-5, 0.2],
        |size| Effect::AxisWobble {
            joint: 2,
            amplitude_rad: size,
            phase_rad: 0.5,
            order: 2.0,
        },
    ),
    at_joint(
        2,
        "external-encoder-latency",
        "delay_s",
        MS,
        [1e-5, 0.3],
        |size| Effect::ExternalEncoderLatency {
            joint: 2,
            delay_s: size,
        },
    ),
    device("encoder-latency", "delay_s", MS, [1e-5, 0.1], |size| {
        Effect::EncoderLatency { delay_s: size }
    }),
    device("cable-latency", "delay_s", MS, [1e-5, 0.1], |size| {
        Effect::CableLatency { delay_s: size }
    }),
    device(
        "cable-exit-geometry",
        "radius_m",
        MM,
        [1e-5, 0.08],
        |size| Effect::CableExitGeometry { radius_m: size },
    ),
    device(
        "cable-twist",
        "twist_m_per_rad2",
        ("mm/rad^2", 1e3),
        [1e-6, 0.1],
        |size| Effect::CableTwist {
            twist_m_per_rad2: size,
        },
    ),
    device("cable-zero-offset", "offset_m", MM, [1e-5, 0.2], |size| {
        Effect::CableZeroOffset { offset_m: size }
    }),
    device(
        "cable-drum-eccentricity",
        "amplitude_m",
        MM,
        [1e-6, 0.01],
        |size| Effect::CableDrumEccentricity {
            amplitude_m: size,
            phase_rad: 0.5,
        },
    ),
    device(
        "cable-drift",
        "m_per_s",
        ("mm/min", 6e4),
        [1e-8, 1e-3],
        |size| Effect::CableDrift { m_per_s: size },
    ),
    device(
        "thermal-drift",
        "m_per_degc",
        ("mm/K", 1e3),
        [1e-6, 0.02],
        |size| Effect::ThermalDrift { m_per_degc: size },
    ),
    device(
        "base-compliance",
        "rad_per_nm",
        ("mrad/(N m)", 1e3),
        [1e-6, 0.1],
        |size| Effect::BaseCompliance { rad_per_nm: size },
    ),
    device(
        "tool-compliance",
        "m_per_n",
        ("mm/N", 1e3),
        [1e-7, 0.01],
        |size| Effect::ToolCompliance { m_per_n: size },
    ),
    CABLE_NOISE,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_of_the_simulator_is_tried() {
        let mut names: Vec<&str> = KINDS.iter().map(|kind| kind.name).collect();
        names.retain(|name| *name != "noise of the cable");
        names.sort_unstable();
        let mut known = haptical_simulator::simulated_effects();
        // of every recording of this experiment, with the size that is assumed
        known.retain(|name| *name != "drum-roughness");
        known.sort_unstable();
        assert_eq!(names, known);
    }

    #[test]
    fn a_label_names_what_is_simulated() {
        for kind in KINDS {
            for effect in kind.effects(kind.sizes[0]) {
                assert_eq!((effect.name(), effect.joint()), (kind.name, kind.joint));
            }
        }
    }
}
