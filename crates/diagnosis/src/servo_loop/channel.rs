//! Joints' positions as channels: what their commands leave of them, before and with the causes.

use haptical_model::{Device, JointType};
use haptical_servo::{JointAnswer, Predicted};

use crate::answer::{
    ChannelGap, Left, NoReduction, NoiseAnswer, Prediction, SecondChannel, Trace, Verdict,
    reduction_percent,
};
use crate::noise::NoiseSource;
use crate::thresholds::second::ALLOWED_OF_COMMANDS;

/// What one joint says, with its share of all joints' gap.
pub(super) struct Joint {
    pub(super) index: usize,
    pub(super) answer: JointAnswer,
    pub(super) weight: f64,
    /// The second recording beside what the causes make of it.
    pub(super) second: Option<Predicted>,
}

pub(super) fn channel(joint: usize) -> String {
    format!("theta{}", joint + 1)
}

fn unit(device: &Device, joint: usize) -> &'static str {
    match device.joints[joint].joint_type {
        JointType::Prismatic => "m",
        JointType::Revolute => "rad",
    }
}

/// Rows of the second recording.
pub(super) fn predictions(joint: &Joint) -> Vec<Prediction> {
    let of = |second: &Predicted| -> Vec<Prediction> {
        let rows = second.row.iter().enumerate();
        let of_row = |(index, row): (usize, &usize)| Prediction {
            row: *row,
            channel: channel(joint.index),
            measured: second.measured[index],
            before: second.before[index],
            after: match is_closed(joint) {
                true => second.after[index],
                false => second.before[index],
            },
        };
        rows.map(of_row).collect()
    };
    joint.second.as_ref().map_or(Vec::new(), of)
}

/// What is left of the second recording, by the floor of the first; beside causes, by what they leave of the first.
pub(super) fn of_second(device: &Device, joint: &Joint) -> Option<SecondChannel> {
    let second = joint.second.as_ref()?;
    let [before, after] = second.rms();
    let answer = &joint.answer;
    let (rms, of_log) = match is_closed(joint) {
        true => (after, answer.rms_after),
        false => (before, 0.0),
    };
    let left = Left {
        rms,
        noise: answer.noise_floor,
        // as many independent readings as eighths of a second are few of
        readings: second.row.len() as f64 / 4.0,
        error_of_fit: 0.0,
    };
    let name = (
        channel(joint.index),
        Some(joint.index + 1),
        unit(device, joint.index),
    );
    Some(SecondChannel::new(
        name,
        (left, of_log),
        ALLOWED_OF_COMMANDS,
        None,
    ))
}

fn is_closed(joint: &Joint) -> bool {
    joint.answer.verdict.has_causes()
}

pub(super) fn gap(device: &Device, joint: &Joint) -> ChannelGap {
    let answer = &joint.answer;
    let has_gap = answer.verdict != Verdict::NoGap;
    let is_closed = is_closed(joint);
    let second = joint.second.as_ref();
    let [before, after] = second.map_or([answer.rms_before, answer.rms_after], Predicted::rms);
    let (closed, closed_ci95) = second.map_or((answer.closed, answer.closed_ci95), |second| {
        let closed = second.closed(answer.noise_floor);
        (closed.share, closed.ci95)
    });
    let floor = answer.noise_floor;
    // as many independent readings as eighths of a second are few of
    let relative = 1.96 / (answer.course.row.len() as f64 / 4.0).max(1.0).sqrt();
    ChannelGap {
        channel: channel(joint.index),
        joint: Some(joint.index + 1),
        has_gap,
        held_out: true,
        rms_before: before,
        rms_after: if is_closed { after } else { before },
        rms_fit: None,
        noise_floor: floor,
        noise_floor_ci95: [floor * (1.0 - relative).max(0.0), floor * (1.0 + relative)],
        noise_source: NoiseSource::Motion,
        unit: unit(device, joint.index).to_owned(),
        share_of_gap: joint.weight,
        reduction_percent: has_gap.then(|| match is_closed {
            true => reduction_percent(closed),
            false => 0.0,
        }),
        reduction_ci95: is_closed.then(|| closed_ci95.map(reduction_percent)),
        no_reduction: (!has_gap).then_some(NoReduction::NoGap),
    }
}

pub(super) fn trace(device: &Device, joint: &Joint) -> Option<Trace> {
    let answer = &joint.answer;
    let course = &answer.course;
    let after = match answer.verdict {
        Verdict::Unknown => &course.before,
        _ => &course.after,
    };
    (answer.verdict != Verdict::NoGap).then(|| {
        let rest = [&course.before, after].map(Clone::clone);
        let unit = unit(device, joint.index);
        Trace::over_time(channel(joint.index), unit, &course.time_s, rest)
    })
}

pub(super) fn noise(joint: &Joint) -> NoiseAnswer {
    NoiseAnswer {
        channel: channel(joint.index),
        ratio: 1.0,
        speed_ratio: 1.0,
        colour: 0.0,
        outlier_share: 0.0,
        readings: joint.answer.course.row.len(),
        degrees_of_freedom: joint.answer.course.row.len() as f64 / 4.0,
        source: NoiseSource::Motion,
        from: "the rounding of its readings, or what neighbours scatter by".to_owned(),
    }
}
