//! Calibration in spite of wild readings: reweighted fits, and which readings are wild.

use std::collections::BTreeMap;

use haptical_identification::{Loss, robust_scale};
use haptical_metrics::gap_reduction_percent;
use haptical_model::{Device, Recording};
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::problem::residuals::lengths;
use crate::problem::some_rows::some_of_long;
use crate::problem::weights::to_its_digits;
use crate::steps::device::fit_once;
use crate::steps::fitted::{LEAST_FREEDOM, parameters_paid_by};
use crate::{
    CalibrationError, CalibrationMethod, Channel, ChannelReport, ChannelResiduals, FittedDevice,
    Options, Outlier, RobustChannel, Robustness, Weighting, Weights, channels,
};

/// Reweightings with one loss, in two steps and in the joint fit, which begins with the others' weights.
const ROUNDS: usize = 15;
const JOINT_ROUNDS: usize = 5;
/// Reweightings by all rows of a long recording, whose weights some of them have shown.
const ROUNDS_OF_ALL: usize = 12;
/// Change of a weight's root that is worth another fit.
const SETTLED: f64 = 1e-2;
/// Chance that noise alone lets some reading of a channel count as wild.
const FALSE_ALARM: f64 = 1e-3;
/// Median length of three standard normal numbers, over that of one times the root of 3: a channel of three
/// axes is judged by its length over that root (chi with 3 degrees of freedom has its median at 1.538 17).
const THREE_AXES: f64 = 1.538_172_254_454_8 / 1.732_050_807_568_877_2 / 0.674_489_750_196_082;

/// Sizes of a channel's readings, row by row: signed for one axis.
fn sizes(channel: Channel, residuals: &[f64]) -> Vec<f64> {
    let axes = (channel.width() as f64).sqrt();
    lengths(channel, residuals)
        .map(|length| length / axes)
        .collect()
}

fn scale_of(channel: Channel, sizes: &[f64], parameters: f64, floor: f64) -> f64 {
    let scale = match channel.width() {
        1 => robust_scale(sizes, parameters),
        width => robust_scale(sizes, parameters / width as f64) / THREE_AXES,
    };
    // half of the readings fitted exactly: their noise is not zero
    scale.max(1e-3 * floor).max(f64::MIN_POSITIVE)
}

/// Efficiency of the median size as a scale: n sizes say as much of it as 0.37 n squares do (Huber & Ronchetti
/// 2009, section 5.1).
const MEDIAN_EFFICIENCY: f64 = 0.37;

/// Standard deviations beyond which the loss of one in a thousand recordings of noise would begin. The scale is
/// found from the same readings: Student's distribution, with as many degrees of freedom as it is worth.
fn limit(readings: usize) -> f64 {
    let readings = readings.max(1) as f64;
    let share = FALSE_ALARM / 2.0 / readings;
    let freedom = (MEDIAN_EFFICIENCY * readings).max(1.0);
    let spread = StudentsT::new(0.0, 1.0, freedom);
    spread.map_or(f64::INFINITY, |spread| -spread.inverse_cdf(share))
}

/// Readings of a recording farther from the device than noise of the given scales explains, farthest first.
///
/// The limit leaves one recording in a thousand of each channel with a false alarm, if the noise is normal.
///
/// `residuals` are those of the scales' channels.
pub(crate) fn far_out(
    residuals: &[ChannelResiduals],
    recording: &Recording,
    scales: &[RobustChannel],
) -> Vec<Outlier> {
    let mut outliers = Vec::new();
    for (channel, scale) in residuals.iter().zip(scales) {
        let (rows, own) = (&channel.rows, &channel.residuals);
        outliers.extend(outliers_of(
            channel.channel,
            rows,
            own,
            recording,
            scale.scale,
        ));
    }
    outliers.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
    outliers
}

fn outliers_of(
    channel: Channel,
    rows: &[usize],
    residuals: &[f64],
    recording: &Recording,
    scale: f64,
) -> Vec<Outlier> {
    let limit = limit(rows.len());
    let axes = (channel.width() as f64).sqrt();
    let rows = rows.iter().zip(sizes(channel, residuals));
    rows.filter(|(_, size)| size.abs() > limit * scale)
        .map(|(&row, size)| Outlier {
            line: recording.line.get(row).copied().unwrap_or(0),
            channel,
            residual: size * axes,
            deviations: size / scale,
        })
        .collect()
}

/// Counts a report's outliers and sets them aside in its figures of the good ones. The report's rows
/// are those of `recording`.
pub(crate) fn set_aside(
    report: &mut ChannelReport,
    robust: &Robustness,
    recording: &Recording,
) -> Vec<Outlier> {
    let mut scales = robust.channels.iter();
    let Some(RobustChannel { channel, scale, .. }) =
        scales.find(|scale| scale.channel.name() == report.channel)
    else {
        return Vec::new();
    };
    let outliers = outliers_of(*channel, &report.rows, &report.after, recording, *scale);
    let limit = limit(report.rows.len()) * scale;
    let is_good: Vec<bool> = sizes(*channel, &report.after)
        .into_iter()
        .map(|size| size.abs() <= limit)
        .collect();
    let rms_of_good = |residuals: &[f64]| {
        let readings = residuals.chunks_exact(channel.width()).zip(&is_good);
        let good = readings.filter(|(_, is_good)| **is_good);
        let (mut square, mut count) = (0.0, 0_usize);
        for residual in good.flat_map(|(axes, _)| axes) {
            square += residual * residual;
            count += 1;
        }
        (square / count.max(1) as f64).sqrt()
    };
    report.rms_before_good = rms_of_good(&report.before);
    report.rms_after_good = rms_of_good(&report.after);
    report.reduction_percent_good = gap_reduction_percent(
        report.rms_before_good,
        report.rms_after_good,
        report.noise_floor,
    );
    report.outliers = outliers.len();
    outliers
}

/// Scales of the channels and weights of their readings at a fitted device.
pub(crate) fn judge(
    fitted: &FittedDevice,
    recording: &Recording,
    loss: Loss,
) -> Result<(Vec<RobustChannel>, Weights), CalibrationError> {
    let residuals = fitted.residuals(recording)?;
    Ok(judge_residuals(fitted, recording, &residuals, loss))
}

/// The same where the residuals are there.
pub(crate) fn judge_residuals(
    fitted: &FittedDevice,
    recording: &Recording,
    residuals: &[ChannelResiduals],
    loss: Loss,
) -> (Vec<RobustChannel>, Weights) {
    let mut weights = fitted.weights.trusting();
    let mut scales = Vec::with_capacity(residuals.len());
    for channel in residuals {
        let sizes = sizes(channel.channel, &channel.residuals);
        let parameters = parameters_paid_by(fitted, channel.channel);
        if channel.residuals.len() as f64 - parameters < LEAST_FREEDOM {
            let factor = weights.factor.get(&channel.channel);
            scales.push(RobustChannel {
                channel: channel.channel,
                scale: channel.noise_floor * factor.copied().unwrap_or(1.0),
                variance_factor: 1.0,
            });
            continue;
        }
        let scale = scale_of(channel.channel, &sizes, parameters, channel.noise_floor);
        let deviations: Vec<f64> = sizes.iter().map(|size| size / scale).collect();
        let variance_factor = loss.variance_factor(&deviations).unwrap_or(1.0);
        let own: BTreeMap<u64, f64> = channel
            .rows
            .iter()
            .zip(&deviations)
            .filter_map(|(&row, &size)| {
                let weight = to_its_digits(loss.weight(size));
                Some((*recording.line.get(row)?, weight))
            })
            .filter(|(_, weight)| *weight < 1.0)
            .collect();
        if !own.is_empty() {
            weights.distrusted.insert(channel.channel, own);
        }
        if channel.noise_floor > 0.0 {
            let factor = to_its_digits(scale / channel.noise_floor);
            weights.factor.insert(channel.channel, factor);
        }
        scales.push(RobustChannel {
            channel: channel.channel,
            scale,
            variance_factor,
        });
    }
    (scales, weights)
}

/// Weights that were found.
struct Reweighted {
    scales: Vec<RobustChannel>,
    weights: Weights,
    /// Whether they stand still.
    settled: bool,
}

/// Fits one after the other, each with weights by what the one before left.
struct Reweighting<'a> {
    device: &'a Device,
    present: &'a [Channel],
    rounds: usize,
    fitted: Option<FittedDevice>,
}

impl Reweighting<'_> {
    /// In stages, each of a loss with rounds until the weights stand still, but so many at most.
    fn reweighted(
        &mut self,
        rows: &Recording,
        mut weights: Weights,
        stages: &[(Loss, &Options, usize)],
    ) -> Result<Reweighted, CalibrationError> {
        let (mut scales, mut settled) = (Vec::new(), false);
        for (loss, options, limit) in stages {
            for _ in 0..*limit {
                // weights change little from round to round, and the values with them: each search begins where the last one ended; random
                // places are tried in the first round, and in the last fit
                let before = self.fitted.as_ref().map(|fitted| &fitted.device);
                let options = &match before {
                    None => options.to_weigh(),
                    Some(_) => Options {
                        starts: 0,
                        ..(*options).clone()
                    },
                };
                let fitted = fit_once(self.device, rows, self.present, &weights, options, before)?;
                self.rounds += 1;
                let wanted;
                (scales, wanted) = judge(&fitted, rows, *loss)?;
                settled = weights.change_to(&wanted) < SETTLED;
                weights = wanted;
                self.fitted = Some(fitted);
                if settled {
                    break;
                }
            }
        }
        Ok(Reweighted {
            scales,
            weights,
            settled,
        })
    }
}

/// Fits with a robust loss: Huber's first, then the one asked for, each until the weights stand still, in two
/// steps, which is quick; the joint fit then starts from those weights. The first weights are those of the
/// nominal device's residuals, among which wild readings stand out already. Of a long recording the weights are found
/// on some of its rows, and then on all from the fit to those.
pub(crate) fn fit(
    device: &Device,
    recording: &Recording,
    options: &Options,
    loss: Loss,
) -> Result<FittedDevice, CalibrationError> {
    let present = channels(device, recording)?;
    // the noise is stated by the weights, channel by channel
    let options = Options {
        weighting: Weighting::Stated,
        ..options.clone()
    };
    let rounds_of = |method: CalibrationMethod| Options {
        method,
        ..options.to_compare()
    };
    let quick = rounds_of(CalibrationMethod::TwoStep);
    let whole = rounds_of(options.method);
    let nominal = FittedDevice {
        device: device.clone(),
        transmissions: Vec::new(),
        whole: None,
        weights: Weights::stated(device, &present),
        robust: None,
    };
    let mut stages = vec![(Loss::Huber, &quick, ROUNDS)];
    if loss != Loss::Huber {
        stages.push((loss, &quick, ROUNDS));
    }
    if options.method == CalibrationMethod::Joint {
        stages.push((loss, &whole, JOINT_ROUNDS));
    }
    let mut search = Reweighting {
        device,
        present: &present,
        rounds: 0,
        fitted: None,
    };
    let some = some_of_long(recording);
    let first = some.as_ref().unwrap_or(recording);
    let (_, mut weights) = judge(&nominal, first, Loss::Huber)?;
    weights.factor.clear();
    let mut found = search.reweighted(first, weights, &stages)?;
    // weights that stand still on some rows are near those of all
    if some.is_some()
        && let (Some(fitted), Some(&(loss, options, _))) = (&search.fitted, stages.last())
    {
        let (_, weights) = judge(fitted, recording, loss)?;
        found = search.reweighted(recording, weights, &[(loss, options, ROUNDS_OF_ALL)])?;
    }
    let Reweighted {
        scales,
        mut weights,
        settled,
    } = found;
    let rounds = search.rounds;
    // the last fit's intervals: those of the weighted readings, times the loss's own factor
    for scale in &scales {
        if let Some(factor) = weights.factor.get_mut(&scale.channel) {
            *factor *= scale.variance_factor.sqrt();
        }
    }
    let start = search.fitted.as_ref().map(|fitted| &fitted.device);
    let mut fitted = fit_once(device, recording, &present, &weights, &options, start)?;
    fitted.weights = weights;
    let outliers = far_out(&fitted.residuals(recording)?, recording, &scales);
    fitted.robust = Some(Robustness {
        loss,
        rounds,
        settled,
        channels: scales,
        outliers,
    });
    Ok(fitted)
}
