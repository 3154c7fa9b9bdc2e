//! Residuals of the nominal and the calibrated device, on rows of the fit or on held-out rows.

use haptical_model::{Device, Recording};

use crate::checks::held_out::{SHORT_LOG, Split, folds};
use crate::fit_device::fit_prepared_device;
use crate::report::warnings;
use crate::start::ids::listed;
use crate::start::prepare::with_unseen_places;
use crate::steps::device::fit_from;
use crate::{
    CalibrationError, Channel, ChannelReport, ChannelResiduals, FittedDevice, HeldOut, Options,
    Weights, channel_residuals,
};

/// A recording with the channels that devices are compared on.
pub(crate) struct Comparison<'a> {
    pub(crate) device: &'a Device,
    pub(crate) recording: &'a Recording,
    pub(crate) channels: &'a [Channel],
    /// The stated noise.
    pub(crate) stated: Weights,
}

impl Comparison<'_> {
    /// Before and after on some rows of the recording.
    pub(crate) fn on_rows(
        &self,
        devices: (&Device, &Device),
        rows: &[usize],
    ) -> Result<Vec<ChannelReport>, CalibrationError> {
        self.on_part(devices, &self.recording.select(rows), rows)
    }

    /// The same on a part of the recording that is made of these rows.
    pub(crate) fn on_part(
        &self,
        (nominal, fitted): (&Device, &Device),
        part: &Recording,
        rows: &[usize],
    ) -> Result<Vec<ChannelReport>, CalibrationError> {
        let nominal = &with_unseen_places(nominal, part)?;
        let fitted = &with_unseen_places(fitted, part)?;
        // channel by channel: of a long recording the rows of all of them, twice, are much
        let mut reports = Vec::new();
        for channel in self.channels {
            let one = std::slice::from_ref(channel);
            let residuals = |device| channel_residuals(device, fitted, part, one, &self.stated);
            reports.extend(self::reports(
                nominal,
                residuals(nominal)?,
                residuals(fitted)?,
            ));
        }
        for row in reports.iter_mut().flat_map(|report| &mut report.rows) {
            *row = rows[*row];
        }
        Ok(reports)
    }

    /// Folds by row, or by the numbers of the postures that the device dwelt at, each predicted by a device fitted
    /// without it; the searches begin where that of `whole` ended, a fit of least squares to all rows. A fold whose fit fails (too few rows
    /// left for the terms) is left out, with a warning; where every fit fails nothing is checked.
    pub(crate) fn cross_validate(
        &self,
        (options, whole): (&Options, Option<&FittedDevice>),
        (count, dwelt): (usize, Option<&[usize]>),
        warnings: &mut Vec<String>,
    ) -> Result<(Vec<ChannelReport>, String), CalibrationError> {
        let (device, recording) = (self.device, self.recording);
        let folds = folds(recording.len(), count, dwelt);
        let count = folds.len();
        let mut checked = 0;
        let mut reasons: Vec<String> = Vec::new();
        let mut before: Vec<ChannelResiduals> = Vec::new();
        let mut after: Vec<ChannelResiduals> = Vec::new();
        // each fold as it is alone, merged in their order
        let made = haptical_parallel::map(&folds, |fold| self.of_fold(fold, options, whole));
        for (fold, made) in folds.iter().zip(made) {
            let made = match made {
                Ok(made) => made?,
                Err(error) => {
                    reasons.push(format!("{} left out: {error}", fold.description));
                    continue;
                }
            };
            checked += 1;
            warnings.extend(made.warning.filter(|warning| !warnings.contains(warning)));
            append(&mut before, made.before, &fold.held_out);
            append(&mut after, made.after, &fold.held_out);
        }
        let reports = reports(device, before, after);
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

    /// What a device fitted to a fold leaves on its own rows, its search begun at the device file; none where it cannot be fitted.
    pub(crate) fn afresh(&self, fold: &Split, options: &Options) -> Option<Vec<ChannelReport>> {
        let made = self.of_fold(fold, options, None).ok()?.ok()?;
        Some(reports(self.device, made.before, made.after))
    }

    /// A fold's own rows as a device that is fitted to the others predicts them; inside, why the fit failed.
    fn of_fold(
        &self,
        fold: &Split,
        options: &Options,
        whole: Option<&FittedDevice>,
    ) -> Result<Result<FoldRows, CalibrationError>, CalibrationError> {
        let (device, recording) = (self.device, self.recording);
        let seen = recording.select(&fold.fit);
        let whole = whole.filter(|_| are_alike(recording, &seen));
        let nominal = crate::prepare_device(device, &seen)?;
        let from_whole = whole.and_then(|whole| fit_from(&nominal, &seen, options, whole).ok());
        let fitted = match from_whole {
            Some(fitted) => fitted,
            None => fit_prepared_device(&nominal, &seen, options)?,
        };
        let unseen = recording.select(&fold.held_out);
        let range_free = without_ranges(&fitted.device);
        let residuals = |device: &Device| {
            let device = &with_unseen_places(device, &unseen)?;
            channel_residuals(device, &range_free, &unseen, self.channels, &self.stated)
        };
        let predicted = || {
            Ok(FoldRows {
                warning: warnings::of_unseen_places(&fitted.device, &unseen),
                before: residuals(&nominal)?,
                after: residuals(&fitted.device)?,
            })
        };
        Ok(predicted())
    }
}

/// Whether a part of a recording touches all that the whole touches, in the same order, and has all of its tools and runs: then their fits
/// have the same numbers, which are known by that order.
fn are_alike(whole: &Recording, part: &Recording) -> bool {
    let ids = |recording: &Recording| {
        let columns = [
            &recording.hand,
            &recording.tool,
            &recording.contact,
            &recording.plane,
        ];
        let mut runs: Vec<i64> = Vec::new();
        for run in recording.run.iter().flatten() {
            if !runs.contains(run) {
                runs.push(*run);
            }
        }
        (columns.map(|column| column.as_deref().map(listed)), runs)
    };
    ids(whole) == ids(part)
}

/// What nominal and fitted device leave of a fold's own rows.
struct FoldRows {
    warning: Option<String>,
    before: Vec<ChannelResiduals>,
    after: Vec<ChannelResiduals>,
}

/// One report for each channel with residuals.
fn reports(
    device: &Device,
    before: Vec<ChannelResiduals>,
    after: Vec<ChannelResiduals>,
) -> Vec<ChannelReport> {
    let pairs = before.into_iter().zip(after);
    pairs
        .filter(|(before, _)| !before.residuals.is_empty())
        .map(|(before, after)| ChannelReport::new(device, before, after))
        .collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_touched_in_another_order_is_not_alike() {
        let touched = |ids: &[&str]| Recording {
            contact: Some(ids.iter().map(|id| (*id).to_owned()).collect()),
            ..Recording::default()
        };
        let whole = touched(&["a", "b", "", "a", "b"]);
        assert!(are_alike(&whole, &touched(&["a", "b"])));
        assert!(!are_alike(&whole, &touched(&["b", "a", "b"])));
        assert!(!are_alike(&whole, &touched(&["a", "a"])));
        let run = |run: &[i64]| Recording {
            run: Some(run.to_vec()),
            ..Recording::default()
        };
        assert!(are_alike(&run(&[3, 3, 1]), &run(&[3, 1, 1])));
        assert!(!are_alike(&run(&[3, 3, 1]), &run(&[3, 3])));
    }
}
