//! Readings that are none: moments at which a channel of a motion reads 0, or one value, or what it read before, and wild torques. They are left
//! out before anything is judged, and named: as noise they would hide any gap.

mod held;
mod moments;
mod neighbours;
mod wild;

use std::borrow::Cow;
use std::ops::Range;

use haptical_calibration::Channel;
use haptical_effects::noise::{DROPOUTS, OUTLIERS};
use haptical_effects::{Spec, runs_of};
use haptical_metrics::gap_reduction_percent;
use haptical_model::{Device, Recording};

use crate::answer::{CauseAnswer, Diagnosis, ParameterAnswer, Place, Verdict};
use crate::thresholds::admission::{FILLED_ROWS, LEAST_DROPOUTS, MOST_DROPOUT_SHARE};
use crate::thresholds::noise::DATA_PROBABILITY;

use held::held;
use moments::moments;
use neighbours::between;
use wild::{speeds, wild};

/// What readings that are none have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// One value.
    Value(f64),
    /// What was read before.
    Held,
    /// Each another one.
    Wild,
}

/// Readings of one channel that are none.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Dropouts {
    /// Channel as the gap has it, and its joint, from 0, where it has one.
    channel: String,
    joint: Option<usize>,
    /// Rows of the recording.
    rows: Vec<usize>,
    /// Readings of the channel, these included.
    readings: usize,
    kind: Kind,
    /// Root mean square over all readings of what they are off by.
    off_rms: f64,
}

/// The recording without such readings; none where there are none. Single postures have no neighbours to tell them by.
pub(crate) fn without_dropouts(
    device: &Device,
    recording: &Recording,
) -> Option<(Recording, Vec<Dropouts>)> {
    recording.time_s.as_ref()?;
    let runs = runs_of(recording);
    let mut found = Vec::new();
    // copied once there is a reason
    let mut without = Cow::Borrowed(recording);
    for joint in 0..device.joints.len() {
        let channel = format!("torque{}", joint + 1);
        let angles = &recording.joint[joint][..];
        let column = recording.torque_nm.get(joint);
        if let Some((column, taken)) =
            taken_out(column, &runs, Some(angles), (&channel, Some(joint)))
        {
            without.to_mut().torque_nm[joint] = Some(column);
            found.extend(taken);
        }
        let channel = format!("out{}", joint + 1);
        let column = recording.output.get(joint);
        if let Some((column, taken)) = taken_out(column, &runs, None, (&channel, Some(joint))) {
            without.to_mut().output[joint] = Some(column);
            found.extend(taken);
        }
    }
    for index in 0..recording.cable_m.len() {
        let channel = Channel::Cable { index }.name();
        let column = recording.cable_m.get(index);
        if let Some((column, taken)) = taken_out(column, &runs, None, (&channel, None)) {
            without.to_mut().cable_m[index] = Some(column);
            found.extend(taken);
        }
    }
    (!found.is_empty()).then(|| (without.into_owned(), found))
}

/// A column without readings that are none, where it has some; of torques, for which the angles of their joint are given, also without held and wild ones, and
/// short moments are filled in.
fn taken_out(
    column: Option<&Option<Vec<f64>>>,
    runs: &[Range<usize>],
    angles: Option<&[f64]>,
    (channel, joint): (&str, Option<usize>),
) -> Option<(Vec<f64>, Vec<Dropouts>)> {
    let mut column = column?.clone()?;
    let readings = column.iter().filter(|value| value.is_finite()).count();
    let are_some = |rows: &[usize]| {
        let share = rows.len() as f64 / readings.max(1) as f64;
        rows.len() >= LEAST_DROPOUTS && share < MOST_DROPOUT_SHARE
    };
    let mut found = Vec::new();
    let mut take = |column: &mut Vec<f64>, rows: Vec<usize>, kind: Kind| {
        if !are_some(&rows) {
            return;
        }
        let lines = rows.iter().map(|&row| between(column, &rows, runs, row));
        let lines: Vec<Option<(f64, usize)>> = lines.collect();
        let off = rows.iter().zip(&lines);
        let off = off.filter_map(|(row, line)| Some(column[*row] - line.as_ref()?.0));
        let squares: f64 = off.map(|off| off * off).sum();
        for (row, line) in rows.iter().zip(lines) {
            // a motion needs its rows without gaps: what is short is put on the line between its neighbours
            let short = line.filter(|(_, rows)| angles.is_some() && *rows <= FILLED_ROWS);
            column[*row] = short.map_or(f64::NAN, |(value, _)| value);
        }
        found.push(Dropouts {
            channel: channel.to_owned(),
            joint,
            readings,
            kind,
            off_rms: (squares / readings as f64).sqrt(),
            rows,
        });
    };
    if let Some((rows, value)) = moments(&column, runs) {
        take(&mut column, rows, Kind::Value(value));
    }
    if let Some(angles) = angles {
        let rows = held(&column, angles, runs);
        take(&mut column, rows, Kind::Held);
        let rows = wild(&column, &speeds(angles, runs), runs);
        take(&mut column, rows, Kind::Wild);
    }
    (!found.is_empty()).then_some((column, found))
}

impl Dropouts {
    fn share(&self) -> f64 {
        self.rows.len() as f64 / self.readings as f64
    }

    /// What was left out, in words.
    pub(crate) fn words(&self) -> String {
        let what = match self.kind {
            Kind::Value(value) => format!("read {value} for moments"),
            Kind::Held => "repeat the reading before while the joint moves".to_owned(),
            Kind::Wild => "are far from both their neighbours".to_owned(),
        };
        format!(
            "{} of {} readings of {} ({:.1} %) {what}: they count for nothing",
            self.rows.len(),
            self.readings,
            self.channel,
            100.0 * self.share()
        )
    }

    fn cause(&self) -> CauseAnswer {
        let spec = self.spec();
        let share = self.share();
        let sd = (share * (1.0 - share) / self.readings as f64).sqrt();
        let mut cause = CauseAnswer::named(spec.name, self.joint, DATA_PROBABILITY);
        let size = ParameterAnswer::normal(share, sd);
        cause.parameters.insert("share".to_owned(), size);
        cause
    }

    fn spec(&self) -> &'static Spec {
        match self.kind {
            Kind::Value(_) | Kind::Held => &DROPOUTS,
            Kind::Wild => &OUTLIERS,
        }
    }

    fn inspect(&self) -> &'static str {
        self.spec().inspect
    }
}

/// Adds dropouts to an answer on the log without them. Where that has no gap they are all of the log's.
pub(crate) fn name_dropouts(dropouts: &[Dropouts], found: &mut Diagnosis) {
    let Some(worst) = dropouts
        .iter()
        .max_by(|a, b| a.share().total_cmp(&b.share()))
    else {
        return;
    };
    let is_all = found.verdict == Verdict::NoGap && found.admission.refusal().is_none();
    let all: f64 = dropouts.iter().map(Dropouts::share).sum();
    for item in dropouts {
        found.warnings.push(item.words());
        found.causes.push(CauseAnswer {
            share: match is_all {
                true => item.share() / all,
                false => 0.0,
            },
            ..item.cause()
        });
        let rows = item.rows.iter().map(|row| (item.channel.clone(), *row));
        found.fit_rows.left_out.extend(rows);
        let mut channels = found.gap.channels.iter_mut();
        let channel = channels.find(|channel| channel.channel == item.channel);
        if let Some(channel) = channel.filter(|channel| is_all || channel.has_gap) {
            channel.rms_before = channel.rms_before.hypot(item.off_rms);
            if is_all {
                channel.has_gap = true;
                channel.reduction_percent = gap_reduction_percent(
                    channel.rms_before,
                    channel.rms_after,
                    channel.noise_floor,
                );
                channel.no_reduction = None;
                channel.share_of_gap = item.share() / all;
            }
        }
    }
    if is_all {
        let region = "in what the channel reads, not in the device".to_owned();
        found.place = Some(Place::new(worst.channel.clone(), worst.joint, region, []));
        found.verdict = Verdict::Named;
        found.next_experiment = Some(format!("check {}", worst.inspect()));
    }
}

#[cfg(test)]
mod tests;
