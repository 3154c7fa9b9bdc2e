//! What external encoders may have been written as.

use haptical_model::{Device, Recording};

use super::hypotheses::{Hypothesis, column, scale};
use super::misses::{Course, RATIO_OFF, pairs_of};

/// Part of the variance that a line leaves at most of a column that follows another one.
const FOLLOWS: f64 = 0.01;

const ANGLES: &str =
    "give both in rad (or m) of the joint, motor-side readings over the transmission ratio";
const OF_JOINTS: &str = "write each external encoder into the column of its joint";

/// Another joint's column, its joint's negated, and factors that no transmission has: degrees and counts.
pub(super) fn of_outputs(device: &Device, recording: &Recording) -> Vec<Hypothesis<'static>> {
    let mut all = Vec::new();
    let mut add = |what, mend, change: Box<dyn Fn(&mut Recording)>| {
        all.push(Hypothesis::of_columns(what, mend, change));
    };
    for (joint, output) in recording.output.iter().enumerate() {
        let Some(output) = output else { continue };
        let follows = |other: usize| {
            let course = Course::new(pairs_of(recording, other, output))?;
            (course.rest < FOLLOWS).then_some(course.slope)
        };
        let name = column(device, "out", joint);
        let times = |factor: f64| {
            let scaled = move |log: &mut Recording| {
                scale(log.output[joint].as_deref_mut().unwrap_or_default(), factor);
            };
            Box::new(scaled)
        };
        add(format!("column {name} negated"), ANGLES, times(-1.0));
        let slope = follows(joint).filter(|slope| (slope.abs() - 1.0).abs() > RATIO_OFF);
        if let Some(slope) = slope {
            add(by_factor(&name, 1.0 / slope), ANGLES, times(1.0 / slope));
            let scaled = move |log: &mut Recording| scale(&mut log.joint[joint], slope);
            let theta = column(device, "theta", joint);
            add(by_factor(&theta, slope), ANGLES, Box::new(scaled));
        }
        let others = (0..recording.joint.len()).filter(|&other| other != joint);
        for other in others.filter(|&other| follows(other).is_some()) {
            let theta = column(device, "theta", other);
            let what = format!("column {name} left out, which follows {theta}");
            let left_out = move |log: &mut Recording| log.output[joint] = None;
            add(what, OF_JOINTS, Box::new(left_out));
            // each pair once
            if recording
                .output
                .get(other)
                .is_some_and(|swapped| other > joint || swapped.is_none())
            {
                let what = format!(
                    "columns {name} and {} swapped",
                    column(device, "out", other)
                );
                let swapped = move |log: &mut Recording| log.output.swap(joint, other);
                add(what, OF_JOINTS, Box::new(swapped));
            }
        }
    }
    all
}

/// A column times a factor, in words.
fn by_factor(name: &str, factor: f64) -> String {
    let hint = "57.3 are degrees, whole numbers of thousands are counts";
    match factor.abs() < 1.0 {
        true => format!("column {name} divided by {:.4} ({hint})", 1.0 / factor),
        false => format!("column {name} times {factor:.4} ({hint})"),
    }
}
