//! Readings that are none: moments at which a channel of a motion reads 0, or one value, and single wild torques. They are left out before
//! anything is judged, and named: as noise they would hide any gap.

use std::collections::BTreeMap;
use std::ops::Range;

use haptical_calibration::Channel;
use haptical_effects::noise::{DROPOUTS, OUTLIERS};
use haptical_effects::runs_of;
use haptical_metrics::gap_reduction_percent;
use haptical_model::{Device, Recording};

use crate::answer::{CauseAnswer, Diagnosis, ParameterAnswer, Place, Verdict};
use crate::noise::{difference_sd, outliers};
use crate::thresholds::admission::{
    DROPOUT_SDS, FILLED_ROWS, LEAST_DROPOUT_SHARE, LEAST_DROPOUTS, LEAST_SPIKE_SHARE,
    LONGEST_DROPOUT_ROWS, MOST_AT_LOW, MOST_DROPOUT_SHARE, SPIKE_OF_TORQUE, SPIKE_SDS,
};
use crate::thresholds::noise::DATA_PROBABILITY;

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
    /// What they read; none where each is another one.
    value: Option<f64>,
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
    let mut without = recording.clone();
    let mut found = Vec::new();
    for joint in 0..device.joints.len() {
        let speeds = speeds(&recording.joint[joint], &runs);
        let torque = without.torque_nm.get_mut(joint).and_then(Option::as_mut);
        if let Some(column) = torque {
            let channel = format!("torque{}", joint + 1);
            found.extend(taken_out(
                column,
                &runs,
                Some(&speeds),
                (&channel, Some(joint)),
            ));
        }
        let output = without.output.get_mut(joint).and_then(Option::as_mut);
        if let Some(column) = output {
            let channel = format!("out{}", joint + 1);
            found.extend(taken_out(column, &runs, None, (&channel, Some(joint))));
        }
    }
    for (index, column) in without.cable_m.iter_mut().enumerate() {
        let channel = Channel::Cable { index }.name();
        if let Some(column) = column {
            found.extend(taken_out(column, &runs, None, (&channel, None)));
        }
    }
    (!found.is_empty()).then_some((without, found))
}

/// Takes readings that are none out of a column; of torques, for which the speeds of their joint are given, also single wild ones, and short
/// moments are filled in.
fn taken_out(
    column: &mut [f64],
    runs: &[Range<usize>],
    speeds: Option<&[f64]>,
    (channel, joint): (&str, Option<usize>),
) -> Vec<Dropouts> {
    let is_torque = speeds.is_some();
    let readings = column.iter().filter(|value| value.is_finite()).count();
    let are_some = |rows: &[usize], least: f64| {
        let share = rows.len() as f64 / readings.max(1) as f64;
        rows.len() >= LEAST_DROPOUTS && (least..MOST_DROPOUT_SHARE).contains(&share)
    };
    let mut found = Vec::new();
    let mut take = |column: &mut [f64], rows: Vec<usize>, value: Option<f64>| {
        let lines = rows.iter().map(|&row| between(column, &rows, runs, row));
        let lines: Vec<Option<(f64, usize)>> = lines.collect();
        let off = rows.iter().zip(&lines);
        let off = off.filter_map(|(row, line)| Some(column[*row] - line.as_ref()?.0));
        let squares: f64 = off.map(|off| off * off).sum();
        found.push(Dropouts {
            channel: channel.to_owned(),
            joint,
            readings,
            value,
            off_rms: (squares / readings as f64).sqrt(),
            rows: rows.clone(),
        });
        for (row, line) in rows.into_iter().zip(lines) {
            // a motion needs its rows without gaps: what is short is put on the line between its neighbours
            let short = line.filter(|(_, rows)| is_torque && *rows <= FILLED_ROWS);
            column[row] = short.map_or(f64::NAN, |(value, _)| value);
        }
    };
    if let Some(value) = most_frequent(column) {
        let rows = moments_at(column, runs, value);
        if are_some(&rows, LEAST_DROPOUT_SHARE) {
            take(column, rows, Some(value));
        }
    }
    if let Some(speeds) = speeds
        && let Some(sd) = difference_sd(column, runs).filter(|sd| *sd > 0.0)
    {
        // where friction changes sides a torque without noise has corners
        let limit = (SPIKE_SDS * sd).max(SPIKE_OF_TORQUE * spread(column));
        let far = outliers(column, runs, true, limit, &vec![0.0; column.len()]);
        let stands_alone = |row: &usize| {
            let around = neighbours(column, &far, runs, *row);
            around.is_some_and(|(before, after)| {
                let step = (column[before] - column[after]).abs();
                let [before, after] = [before, after].map(|item| column[*row] - column[item]);
                // a torque that goes on from another level has stepped there, as friction does where a joint turns round
                before.abs().min(after.abs()) > limit.max(step) && before * after > 0.0
            })
        };
        let rows: Vec<usize> = far.iter().copied().filter(stands_alone).collect();
        let load = |row: usize| {
            let around = neighbours(column, &rows, runs, row);
            around.map_or(f64::NAN, |(before, after)| {
                0.5 * (column[before] + column[after]).abs()
            })
        };
        // knocks of a gear come where the load changes sides or the joint turns round: they are the arm's
        let is_of_arm = || {
            let loads: Vec<f64> = (0..column.len()).map(load).collect();
            are_low(&rows, speeds) || are_low(&rows, &loads)
        };
        if are_some(&rows, LEAST_SPIKE_SHARE) && !is_of_arm() {
            take(column, rows, None);
        }
    }
    found
}

/// Whether rows come where a quantity is low: most of them in its lowest fifth.
fn are_low(rows: &[usize], quantity: &[f64]) -> bool {
    let mut sorted: Vec<f64> = quantity
        .iter()
        .copied()
        .filter(|value| value.is_finite())
        .collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let Some(lowest) = sorted.get(sorted.len() / 5) else {
        return false;
    };
    let low = rows.iter().filter(|row| quantity[**row] < *lowest).count();
    low as f64 > MOST_AT_LOW * rows.len() as f64
}

/// Speed of a joint from row to row, without a sign and up to a factor.
fn speeds(joint: &[f64], runs: &[Range<usize>]) -> Vec<f64> {
    let mut speeds = vec![f64::NAN; joint.len()];
    for run in runs.iter().filter(|run| run.len() > 2) {
        for row in run.start + 1..run.end - 1 {
            speeds[row] = (joint[row + 1] - joint[row - 1]).abs();
        }
    }
    speeds
}

/// Standard deviation of the readings.
fn spread(column: &[f64]) -> f64 {
    let read = || column.iter().filter(|value| value.is_finite());
    let count = read().count().max(1) as f64;
    let mean = read().sum::<f64>() / count;
    (read().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// The value that most readings share.
fn most_frequent(column: &[f64]) -> Option<f64> {
    let mut counts: BTreeMap<u64, usize> = BTreeMap::new();
    for value in column.iter().filter(|value| value.is_finite()) {
        // a zero has two signs
        *counts.entry((value + 0.0).to_bits()).or_default() += 1;
    }
    let most = counts.into_iter().max_by_key(|(_, count)| *count);
    most.filter(|(_, count)| *count >= LEAST_DROPOUTS)
        .map(|(bits, _)| f64::from_bits(bits))
}

/// Rows that read a value for a moment, which is far from what is read before and after. None where most rows with that value are not such:
/// then it is one that the channel may have.
fn moments_at(column: &[f64], runs: &[Range<usize>], value: f64) -> Vec<usize> {
    let is_it = |row: usize| column[row] == value;
    let others: Vec<f64> = (column.iter())
        .map(|item| if *item == value { f64::NAN } else { *item })
        .collect();
    let Some(sd) = difference_sd(&others, runs).filter(|sd| *sd > 0.0) else {
        return Vec::new();
    };
    let is_far = |row: usize| (column[row] - value).abs() > DROPOUT_SDS * sd;
    let mut rows = Vec::new();
    for run in runs {
        let mut row = run.start;
        while row < run.end {
            let first = row;
            while row < run.end && is_it(row) {
                row += 1;
            }
            let is_moment = row - first <= LONGEST_DROPOUT_ROWS;
            let is_inside = row > first && first > run.start && row < run.end;
            if is_inside && is_moment && is_far(first - 1) && is_far(row) {
                rows.extend(first..row);
            }
            row = row.max(first + 1);
        }
    }
    let all = (0..column.len()).filter(|row| is_it(*row)).count();
    match 2 * rows.len() > all {
        true => rows,
        false => Vec::new(),
    }
}

/// The readings around a row that stay.
fn neighbours(
    column: &[f64],
    gone: &[usize],
    runs: &[Range<usize>],
    row: usize,
) -> Option<(usize, usize)> {
    let run = runs.iter().find(|run| run.contains(&row))?;
    let stays = |row: &usize| column[*row].is_finite() && gone.binary_search(row).is_err();
    let before = (run.start..row).rev().find(stays)?;
    let after = (row + 1..run.end).find(stays)?;
    Some((before, after))
}

/// The line between the readings around a row that stay, and how many rows they are apart.
fn between(
    column: &[f64],
    gone: &[usize],
    runs: &[Range<usize>],
    row: usize,
) -> Option<(f64, usize)> {
    let (before, after) = neighbours(column, gone, runs, row)?;
    let share = (row - before) as f64 / (after - before) as f64;
    let value = column[before] + share * (column[after] - column[before]);
    Some((value, after - before - 1))
}

impl Dropouts {
    fn share(&self) -> f64 {
        self.rows.len() as f64 / self.readings as f64
    }

    /// What was left out, in words.
    pub(crate) fn words(&self) -> String {
        let what = match self.value {
            Some(value) => format!("read {value} for moments"),
            None => "are far from both their neighbours".to_owned(),
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
        let spec = match self.value {
            Some(_) => &DROPOUTS,
            None => &OUTLIERS,
        };
        let share = self.share();
        let sd = (share * (1.0 - share) / self.readings as f64).sqrt();
        let mut cause = CauseAnswer::named(spec.name, self.joint, DATA_PROBABILITY);
        let size = ParameterAnswer::normal(share, sd);
        cause.parameters.insert("share".to_owned(), size);
        cause
    }

    fn inspect(&self) -> &'static str {
        match self.value {
            Some(_) => DROPOUTS.inspect,
            None => OUTLIERS.inspect,
        }
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
mod tests {
    use haptical_judge::Check;

    use super::*;
    use crate::answer::{ChannelGap, Floor, Gap, Provenance};
    use crate::noise::NoiseSource;

    /// Torque of a joint in motion with noise of 0.02, made up without a generator of its own.
    fn torque(rows: usize) -> Vec<f64> {
        let noise = |row: usize| 0.02 * (7.0 * (row as f64).powi(2)).sin();
        let of = |row: usize| 3.0 * (0.02 * row as f64).cos() + noise(row);
        (0..rows).map(of).collect()
    }

    fn found(column: &[f64]) -> (Vec<f64>, Vec<Dropouts>) {
        let speeds = vec![1.0; column.len()];
        found_at(column, &speeds)
    }

    fn found_at(column: &[f64], speeds: &[f64]) -> (Vec<f64>, Vec<Dropouts>) {
        let mut column = column.to_vec();
        let rows = 0..column.len();
        let found = taken_out(&mut column, &[rows], Some(speeds), ("torque1", Some(0)));
        (column, found)
    }

    #[test]
    fn moments_at_zero_and_single_wild_torques_are_told_and_left_out() {
        let sound = torque(1200);
        let mut lost = sound.clone();
        for row in (40..1200).step_by(37) {
            lost[row] = 0.0;
            lost[row + 1] = 0.0;
        }
        let (left, dropouts) = found(&lost);
        assert_eq!(dropouts.len(), 1);
        assert_eq!(dropouts[0].value, Some(0.0));
        // where the torque itself is about zero nothing tells them
        assert!(dropouts[0].rows.len() > 50, "{}", dropouts[0].rows.len());
        let is_mended = |row: &usize| (left[*row] - sound[*row]).abs() < 0.2;
        assert!(dropouts[0].rows.iter().all(is_mended));
        assert!(
            (dropouts[0].off_rms - 0.5).abs() < 0.15,
            "{}",
            dropouts[0].off_rms
        );

        let mut wild = sound.clone();
        for row in (40..1200).step_by(61) {
            wild[row] = -wild[row];
        }
        let (_, spikes) = found(&wild);
        assert_eq!(spikes.len(), 1);
        assert!(spikes[0].value.is_none() && spikes[0].rows.len() > 12);
        assert!(spikes[0].rows.iter().all(|row| row % 61 == 40));
    }

    /// Where friction changes sides at the top of a wave, one reading may lie alone.
    #[test]
    fn a_corner_of_a_torque_without_noise_is_no_wild_reading() {
        let corners = |size: f64| {
            let mut column: Vec<f64> = (0..1200)
                .map(|row| 3.0 * (0.02 * f64::from(row)).cos())
                .collect();
            for row in (40..1200).step_by(61) {
                column[row] += size;
            }
            found(&column).1.len()
        };
        assert_eq!(corners(0.1), 0);
        assert_eq!(corners(1.0), 1);
    }

    /// At 100 rows a second friction steps from one reading to the next, on a torque that goes up to the step and on behind it.
    #[test]
    fn friction_that_changes_sides_is_no_wild_reading() {
        let friction = |row: usize| {
            let phase = 0.1 * row as f64;
            let noise = 0.02 * (7.0 * (row as f64).powi(2)).sin();
            2.0 * phase.sin() - 0.8 * (phase + 0.3).sin().signum() + noise
        };
        let stepping: Vec<f64> = (0..4000).map(friction).collect();
        assert!(found(&stepping).1.is_empty());
    }

    /// A gear with play knocks where its load changes sides, or where the joint turns round.
    #[test]
    fn knocks_are_no_wild_readings() {
        let load = |row: usize| 3.0 * (0.02 * row as f64).cos();
        let at = |is_knock: fn(f64, f64) -> bool| {
            let mut column = torque(3000);
            let rows = (1..3000).filter(|row| is_knock(load(row - 1), load(*row)));
            let rows: Vec<usize> = rows.collect();
            rows.iter().for_each(|row| column[*row] += 2.0);
            let speeds: Vec<f64> = (0..3000).map(|row| load(row + 20).abs()).collect();
            found_at(&column, &speeds).1.len()
        };
        assert_eq!(at(|before, now| before * now <= 0.0), 0);
        assert_eq!(at(|before, now| (before > 2.0) != (now > 2.0)), 1);
    }

    #[test]
    fn each_channel_with_dropouts_has_its_gap_and_no_other() {
        let device = Device::from_toml("[[joint]]\n", "device.toml")
            .unwrap()
            .device;
        let channel = |number: usize| {
            let channel = Channel::Output { joint: number };
            let floor = Floor::new(channel, 0.02, 1000.0, NoiseSource::Motion);
            let name = format!("torque{}", number + 1);
            ChannelGap::fitted(name, Some(number), [0.019; 2], &floor, "N m")
        };
        let gap = Gap::new(Verdict::NoGap, None, (0..3).map(channel).collect());
        let clear = Diagnosis::of_causes(
            Verdict::NoGap,
            gap,
            Vec::new(),
            device,
            Provenance::default(),
        );
        let lost = |joint: usize, rows: usize| Dropouts {
            channel: format!("torque{}", joint + 1),
            joint: Some(joint),
            rows: (0..rows).collect(),
            readings: 64,
            value: Some(0.0),
            off_rms: 0.5,
        };
        let dropouts = [lost(0, 4), lost(2, 12)];
        let mut found = clear.clone();
        name_dropouts(&dropouts, &mut found);
        assert_eq!((found.verdict, found.causes.len()), (Verdict::Named, 2));
        let gaps = found
            .gap
            .channels
            .iter()
            .map(|gap| (gap.has_gap, gap.share_of_gap));
        assert_eq!(
            gaps.collect::<Vec<_>>(),
            [(true, 0.25), (false, 0.0), (true, 0.75)]
        );
        assert_eq!(found.place.unwrap().channel, "torque3");

        // an answer that is not admitted stays what it is
        let mut barred = clear;
        barred.admission.enough = Check::no("2 s", "record 10 s");
        name_dropouts(&dropouts, &mut barred);
        assert_eq!(barred.verdict, Verdict::NoGap);
        assert!(barred.gap.channels.iter().all(|gap| !gap.has_gap));
    }

    #[test]
    fn steps_limits_and_rests_are_no_dropouts() {
        let sound = torque(1200);
        assert_eq!(found(&sound).1, []);
        // friction that changes sides, a drive at its limit, a joint that rests
        let friction =
            |(row, item): (usize, &f64)| item + if row / 100 % 2 == 0 { 1.0 } else { -1.0 };
        let reversing: Vec<f64> = sound.iter().enumerate().map(friction).collect();
        assert_eq!(found(&reversing).1, []);
        let limited: Vec<f64> = sound.iter().map(|item| item.clamp(-2.0, 2.0)).collect();
        assert_eq!(found(&limited).1, []);
        let resting = sound.iter().enumerate();
        let resting: Vec<f64> = resting
            .map(|(row, item)| if row / 100 % 3 == 0 { 0.0 } else { *item })
            .collect();
        assert_eq!(found(&resting).1, []);
    }
}
