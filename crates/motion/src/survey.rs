//! What a log of a moving arm has for the equations of motion, before anything is fitted.

use haptical_model::{Device, JointType, Missing, ModelError, Recording, RigidBodies};

use crate::MotionError;
use crate::fit::problem::is_still;
use crate::signal::samples::Samples;
use crate::signal::states::States;
use crate::thresholds::fit::{LEAST_RATE_HZ, RATE_ROUNDED};

/// A log of positions and torques.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// Rows per second.
    pub rate_hz: f64,
    /// Root mean square deviation of the stamps from an even grid, as a share of a step.
    pub jitter: f64,
    /// Share of the rows that no piece without a gap has.
    pub lost_share: f64,
    /// The joints.
    pub joints: Vec<SurveyedJoint>,
}

/// A joint of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurveyedJoint {
    /// Fastest motion \[rad/s\] or \[m/s\].
    pub fastest: f64,
    /// Whether it moves.
    pub moves: bool,
    /// Its torque: whether there is one, and whether it changes.
    pub torque: SurveyedTorque,
}

/// A torque's column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SurveyedTorque {
    /// There is none.
    Absent,
    /// It has this value throughout.
    Constant(f64),
    /// It is one.
    Changes,
}

/// Describes a log.
///
/// # Errors
/// [`MotionError`] as [`why_not`] has it in words.
pub fn survey(device: &Device, recording: &Recording) -> Result<Survey, MotionError> {
    let samples = usable(device, recording)?;
    let edge = (0.1 * samples.rate_hz()).min(20.0);
    let states = States::new(&samples, edge);
    let fastest = |joint: usize| {
        let speeds = states.iter().flat_map(|own| &own.motor.dq[joint]);
        speeds.fold(0.0_f64, |most, own| most.max(own.abs()))
    };
    let speeds: Vec<f64> = (0..device.joints.len()).map(fastest).collect();
    let most = speeds.iter().copied().fold(0.0, f64::max);
    let joints = speeds
        .iter()
        .enumerate()
        .map(|(joint, fastest)| SurveyedJoint {
            fastest: *fastest,
            moves: !is_still(*fastest, most),
            torque: match samples.constant_torque(joint) {
                None => SurveyedTorque::Absent,
                Some(Some(value)) => SurveyedTorque::Constant(value),
                Some(None) => SurveyedTorque::Changes,
            },
        });
    Ok(Survey {
        rate_hz: samples.rate_hz(),
        jitter: samples.jitter,
        lost_share: samples.lost_share,
        joints: joints.collect(),
    })
}

/// Why the equations of motion are not asked of a log that has torques in time; none where they are, and for logs of another kind.
pub fn why_not(device: &Device, recording: &Recording) -> Option<String> {
    let has_torques = (recording.torque_nm.iter().flatten().flatten()).any(|own| own.is_finite());
    if !has_torques || !device.has_links() || recording.time_s.is_none() {
        return None;
    }
    match usable(device, recording) {
        Ok(_) => None,
        Err(MotionError::Model(ModelError::Unweighed { missing, .. })) => {
            let words: Vec<String> = missing.iter().take(3).map(ToString::to_string).collect();
            let more = match missing.len().saturating_sub(3) {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            Some(format!("the device file has {}{more}", words.join(", ")))
        }
        Err(why) => Some(why.to_string()),
    }
}

/// The log's samples, where they and the device serve the equations of motion.
pub(crate) fn usable(device: &Device, recording: &Recording) -> Result<Samples, MotionError> {
    let bodies = match RigidBodies::of_device(device) {
        // an inertia that no body has is left out, which the device's warnings say, and a plausible one is taken
        Err(ModelError::Unweighed { missing, .. })
            if missing
                .iter()
                .all(|own| matches!(own, Missing::Body { .. })) =>
        {
            RigidBodies::plausible(device)?
        }
        other => other?,
    };
    let samples = Samples::new(recording, false)?;
    check_rate(&samples)?;
    if bodies.joint_count() != recording.joint.len() {
        return Err(MotionError::Sampling(
            "the log has other joints than the device".to_owned(),
        ));
    }
    Ok(samples)
}

/// The usual time between rows \[s\]; none without times, and of few rows.
pub fn usual_step_s(recording: &Recording) -> Option<f64> {
    crate::signal::samples::usual_step(recording, recording.time_s.as_ref()?)
}

/// The one rule for the rate of a log of a motion.
///
/// # Errors
/// [`MotionError::Sampling`] for too few rows a second.
pub(crate) fn check_rate(samples: &Samples) -> Result<(), MotionError> {
    match is_fast_enough(samples.rate_hz()) {
        true => Ok(()),
        false => Err(too_slow(samples.rate_hz())),
    }
}

/// Whether rows follow each other fast enough \[Hz\] for what a motion's torques say: 20 a second, within what rounded stamps make of it.
///
/// ```
/// assert!(haptical_motion::is_fast_enough(19.999_7) && !haptical_motion::is_fast_enough(16.7));
/// ```
pub fn is_fast_enough(rate_hz: f64) -> bool {
    rate_hz >= (1.0 - RATE_ROUNDED) * LEAST_RATE_HZ
}

/// What is said of too few rows.
fn too_slow(rate_hz: f64) -> MotionError {
    let hint = match rate_hz < 1.0 {
        true => "; is t_s in milliseconds, and not in seconds?",
        false => "",
    };
    MotionError::Sampling(format!(
        "{rate_hz:.3} rows a second are too few for accelerations: {LEAST_RATE_HZ} rows a second are needed{hint}"
    ))
}

/// The recording with turns that its encoders wrapped undone, and for each joint (from 0) where they were, how many; none where
/// there are none.
///
/// A joint that turns does not go half a turn from one row to the next where rows are 0.05 s apart or nearer: such a step
/// is one of an encoder that begins anew at a whole turn.
pub fn unwrapped(
    device: &Device,
    recording: &Recording,
) -> Option<(Recording, Vec<(usize, usize)>)> {
    use std::f64::consts::{PI, TAU};
    let time_s = recording.time_s.as_ref()?;
    let mut found: Option<(Recording, Vec<(usize, usize)>)> = None;
    for (joint, own) in device.joints.iter().enumerate() {
        if own.joint_type != JointType::Revolute {
            continue;
        }
        let readings = recording.joint.get(joint)?;
        let (mut turns, mut count) = (0.0, 0);
        let mut straight = readings.clone();
        for row in 1..readings.len() {
            let is_next = recording.run_at(row) == recording.run_at(row - 1);
            let is_near = (time_s[row] - time_s[row - 1]).abs() < 1.0 / LEAST_RATE_HZ;
            let step = readings[row] - readings[row - 1];
            if !is_next {
                turns = 0.0;
            } else if is_near && step.abs() > PI && (step.abs() - TAU).abs() < 1.0 {
                turns -= step.signum();
                count += 1;
            }
            straight[row] += turns * TAU;
        }
        if count > 0 {
            let (with, joints) = found.get_or_insert_with(|| (recording.clone(), Vec::new()));
            with.joint[joint] = straight;
            joints.push((joint, count));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_that_an_encoder_wrapped_are_undone_and_a_fast_joint_stays() {
        let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n[[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\n[[joint]]\n";
        let device = Device::from_toml(text, "lever.toml").unwrap().device;
        let angles: Vec<f64> = (0..1000)
            .map(|k| 4.0 * (0.01 * f64::from(k)).sin())
            .collect();
        let log = |angles: Vec<f64>| Recording {
            line: (2..).take(angles.len()).collect(),
            time_s: Some((0..angles.len()).map(|k| 0.005 * k as f64).collect()),
            joint: vec![angles],
            ..Recording::default()
        };
        assert_eq!(unwrapped(&device, &log(angles.clone())), None);
        let pi = std::f64::consts::PI;
        let wrap = |angle: &f64| (angle + pi).rem_euclid(2.0 * pi) - pi;
        let (straight, joints) =
            unwrapped(&device, &log(angles.iter().map(wrap).collect())).unwrap();
        assert_eq!(joints, [(0, 6)]);
        for (found, wanted) in straight.joint[0].iter().zip(&angles) {
            assert!((found - wanted).abs() < 1e-12);
        }
    }
}
