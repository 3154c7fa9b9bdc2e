//! Effects that add a deviation to one signal: the place where it is added, and the law.

use crate::effects::{Effect, Facts, Info};
use crate::rig::scene::Scene;

/// Where a deviation is added.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Place {
    /// Between motor and external encoder: the motor has to turn this much more.
    Upstream(usize),
    /// To the motor-side reading.
    Motor(usize),
    /// To the external encoder's reading.
    External(usize),
    /// To the link behind the external encoder.
    Link(usize),
    /// To the first cable's reading.
    Cable,
}

impl Place {
    /// The joint, from 0.
    pub(crate) fn joint(self) -> Option<usize> {
        match self {
            Self::Upstream(joint)
            | Self::Motor(joint)
            | Self::External(joint)
            | Self::Link(joint) => Some(joint),
            Self::Cable => None,
        }
    }

    /// Length of one count of the encoder there, in the signal's unit; 0 where there is none.
    pub(crate) fn count(self, scene: &Scene<'_>) -> f64 {
        let count = match self {
            Self::Upstream(joint) | Self::Motor(joint) | Self::Link(joint) => {
                scene.device.joints[joint].reading_quantum_rad()
            }
            Self::External(joint) => scene.device.joints[joint]
                .external_encoder_counts_per_rev
                .map(|counts| std::f64::consts::TAU / counts),
            Self::Cable => scene.device.cables.first().and_then(|cable| {
                Some(std::f64::consts::TAU * cable.drum_radius_m? / cable.counts_per_rev?)
            }),
        };
        count.unwrap_or(0.0)
    }
}

/// A law: how much is added to each sample of a signal.
pub(crate) trait Law: std::fmt::Debug + Send + Sync {
    /// The deviation, in the signal's unit, sample by sample. For the upstream place a positive one
    /// lets the motor lead.
    fn deviation(&self, scene: &Scene<'_>, place: Place, signal: &[f64]) -> Vec<f64>;

    /// Parameters with the catalogue's names and numbers of the law.
    fn facts(&self, scene: &Scene<'_>, place: Place) -> Facts;
}

/// A law at a place.
#[derive(Debug)]
pub(crate) struct Added {
    info: Info,
    place: Place,
    law: Box<dyn Law>,
}

impl Added {
    pub(crate) fn boxed(info: Info, place: Place, law: impl Law + 'static) -> Box<dyn Effect> {
        Box::new(Self {
            info,
            place,
            law: Box::new(law),
        })
    }

    fn add(&self, scene: &Scene<'_>, signal: &mut [f64]) {
        let deviation = self.law.deviation(scene, self.place, signal);
        for (value, extra) in signal.iter_mut().zip(deviation) {
            *value += extra;
        }
    }
}

impl Effect for Added {
    fn info(&self) -> &Info {
        &self.info
    }

    fn facts(&self, scene: &Scene<'_>) -> Facts {
        self.law.facts(scene, self.place)
    }

    fn upstream(&self, scene: &Scene<'_>, windup_rad: &mut [Vec<f64>]) {
        if let Place::Upstream(joint) = self.place {
            let angle = &scene.motion.angle_rad[joint];
            let deviation = self.law.deviation(scene, self.place, angle);
            for (value, extra) in windup_rad[joint].iter_mut().zip(deviation) {
                *value += extra;
            }
        }
    }

    fn motor(&self, scene: &Scene<'_>, reading_rad: &mut [Vec<f64>]) {
        if let Place::Motor(joint) = self.place {
            self.add(scene, &mut reading_rad[joint]);
        }
    }

    fn external(&self, scene: &Scene<'_>, output_rad: &mut [Vec<f64>]) {
        if let Place::External(joint) = self.place {
            self.add(scene, &mut output_rad[joint]);
        }
    }

    fn link(&self, scene: &Scene<'_>, angle_rad: &mut [Vec<f64>]) {
        if let Place::Link(joint) = self.place {
            self.add(scene, &mut angle_rad[joint]);
        }
    }

    fn cable(&self, scene: &Scene<'_>, cable_m: &mut Vec<f64>) {
        if self.place == Place::Cable {
            self.add(scene, cable_m);
        }
    }
}
