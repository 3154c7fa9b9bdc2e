//! External encoders against the motor-side readings of the joints: another joint's column, a turned one, counts.

use haptical_model::{Device, JointType, Recording};

use crate::CalibrationError;

/// Fewest rows in which both columns have a reading.
const LEAST_ROWS: usize = 8;
/// What a transmission may be off by: its ratio, as a share, and the part of the variance that its error takes.
const RATIO_OFF: f64 = 0.5;
const ERROR_PART: f64 = 0.05;
/// Part of the variance that a mistaken column leaves at most beside the one that it is.
const ALIKE_PART: f64 = 0.01;

/// How an output column follows a joint's column: slope, and the part of its variance that this leaves.
struct Course {
    slope: f64,
    rest: f64,
}

/// Refuses external encoders that follow another joint's column, the own one backwards, or by a factor that no
/// transmission has.
///
/// # Errors
/// [`CalibrationError::Reading`] that names the columns.
pub(crate) fn check(device: &Device, recording: &Recording) -> Result<(), CalibrationError> {
    for (joint, output) in recording.output.iter().enumerate() {
        let Some(output) = output else { continue };
        let Some(own) = course(recording, joint, output) else {
            continue;
        };
        let is_sound = (own.slope - 1.0).abs() < RATIO_OFF && own.rest < ERROR_PART;
        if is_sound {
            continue;
        }
        if let Some(message) = mistake(device, recording, joint, &own, output) {
            return Err(CalibrationError::Reading {
                line: recording.line.first().copied().unwrap_or(0),
                column: column(device, "out", joint),
                message,
            });
        }
    }
    Ok(())
}

fn mistake(
    device: &Device,
    recording: &Recording,
    joint: usize,
    own: &Course,
    output: &[f64],
) -> Option<String> {
    let theta = |of: usize| column(device, "theta", of);
    if own.rest < ALIKE_PART {
        let slope = own.slope;
        return Some(match (slope + 1.0).abs() < RATIO_OFF {
            true => format!(
                "it runs against {}: one of the two has the wrong sign; negate it",
                theta(joint)
            ),
            false => format!(
                "it is {slope:.3} times {}: give both in rad (or m) of the joint, motor-side readings over the \
                 transmission ratio; 57.3 are degrees, and whole numbers of thousands counts",
                theta(joint)
            ),
        });
    }
    let others = (0..recording.joint.len()).filter(|&other| other != joint);
    let courses = others.filter_map(|other| Some((other, course(recording, other, output)?)));
    let alike = courses.filter(|(_, course)| {
        course.rest < ALIKE_PART && (course.slope.abs() - 1.0).abs() < RATIO_OFF
    });
    let (other, course) = alike.min_by(|a, b| a.1.rest.total_cmp(&b.1.rest))?;
    let turned = if course.slope < 0.0 { ", negated" } else { "" };
    Some(format!(
        "it follows {}{turned}, not {}: two columns are swapped, or one is another joint's",
        theta(other),
        theta(joint)
    ))
}

/// The line through an output column over a joint's; none where either stands still.
fn course(recording: &Recording, joint: usize, output: &[f64]) -> Option<Course> {
    let readings = recording.joint.get(joint)?.iter().zip(output);
    let pairs: Vec<(f64, f64)> = readings
        .filter(|(theta, out)| theta.is_finite() && out.is_finite())
        .map(|(theta, out)| (*theta, *out))
        .collect();
    if pairs.len() < LEAST_ROWS {
        return None;
    }
    let count = pairs.len() as f64;
    let (x, y) = pairs.iter().fold((0.0, 0.0), |(x, y), pair| {
        (x + pair.0 / count, y + pair.1 / count)
    });
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (theta, out) in pairs {
        xx += (theta - x) * (theta - x);
        xy += (theta - x) * (out - y);
        yy += (out - y) * (out - y);
    }
    let course = Course {
        slope: xy / xx,
        rest: 1.0 - xy * xy / (xx * yy),
    };
    (course.slope.is_finite() && course.rest.is_finite()).then_some(course)
}

fn column(device: &Device, name: &str, joint: usize) -> String {
    let unit = match device.joints.get(joint).map(|joint| joint.joint_type) {
        Some(JointType::Prismatic) => "m",
        _ => "rad",
    };
    format!("{name}{}_{unit}", joint + 1)
}
