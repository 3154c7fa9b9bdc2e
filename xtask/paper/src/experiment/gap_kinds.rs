//! Effects that could explain the authors' 96.6 %, each with the one size that is varied.

use std::fmt::Write as _;

use anyhow::Result;
use haptical_model::Recording;
use haptical_simulator::Effects;
use xtask_blind::{Random, rows};

#[derive(Debug, Clone, Copy)]
pub(crate) struct Kind {
    /// Joint from 1, where it has one.
    pub(crate) joint: Option<usize>,
    pub(crate) name: &'static str,
    /// Parameter of the catalogue that is varied; none of noise, which is no effect.
    pub(crate) parameter: &'static str,
    /// Unit in which it is shown, and how many of them one SI unit is.
    pub(crate) unit: (&'static str, f64),
    /// Smallest and largest size that is tried (SI), the one that does least first.
    pub(crate) sizes: [f64; 2],
    /// Its other numbers, as an effects file has them.
    further: &'static str,
}

impl Kind {
    /// `backlash@3`.
    pub(crate) fn label(&self) -> String {
        label(self.name, self.joint)
    }

    pub(crate) fn is_noise(&self) -> bool {
        self.parameter.is_empty()
    }

    /// Effects of the simulator at a size.
    pub(crate) fn effects(&self, size: f64) -> Result<Effects> {
        if self.is_noise() {
            return Ok(Effects::none());
        }
        let size = if self.parameter == "counts" {
            size.round()
        } else {
            size
        };
        let mut text = format!("[[effect]]\nname = \"{}\"\n{}\n", self.name, self.further);
        if let Some(joint) = self.joint {
            writeln!(text, "joint = {joint}")?;
        }
        writeln!(text, "{} = {size:e}", self.parameter)?;
        Ok(Effects::from_toml(&text, self.name)?)
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

/// An effect at a joint, or anywhere.
pub(crate) fn label(effect: &str, joint: Option<usize>) -> String {
    let joint = joint.map(|joint| format!("@{joint}"));
    format!("{effect}{}", joint.unwrap_or_default())
}

const MRAD: (&str, f64) = ("mrad", 1e3);
const MS: (&str, f64) = ("ms", 1e3);
const MM: (&str, f64) = ("mm", 1e3);
const STIFFNESS: (&str, f64) = ("N m/rad", 1.0);

/// Every effect that the simulator knows, and white noise of the cable encoder: no effect, but what a worn one would show.
/// Counts are lost in the middle of the motion.
pub(crate) const KINDS: [Kind; 20] = rows! {
    Kind {joint name parameter unit sizes further}
    Some(2), "capstan-compliance", "stiffness_nm_per_rad", STIFFNESS, [1e5, 3.0], "";
    Some(2), "joint-compliance", "stiffness_nm_per_rad", STIFFNESS, [1e5, 3.0], "";
    Some(3), "backlash", "width_rad", MRAD, [1e-5, 0.2], "driven_by = 'hand'";
    Some(2), "hysteresis", "amplitude_rad", MRAD, [1e-5, 0.1], "transition_rad = 0.02\ndriven_by = 'hand'";
    Some(2), "viscous-lag", "delay_s", MS, [1e-5, 0.1], "";
    Some(1), "encoder-count-loss", "counts", ("counts", 1.0), [1.0, 3000.0], "time_s = 50.0";
    Some(2), "joint-drift", "rad_per_s", ("mrad/min", 6e4), [1e-8, 1e-3], "";
    Some(2), "axis-wobble", "amplitude_rad", MRAD, [1e-5, 0.2], "phase_rad = 0.5\norder = 2.0";
    Some(2), "external-encoder-latency", "delay_s", MS, [1e-5, 0.3], "";
    None, "encoder-latency", "delay_s", MS, [1e-5, 0.1], "";
    None, "cable-latency", "delay_s", MS, [1e-5, 0.1], "";
    None, "cable-exit-geometry", "radius_m", MM, [1e-5, 0.08], "";
    None, "cable-twist", "twist_m_per_rad2", ("mm/rad^2", 1e3), [1e-6, 0.1], "";
    None, "cable-zero-offset", "offset_m", MM, [1e-5, 0.2], "";
    None, "cable-drum-eccentricity", "amplitude_m", MM, [1e-6, 0.01], "phase_rad = 0.5";
    None, "cable-drift", "m_per_s", ("mm/min", 6e4), [1e-8, 1e-3], "";
    None, "thermal-drift", "m_per_degc", ("mm/K", 1e3), [1e-6, 0.02], "";
    None, "base-compliance", "rad_per_nm", ("mrad/(N m)", 1e3), [1e-6, 0.1], "";
    None, "tool-compliance", "m_per_n", ("mm/N", 1e3), [1e-7, 0.01], "";
    None, "noise of the cable", "", MM, [1e-9, 0.02], "";
};

pub(crate) const CABLE_NOISE: Kind = KINDS[KINDS.len() - 1];

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
            for effect in kind.effects(kind.sizes[0]).unwrap().as_slice() {
                assert_eq!((effect.name(), effect.joint()), (kind.name, kind.joint));
            }
        }
    }
}
