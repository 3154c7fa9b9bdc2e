//! One trial: a device, two recordings of it, what is left out of the catalogue, and the truth.

use std::collections::BTreeMap;

use haptical_model::{Device, Recording, TransmissionError};

use crate::again::Again;
use crate::effects::{Draw, Effect, Facts, Kind};
use crate::error::BlindError;
use crate::gap::true_gap;
use crate::random::Random;
use crate::rig::devices::{Nominal, perturbed, torque_scales};
use crate::rig::motion::MotionPlan;
use crate::rig::noise::NoisePlan;
use crate::rig::scene::{CleanChannels, Recorded, Scene};
use crate::truth::{EffectTruth, Truth};

/// A trial of a diagnosis.
#[derive(Debug, Clone)]
pub struct Trial {
    /// Nominal device.
    pub device: Device,
    /// Its file.
    pub device_toml: String,
    /// A model to diagnose against, where the trial is about one (suite S8): the file of a device.
    pub model_toml: Option<String>,
    /// Recording to diagnose.
    pub log: Recording,
    /// Recording to validate on.
    pub log2: Recording,
    /// The second recording's channels without noise.
    pub clean2: CleanChannels,
    /// Effects that the catalogue must do without.
    pub without: Vec<String>,
    /// An effect that is not there and is to be fitted all the same (suite SLA).
    pub asked: Option<Asked>,
    /// What is hidden.
    pub truth: Truth,
}

/// An effect that is asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Asked {
    /// The name in the catalogue.
    pub effect: &'static str,
    /// Joint, from 1.
    pub joint: Option<usize>,
}

/// What a suite orders for one trial.
#[derive(Debug, Clone)]
pub(crate) struct Order {
    pub(crate) nominal: Nominal,
    pub(crate) plan: MotionPlan,
    /// Effects: kind, joint (from 0), size.
    pub(crate) effects: Vec<(&'static Kind, usize, f64)>,
    pub(crate) noise: NoisePlan,
    pub(crate) label: Option<String>,
    pub(crate) withhold: bool,
    pub(crate) no_gap_is_right: bool,
    pub(crate) implausible: bool,
    /// The model has the true links and nominal transmissions: names alone count, at any joint.
    pub(crate) is_ablation: bool,
    /// The log has joints and torques alone.
    pub(crate) has_torques_alone: bool,
}

impl Order {
    /// A clean trial of a device.
    pub(crate) fn clean(nominal: Nominal, joints: usize) -> Self {
        Self {
            nominal,
            plan: MotionPlan::default(),
            effects: Vec::new(),
            noise: NoisePlan::white(joints),
            label: None,
            withhold: false,
            no_gap_is_right: false,
            implausible: false,
            is_ablation: false,
            has_torques_alone: false,
        }
    }

    /// Makes the recordings.
    pub(crate) fn make(
        self,
        suite: &str,
        index: u64,
        batch_seed: u64,
        random: &mut Random,
    ) -> Result<Trial, BlindError> {
        Ok(self.make_again(suite, index, batch_seed, random)?.0)
    }

    /// Makes the recordings, and keeps the device for further ones.
    pub(crate) fn make_again(
        self,
        suite: &str,
        index: u64,
        batch_seed: u64,
        random: &mut Random,
    ) -> Result<(Trial, Again), BlindError> {
        let nominal = self.nominal.device()?;
        let mut device = perturbed(&nominal, random);
        let scales = torque_scales(&nominal, random);
        let effects: Vec<Effect> = self
            .effects
            .iter()
            .zip(0..)
            .map(|((kind, joint, size), tag)| {
                kind.draw(&mut Draw {
                    device: &nominal,
                    joint: *joint,
                    size: *size,
                    tag,
                    random: &mut *random,
                })
            })
            .collect();
        for effect in &effects {
            effect.device(&mut device);
        }
        let mut facts: Vec<Vec<Facts>> = Vec::new();
        let mut record = |random: &mut Random| -> Result<Recorded, BlindError> {
            let scene = Scene::draw(&device, &self.plan, random.seed())?;
            facts.push(effects.iter().map(|effect| effect.facts(&scene)).collect());
            let recorded = scene.record(&effects, &self.noise, &scales)?;
            Ok(match self.has_torques_alone {
                true => torques_alone(recorded),
                false => recorded,
            })
        };
        let first = record(random)?;
        let second = record(random)?;
        let model = self.is_ablation.then(|| kinematics_only(&device));
        let model_toml = model
            .as_ref()
            .map(|model| model.to_toml(self.nominal.toml, self.nominal.name))
            .transpose()?;
        let mut truth = self.truth(&effects, &facts);
        truth.gap = true_gap(model.as_ref().unwrap_or(&device), &first)?;
        if self.is_ablation {
            truth.effects = base_errors(&device);
        }
        truth.suite = suite.to_owned();
        truth.index = index;
        truth.batch_seed = batch_seed;
        let trial = Trial {
            device: nominal,
            device_toml: self.nominal.toml.to_owned(),
            model_toml,
            log: first.log,
            log2: second.log,
            clean2: second.clean,
            without: truth.without.clone(),
            asked: None,
            truth,
        };
        let again = Again {
            device,
            effects,
            plan: self.plan,
            noise: self.noise,
            scales,
        };
        Ok((trial, again))
    }

    fn truth(&self, effects: &[Effect], facts: &[Vec<Facts>]) -> Truth {
        let owned = |names: &[&str]| -> Vec<String> {
            names.iter().map(|name| (*name).to_owned()).collect()
        };
        let infos: Vec<_> = effects.iter().map(|effect| &effect.info).collect();
        let groups: Vec<_> = infos.iter().filter(|info| !info.right.is_empty()).collect();
        let mut right: Vec<Vec<String>> = groups.iter().map(|info| owned(&info.right)).collect();
        let joints: Vec<Option<usize>> = groups
            .iter()
            .map(|info| info.joint.map(|joint| joint + 1))
            .collect();
        let joints = if self.is_ablation {
            vec![None; right.len()]
        } else {
            joints
        };
        let mut without = Vec::new();
        if self.withhold {
            without = right.iter().flatten().cloned().collect();
            right = vec![vec!["unknown".to_owned()]];
        }
        let joined: Vec<&str> = infos.iter().map(|info| info.name).collect();
        let effects = infos
            .iter()
            .enumerate()
            .map(|(index, info)| {
                let of_first = facts.first().map(|facts| &facts[index]);
                let numbers = |pick: fn(&Facts) -> &BTreeMap<&'static str, f64>| {
                    of_first
                        .into_iter()
                        .flat_map(pick)
                        .map(|(name, value)| ((*name).to_owned(), *value))
                        .collect()
                };
                EffectTruth {
                    effect: info.name.to_owned(),
                    joint: info.joint.map(|joint| joint + 1),
                    size: info.size,
                    parameters: numbers(|facts| &facts.parameters),
                    law: numbers(|facts| &facts.law),
                    events: facts
                        .iter()
                        .map(|facts| facts[index].events.clone())
                        .collect(),
                }
            })
            .collect();
        Truth {
            device: self.nominal.name.to_owned(),
            name: self.label.clone().unwrap_or_else(|| joined.join("+")),
            joint: joints.first().copied().flatten(),
            joints,
            acceptable: infos
                .iter()
                .flat_map(|info| owned(&info.acceptable))
                .collect(),
            effects,
            right,
            depends_on: infos
                .iter()
                .flat_map(|info| info.depends_on.clone())
                .collect(),
            gap: BTreeMap::new(),
            without,
            no_gap_is_right: self.no_gap_is_right,
            implausible: self.implausible,
            suite: String::new(),
            index: 0,
            batch_seed: 0,
        }
    }
}

/// Joints, times and torques of a recording.
fn torques_alone(recorded: Recorded) -> Recorded {
    let Recording {
        line,
        time_s,
        run,
        joint,
        torque_nm,
        ..
    } = recorded.log;
    Recorded {
        log: Recording {
            output: vec![None; joint.len()],
            line,
            time_s,
            run,
            joint,
            torque_nm,
            ..Recording::default()
        },
        clean: CleanChannels::default(),
    }
}

/// The true links with nominal transmissions.
fn kinematics_only(device: &Device) -> Device {
    let mut model = device.clone();
    for joint in &mut model.joints {
        joint.transmission_error = TransmissionError::default();
    }
    model
}

/// Every transmission error of a device, as effects with the parameters of an identified device file.
fn base_errors(device: &Device) -> Vec<EffectTruth> {
    let mut effects = Vec::new();
    for (index, joint) in device.joints.iter().enumerate() {
        let (capstan, bars_m) = match &joint.transmission_error {
            error if *error == TransmissionError::default() => continue,
            TransmissionError::Capstan(capstan) => (capstan, None),
            TransmissionError::Parallelogram {
                capstan,
                length_deviations_m,
            } => (capstan, Some(length_deviations_m)),
            TransmissionError::Chebyshev { .. } => continue,
        };
        let mut add = |effect: &str, parameters: &[(&str, f64)]| {
            let named = |(name, value): &(&str, f64)| ((*name).to_owned(), *value);
            effects.push(EffectTruth {
                effect: effect.to_owned(),
                joint: Some(index + 1),
                size: 1.0,
                parameters: parameters.iter().map(named).collect(),
                law: BTreeMap::new(),
                events: Vec::new(),
            });
        };
        let ratio_deviation = capstan.ratio_deviation;
        add("ratio-error", &[("ratio_deviation", ratio_deviation)]);
        let [x_m, y_m] = capstan.output_drum_xy_m;
        let output_drum = [("output_drum_x_m", x_m), ("output_drum_y_m", y_m)];
        add("drum-eccentricity", &output_drum);
        if let Some([ab_m, bc_m, ce_m, ea_m]) = bars_m {
            let bars = [
                ("ab_m", *ab_m),
                ("bc_m", *bc_m),
                ("ce_m", *ce_m),
                ("ea_m", *ea_m),
            ];
            add("parallelogram-error", &bars);
        }
    }
    effects
}
