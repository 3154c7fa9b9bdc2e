//! Size of the torques' gap, joint by joint, row by row.

use haptical_calibration::Channel;

use crate::answer::{ChannelGap, Floor, Trace};
use crate::force::effects::is_scale;
use crate::force::fast::deviations;
use crate::force::{Means, Model};
use crate::noise::NoiseSource;

impl Model<'_> {
    /// What the base model leaves of torques that still include the payloads.
    fn rest_before(&self) -> &Means {
        match self.carried.payloads.is_empty() {
            true => &self.selection.rest_before,
            false => &self.carried.rest_before,
        }
    }

    /// Gap of each channel. `added` are mean squares of torques that free numbers of the base model absorbed; the gap
    /// before includes them.
    pub(super) fn gaps(&self, added: &[f64]) -> Vec<ChannelGap> {
        let along = &self.effects.along;
        let recorded = &along.recorded;
        let blocks = recorded.blocks.len();
        let size = recorded.rows() / blocks.max(1) as f64;
        let solution = self.base.regression.solution();
        let rest_after = &self.selection.rest_after;
        let fitted_after = &along.reading - rest_after + &self.carried.torque_nm;
        let gap = |(channel, &joint): (usize, &usize)| {
            let row_sd = along.row_sd(channel);
            // mean square of what varies within blocks, and the number of rows
            let within = |torque_nm: &[f64], fitted: &[f64]| {
                let rest = deviations(recorded, torque_nm, fitted);
                let rest: Vec<f64> = rest.into_iter().flat_map(|(_, values)| values).collect();
                match rest.len() {
                    0 => (row_sd * row_sd * (1.0 - 1.0 / size), 0),
                    count => (mean_square(&rest), count),
                }
            };
            let torque_nm = &recorded.torque_nm[channel];
            let fitted_before = self.carried.fitted_before.column(channel).into_owned();
            let (before, _) = within(torque_nm, fitted_before.as_slice());
            let fitted = fitted_after.column(channel).into_owned();
            let (torque_nm, fitted) = self.without_picks(
                &solution,
                channel,
                (torque_nm.clone(), fitted.as_slice().to_vec()),
            );
            let (after, fast) = within(&torque_nm, &fitted);
            // what varies within blocks is noise, except what was named
            let noise = after / (1.0 - 1.0 / size).max(1.0 / size);
            let [of_before, of_after] = [self.rest_before(), rest_after]
                .map(|rest| rest.column(channel).norm_squared() / blocks.max(1) as f64);
            let floor = Floor::new(
                Channel::Output { joint },
                noise.sqrt().min(row_sd),
                (fast.max(blocks) as f64).max(1.0),
                match fast {
                    0 => NoiseSource::Stated,
                    _ => NoiseSource::Motion,
                },
            );
            let sizes = [
                (of_before + before + added[channel]).sqrt(),
                (of_after + after).sqrt(),
            ];
            let (name, unit) = recorded.named(channel);
            ChannelGap::fitted(name, Some(joint), sizes, &floor, unit)
        };
        recorded.channels.iter().enumerate().map(gap).collect()
    }

    /// A channel's torques row by row, and the model's block means, both without the effects that were chosen for the
    /// channel.
    fn without_picks(
        &self,
        solution: &[f64],
        channel: usize,
        (mut torque_nm, mut fitted): (Vec<f64>, Vec<f64>),
    ) -> (Vec<f64>, Vec<f64>) {
        let recorded = &self.effects.along.recorded;
        let take_off = |from: &mut [f64], values: &[f64]| {
            let pairs = from.iter_mut().zip(values);
            pairs.for_each(|(from, value)| *from -= value);
        };
        for pick in &self.selection.picks {
            let effect = self.effects.effect(pick.effect);
            if self.effects.channel(pick.effect) != Some(channel) || is_scale(effect) {
                continue;
            }
            let amplitudes = &solution[pick.first..pick.first + effect.spec().amplitudes];
            let signal = effect.signal(recorded.context, amplitudes, pick.shape);
            for (_, values) in &signal.parts {
                take_off(&mut torque_nm, values);
                take_off(&mut fitted, &recorded.means(values));
            }
        }
        (torque_nm, fitted)
    }

    /// The torques with the largest gap, over time.
    pub(super) fn course(&self, channels: &[ChannelGap]) -> Option<Trace> {
        let recorded = &self.effects.along.recorded;
        let time_s = recorded.context.recording.time_s.as_ref()?;
        let share = |channel: &usize| channels[*channel].share_of_gap;
        let channel = (0..channels.len()).max_by(|a, b| share(a).total_cmp(&share(b)))?;
        let on_channel = |rest: &Means| rest.column(channel).iter().copied().collect();
        Some(Trace::over_time(
            channels[channel].channel.clone(),
            recorded.named(channel).1,
            &recorded.means(time_s),
            [self.rest_before(), &self.selection.rest_after].map(on_channel),
        ))
    }
}

pub(super) fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64
}
