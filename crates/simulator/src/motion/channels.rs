//! The sensors of a hand-guided recording: what each adds, and how late it is.

use haptical_model::{Device, Joint};

use crate::SimulatorError;
use crate::effect::Effect;
use crate::motion::scene::Scene;
use crate::motion::settings::{Encoders, MotionSettings};
use crate::sensor::Sensor;
use crate::settings::{CableSigma, Noise, Settings};
use crate::simulate::has_output;
use crate::streams::Stream;
use crate::waves::Waves;

/// Band of the drums' roughness \[1/rad\]: waves of 6 to 60 mrad, assumption A47.
const ROUGHNESS_BAND_PER_RAD: [f64; 2] = [100.0, 1000.0];
/// Sines of one joint's roughness.
const ROUGHNESS_SINES: usize = 32;

/// A motor-side encoder.
#[derive(Debug, Clone)]
pub(crate) struct Motor {
    pub(crate) scene: usize,
    pub(crate) sensor: Sensor,
    /// From when on the reading is too high, and by how much.
    pub(crate) steps: Vec<[f64; 2]>,
}

/// An external encoder.
#[derive(Debug, Clone)]
pub(crate) struct Output {
    pub(crate) scene: usize,
    pub(crate) sensor: Sensor,
    pub(crate) roughness: Option<Waves>,
}

/// The device with each delay that is asked for, once.
pub(crate) struct Scenes<'d, 'e> {
    truth: &'d Device,
    effects: &'e [Effect],
    pub(crate) made: Vec<Scene<'d>>,
}

impl<'d, 'e> Scenes<'d, 'e> {
    /// The device without delay.
    pub(crate) fn new(truth: &'d Device, effects: &'e [Effect]) -> Result<Self, SimulatorError> {
        Ok(Self {
            truth,
            effects,
            made: vec![Scene::new(truth, effects, 0.0)?],
        })
    }

    /// Index of the scene with a delay.
    fn with(&mut self, delay_s: f64) -> Result<usize, SimulatorError> {
        if let Some(index) = self.made.iter().position(|scene| scene.delay_s == delay_s) {
            return Ok(index);
        }
        self.made
            .push(Scene::new(self.truth, self.effects, delay_s)?);
        Ok(self.made.len() - 1)
    }
}

/// Sum of the delays that a channel has.
fn delay(effects: &[Effect], of: impl Fn(&Effect) -> Option<f64>) -> f64 {
    effects.iter().filter_map(of).sum()
}

/// The motor-side encoders.
pub(crate) fn motors(
    truth: &Device,
    settings: &MotionSettings,
    scenes: &mut Scenes<'_, '_>,
) -> Result<Vec<Motor>, SimulatorError> {
    let list = scenes.effects;
    let late_s = delay(list, |effect| match *effect {
        Effect::EncoderLatency { delay_s } => Some(delay_s),
        _ => None,
    });
    let scene = scenes.with(late_s)?;
    let with_counts = Settings::real_encoders();
    let make = |(index, joint): (usize, &Joint)| {
        let described = joint.encoder_counts_per_rev.is_some();
        let sensor = match &settings.encoders {
            Encoders::Same(settings) => Sensor::motor(joint, index, settings)?,
            Encoders::Described if described => Sensor::motor(joint, index, &with_counts)?,
            Encoders::Described | Encoders::Exact => Sensor::exact(),
        };
        let mut steps = Vec::new();
        for effect in list {
            if let Effect::EncoderCountLoss {
                joint: number,
                counts,
                time_s,
            } = *effect
                && number == index + 1
            {
                // refuses a device that does not say how long a count is
                let count = Sensor::motor(joint, index, &with_counts)?.count();
                steps.push([time_s, counts * count]);
            }
        }
        Ok(Motor {
            scene,
            sensor,
            steps,
        })
    };
    truth.joints.iter().enumerate().map(make).collect()
}

/// The external encoders, where there are any.
pub(crate) fn outputs(
    truth: &Device,
    settings: &MotionSettings,
    scenes: &mut Scenes<'_, '_>,
    seed: u64,
) -> Result<Vec<Option<Output>>, SimulatorError> {
    let make = |(index, joint): (usize, &Joint)| {
        if !has_output(joint) {
            return Ok(None);
        }
        let generator = Stream::MotionOutput.open(index, seed);
        let noise = match &settings.encoders {
            Encoders::Same(settings) => settings.output_noise,
            Encoders::Exact => Noise::None,
            Encoders::Described if joint.external_encoder_counts_per_rev.is_some() => Noise::Counts,
            Encoders::Described if joint.external_encoder_sd_rad.is_some() => Noise::Gaussian,
            Encoders::Described => Noise::None,
        };
        let late_s = delay(scenes.effects, |effect| match *effect {
            Effect::ExternalEncoderLatency { joint, delay_s } => {
                (joint == index + 1).then_some(delay_s)
            }
            _ => None,
        });
        let drums = Stream::Roughness.open(index, settings.device_seed);
        let rough = scenes.effects.iter().find_map(|effect| match *effect {
            Effect::DrumRoughness { joint, rms_rad } => (joint == index + 1).then_some(rms_rad),
            _ => None,
        });
        let rms = rough.unwrap_or(0.0);
        Ok(Some(Output {
            scene: scenes.with(late_s)?,
            sensor: Sensor::output(joint, index, noise, generator)?,
            roughness: (rms > 0.0)
                .then(|| Waves::new(drums, ROUGHNESS_SINES, ROUGHNESS_BAND_PER_RAD, rms)),
        }))
    };
    truth.joints.iter().enumerate().map(make).collect()
}

/// The cable encoders of a device with links, each with its scene. What makes a cable late is the
/// first one's.
pub(crate) fn cables(
    truth: &Device,
    settings: &MotionSettings,
    scenes: &mut Scenes<'_, '_>,
    seed: u64,
) -> Result<Vec<(usize, Sensor)>, SimulatorError> {
    if !truth.has_links() {
        return Ok(Vec::new());
    }
    let late_s = delay(scenes.effects, |effect| match *effect {
        Effect::CableLatency { delay_s } => Some(delay_s),
        _ => None,
    });
    (0..truth.cables.len())
        .map(|index| {
            let sensor = cable_sensor(truth, index, settings, seed)?;
            Ok((scenes.with(if index == 0 { late_s } else { 0.0 })?, sensor))
        })
        .collect()
}

fn cable_sensor(
    truth: &Device,
    index: usize,
    settings: &MotionSettings,
    seed: u64,
) -> Result<Sensor, SimulatorError> {
    let cable = &truth.cables[index];
    let generator = Stream::MotionCable.open(index, seed);
    let described = Settings {
        cable_sigma: CableSigma::Stated,
        ..Settings::paper()
    };
    let has_counts = cable.drum_radius_m.is_some() && cable.counts_per_rev.is_some();
    match &settings.encoders {
        Encoders::Same(settings) => Sensor::cable(cable, index, settings, generator),
        Encoders::Described if cable.distance_sd_m.is_some() => {
            Sensor::cable(cable, index, &described, generator)
        }
        Encoders::Described if has_counts => {
            Sensor::cable(cable, index, &Settings::real_encoders(), generator)
        }
        Encoders::Described | Encoders::Exact => Ok(Sensor::exact()),
    }
}
