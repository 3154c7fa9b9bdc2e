//! A second recording of torques: what the model of the first one leaves of it, and whether the arm carries the same.

use haptical_effects::Context;
use haptical_model::{Device, Recording};
use haptical_motion::torque_nm_without_effects;

use super::carried::{Carried, held_out};
use super::{FOLDS, Payload, UnseenBlocks, changes};
use crate::DiagnosisError;
use crate::answer::{HeldOutAnswer, Prediction};
use crate::force::along::Along;
use crate::force::base::Base;
use crate::force::effects::{Effects, is_scale};
use crate::force::recorded::{Besides, Recorded};
use crate::force::select::Selection;

/// What a second recording shows.
#[derive(Debug, Clone, Default)]
pub(crate) struct OnSecond {
    /// Gap of each torque before and after.
    pub(crate) held_out: Vec<HeldOutAnswer>,
    /// Block means, at the row in the middle of each.
    pub(crate) predictions: Vec<Prediction>,
    pub(crate) warnings: Vec<String>,
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
            Ok(recorded) => self.predicted(&Along::new(&recorded), &self.without_effects()),
            Err(why) => OnSecond {
                warnings: vec![format!(
                    "the torques of the second recording were not predicted: {why}"
                )],
                ..OnSecond::default()
            },
        };
        let both = joined(device, first.context.recording, second);
        seen.warnings
            .extend(carries_more(device, &both, first.context.runs.len())?);
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

/// A warning where the arm carries more, or less, in the runs from `first` on than at the end of those before.
fn carries_more(
    device: &Device,
    both: &Recording,
    first: usize,
) -> Result<Option<String>, DiagnosisError> {
    let context = Context::new(device, both, &[])?;
    let Ok(recorded) = Recorded::new(&context) else {
        return Ok(None);
    };
    let along = Along::new(&recorded);
    let Some(whitener) = along.whitener(Besides::Nothing) else {
        return Ok(None);
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
    Ok(found.iter().find(|payload| payload.run == first).map(told))
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
        ..Recording::default()
    }
}
