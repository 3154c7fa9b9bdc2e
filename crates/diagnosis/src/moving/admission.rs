//! What admits a verdict on the torques of a moving arm, or on encoders on its links.

use haptical_judge::{Admission, Check};
use haptical_motion::Change;

use super::warnings::of_doubt;
use super::words::Words;
use crate::thresholds::admission::{DRIVING_NOISES, FOLLOWED, LEAST_MOTION_S};

/// The four questions.
pub(super) fn admission(words: &Words<'_>) -> Admission {
    let examined = words.examined;
    Admission {
        belongs: belongs(words),
        credible_base: credible_base(words),
        known_noise: known_noise(words),
        enough: enough(&examined.time_s),
    }
}

/// Whether each torque is one of its joint.
fn belongs(words: &Words<'_>) -> Check {
    let (device, examined) = (words.device, words.examined);
    if let Some(doubt) = examined.doubts.first() {
        let next = "correct the column, or take the log of this device";
        let said = of_doubt(device, doubt);
        return Check::no(
            format!("log and device do not belong together: {said}"),
            next,
        );
    }
    if let Some(why) = of_another_arm(words) {
        return Check::no(
            why,
            "compare lengths and masses of the device file with those of the arm, and the unit of its torques",
        );
    }
    let scales = examined
        .channels
        .iter()
        .filter_map(|entry| Some((entry.joint, entry.scale?)));
    let loudest = scales.max_by(|a, b| a.1.heard.total_cmp(&b.1.heard));
    match loudest {
        Some((joint, scale)) if scale.explained < FOLLOWED => Check::no(
            format!(
                "log and device do not belong together: {}",
                explained(words, joint, scale.explained)
            ),
            "take the log of this device, or the device file of this log: check joints, units and signs",
        ),
        Some((joint, scale)) => Check::yes(explained(words, joint, scale.explained)),
        None => Check::unknown("no torque was compared with what the links ask for"),
    }
}

/// One factor on all torques and another body than described, both at once.
fn of_another_arm(words: &Words<'_>) -> Option<String> {
    let (factor, body) = words.examined.of_another_arm()?;
    let joint = body.joint.map_or(0, |joint| joint + 1);
    Some(format!(
        "log and device may not belong together: all torques are {factor:.2} times what the links ask for, and {} at joint {joint} is added to \
         that, as with an arm of other lengths or masses",
        body.effect
    ))
}

/// How much of the torque that is clearest above its noise the base model explains.
fn explained(words: &Words<'_>, joint: usize, share: f64) -> String {
    format!(
        "links, friction and rotor explain {:.1} % of the variance of {}, which is clearest above its noise",
        100.0 * share,
        words.channel(joint)
    )
}

/// Whether the numbers that are fitted next to the bodies are those of an arm.
fn credible_base(words: &Words<'_>) -> Check {
    let examined = words.examined;
    if let Some(why) = rotor_below_zero(words).or_else(|| driving_friction(words)) {
        return Check::no(
            why,
            "check joints, signs and units of the torques, and that the log is of this device",
        );
    }
    let negative = examined.free_armatures.iter().find(|entry| entry.1 < 0.0);
    match negative {
        Some((joint, armature)) => Check::unknown(format!(
            "the armature of joint {} is fitted as {armature:.4} kg m^2, below zero",
            joint + 1
        )),
        None => Check::yes(format!(
            "{} numbers are fitted, bodies within what a description may be off by",
            examined.numbers
        )),
    }
}

/// A cause by which a rotor has an inertia below zero.
fn rotor_below_zero(words: &Words<'_>) -> Option<String> {
    let found = words.examined.findings.iter().filter(|_| words.is_adequate);
    let mut rotors = found.filter_map(|found| match found.change {
        Some(Change::Armature { joint, more_kgm2 }) => {
            let sd = found.numbers.first().map_or(0.0, |number| number.2);
            let stated = words.device.joints[joint].armature_kgm2.unwrap_or(0.0);
            Some((joint, stated + more_kgm2, sd))
        }
        _ => None,
    });
    let (joint, armature, _) = rotors.find(|(_, armature, sd)| armature + 2.0 * sd < 0.0)?;
    Some(format!(
        "with the causes the armature of joint {} is {armature:.4} kg m^2",
        joint + 1
    ))
}

/// Friction that is fitted next to causes and drives its joint at full speed, by more than noise.
fn driving_friction(words: &Words<'_>) -> Option<String> {
    let adjusted = words.adjusted();
    let examined = words.examined;
    let of_joint = |joint: usize| {
        let number = adjusted.iter().filter(|number| number.joint == joint + 1);
        number.filter(|number| number.name == "friction").fold(
            [0.0; 2],
            |[friction, half], number| {
                let speed = match number.number.starts_with("viscous") {
                    true => examined.fastest.get(joint).copied().unwrap_or(0.0),
                    false => 1.0,
                };
                let half_width = number.ci95[1] - number.after;
                [friction + speed * number.after, half + speed * half_width]
            },
        )
    };
    let mut channels = examined.channels.iter().filter(|_| words.is_adequate);
    channels.find_map(|channel| {
        let [friction, half] = of_joint(channel.joint);
        let drives = friction + 2.0 * half < 0.0 && friction < -DRIVING_NOISES * channel.noise;
        drives.then(|| {
            format!(
                "with the causes the friction of joint {} drives it, by {:.4} {} at its fastest",
                channel.joint + 1,
                -friction,
                words.unit(channel.joint)
            )
        })
    })
}

/// What is faster than the motion says how large the noise is.
fn known_noise(words: &Words<'_>) -> Check {
    let examined = words.examined;
    let sizes = examined.channels.iter().map(|channel| {
        let (name, unit) = (words.channel(channel.joint), words.unit(channel.joint));
        format!("{name} {:.3e} {unit}", channel.noise)
    });
    let sizes = sizes.collect::<Vec<_>>().join(", ");
    let shaken = examined.oscillations.iter().map(|(joint, line)| {
        let (name, unit) = (words.channel(*joint), words.unit(*joint));
        let (hz, amplitude) = (line.hz, line.amplitude);
        format!("{name} oscillates at {hz:.1} Hz by {amplitude:.4} {unit}, which is no noise")
    });
    let shaken = shaken.collect::<Vec<_>>().join("; ");
    match (shaken.is_empty(), examined.has_gap()) {
        (true, _) => {}
        (false, true) => return Check::unknown(shaken),
        // a gap may hide in it
        (false, false) => {
            return Check::no(
                shaken,
                "look for what shakes the arm at that frequency: a loop at its limit, a loose part, a drive's ripple; or log without it",
            );
        }
    }
    let memory = if examined.has_memory() {
        ", with a memory"
    } else {
        ""
    };
    Check::yes(format!(
        "by what is faster than {} Hz{memory}: {sizes}",
        examined.edge_hz
    ))
}

/// Whether the motion is long enough, by the times of its rows.
fn enough(time_s: &[f64]) -> Check {
    let mut steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.retain(|step| *step > 0.0);
    steps.sort_by(f64::total_cmp);
    let usual_s = steps.get(steps.len() / 2).copied().unwrap_or_default();
    let length_s = usual_s * time_s.len() as f64;
    let figure = format!("{length_s:.2} s of motion");
    match length_s < LEAST_MOTION_S {
        true => Check::no(
            format!("{figure} are too little: {LEAST_MOTION_S} s are needed"),
            format!(
                "record at least {LEAST_MOTION_S} s, better 20 s, in which every joint moves both ways"
            ),
        ),
        false => Check::yes(figure),
    }
}
