//! A fit that is worse than none on rows that it did not see is no result.

use haptical_model::{Device, JointType, Parameter};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::ChannelReport;

/// A fit that was not kept, since it is worse on rows that it did not see.
#[derive(Debug, Clone)]
pub struct Rejected {
    /// The device of that fit.
    pub device: Device,
    /// Before and after it, on rows that it did not see.
    pub held_out_channels: Vec<ChannelReport>,
    /// The channel that is worse.
    pub growth: Growth,
    /// What was kept in its place.
    pub kept: Kept,
}

/// What is kept of a calibration whose fit was rejected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kept {
    /// The device as it was.
    Nominal,
    /// The device with new joint offsets, everything else as it was.
    JointOffsets,
}

/// How much worse a channel is on unseen rows, in its unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Growth {
    /// Channel.
    pub channel: String,
    /// Unit.
    pub unit: String,
    /// Root mean square residual before the fit.
    pub rms_before: f64,
    /// Root mean square residual after it.
    pub rms_after: f64,
}

/// Blocks of successive rows by whose scatter the growth is judged: rows of one block may share an error.
const BLOCKS: usize = 10;
/// Chance that a fit which changes nothing is rejected, on one channel.
const CHANCE: f64 = 0.025;

/// The channel of the whole chain that grew most beyond its own uncertainty; none where none did.
///
/// The squares after less those before are summed over blocks of rows; their mean is compared with the scatter of the
/// blocks (Student's t, one-sided).
pub(crate) fn growth(reports: &[ChannelReport]) -> Option<Growth> {
    let chain = reports
        .iter()
        .filter(|report| report.joint.is_none() && !report.is_pair());
    let grown = chain.filter(|report| has_grown(report));
    let by_ratio = |a: &&ChannelReport, b: &&ChannelReport| {
        let ratio = |r: &ChannelReport| r.rms_after_good / r.rms_before_good.max(f64::MIN_POSITIVE);
        ratio(a).total_cmp(&ratio(b))
    };
    grown.max_by(by_ratio).map(|report| Growth {
        channel: report.channel.clone(),
        unit: report.unit.clone(),
        rms_before: report.rms_before_good,
        rms_after: report.rms_after_good,
    })
}

fn has_grown(report: &ChannelReport) -> bool {
    let rows = report.rows.len();
    if report.rms_after_good <= report.rms_before_good || rows < 2 {
        return false;
    }
    let width = report.after.len() / rows;
    let mut order: Vec<usize> = (0..rows).collect();
    order.sort_by_key(|&position| report.rows[position]);
    let blocks = BLOCKS.min(rows);
    let mut sums = vec![0.0; blocks];
    for (place, &position) in order.iter().enumerate() {
        let own = position * width..(position + 1) * width;
        let square = |residuals: &[f64]| -> f64 { residuals.iter().map(|r| r * r).sum() };
        sums[place * blocks / rows] +=
            square(&report.after[own.clone()]) - square(&report.before[own]);
    }
    let mean = sums.iter().sum::<f64>() / blocks as f64;
    let freedom = (blocks - 1) as f64;
    let scatter = sums.iter().map(|sum| (sum - mean).powi(2)).sum::<f64>() / freedom;
    let deviation = (scatter / blocks as f64).sqrt();
    let quantile =
        StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(1.0 - CHANCE));
    mean > quantile * deviation
}

/// The device with all numbers of its links held but the offsets of its joints.
pub(crate) fn with_offsets_alone(device: &Device) -> Device {
    let mut held = device.clone();
    for row in 0..device.links.len() {
        let own = device.drive(row).map(|drive| match drive.motion {
            JointType::Revolute => Parameter::Theta,
            JointType::Prismatic => Parameter::D,
        });
        for number in Parameter::ALL {
            if own != Some(number) {
                held.deviations.insert((row, number), 0.0);
            }
        }
    }
    held
}

/// Mean square of the unseen residuals of the whole chain, in those of the nominal device.
pub(crate) fn share_left(reports: &[ChannelReport]) -> f64 {
    let chain = reports
        .iter()
        .filter(|report| report.joint.is_none() && !report.is_pair());
    let (mut sum, mut count) = (0.0, 0.0);
    for report in chain {
        sum += (report.rms_after_good / report.rms_before_good.max(f64::MIN_POSITIVE)).powi(2);
        count += 1.0;
    }
    if count > 0.0 {
        sum / count
    } else {
        f64::INFINITY
    }
}

/// The rejection in words.
pub(crate) fn sentence(growth: &Growth, kept: Kept) -> String {
    let percent = 100.0 * (growth.rms_after / growth.rms_before - 1.0);
    let kept = match kept {
        Kept::Nominal => "the device as it was",
        Kept::JointOffsets => "new joint offsets alone",
    };
    format!(
        "the fit is rejected: on rows that it did not see, {} is {percent:.0} % worse than without it. The model lacks \
         what the device does, or rows disagree; kept is {kept}, and the full fit is in rejected.toml. Run haptical \
         diagnose on this log",
        growth.channel
    )
}
