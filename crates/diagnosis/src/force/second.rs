//! A second recording of torques: what the model of the first one leaves of it, and whether the arm carries the same.

use haptical_effects::Context;
use haptical_linalg::{Information, dot};
use haptical_model::{Device, Recording};
use haptical_motion::{Unseen, torque_nm_without_effects};

use super::along::Along;
use super::changes::Payload;
use super::effects::is_scale;
use super::recorded::Recorded;
use super::{Means, Model};
use crate::Result;
use crate::answer::{OnSecond, SecondChannel, held_out};
use crate::thresholds::recording::MOST_LEVERAGE;

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
        let mut undetermined = Vec::new();
        for mut unseen in unseen {
            let Some(channel) = first.channel(unseen.joint) else {
                continue;
            };
            let (lacking, kept) = (unseen.left_out.0, unseen.rows_in_all());
            if lacking > 0 {
                let (name, _) = first.named(channel);
                undetermined.push(format!("{name} {lacking} of {}", lacking + kept));
            }
            if kept == 0 {
                continue;
            }
            let both = both.as_ref().ok();
            unseen.of_both = both.and_then(|both| both.left_of(unseen.joint, log.len()));
            // what the model leaves of the log without a gap is no gap of the second recording
            let rest = self.selection.rest_after.column(channel);
            let kept = (rest.norm_squared() / rest.len().max(1) as f64).sqrt();
            let answer = held_out(first.named(channel), &unseen, &unseen.after);
            seen.add(answer, &unseen, (kept, rest.len()), true);
        }
        let has_gap = seen.second.channels.iter().any(|own| own.has_gap);
        match seen.held_out.is_empty() {
            true => seen.second.not_predicted.extend(left_out(&undetermined)),
            // where the torques show nothing the counts alone are kept
            false if has_gap || !self.selection.picks.is_empty() => {
                seen.warnings.extend(left_out(&undetermined));
            }
            false => {}
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
            let missing = missing.map(|name| format!("nothing of {name} could be compared"));
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

    /// Columns of another recording for the numbers of this model, effects included; none of a number that says nothing there.
    fn columns_of(&self, along: &Along<'_>) -> Vec<Option<Means>> {
        let recorded = &along.recorded;
        let base = along.columns_of(&self.effects.along, &self.base);
        let mut columns: Vec<Option<Means>> = base.into_iter().map(Some).collect();
        columns.resize(self.base.regression.len(), None);
        for pick in &self.selection.picks {
            let effect = self.effects.effect(pick.effect);
            if is_scale(effect) {
                continue;
            }
            let amplitudes = effect.spec().amplitudes;
            for place in 0..amplitudes {
                let unit: Vec<f64> = (0..amplitudes)
                    .map(|k| f64::from(u8::from(k == place)))
                    .collect();
                let signal = effect.signal(recorded.context, &unit, pick.shape);
                columns[pick.first + place] = Some(recorded.signal_means(&signal));
            }
        }
        columns
    }

    /// What this model leaves of the torques that another recording has too, without effects and with them. Blocks that the rows of the
    /// log do not determine are left out (A245).
    pub(super) fn predicted(&self, along: &Along<'_>) -> Vec<Unseen> {
        let (recorded, first) = (&along.recorded, &self.effects.along);
        let regression = &self.base.regression;
        let information = Information::new(regression.len(), |a, b| {
            dot(regression.column(a), regression.column(b))
        });
        let mut alone = regression.clone();
        alone.truncate(self.base.scales.end);
        let columns = self.columns_of(along);
        let [before, mut after] = [alone.solution(), regression.solution()].map(|solution| {
            let mut torque = along.reading.map(|_| 0.0);
            let columns = columns.iter().zip(&solution);
            for (column, factor) in
                columns.filter_map(|(own, factor)| Some((own.as_ref()?, factor)))
            {
                torque += column * *factor;
            }
            torque
        });
        // the arm carries what it carried at the end of the first recording
        for payload in &self.carried.payloads {
            after += along.link_torques(&payload.inertia);
        }
        let channels = recorded.channels.iter().zip(recorded.block_variances());
        let channels = channels.enumerate();
        let common = channels.filter(|(_, (joint, _))| first.recorded.channel(**joint).is_some());
        let unseen = common.map(|(channel, (&joint, variance))| {
            let mut unseen = Unseen::new(joint, variance.sqrt());
            let mut errors = 0.0;
            for (index, block) in recorded.blocks.iter().enumerate() {
                let at = (index, channel);
                let [measured, before, after] = [along.reading[at], before[at], after[at]];
                let squares = [before, after].map(|model| (measured - model).powi(2));
                let entry = |number: usize| columns[number].as_ref().map_or(0.0, |own| own[at]);
                let leverage = information.leverage(|number| entry(number) / variance.sqrt());
                // not so of what is no number
                let is_determined = leverage <= MOST_LEVERAGE;
                if !is_determined {
                    unseen.leave_out(squares[0]);
                    continue;
                }
                errors += leverage;
                unseen.add((index, recorded.blocks.len()), squares);
                let middle = block.rows.start + block.rows.len() / 2;
                unseen.predictions.push((middle, [measured, before, after]));
            }
            unseen.error_of_fit = errors / unseen.rows_in_all().max(1) as f64;
            unseen
        });
        unseen.collect()
    }
}

/// What is said of the torques of which means over time are not predicted.
fn left_out(torques: &[String]) -> Option<String> {
    (!torques.is_empty()).then(|| {
        format!(
            "means over time of the second recording are not predicted and left out, as the rows of the log do not determine the arm's \
             torques there: {}",
            torques.join(", ")
        )
    })
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
