//! The choice between least squares and a robust loss: wild readings against effects that the model lacks.

use std::collections::{BTreeMap, BTreeSet};

use haptical_identification::Loss;
use haptical_model::{Device, Recording};

use crate::robust::reweighted::{far_out, fit, judge_residuals, set_aside};
use crate::{
    CalibrationError, CalibrationMethod, Channel, ChannelReport, ChannelResiduals, FittedDevice,
    Options, Outlier, ParameterFit, RobustChannel, Robustness, channels, with_ordered_noise,
};

/// Rows on which it is tried whether a robust loss is needed.
const SCREENED: usize = 600;
/// Share of the outliers that are before another one from which on they are no single wild readings but an
/// effect in time: of independent ones, the share is that of the outliers among all readings.
const IN_STRETCHES: f64 = 0.6;
/// Residual over noise floor beyond which more than noise is left.
const ABOVE_FLOOR: f64 = 1.5;

/// Least squares, unless there are wild readings: then Tukey's loss.
///
/// Wild readings show as such among the residuals of least squares, or they have bent its fit so far that they
/// do not: then a robust fit of some of the rows finds that most of them are at their noise, which least squares
/// is not. An effect that the model lacks disturbs most rows, and its fit stays that of least squares.
pub(crate) fn automatic(
    device: &Device,
    recording: &Recording,
    options: &Options,
    plain: Result<FittedDevice, CalibrationError>,
) -> Result<FittedDevice, CalibrationError> {
    let (mut wild, mut disturbed) = (true, Vec::new());
    if let Ok(fitted) = &plain {
        wild = false;
        // channel by channel: of a long recording the residuals of all are much
        for channel in channels(&fitted.device, recording)? {
            let residuals = fitted.residuals_of(recording, &[channel])?;
            let (scales, _) = judge_residuals(fitted, recording, &residuals, Loss::Squares);
            wild |= !far_out(&residuals, recording, &scales).is_empty();
            disturbed.extend(above_floor(&residuals));
        }
        if !wild && disturbed.is_empty() {
            return plain;
        }
    }
    let step = recording.len().div_ceil(SCREENED).max(1);
    let some: Vec<usize> = (0..recording.len()).step_by(step).collect();
    let sample = recording.select(&some);
    let quick = Options {
        method: CalibrationMethod::TwoStep,
        ..options.clone()
    };
    let Ok(screen) = fit(device, &sample, &quick, Loss::Tukey) else {
        return plain;
    };
    let is_at_noise = is_at_noise(&screen, &sample)?;
    let mut found = screen.robust.iter().flat_map(|robust| &robust.channels);
    let at_noise = found.any(|found| disturbed.contains(&found.channel) && is_at_noise(found));
    let outliers = screen.robust.map_or(Vec::new(), |robust| robust.outliers);
    if outliers.is_empty() || !(wild || at_noise) || are_in_stretches(&outliers, &sample) {
        return plain;
    }
    match (fit(device, recording, options, Loss::Tukey), plain) {
        (Ok(robust), Err(_)) => Ok(robust),
        (Ok(robust), Ok(plain)) => {
            let is_better = is_sound(&robust, recording)?
                && !is_surer(&plain, &robust, recording, options.method)?;
            Ok(if is_better { robust } else { plain })
        }
        (Err(_), plain) => plain,
    }
}

/// Whether least squares states smaller standard deviations than a robust fit, in the geometric mean: where a part of the
/// range is louder it loses less than a loss that takes loud readings for wild ones.
fn is_surer(
    plain: &FittedDevice,
    robust: &FittedDevice,
    recording: &Recording,
    method: CalibrationMethod,
) -> Result<bool, CalibrationError> {
    let [plain, robust] = [plain, robust].map(|fitted| -> Result<_, CalibrationError> {
        let fitted = with_ordered_noise(fitted.clone(), recording, method)?;
        let steps = fitted.transmissions.into_iter().filter_map(|step| step.fit);
        let fits: Vec<ParameterFit> = steps.chain(fitted.whole).collect();
        let estimates = fits.into_iter().flat_map(|fit| fit.estimates);
        let stated = estimates.filter_map(|own| Some((own.name, own.standard_deviation?)));
        Ok(stated.collect::<BTreeMap<String, f64>>())
    });
    let (plain, robust) = (plain?, robust?);
    let ratios = plain.iter().filter_map(|(name, sd)| {
        let ratio = (sd / robust.get(name)?).ln();
        ratio.is_finite().then_some(ratio)
    });
    Ok(ratios.sum::<f64>() < 0.0)
}

/// Whether a robust fit came to rest, or all but its wild readings are at their noise: it need not come to rest
/// where a term or a parameter more fits about as well as one less.
fn is_sound(fitted: &FittedDevice, recording: &Recording) -> Result<bool, CalibrationError> {
    let Some(robust) = &fitted.robust else {
        return Ok(false);
    };
    if robust.settled {
        return Ok(true);
    }
    let is_at_noise = is_at_noise(fitted, recording)?;
    Ok(robust.channels.iter().all(is_at_noise))
}

/// Whether the scale of a channel is that of its noise floor.
fn is_at_noise(
    fitted: &FittedDevice,
    recording: &Recording,
) -> Result<impl Fn(&RobustChannel) -> bool + use<>, CalibrationError> {
    let residuals = fitted.residuals(recording)?.into_iter();
    let floors: BTreeMap<Channel, f64> = residuals
        .map(|channel| (channel.channel, channel.noise_floor))
        .collect();
    Ok(move |channel: &RobustChannel| {
        let floor = floors.get(&channel.channel).copied().unwrap_or(0.0);
        channel.scale <= ABOVE_FLOOR * floor
    })
}

/// Largest share of a channel's held-out readings that are wild ones rather than an effect.
const FEW: f64 = 0.02;

/// The scales of a fit of least squares to the rows that it saw.
pub(crate) fn least_squares(
    fitted: &FittedDevice,
    seen: &Recording,
) -> Result<Robustness, CalibrationError> {
    let mut scales = Vec::new();
    for channel in channels(&fitted.device, seen)? {
        let residuals = fitted.residuals_of(seen, &[channel])?;
        scales.extend(judge_residuals(fitted, seen, &residuals, Loss::Squares).0);
    }
    Ok(Robustness {
        loss: Loss::Squares,
        rounds: 0,
        settled: true,
        channels: scales,
        outliers: Vec::new(),
    })
}

/// Wild readings among rows that a fit of least squares did not see, which it therefore did not have to weigh: they
/// are set aside in the reports of these rows, where they are few.
pub(crate) fn wild_held_out(
    least_squares: &Robustness,
    reports: &mut [ChannelReport],
    recording: &Recording,
) -> Vec<Outlier> {
    let mut all = Vec::new();
    for report in reports {
        let mut aside = report.clone();
        let outliers = set_aside(&mut aside, least_squares, recording);
        let most = (FEW * report.readings as f64).max(1.0);
        let are_few = !outliers.is_empty() && outliers.len() as f64 <= most;
        if are_few && !are_in_stretches(&outliers, recording) {
            *report = aside;
            all.extend(outliers);
        }
    }
    all
}

/// Whether outliers come in consecutive rows, as those of an effect do and wild readings do not.
fn are_in_stretches(outliers: &[Outlier], recording: &Recording) -> bool {
    let wild: BTreeSet<(Channel, u64)> = outliers
        .iter()
        .map(|outlier| (outlier.channel, outlier.line))
        .collect();
    let lines = recording.line.windows(2);
    let next: BTreeMap<u64, u64> = lines.map(|pair| (pair[0], pair[1])).collect();
    let beside = wild.iter().filter(|(channel, line)| {
        let next = next.get(line);
        next.is_some_and(|&next| wild.contains(&(*channel, next)))
    });
    beside.count() as f64 > IN_STRETCHES * wild.len() as f64
}

/// Channels whose residuals are above their noise floor.
fn above_floor(residuals: &[ChannelResiduals]) -> Vec<Channel> {
    let above = residuals
        .iter()
        .filter(|channel| channel.rms().unwrap_or(0.0) > ABOVE_FLOOR * channel.noise_floor);
    above.map(|channel| channel.channel).collect()
}
