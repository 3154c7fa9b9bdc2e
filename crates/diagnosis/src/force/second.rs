//! A second recording of torques: what the model of the first one leaves of it, and whether the arm carries the same.

use haptical_effects::Context;
use haptical_model::{Device, Recording};
use haptical_motion::torque_nm_without_effects;

use super::Model;
use super::along::Along;
use super::changes::{FOLDS, Payload};
use super::effects::is_scale;
use super::recorded::Recorded;
use crate::DiagnosisError;
use crate::answer::second::{Left, SecondAnswer, SecondChannel};
use crate::answer::{HeldOutAnswer, Prediction};
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

/// Why the torques of a second recording are not judged.
pub(crate) fn not_predicted(why: &str) -> String {
    format!("the torques of the second recording were not predicted: {why}")
}

impl Model<'_> {
    /// Predicts a second recording, and compares what the arm carries in both: one model of both, of which the first is some runs.
    pub(super) fn on_second(&self, second: &Recording) -> Result<OnSecond, DiagnosisError> {
        let first = &self.effects.along.recorded;
        let device = first.context.device;
        let context = Context::new(device, second, &[])?;
        let mut seen = match Recorded::new(&context, false) {
            Ok(recorded) => self.predicted(&Along::new(recorded)?),
            Err(why) => OnSecond {
                not_predicted: vec![not_predicted(&why)],
                ..OnSecond::default()
            },
        };
        let [log, second] = [
            [first.context.recording, second],
            [second, first.context.recording],
        ]
        .map(|both| torques_alone(device, both));
        let Ok(joined) = Recording::joined(&[&log, &second]) else {
            return Ok(seen);
        };
        let context = Context::new(device, &joined, &[])?;
        let mut both = Model::new(&context, false, &[])?;
        let of_runs = both.as_ref().map(|both| both.carried.payloads.as_slice());
        let is_between = |own: &&Payload| own.run == first.context.runs.len();
        let carries_more = of_runs
            .unwrap_or_default()
            .iter()
            .find(is_between)
            .map(told);
        let has_same = carries_more.is_none();
        seen.warnings.extend(carries_more);
        for own in &seen.held_out {
            let of_channel = |channel: &usize| first.name(*channel) == own.channel;
            let Some(channel) = (0..first.channels.len()).find(of_channel) else {
                continue;
            };
            let joint = first.channels[channel];
            let of_both = both
                .as_ref()
                .ok()
                .and_then(|both| both.left_of(joint, log.len()));
            let left = Left {
                rms: own.rms_after,
                noise: own.noise_floor,
                readings: of_both.map_or(0.0, |both| both[1].readings),
            };
            // what the log's own torques may keep without a gap is none of the second recording's
            let rest = self.selection.rest_after.column(channel);
            let kept = (rest.norm_squared() / rest.len().max(1) as f64).sqrt();
            let name = (own.channel.clone(), Some(joint + 1), own.unit.as_str());
            let channel = SecondChannel::new(name, (left, kept), ALLOWED, of_both);
            seen.channels.push(channel);
        }
        // one fit of both, as torques of a log are judged
        if seen.channels.iter().any(|own| own.has_gap) && has_same {
            let not_tested = match &mut both {
                Ok(both) => {
                    both.selection = both.effects.select(&mut both.base)?;
                    let together = both.answer()?;
                    (!together.significant, together.not_tested)
                }
                Err(why) => (true, Some(why.clone())),
            };
            let (is_explained, not_tested) = not_tested;
            if is_explained {
                let channels = seen.channels.iter_mut();
                channels.for_each(SecondChannel::explain_by_both);
            }
            let not_tested = not_tested.into_iter();
            let not_tested = not_tested.map(|why| format!("torques of both recordings: {why}"));
            seen.not_predicted.extend(not_tested);
        }
        if seen.not_predicted.is_empty() {
            let names = (0..first.channels.len()).map(|channel| first.name(channel));
            let missing =
                names.filter(|name| !seen.channels.iter().any(|own| own.channel == *name));
            let missing = missing.map(|name| format!("it has no {name}, and the log has"));
            seen.not_predicted = missing.collect();
        }
        Ok(seen)
    }

    /// What the base model leaves of a joint's torque, in the first rows and in the others.
    fn left_of(&self, joint: usize, first_rows: usize) -> Option<[Left; 2]> {
        let recorded = &self.effects.along.recorded;
        let channel = recorded.channel(joint)?;
        let noise = recorded.block_variances()[channel].sqrt();
        let rest = self.carried.rest_before.column(channel);
        Some([false, true].map(|side| {
            let blocks = recorded.blocks.iter().zip(&rest);
            let own = blocks.filter(|(block, _)| (block.rows.start >= first_rows) == side);
            let squares: Vec<f64> = own.map(|(_, rest)| rest * rest).collect();
            let readings = squares.len() as f64;
            Left {
                rms: (squares.iter().sum::<f64>() / readings.max(1.0)).sqrt(),
                noise,
                readings,
            }
        }))
    }

    /// What this model, and its base model without effects, leave of another recording.
    pub(super) fn predicted(&self, along: &Along<'_>) -> OnSecond {
        let (recorded, own) = (&along.recorded, &self.effects.along);
        let mut alone = self.base.regression.clone();
        alone.truncate(self.base.scales.end);
        let solution = self.base.regression.solution();
        let [before, mut after] = [&alone.solution(), &solution]
            .map(|solution| along.predicted(own, &self.base, solution));
        for pick in &self.selection.picks {
            let effect = self.effects.effect(pick.effect);
            if !is_scale(effect) {
                let amplitudes = &solution[pick.first..pick.first + effect.spec().amplitudes];
                let signal = effect.signal(recorded.context, amplitudes, pick.shape);
                after += recorded.signal_means(&signal);
            }
        }
        // as the arm was at the end of the first recording
        for payload in &self.carried.payloads {
            after += along.link_torques(&payload.inertia);
        }
        let blocks = recorded.blocks.len();
        let variances = recorded.block_variances();
        let mut seen = OnSecond::default();
        for (channel, &joint) in recorded.channels.iter().enumerate() {
            if own.recorded.channel(joint).is_none() {
                continue;
            }
            let mut sums = [vec![0.0; FOLDS], vec![0.0; FOLDS]];
            for (index, block) in recorded.blocks.iter().enumerate() {
                let at = (index, channel);
                let [measured, before, after] = [along.reading[at], before[at], after[at]];
                for (sums, model) in sums.iter_mut().zip([before, after]) {
                    sums[index * FOLDS / blocks.max(1)] += (measured - model).powi(2);
                }
                seen.predictions.push(Prediction {
                    row: block.rows.start + block.rows.len() / 2,
                    channel: recorded.name(channel),
                    measured,
                    before,
                    after,
                });
            }
            let held_out = recorded.held_out(channel, blocks as f64, variances[channel], sums);
            seen.held_out.push(held_out);
        }
        seen
    }
}

/// A warning where the arm carries more, or less, in the second recording than at the end of the first.
fn told(payload: &Payload) -> String {
    let [low, high] = payload.size.ci95_kg;
    format!(
        "the arm carries {:+.3} kg [{low:.3}, {high:.3}] in the second recording, beyond what it carried at the end of \
         the log: the gap of the second recording has this in it",
        payload.size.mass_kg
    )
}

/// What the torques of one recording are examined by, without what the device's own effects add, where another one has it too.
fn torques_alone(device: &Device, [own, other]: [&Recording; 2]) -> Recording {
    let torque_of = |joint: usize| {
        other.torque_nm.get(joint)?.as_ref()?;
        torque_nm_without_effects(device, own, joint)
    };
    let joints = 0..own.joint.len();
    Recording {
        line: own.line.clone(),
        time_s: own.time_s.clone().filter(|_| other.time_s.is_some()),
        run: own.run.clone(),
        joint: own.joint.clone(),
        output: vec![None; joints.len()],
        torque_nm: joints.map(torque_of).collect(),
        force_n: own.force_n.clone().filter(|_| other.force_n.is_some()),
        ..Recording::default()
    }
}
