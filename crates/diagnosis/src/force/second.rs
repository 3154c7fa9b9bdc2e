//! A second recording of torques: what the model of the first one leaves of it, and whether the arm carries the same.

use haptical_effects::Context;
use haptical_model::{Device, Recording};
use haptical_motion::{Unseen, torque_nm_without_effects};

use super::Model;
use super::along::Along;
use super::changes::Payload;
use super::effects::is_scale;
use super::recorded::Recorded;
use crate::Result;
use crate::answer::{OnSecond, SecondChannel, held_out};

impl Model<'_> {
    /// Predicts a second recording, and compares what the arm carries in both by one model whose runs are those of
    /// both recordings.
    pub(super) fn on_second(&self, second: &Recording) -> Result<OnSecond> {
        let first = &self.effects.along.recorded;
        let (device, log) = (first.context.device, first.context.recording);
        let context = Context::new(device, second, &[])?;
        let (mut seen, unseen) = match Recorded::new(&context, false) {
            Ok(recorded) => (OnSecond::default(), self.predicted(&Along::new(recorded)?)),
            Err(why) => (OnSecond::not_predicted(&why), Vec::new()),
        };
        let both = [[log, second], [second, log]].map(|both| torques_alone(device, both));
        let Ok(joined) = Recording::joined(&both.each_ref()) else {
            return Ok(seen);
        };
        let context = Context::new(device, &joined, &[])?;
        let mut both = Model::new(&context, false, &[])?;
        let payloads = both.as_ref().map(|both| both.carried.payloads.as_slice());
        let is_between = |payload: &&Payload| payload.run == first.context.runs.len();
        let carries_more = payloads.unwrap_or_default().iter().find(is_between);
        let has_same = carries_more.is_none();
        seen.warnings.extend(carries_more.map(warning));
        for mut unseen in unseen {
            let Some(channel) = first.channel(unseen.joint) else {
                continue;
            };
            let both = both.as_ref().ok();
            unseen.of_both = both.and_then(|both| both.left_of(unseen.joint, log.len()));
            // what the model leaves of the log without a gap is no gap of the second recording
            let rest = self.selection.rest_after.column(channel);
            let kept = (rest.norm_squared() / rest.len().max(1) as f64).sqrt();
            let answer = held_out(first.named(channel), &unseen, &unseen.after);
            seen.add(answer, &unseen, (kept, rest.len()), true);
        }
        // one fit of both is judged as the torques of a log are
        let found = &mut seen.second;
        if found.channels.iter().any(|channel| channel.has_gap) && has_same {
            let (is_explained, not_tested) = match &mut both {
                Ok(both) => {
                    both.selection = both.effects.select(&mut both.base)?;
                    let together = both.answer()?;
                    (!together.significant, together.not_tested)
                }
                Err(why) => (true, Some(why.clone())),
            };
            if is_explained {
                let channels = found.channels.iter_mut();
                channels.for_each(SecondChannel::explain_by_both);
            }
            let not_tested = not_tested.into_iter();
            let not_tested = not_tested.map(|why| format!("torques of both recordings: {why}"));
            found.not_predicted.extend(not_tested);
        }
        if found.not_predicted.is_empty() {
            let names = (0..first.channels.len()).map(|channel| first.named(channel).0);
            let is_seen = |name: &String| {
                found
                    .channels
                    .iter()
                    .any(|channel| channel.channel == *name)
            };
            let missing = names.filter(|name| !is_seen(name));
            let missing = missing.map(|name| format!("it has no {name}, and the log has"));
            found.not_predicted = missing.collect();
        }
        Ok(seen)
    }

    /// Root mean square over the noise of what the base model leaves of a joint's torque, in the first rows and in the others.
    fn left_of(&self, joint: usize, first_rows: usize) -> Option<[f64; 2]> {
        let recorded = &self.effects.along.recorded;
        let channel = recorded.channel(joint)?;
        let variance = recorded.block_variances()[channel];
        let rest = self.carried.rest_before.column(channel);
        Some([false, true].map(|side| {
            let blocks = recorded.blocks.iter().zip(&rest);
            let blocks = blocks.filter(|(block, _)| (block.rows.start >= first_rows) == side);
            let squares: Vec<f64> = blocks.map(|(_, rest)| rest * rest).collect();
            let mean = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
            (mean / variance).sqrt()
        }))
    }

    /// What this model leaves of the torques that another recording has too, without effects and with them.
    pub(super) fn predicted(&self, along: &Along<'_>) -> Vec<Unseen> {
        let (recorded, first) = (&along.recorded, &self.effects.along);
        let mut alone = self.base.regression.clone();
        alone.truncate(self.base.scales.end);
        let solution = self.base.regression.solution();
        let [before, mut after] = [&alone.solution(), &solution]
            .map(|solution| along.predicted(first, &self.base, solution));
        for pick in &self.selection.picks {
            let effect = self.effects.effect(pick.effect);
            if !is_scale(effect) {
                let amplitudes = &solution[pick.first..pick.first + effect.spec().amplitudes];
                let signal = effect.signal(recorded.context, amplitudes, pick.shape);
                after += recorded.signal_means(&signal);
            }
        }
        // the arm carries what it carried at the end of the first recording
        for payload in &self.carried.payloads {
            after += along.link_torques(&payload.inertia);
        }
        let channels = recorded.channels.iter().zip(recorded.block_variances());
        let channels = channels.enumerate();
        let common = channels.filter(|(_, (joint, _))| first.recorded.channel(**joint).is_some());
        let unseen = common.map(|(channel, (&joint, variance))| {
            let mut unseen = Unseen::new(joint, variance.sqrt());
            for (index, block) in recorded.blocks.iter().enumerate() {
                let at = (index, channel);
                let [measured, before, after] = [along.reading[at], before[at], after[at]];
                let squares = [before, after].map(|model| (measured - model).powi(2));
                unseen.add((index, recorded.blocks.len()), squares);
                let middle = block.rows.start + block.rows.len() / 2;
                unseen.predictions.push((middle, [measured, before, after]));
            }
            unseen
        });
        unseen.collect()
    }
}

/// A warning where the arm carries more, or less, in the second recording than at the end of the first.
fn warning(payload: &Payload) -> String {
    let mass_kg = payload.cause.parameters["mass_kg"];
    let [low, high] = mass_kg.ci95;
    format!(
        "the arm carries {:+.3} kg [{low:.3}, {high:.3}] in the second recording, beyond what it carried at the end of \
         the log: the gap of the second recording has this in it",
        mass_kg.value
    )
}

/// The part of a recording by which its torques are examined, where another recording has that too. The torques are
/// without what the device's effects add.
fn torques_alone(device: &Device, [recording, other]: [&Recording; 2]) -> Recording {
    let torque_of = |joint: usize| {
        other.torque_nm.get(joint)?.as_ref()?;
        torque_nm_without_effects(device, recording, joint)
    };
    let joints = 0..recording.joint.len();
    Recording {
        line: recording.line.clone(),
        time_s: recording.time_s.clone().filter(|_| other.time_s.is_some()),
        run: recording.run.clone(),
        joint: recording.joint.clone(),
        output: vec![None; joints.len()],
        torque_nm: joints.map(torque_of).collect(),
        force_n: recording
            .force_n
            .clone()
            .filter(|_| other.force_n.is_some()),
        ..Recording::default()
    }
}
