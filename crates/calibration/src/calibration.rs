//! The whole calibration: check the recording, fit, and judge on held-out rows.

use std::collections::BTreeSet;

use haptical_identification::Loss;
use haptical_model::{Device, Recording};

use crate::checks::held_out::{
    FOLDS, NOTHING, SHORT_LOG, check_share, dwelt, folds, is_for_folds, is_of_postures,
};
use crate::checks::ran_away::{ran_away, refusal};
use crate::checks::rejection::{self, Rejected};
use crate::checks::{postures, sufficiency};
use crate::comparison::Comparison;
use crate::error::wrap;
use crate::fit_device::fit_prepared_device;
use crate::report::warnings;
use crate::robust::{automatic, reweighted};
use crate::steps::device::straighten;
use crate::{
    CalibrationError, CalibrationMethod, Channel, ChannelReport, FittedDevice, HeldOut, LossChoice,
    Options, Outlier, Robustness, Weights, channels, split, with_ordered_noise, without_own_places,
};

/// A calibrated device, with what is known of its quality.
#[derive(Debug, Clone)]
pub struct Calibration {
    /// The calibrated device.
    pub device: Device,
    /// The device as it was, with start values of its surroundings.
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
    /// The full fit, where it is worse than none on rows that it did not see; the rest of this record is then of what
    /// was kept in its place.
    pub rejected: Option<Rejected>,
}

/// Calibrates a device from a recording.
///
/// The fit sees the rows that [`crate::split`] leaves it; before and after are reported for them and
/// for the others. A log of fewer than 100 rows is too short for blocks, and one of separate postures (touches, an
/// unknown tracker) has none that belong together: the device is fitted to all
/// rows and the held-out figures come from ten folds, each fitted without its own rows. Where the held-out rows
/// touch a point or a plane that the fit did not see, it is placed as these rows have it best.
///
/// Where the fit is worse on unseen rows than the device was, beyond the uncertainty of that figure, it is rejected:
/// kept is the better of the device as it was and of new joint offsets alone.
///
/// # Errors
/// [`CalibrationError`]; [`CalibrationError::is_unidentifiable`] tells data that fix nothing from
/// data that are wrong.
pub fn calibrate(
    device: &Device,
    recording: &Recording,
    options: &Options,
) -> Result<Calibration, CalibrationError> {
    let full = fit_and_check(device, recording, options)?;
    let found = match rejection::growth(&full.held_out_channels) {
        None => full,
        Some(growth) => {
            let alone = rejection::with_offsets_alone(device);
            let offsets = fit_and_check(&alone, recording, options).ok();
            kept_instead(&full, &growth, offsets)
        }
    };
    // a part that was interrupted may have been left out
    let ended = options.search.interrupt.check();
    ended.map_err(|source| wrap("calibration", source))?;
    Ok(found)
}

/// The better of the nominal device and one with joint offsets alone, with what was rejected for it.
fn kept_instead(
    full: &Calibration,
    growth: &rejection::Growth,
    offsets: Option<Calibration>,
) -> Calibration {
    let offsets = offsets.filter(|alone| {
        !alone.held_out_channels.is_empty() && rejection::share_left(&alone.held_out_channels) < 1.0
    });
    let rejected = |kept: rejection::Kept| Rejected {
        device: full.device.clone(),
        held_out_channels: full.held_out_channels.clone(),
        growth: growth.clone(),
        kept,
    };
    let (kept, mut calibration) = match offsets {
        Some(mut alone) => {
            alone.device.deviations.clone_from(&full.device.deviations);
            (rejection::Kept::JointOffsets, alone)
        }
        None => (rejection::Kept::Nominal, as_it_was(full)),
    };
    calibration
        .warnings
        .insert(0, rejection::sentence(growth, kept));
    calibration.rejected = Some(rejected(kept));
    calibration
}

/// A calibration that changed nothing.
fn as_it_was(full: &Calibration) -> Calibration {
    let mut same = full.clone();
    same.device.clone_from(&full.nominal);
    same.fitted.device.clone_from(&full.nominal);
    same.fitted.transmissions.clear();
    same.fitted.whole = None;
    for report in same
        .fit_channels
        .iter_mut()
        .chain(&mut same.held_out_channels)
    {
        report.after.clone_from(&report.before);
        report.rms_after = report.rms_before;
        report.sd_after = report.sd_before;
        report.rms_after_good = report.rms_before_good;
        for hand in &mut report.hands {
            hand.rms_after = hand.rms_before;
        }
        report.reduction_percent = report.reduction_percent.map(|_| 0.0);
        report.reduction_percent_good = report.reduction_percent_good.map(|_| 0.0);
    }
    same
}

/// Warnings of postures at which the arm dwells, and of those that are all alike.
fn of_postures(
    recording: &Recording,
    channels: &[Channel],
    dwelt: Option<&[usize]>,
) -> Vec<String> {
    let dwelling = dwelt.and_then(|own| postures::of_dwelling(recording, own));
    let mut warnings: Vec<String> = dwelling.into_iter().collect();
    if channels.iter().any(|channel| channel.sees_chain()) {
        warnings.extend(postures::narrow(recording));
    }
    warnings
}

fn fit_and_check(
    device: &Device,
    recording: &Recording,
    options: &Options,
) -> Result<Calibration, CalibrationError> {
    let channels = channels(device, recording)?;
    sufficiency::check(device, recording, &channels)?;
    crate::check_rig(device, recording)?;
    crate::check_stands(device, recording)?;
    check_share(options.held_out)?;
    let dwelt = match options.held_out {
        HeldOut::Folds(count) => dwelt(recording, count),
        HeldOut::Share(_) | HeldOut::None => dwelt(recording, FOLDS),
    };
    let mut warnings = warnings::of_recording(device, recording, &channels);
    warnings.extend(of_postures(recording, &channels, dwelt.as_deref()));
    let whole = &without_own_places(device, recording);
    let count = fold_count(device, whole, options, dwelt.is_some());
    let split = split(whole, count.map_or(options.held_out, |_| HeldOut::None))?;
    let seen = recording.select(&split.fit);
    let mut nominal = crate::prepare_device(device, &seen)?;
    let mut fitted = whole_fit(&nominal, &seen, options)?;
    let is_plain = fitted.robust.is_none() && options.loss == LossChoice::Auto;
    let least_squares = match is_plain && count.is_none() {
        true => Some(automatic::least_squares(&fitted, &seen)?),
        false => None,
    };
    let comparison = Comparison {
        device,
        recording,
        channels: &channels,
        stated: Weights::stated(device, &channels),
    };
    let mut fit_channels = comparison.on_part((&nominal, &fitted.device), &seen, &split.fit)?;
    // of a long recording, which has no folds, a copy of most rows
    let folded = count.map(|count| (count, seen));
    let (mut held_out_channels, held_out) = match &folded {
        Some((count, seen)) => {
            let whole = (nominal, fitted, fit_channels);
            let by = (*count, dwelt.as_deref());
            let seen = (&comparison, seen, &split.fit[..]);
            let (whole, checked) = by_folds(whole, seen, by, options, &mut warnings)?;
            (nominal, fitted, fit_channels) = whole;
            checked
        }
        None if split.held_out.is_empty() => (Vec::new(), split.description),
        None => {
            let unseen = recording.select(&split.held_out);
            warnings.extend(warnings::of_unseen_places(&fitted.device, &unseen));
            (
                comparison.on_rows((&nominal, &fitted.device), &split.held_out)?,
                split.description,
            )
        }
    };
    let mut outliers = Vec::new();
    if let Some(robust) = &fitted.robust {
        let reports = [&mut fit_channels, &mut held_out_channels];
        outliers = outliers_of(robust, reports, recording);
    } else if let Some(scales) = &least_squares {
        outliers = automatic::wild_held_out(scales, &mut held_out_channels, recording);
        if !outliers.is_empty() {
            warnings.push(warnings::of_wild_held_out(outliers.len()));
        }
    }
    for report in fit_channels.iter_mut().chain(&mut held_out_channels) {
        let wild = outliers
            .iter()
            .filter(|own| own.channel.name() == report.channel);
        let wild: Vec<u64> = wild.map(|own| own.line).collect();
        report.tell_hands(device, recording, &wild);
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
        rejected: None,
    })
}

/// A prepared device, its fit, and what both leave on the rows of the fit.
type Whole = (Device, FittedDevice, Vec<ChannelReport>);

/// What folds leave of the rows that they do not see: of a count, by row or by the postures at which the device dwelt; and the fit that
/// they do not refute.
fn by_folds(
    whole: Whole,
    (comparison, seen, rows): (&Comparison<'_>, &Recording, &[usize]),
    by: (usize, Option<&[usize]>),
    options: &Options,
    warnings: &mut Vec<String>,
) -> Result<(Whole, (Vec<ChannelReport>, String)), CalibrationError> {
    // the folds check the fit that was made, not others
    let robust = whole.1.robust.as_ref();
    let loss = robust.map_or(Loss::Squares, |robust| robust.loss);
    let mut of_fold = Options {
        loss: LossChoice::Fixed(loss),
        ..options.clone()
    };
    // nobody reads those of a fold
    of_fold.rules.singular_values = false;
    let from = (loss == Loss::Squares).then_some(&whole.1);
    let mut of_folds = Vec::new();
    let mut checked = comparison.cross_validate((&of_fold, from), by, &mut of_folds)?;
    let all = || folds(comparison.recording.len(), by.0, by.1).into_iter();
    // folds that begin where the fit ended share a wrong minimum: the first that can be fitted is begun at the device file, too
    let quick = of_fold.to_compare();
    let first = || all().find_map(|fold| comparison.afresh(&fold, &quick));
    let refutes = |unseen: Vec<ChannelReport>| ran_away(&whole.2, &unseen).is_some();
    if from.is_some() && first().is_none_or(refutes) {
        of_folds.clear();
        checked = comparison.cross_validate((&of_fold, None), by, &mut of_folds)?;
    }
    warnings.extend(of_folds);
    let starts = all().map(|fold| fold.fit);
    let seen = (comparison, seen, rows);
    let whole = not_above_folds(whole, seen, starts, (options, &checked.0))?;
    Ok((whole, checked))
}

/// A fit that does not end far above what its folds leave: one that does is begun again where each of them began.
///
/// # Errors
/// [`CalibrationError::NotConverged`] where it ends there from everywhere.
fn not_above_folds(
    mut whole: Whole,
    (comparison, seen, rows): (&Comparison<'_>, &Recording, &[usize]),
    starts: impl Iterator<Item = Vec<usize>>,
    (options, unseen): (&Options, &[ChannelReport]),
) -> Result<Whole, CalibrationError> {
    for start in starts {
        if ran_away(&whole.2, unseen).is_none() {
            break;
        }
        let begun = comparison.recording.select(&start);
        let nominal = crate::prepare_device(comparison.device, &begun)?;
        let Ok(fitted) = whole_fit(&nominal, seen, options) else {
            continue;
        };
        let channels = comparison.on_part((&nominal, &fitted.device), seen, rows)?;
        if ran_away(&channels, unseen).is_none() {
            whole = (nominal, fitted, channels);
        }
    }
    refusal(&whole.2, unseen).map_or(Ok(whole), Err)
}

/// The fit of a prepared device, with the noise that the order of its rows shows.
fn whole_fit(
    nominal: &Device,
    seen: &Recording,
    options: &Options,
) -> Result<FittedDevice, CalibrationError> {
    let fitted = fit_prepared_device(nominal, seen, options)?;
    let fitted = with_ordered_noise(fitted, seen, options.method)?;
    straighten(fitted, seen, options)
}

/// Number of folds that check the result; none where rows are held out of a single fit, or nothing is.
fn fold_count(
    device: &Device,
    recording: &Recording,
    options: &Options,
    is_dwelt: bool,
) -> Option<usize> {
    let short = recording.len() < SHORT_LOG || is_of_postures(device, recording);
    let short = short || (is_dwelt && is_for_folds(recording, options.held_out));
    match options.held_out {
        HeldOut::Folds(count) => Some(count),
        HeldOut::Share(share) if short && share > 0.0 => Some(FOLDS),
        _ => None,
    }
}

/// Sets the outliers of a robust loss aside in the reports; each reading is listed once, the farthest first.
fn outliers_of(
    robust: &Robustness,
    reports: [&mut Vec<ChannelReport>; 2],
    recording: &Recording,
) -> Vec<Outlier> {
    let mut outliers = Vec::new();
    for report in reports.into_iter().flatten() {
        outliers.extend(reweighted::set_aside(report, robust, recording));
    }
    outliers.sort_by(|a: &Outlier, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
    // folds judge the rows of the fit once more
    let mut listed = BTreeSet::new();
    outliers.retain(|outlier| listed.insert((outlier.line, outlier.channel)));
    outliers
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
