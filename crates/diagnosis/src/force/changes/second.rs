//! A second recording of torques: what the model of the first one leaves of it, and whether the arm carries the same.

use haptical_effects::Context;
use haptical_model::{Device, Recording};
use haptical_motion::torque_nm_without_effects;

use super::carried::{Carried, held_out};
use super::{FOLDS, Payload, UnseenBlocks, changes};
use crate::DiagnosisError;
use crate::answer::second::{Left, SecondAnswer, SecondChannel};
use crate::answer::{HeldOutAnswer, Prediction};
use crate::force::along::Along;
use crate::force::base::Base;
use crate::force::effects::{Effects, is_scale};
use crate::force::examine;
use crate::force::recorded::{Besides, Recorded};
use crate::force::select::Selection;
use crate::thresholds::second::ALLOWED;

/// What a second recording shows.
#[derive(Debug, Clone, Default)]
pub(crate) struct OnSecond {
    /// Gap of each torque before and after.
    pub(crate) held_out: Vec<HeldOutAnswer>,
    /// Block means, at the row in the middle of each.
    pub(crate) predictions: Vec<Prediction>,
    pub(crate) warnings: Vec<String>,
    /// What the rule for second recordings says of each channel.
    pub(crate) channels: Vec<SecondChannel>,
    /// What was not predicted, and why.
    pub(crate) not_predicted: Vec<String>,
}

impl OnSecond {
    /// As a part of the answer.
    pub(crate) fn answer(&self) -> SecondAnswer {
        SecondAnswer {
            channels: self.channels.clone(),
            not_predicted: self.not_predicted.clone(),
            is_gap_of_it_alone: false,
        }
    }

    /// With what another view of the same recording says.
    pub(crate) fn extend(&mut self, other: Self) {
        self.held_out.extend(other.held_out);
        self.predictions.extend(other.predictions);
        self.warnings.extend(other.warnings);
        self.channels.extend(other.channels);
        self.not_predicted.extend(other.not_predicted);
    }
}

/// The model of a first recording, its effects included.
#[derive(Clone, Copy)]
pub(in crate::force) struct Model<'m, 'e, 'a> {
    pub(in crate::force) effects: &'m Effects<'e, 'a>,
    pub(in crate::force) base: &'m Base,
    pub(in crate::force) selection: &'m Selection,
    pub(in crate::force) carried: &'m Carried,
}

impl Model<'_, '_, '_> {
    /// Predicts a second recording, and compares what the arm carries in both.
    pub(in crate::force) fn on_second(
        self,
        second: &Recording,
    ) -> Result<OnSecond, DiagnosisError> {
        let first = self.effects.along.recorded;
        let device = first.context.device;
        let context = Context::new(device, second, &[])?;
        let mut seen = match Recorded::new(&context) {
            Ok(recorded) => self.predicted(&Along::new(&recorded)?, &self.without_effects()),
            Err(why) => OnSecond {
                not_predicted: vec![not_predicted(&why)],
                ..OnSecond::default()
            },
        };
        let joined = joined(device, first.context.recording, second);
        let both = Both::new(device, &joined, first.context)?;
        seen.warnings.extend(both.carries_more.clone());
        // what the log's own torques may keep without a gap is none of the second recording's
        let blocks = first.blocks.len();
        let kept = |joint: usize| {
            let channel = first.channel(joint)?;
            let cells = self.selection.rest_after.get(channel * blocks..)?;
            let squares: f64 = cells.iter().take(blocks).map(|rest| rest * rest).sum();
            Some((squares / blocks.max(1) as f64).sqrt())
        };
        let of_torque = |own: &HeldOutAnswer| {
            let joint: Option<usize> = own.channel.trim_start_matches("torque").parse().ok();
            let kept = joint.and_then(|joint| kept(joint - 1)).unwrap_or(0.0);
            let left = Left {
                rms: own.rms_after,
                noise: own.noise_floor,
                readings: both.blocks[1],
            };
            let of_both = both.left.iter().find(|(name, _)| *name == own.channel);
            let name = (own.channel.clone(), joint, own.unit.as_str());
            SecondChannel::new(name, (left, kept), ALLOWED, of_both.map(|own| own.1))
        };
        seen.channels = seen.held_out.iter().map(of_torque).collect();
        // one fit of both, as torques of a log are judged
        if seen.channels.iter().any(|own| own.has_gap) && both.carries_more.is_none() {
            let context = Context::new(device, &joined, &[])?;
            let together = examine(&context, &[])?;
            if !together.significant {
                let channels = seen.channels.iter_mut();
                channels.for_each(SecondChannel::explain_by_both);
            }
            let not_tested = together.not_tested.into_iter();
            let not_tested = not_tested.map(|why| format!("torques of both recordings: {why}"));
            seen.not_predicted.extend(not_tested);
        }
        let device_joints = first
            .channels
            .iter()
            .map(|joint| format!("torque{}", joint + 1));
        let is_missing = |name: &String| !seen.channels.iter().any(|own| own.channel == *name);
        if seen.not_predicted.is_empty() {
            let missing = device_joints.filter(is_missing);
            let missing = missing.map(|name| format!("it has no {name}, and the log has"));
            seen.not_predicted = missing.collect();
        }
        Ok(seen)
    }

    /// Coefficients of the base model fitted without the effects.
    fn without_effects(self) -> Vec<f64> {
        let count = self.base.scales + self.effects.along.recorded.channels.len();
        let mut alone = self.base.clone();
        alone.regression.truncate(count);
        alone.regression.solution()
    }

    /// What this model, and one with the coefficients `alone` and no effects, leave of another recording.
    pub(in crate::force) fn predicted(self, along: &Along<'_>, alone: &[f64]) -> OnSecond {
        let recorded = along.recorded;
        let own = self.effects.along;
        let before = along.predicted(own, self.base, alone);
        let solution = self.base.regression.solution();
        let mut after = along.predicted(own, self.base, &solution);
        let add = |torque: &[f64], to: &mut Vec<f64>| {
            to.iter_mut()
                .zip(torque)
                .for_each(|(sum, value)| *sum += value);
        };
        for pick in &self.selection.picks {
            let effect = self.effects.effect(pick.effect);
            if is_scale(effect) {
                continue;
            }
            let amplitudes = &solution[pick.first..pick.first + effect.spec().amplitudes];
            let signal = effect.signal(recorded.context, amplitudes, pick.shape);
            add(&recorded.signal_means(&signal), &mut after);
        }
        // as the arm was at the end of the first recording
        for payload in &self.carried.changes.payloads {
            add(&along.link_torques(&payload.inertia), &mut after);
        }
        let blocks = recorded.blocks.len();
        let mut seen = OnSecond::default();
        for (channel, &joint) in recorded.channels.iter().enumerate() {
            let Some(known) = own.recorded.channel(joint) else {
                continue;
            };
            let cells = channel * blocks..(channel + 1) * blocks;
            let mut unseen = UnseenBlocks {
                channel: known,
                rows: blocks as f64,
                before: vec![0.0; FOLDS],
                after: vec![0.0; FOLDS],
                floor: recorded.block_variance(channel),
            };
            for (block, cell) in cells.enumerate() {
                let fold = block * FOLDS / blocks.max(1);
                let measured = along.reading[cell];
                unseen.before[fold] += (measured - before[cell]).powi(2);
                unseen.after[fold] += (measured - after[cell]).powi(2);
                let rows = &recorded.blocks[block].rows;
                seen.predictions.push(Prediction {
                    row: rows.start + rows.len() / 2,
                    channel: format!("torque{}", joint + 1),
                    measured,
                    before: before[cell],
                    after: after[cell],
                });
            }
            seen.held_out.push(held_out(own.recorded, &unseen));
        }
        seen
    }
}

/// Why the torques of a second recording are not judged.
pub(crate) fn not_predicted(why: &str) -> String {
    format!("the torques of the second recording were not predicted: {why}")
}

/// One fit of two recordings of torques.
#[derive(Default)]
struct Both {
    /// A warning where the arm carries more, or less, in the second one than at the end of the first.
    carries_more: Option<String>,
    /// What the base model leaves of each channel, in the first and in the second.
    left: Vec<(String, [Left; 2])>,
    /// Blocks of the first and of the second.
    blocks: [f64; 2],
}

impl Both {
    /// `both`: the two as runs of one, of which the first has those of `first`.
    fn new(device: &Device, both: &Recording, first: &Context<'_>) -> Result<Self, DiagnosisError> {
        let context = Context::new(device, both, &[])?;
        let Ok(recorded) = Recorded::new(&context) else {
            return Ok(Self::default());
        };
        let along = Along::new(&recorded)?;
        let Some(whitener) = along.whitener(Besides::Nothing) else {
            return Ok(Self::default());
        };
        let base = along.fit(&whitener, Besides::Nothing);
        let found = changes(&along, &base).payloads;
        let told = |payload: &Payload| {
            let [low, high] = payload.size.ci95_kg;
            format!(
                "the arm carries {:+.3} kg [{low:.3}, {high:.3}] in the second recording, beyond what it carried at the end of \
                 the log: the gap of the second recording has this in it",
                payload.size.mass_kg
            )
        };
        let runs = first.runs.len();
        let rest = base.rest();
        let count = recorded.blocks.len();
        let of_second: Vec<bool> = (recorded.blocks.iter())
            .map(|block| block.rows.start >= first.rows())
            .collect();
        let blocks = [false, true].map(|side| {
            let own = of_second.iter().filter(|own| **own == side);
            own.count() as f64
        });
        let left = recorded
            .channels
            .iter()
            .enumerate()
            .map(|(channel, joint)| {
                let cells = &rest[channel * count..][..count];
                let both = [false, true].map(|side| {
                    let own = cells.iter().zip(&of_second).filter(|own| *own.1 == side);
                    let squares: f64 = own.map(|(rest, _)| rest * rest).sum();
                    let readings = blocks[usize::from(side)];
                    Left {
                        rms: (squares / readings.max(1.0)).sqrt(),
                        noise: recorded.block_variance(channel).sqrt(),
                        readings,
                    }
                });
                (format!("torque{}", joint + 1), both)
            });
        Ok(Self {
            carries_more: found.iter().find(|own| own.run == runs).map(told),
            left: left.collect(),
            blocks,
        })
    }
}

/// Two recordings one after the other, as runs of one; torques without what the device's own effects add.
fn joined(device: &Device, first: &Recording, second: &Recording) -> Recording {
    let rows = first.len() + second.len();
    let number = |recording: &Recording, from: i64| -> Vec<i64> {
        match &recording.run {
            Some(run) => {
                let mut number = from;
                let mut last = run.first().copied();
                let next = |&own: &i64| {
                    number += i64::from(last != Some(own));
                    last = Some(own);
                    number
                };
                run.iter().map(next).collect()
            }
            None => vec![from; recording.len()],
        }
    };
    let mut run = number(first, 1);
    let from = run.last().copied().unwrap_or(0) + 1;
    run.extend(number(second, from));
    let numbers = |a: &Vec<f64>, b: &Vec<f64>| [a.as_slice(), b.as_slice()].concat();
    let joints = first.joint.len();
    let torque_nm = (0..joints).map(|joint| {
        let own = |recording| torque_nm_without_effects(device, recording, joint);
        Some(numbers(&own(first)?, &own(second)?))
    });
    Recording {
        line: (2..).take(rows).collect(),
        time_s: first
            .time_s
            .as_ref()
            .zip(second.time_s.as_ref())
            .map(|(a, b)| numbers(a, b)),
        run: Some(run),
        joint: first
            .joint
            .iter()
            .zip(&second.joint)
            .map(|(a, b)| numbers(a, b))
            .collect(),
        output: vec![None; joints],
        torque_nm: torque_nm.collect(),
        force_n: (first.force_n.as_ref().zip(second.force_n.as_ref()))
            .map(|(a, b)| [0, 1, 2].map(|axis| numbers(&a[axis], &b[axis]))),
        ..Recording::default()
    }
}
