//! Size of the torques' gap, joint by joint, row by row.

use crate::answer::ChannelGap;
use crate::answer::floor::Floor;
use crate::force::base::Base;
use crate::force::changes::carried::Carried;
use crate::force::effects::{Effects, is_scale};
use crate::force::rows::fast;
use crate::force::select::Selection;
use crate::noise::NoiseSource;

/// Gaps of every channel. `added`: mean squares of torques that the base model's freedom took, which were there before.
pub(super) fn channels(
    effects: &Effects<'_, '_>,
    base: &Base,
    selection: &Selection,
    carried: &Carried,
    added: &[f64],
) -> Vec<ChannelGap> {
    let recorded = effects.along.recorded;
    let along = effects.along;
    let blocks = recorded.blocks.len();
    let size = effects.rows() / blocks.max(1) as f64;
    let solution = base.regression.solution();
    let fitted_after = carried.on(&along.less(&selection.rest_after));
    let rest_before = carried
        .rest_before
        .as_ref()
        .unwrap_or(&selection.rest_before);
    let fitted_before = &carried.fitted_before;
    let gap = |(channel, &joint): (usize, &usize)| {
        let range = channel * blocks..(channel + 1) * blocks;
        let row_sd = recorded.row_sd(channel, &along.hand);
        let torque = &recorded.torque_nm[channel];
        let fast_before = fast::deviations(along, torque, &fitted_before[range.clone()]);
        let (torque, fitted) = without_picks(effects, &solution, selection, channel, &fitted_after);
        let fast_after = fast::deviations(along, &torque, &fitted);
        let within = |rest: &[(usize, f64)]| match rest.len() {
            0 => row_sd * row_sd * (1.0 - 1.0 / size),
            count => rest.iter().map(|(_, value)| value * value).sum::<f64>() / count as f64,
        };
        let (before, after) = (within(&fast_before), within(&fast_after));
        // what varies within blocks is noise but for what was named
        let noise = after / (1.0 - 1.0 / size).max(1.0 / size);
        let sizes = [
            (mean_square(&rest_before[range.clone()]) + before + added[channel]).sqrt(),
            (mean_square(&selection.rest_after[range]) + after).sqrt(),
        ];
        let floor = Floor {
            channel: haptical_calibration::Channel::Output { joint },
            rms: noise.sqrt().min(row_sd),
            freedom: (fast_after.len().max(blocks) as f64).max(1.0),
            source: if fast_after.is_empty() {
                NoiseSource::Stated
            } else {
                NoiseSource::Motion
            },
            is_another: false,
            is_contradicted: false,
        };
        let name = format!("torque{}", joint + 1);
        ChannelGap::fitted(name, Some(joint), sizes, &floor, recorded.unit(channel))
    };
    recorded.channels.iter().enumerate().map(gap).collect()
}

/// Mean square of values.
pub(super) fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64
}

/// A channel's torques without the effects that were chosen for it, row by row, and the block means
/// of what the model says of the rest.
fn without_picks(
    effects: &Effects<'_, '_>,
    solution: &[f64],
    selection: &Selection,
    channel: usize,
    fitted: &[f64],
) -> (Vec<f64>, Vec<f64>) {
    let recorded = effects.along.recorded;
    let blocks = recorded.blocks.len();
    let mut torque = recorded.torque_nm[channel].clone();
    let mut fitted = fitted[channel * blocks..(channel + 1) * blocks].to_vec();
    let context = recorded.context;
    for pick in &selection.picks {
        let effect = effects.effect(pick.effect);
        if effect.joint() != Some(recorded.channels[channel]) || is_scale(effect) {
            continue;
        }
        let amplitudes = &solution[pick.first..pick.first + effect.spec().amplitudes];
        let signal = effect.signal(context, amplitudes, pick.shape);
        for values in signal.parts.iter().map(|(_, values)| values) {
            for (torque, value) in torque.iter_mut().zip(values) {
                *torque -= value;
            }
            let means = recorded.means(|row| values[row]);
            for (fitted, mean) in fitted.iter_mut().zip(means) {
                *fitted -= mean;
            }
        }
    }
    (torque, fitted)
}
