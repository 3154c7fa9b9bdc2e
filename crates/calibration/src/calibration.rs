//! The whole calibration: look at the recording, fit, and check on rows that the fit did not see.

use std::collections::BTreeSet;

use haptical_identification::Loss;
use haptical_model::{Device, Recording};

use crate::checks::held_out::{
    FOLDS, NOTHING, SHORT_LOG, check_share, dwelt, folds, is_for_folds, is_of_postures,
};
use crate::checks::{postures, sufficiency};
use crate::report::warnings;
use crate::robust::{automatic, reweighted};
use crate::start::prepare::with_unseen_touches;
use crate::steps::device::{add_step_one_noise, profile_whole};
use crate::{
    CalibrationError, CalibrationMethod, Channel, ChannelReport, ChannelResiduals, FittedDevice,
    HeldOut, LossChoice, Options, Outlier, Weights, channel_residuals, channels, fit_device, split,
};

/// A calibrated device, with what is known of its quality.
#[derive(Debug, Clone)]
pub struct Calibration {
    /// The calibrated device.
    pub device: Device,
    /// The device as it was, with start values of what stands beside the chain.
    pub nominal: Device,
    /// The fits.
    pub fitted: FittedDevice,
    /// Before and after, on the rows of the fit.
    pub fit_channels: Vec<ChannelReport>,
    /// Before and after, on rows that the fit did not see.
    pub held_out_channels: Vec<ChannelReport>,
    /// What was held out, in words.
    pub held_out: String,
    /// Readings that noise does not explain, farthest first, where a robust loss was used: those of the fit
    /// and those that were held out, each once.
    pub outliers: Vec<Outlier>,
    /// Things that a user should know.
    pub warnings: Vec<String>,
}

/// Calibrates a device from a recording.
///
/// The fit sees the rows that [`crate::split`] leaves it; before and after are reported for them and
/// for the others. A log of fewer than 100 rows is too short for blocks, and one of separate postures (touches, an
/// unknown tracker) has none that belong together: the device is fitted to all
/// rows and the held-out figures come from ten folds, each fitted without its own rows. Where the held-out rows
/// touch a point or a plane that the fit did not see, it is placed as these rows have it best.
///
/// # Errors
/// [`CalibrationError`]; [`CalibrationError::is_unidentifiable`] tells data that fix nothing from
/// data that are wrong.
pub fn calibrate(
    device: &Device,
    recording: &Recording,
    options: &Options,
) -> Result<Calibration, CalibrationError> {
    let channels = channels(device, recording)?;
    sufficiency::check(device, recording, &channels)?;
    crate::check_rig(device, recording)?;
    let mut warnings = warnings::of_recording(device, recording, &channels);
    check_share(options.held_out)?;
    let dwelt = match options.held_out {
        HeldOut::Folds(count) => dwelt(recording, count),
        HeldOut::Share(_) | HeldOut::None => dwelt(recording, FOLDS),
    };
    if let Some(own) = &dwelt {
        warnings.push(postures::of_dwelling(recording, own));
    }
    if channels.iter().any(|channel| channel.sees_chain()) {
        warnings.extend(postures::narrow(recording));
    }
    let stated = Weights::stated(device, &channels);
    let short = recording.len() < SHORT_LOG || is_of_postures(device, recording);
    let short = short || (dwelt.is_some() && is_for_folds(recording, options.held_out));
    let count = match options.held_out {
        HeldOut::Folds(count) => Some(count),
        HeldOut::Share(share) if short && share > 0.0 => Some(FOLDS),
        _ => None,
    };
    let rows = count.map_or(options.held_out, |_| HeldOut::None);
    let split = split(recording, rows)?;
    let seen = recording.select(&split.fit);
    let mut fitted = fit_device(device, &seen, options)?;
    if options.method == CalibrationMethod::TwoStep {
        fitted = add_step_one_noise(fitted, &channels, &seen)?;
    }
    profile_whole(&mut fitted, &seen, options)?;
    let nominal = device.clone();
    let nominal = crate::prepare_device(&nominal, &seen)?;
    let mut fit_channels = compare(&nominal, &fitted.device, &seen, &channels, &stated)?;
    in_recording(&mut fit_channels, &split.fit);
    let (mut held_out_channels, held_out) = match count {
        Some(count) => cross_validate(
            device,
            recording,
            &channels,
            &stated,
            &Options {
                // the folds check the fit that was made, not others
                loss: LossChoice::Fixed(fitted.robust.as_ref().map_or(Loss::Squares, |r| r.loss)),
                ..*options
            },
            (count, dwelt.as_deref()),
            &mut warnings,
        )?,
        _ if split.held_out.is_empty() => (Vec::new(), split.description.clone()),
        _ => {
            let unseen = recording.select(&split.held_out);
            let mut reports = compare(&nominal, &fitted.device, &unseen, &channels, &stated)?;
            in_recording(&mut reports, &split.held_out);
            (reports, split.description.clone())
        }
    };
    let mut outliers = Vec::new();
    if let Some(robust) = &fitted.robust {
        for reports in [&mut fit_channels, &mut held_out_channels] {
            for report in reports.iter_mut() {
                outliers.extend(reweighted::set_aside(report, robust, recording));
            }
        }
        outliers.sort_by(|a: &Outlier, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
        // folds judge the rows of the fit once more
        let mut listed = BTreeSet::new();
        outliers.retain(|outlier| listed.insert((outlier.line, outlier.channel)));
    } else if options.loss == LossChoice::Auto && count.is_none() {
        outliers = automatic::wild_held_out(&fitted, &seen, &mut held_out_channels, recording)?;
        if !outliers.is_empty() {
            warnings.push(warnings::of_wild_held_out(outliers.len()));
        }
    }
    let judged = if held_out_channels.is_empty() {
        &fit_channels
    } else {
        &held_out_channels
    };
    warnings.extend(warnings::of_result(
        &nominal,
        &fitted,
        (&fit_channels, judged),
        options.method,
    ));
    Ok(Calibration {
        device: fitted.device.clone(),
        nominal,
        fitted,
        fit_channels,
        held_out_channels,
        held_out,
        outliers,
        warnings,
    })
}

/// Before and after on one recording.
fn compare(
    nominal: &Device,
    fitted: &Device,
    recording: &Recording,
    channels: &[Channel],
    stated: &Weights,
) -> Result<Vec<ChannelReport>, CalibrationError> {
    let (nominal, fitted) = (
        &with_unseen_touches(nominal, recording)?,
        &with_unseen_touches(fitted, recording)?,
    );
    let before = channel_residuals(nominal, fitted, recording, channels, stated)?;
    let after = channel_residuals(fitted, fitted, recording, channels, stated)?;
    Ok(before
        .into_iter()
        .zip(after)
        .filter(|(before, _)| !before.residuals.is_empty())
        .map(|(before, after)| ChannelReport::new(nominal, before, after))
        .collect())
}

/// Turns rows of a part into rows of the recording that it was taken from.
fn in_recording(reports: &mut [ChannelReport], part: &[usize]) {
    for row in reports.iter_mut().flat_map(|report| &mut report.rows) {
        *row = part[*row];
    }
}

/// Folds by row, or by the numbers of the postures that the device dwelt at, each predicted by a device fitted
/// without it. A fold whose fit fails (too few rows
/// left for the terms) is left out, with a warning; where every fit fails nothing is checked.
fn cross_validate(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
    stated: &Weights,
    options: &Options,
    (count, dwelt): (usize, Option<&[usize]>),
    warnings: &mut Vec<String>,
) -> Result<(Vec<ChannelReport>, String), CalibrationError> {
    let folds = folds(recording.len(), count, dwelt);
    let count = folds.len();
    let mut checked = 0;
    let mut reasons: Vec<String> = Vec::new();
    let mut before: Vec<ChannelResiduals> = Vec::new();
    let mut after: Vec<ChannelResiduals> = Vec::new();
    for fold in folds {
        let seen = recording.select(&fold.fit);
        let fitted = match fit_device(device, &seen, options) {
            Ok(fitted) => fitted,
            Err(error) => {
                reasons.push(format!("{} left out: {error}", fold.description));
                continue;
            }
        };
        checked += 1;
        let unseen = recording.select(&fold.held_out);
        let range_free = without_ranges(&fitted.device);
        let nominal = device.clone();
        let nominal = crate::prepare_device(&nominal, &seen)?;
        for (device, kept) in [(&nominal, &mut before), (&fitted.device, &mut after)] {
            let device = &with_unseen_touches(device, &unseen)?;
            let part = channel_residuals(device, &range_free, &unseen, channels, stated)?;
            append(kept, part, &fold.held_out);
        }
    }
    let reports = before
        .into_iter()
        .zip(after)
        .filter(|(before, _)| !before.residuals.is_empty())
        .map(|(before, after)| ChannelReport::new(device, before, after))
        .collect();
    if checked == 0 {
        warnings.push(warnings::of_no_check(count, reasons.first()));
        return Ok((
            Vec::new(),
            format!("not checked: none of {count} folds could be fitted"),
        ));
    }
    warnings.extend(reasons);
    let kind = match options.held_out {
        _ if dwelt.is_some() => "of whole postures",
        HeldOut::Folds(_) => "by row",
        _ if recording.len() < SHORT_LOG => "of a short log",
        _ => "of separate postures",
    };
    let count = match checked {
        all if all == count => count.to_string(),
        some => format!("{some} of {count}"),
    };
    Ok((
        reports,
        format!("{count} folds {kind}, each fitted without its own rows"),
    ))
}

/// A device whose polynomials count as known everywhere: leaving out the extreme samples of a short
/// log would flatter it, and beyond its range a polynomial continues on its tangent.
fn without_ranges(device: &Device) -> Device {
    let mut device = device.clone();
    for joint in &mut device.joints {
        joint.transmission_error = haptical_model::TransmissionError::default();
    }
    device
}

fn append(kept: &mut Vec<ChannelResiduals>, part: Vec<ChannelResiduals>, rows: &[usize]) {
    for channel in part {
        let original: Vec<usize> = channel.rows.iter().map(|&row| rows[row]).collect();
        match kept
            .iter_mut()
            .find(|other| other.channel == channel.channel)
        {
            Some(sum) => {
                let (have, more) = (sum.rows.len() as f64, channel.rows.len() as f64);
                if have + more > 0.0 {
                    let square =
                        sum.noise_floor.powi(2) * have + channel.noise_floor.powi(2) * more;
                    sum.noise_floor = (square / (have + more)).sqrt();
                }
                sum.rows.extend(original);
                sum.residuals.extend(channel.residuals);
                sum.outside_range += channel.outside_range;
            }
            None => kept.push(ChannelResiduals {
                rows: original,
                ..channel
            }),
        }
    }
}

impl Calibration {
    /// Channels that the result is judged by: on rows that the fit did not see, empty where none of them could be
    /// checked. Of the fit's own rows only where nothing was to be held out.
    pub fn judged_channels(&self) -> &[ChannelReport] {
        match self.held_out == NOTHING {
            true => &self.fit_channels,
            false => &self.held_out_channels,
        }
    }

    /// Whether the calibration followed the paper's two steps.
    pub fn method_name(method: CalibrationMethod) -> &'static str {
        match method {
            CalibrationMethod::TwoStep => "two-step",
            CalibrationMethod::Joint => "joint",
        }
    }
}
