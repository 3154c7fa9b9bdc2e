//! One trial: a device, two recordings of it, what is left out of the catalogue, and the truth.

use std::collections::BTreeMap;

use anyhow::Result;
use haptical_model::{Device, Recording, TransmissionError};

use crate::again::Again;
use crate::effects::{Draw, Effect, Facts, Kind};
use crate::gap::true_gap;
use crate::planted::{Planted, Story};
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

/// Which trial it is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TrialId {
    pub(crate) suite: &'static str,
    /// In the batch.
    pub(crate) index: u64,
    /// Of the batch.
    pub(crate) seed: u64,
}

impl Trial {
    /// A trial of a device of which no more is known than its file says.
    pub(crate) fn of(
        device_toml: String,
        [log, log2]: [Recording; 2],
        clean2: CleanChannels,
        truth: Truth,
    ) -> Result<Self> {
        Ok(Self {
            device: Device::from_toml(&device_toml, &truth.device)?.device,
            device_toml,
            model_toml: None,
            log,
            log2,
            clean2,
            without: truth.without.clone(),
            asked: None,
            truth,
        })
    }
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

    /// With the names of its effects withheld.
    pub(crate) fn withheld(mut self) -> Self {
        self.withhold = true;
        self
    }

    pub(crate) fn or_no_gap(mut self) -> Self {
        self.no_gap_is_right = true;
        self
    }

    /// Makes the recordings, and keeps the device for further ones.
    pub(crate) fn make(self, id: TrialId, random: &mut Random) -> Result<(Trial, Again)> {
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
        let mut record = |random: &mut Random| -> Result<Recorded> {
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
        let model_toml = model.as_ref();
        let model_toml = model_toml.map(|own| own.to_toml(self.nominal.toml, self.nominal.name));
        let gap = true_gap(model.as_ref().unwrap_or(&device), &first)?;
        let mut truth = self.story(&effects, &facts).truth(id, gap);
        truth.no_gap_is_right = self.no_gap_is_right;
        truth.implausible = self.implausible;
        if self.is_ablation {
            truth.effects = base_errors(&device);
            truth.joints.fill(None);
            truth.joint = None;
        }
        let trial = Trial {
            device: nominal,
            device_toml: self.nominal.toml.to_owned(),
            model_toml: model_toml.transpose()?,
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

    /// The effects as they were put in; their numbers are those of the first recording, their events of each.
    fn story(&self, effects: &[Effect], facts: &[Vec<Facts>]) -> Story {
        let infos = effects.iter().map(|effect| &effect.info);
        let joined: Vec<&str> = infos.clone().map(|info| info.name).collect();
        let planted = infos.clone().enumerate().map(|(index, info)| {
            let numbers = |pick: fn(&Facts) -> &BTreeMap<&'static str, f64>| {
                let of_first = facts.first().into_iter();
                let numbers = of_first.flat_map(|facts| pick(&facts[index]));
                numbers
                    .map(|(name, value)| ((*name).to_owned(), *value))
                    .collect()
            };
            let events = facts.iter().map(|facts| facts[index].events.clone());
            Planted {
                name: info.name,
                joint: info.joint,
                size: info.size,
                right: info.right.clone(),
                acceptable: info.acceptable.clone(),
                parameters: numbers(|facts| &facts.parameters),
                law: numbers(|facts| &facts.law),
                events: events.collect(),
            }
        });
        let named = infos.clone().flat_map(|info| info.right.clone());
        Story {
            label: self.label.clone().unwrap_or_else(|| joined.join("+")),
            device: self.nominal.name.to_owned(),
            planted: planted.collect(),
            without: named.filter(|_| self.withhold).collect(),
            depends_on: infos.flat_map(|info| info.depends_on.clone()).collect(),
            is_unknown: false,
        }
    }
}

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
        if let Some(&[ab_m, bc_m, ce_m, ea_m]) = bars_m {
            add("parallelogram-error", &named!(ab_m, bc_m, ce_m, ea_m));
        }
    }
    effects
}
