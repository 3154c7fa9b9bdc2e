//! What is said of a moving arm's log: of its columns, of what was fitted, of what a corrected device cannot hold.

use haptical_effects::device::is_law;
use haptical_model::{Device, JointType};
use haptical_motion::{Doubt, Examined, Finding, Scale};

use crate::thresholds::moving::{SAME_UNIT, TOO_FAST_RAD_PER_S};

pub(super) fn warnings(device: &Device, examined: &Examined) -> Vec<String> {
    let mut warnings = of_torques(device, examined);
    warnings.extend(of_rows(examined));
    warnings.extend(examined.of_stretches.clone());
    warnings.extend(of_second(examined));
    warnings.extend(of_armatures(&examined.free_armatures));
    warnings.extend(of_friction(&examined.other_friction));
    if examined.findings.iter().any(Finding::is_of_sampling) && !examined.is_adequate() {
        let said = match examined.is_borne_out() {
            true => {
                "the rows that the log repeats or lacks bend what is left of the torques: the other causes are those that the second recording bears out"
            }
            false => {
                "the torques were not judged beyond the rows that the log repeats or lacks: record again without such rows"
            }
        };
        warnings.push(said.to_owned());
    }
    let centres = examined
        .findings
        .iter()
        .filter(|own| own.numbers.iter().any(|number| number.0 == "centre_x_m"));
    warnings.extend(centres.filter_map(|own| own.joint).map(|joint| {
        format!(
            "the shift of the centre of mass behind joint {} is along the axes of its row of the device, and a robot description's link may \
             have others: the exported description has the centre in those",
            joint + 1
        )
    }));
    let named = examined.findings.iter().filter(|_| examined.is_answer());
    // rows that are set right are no number of a device
    let named = named.filter(|own| !own.is_of_sampling());
    for found in named.filter(|own| !is_kept(device, own)) {
        warnings.push(format!(
            "corrected.toml does not hold {}: a device file has no such effect; put its numbers into the masses or the log by hand",
            found.effect
        ));
    }
    for own in examined
        .channels
        .iter()
        .filter(|own| (examined.is_adequate() || examined.is_partial()) && own.has_rest())
    {
        let why = match examined.leaves_friction() {
            true => {
                "friction that depends on the joint's position explains that rest, and no device file holds it"
            }
            false => "no effect of the catalogue explains that rest",
        };
        warnings.push(format!(
            "torque{} keeps {:.1} times its noise: {why}",
            own.joint + 1,
            own.rms_after / own.noise
        ));
    }
    if examined.lacks_gravity && examined.has_gap() {
        warnings.push(
            "the torques lack what gravity asks of the links: a simulator's gravity compensation, or a controller that takes it off (an \
             \"external\" torque)? Log the torques of the drives, or add gravity's part"
                .to_owned(),
        );
    }
    if examined.has_memory() {
        warnings.push(
            "the noise of the torques has a memory: by its fastest part it is larger within the band than a white one".to_owned(),
        );
    }
    if let Some(edge_hz) = examined.above_hz {
        warnings.push(format!(
            "the torques have a gap above {edge_hz} Hz that no effect explains: the spring was found in what is slower, well below its resonance"
        ));
    }
    if examined.jitter > 0.1 {
        let percent = 100.0 * examined.jitter;
        warnings.push(match examined.is_stamped_late {
            true => format!(
                "time stamps are {percent:.0} % of a step off an even grid (rms), and the positions are smoother without that: rows were \
                 taken as evenly spaced"
            ),
            false => format!(
                "time stamps are {percent:.0} % of a step off an even grid (rms): readings were put on one"
            ),
        });
    }
    warnings
}

/// Rows that are listed.
const LISTED_ROWS: usize = 5;

/// Rows that the log repeats, and places where it lacks some.
fn of_rows(examined: &Examined) -> Vec<String> {
    let listed = |rows: &[usize]| {
        let first: Vec<String> = rows
            .iter()
            .take(LISTED_ROWS)
            .map(usize::to_string)
            .collect();
        let more = if rows.len() > LISTED_ROWS {
            ", ..."
        } else {
            ""
        };
        format!("{}{more}", first.join(", "))
    };
    let (repeated, behind) = (&examined.repeated_rows, &examined.behind_missing_rows);
    let said = [
        (!repeated.is_empty()).then(|| {
            format!(
                "{} rows repeat the one before them while the arm moves, and were left out: {} (from 0)",
                repeated.len(),
                listed(repeated)
            )
        }),
        (!behind.is_empty()).then(|| {
            format!(
                "the log lacks rows before {} others though its stamps run on, and time was set right: {} (from 0)",
                behind.len(),
                listed(behind)
            )
        }),
    ];
    said.into_iter().flatten().collect()
}

/// Whether a device with the causes holds what was found.
fn is_kept(device: &Device, found: &Finding) -> bool {
    if let Some(change) = found.change {
        return change.applied(device).is_some();
    }
    let has = |name: &str| found.numbers.iter().any(|own| own.0 == name);
    let is_whole = |spec: &haptical_effects::Spec| {
        spec.parameters.len() == found.numbers.len()
            && spec.parameters.iter().all(|own| has(own.name))
    };
    let mut specs = haptical_effects::specs().filter(|spec| spec.name == found.effect);
    specs.any(|spec| spec.hook.is_on_drives() && is_law(spec).is_ok() && is_whole(spec))
}

/// Why causes are not named that leave a share of the second recording's squares beyond noise.
pub(crate) fn leaves_of_second(causes: &str, left: f64) -> String {
    let percent = 100.0 * left;
    format!(
        "{causes} would fit the log, but {percent:.0} % of the squares of the second recording's gap stay: not named"
    )
}

/// What the second recording contradicts.
fn of_second(examined: &Examined) -> Vec<String> {
    let place = |effect: &str, joint: Option<usize>| match joint {
        Some(joint) => format!("{effect} at joint {}", joint + 1),
        None => effect.to_owned(),
    };
    let mut said: Vec<String> = (examined.refuted.iter())
        .map(|(effect, joint)| {
            format!(
                "{} explains a part of the log, but the second recording does not bear it out: not named",
                place(effect, *joint)
            )
        })
        .collect();
    if let Some(left) = examined
        .left_of_second
        .filter(|_| examined.is_contradicted())
    {
        let found: Vec<String> = (examined.findings.iter())
            .map(|own| place(own.effect, own.joint))
            .collect();
        said.push(leaves_of_second(&found.join(", "), left));
    }
    if examined.is_push_contradicted {
        said.push(
            "a push would explain the log, but the second recording has a gap that none explains: not named".to_owned(),
        );
    }
    let is_checked = examined.second.is_none()
        && examined
            .unseen
            .iter()
            .any(|own| !own.predictions.is_empty());
    if is_checked && examined.is_adequate() && examined.findings.iter().any(Finding::is_push) {
        said.push(
            "a push belongs to its log: the second recording is predicted without it, and may have one of its own".to_owned(),
        );
    }
    said
}

/// Armatures that no file states, in one sentence.
fn of_armatures(free: &[(usize, f64)]) -> Option<String> {
    let (joints, values) = by_joint(free, 4)?;
    Some(format!(
        "the device file has no armature of {joints}: fitted, and no cause: {values} kg m^2"
    ))
}

/// Friction that is no longer that of the file, in one sentence.
fn of_friction(other: &[(usize, f64)]) -> Option<String> {
    let (joints, times) = by_joint(other, 2)?;
    Some(format!(
        "the friction of {joints} is not that of the device file: fitted, and no cause: {times} times as large"
    ))
}

/// Joints and a number of each with so many digits, in words; none of none.
fn by_joint(numbers: &[(usize, f64)], digits: usize) -> Option<(String, String)> {
    let (joints, numbers): (Vec<usize>, Vec<f64>) = numbers.iter().copied().unzip();
    let numbers: Vec<String> = numbers
        .iter()
        .map(|value| format!("{value:.digits$}"))
        .collect();
    (!joints.is_empty()).then(|| (joints_of(&joints), numbers.join(", ")))
}

/// What is odd about torques: their columns, signs, units, and joints of which they say little.
fn of_torques(device: &Device, examined: &Examined) -> Vec<String> {
    let column = |joint: usize| device.joints[joint].torque_column(joint + 1);
    let mut said = Vec::new();
    for (joint, value) in &examined.constant {
        said.push(format!(
            "{} is {value} throughout: nothing was measured there, and nothing is said of joint {}",
            column(*joint),
            joint + 1
        ));
    }
    for (joint, speed) in examined.fastest.iter().enumerate() {
        let own = &device.joints[joint];
        if own.joint_type == JointType::Revolute
            && *speed > TOO_FAST_RAD_PER_S
            && examined.has_gap()
        {
            said.push(format!(
                "theta{number}_rad turns at {speed:.0} rad/s, which no arm does: is the column in degrees? Multiply it by pi/180",
                number = joint + 1
            ));
        }
    }
    said.extend(examined.doubts.iter().map(|doubt| of_doubt(device, doubt)));
    let in_doubt = |joint: usize| {
        examined.doubts.iter().any(|own| match own {
            Doubt::Sign { joint: own, .. }
            | Doubt::Silent { joint: own }
            | Doubt::Driven { joint: own } => *own == joint,
            Doubt::Unit { slopes } => slopes.iter().any(|own| own.0 == joint),
        })
    };
    for own in &examined.channels {
        let Some(scale) = own.scale else {
            continue;
        };
        let is_off = scale.is_known() && !SAME_UNIT.contains(&scale.slope.abs());
        // what a wrist asks for without its payload is little
        if is_off && !in_doubt(own.joint) && !examined.is_answer() {
            said.push(format!(
                "{} is {:.3} times what the links ask for: is it in N m at the joint, and not in N mm, at the motor, or a current?",
                column(own.joint),
                scale.slope
            ));
        }
    }
    let drowned: Vec<usize> = drowned(examined)
        .filter(|joint| !in_doubt(*joint))
        .collect();
    if !drowned.is_empty() {
        said.push(format!(
            "{}: the torque is no larger than its noise, and next to nothing is said of it",
            joints_of(&drowned)
        ));
    }
    if !examined.still.is_empty() {
        said.push(format!(
            "{}: still throughout, so that of the torque the load alone was looked at; nothing is said of friction, gain, armature, spring \
             or play there",
            joints_of(&examined.still)
        ));
    }
    said
}

/// Why torques may have no name.
pub(super) fn of_doubt(device: &Device, doubt: &Doubt) -> String {
    let column = |joint: usize| device.joints[joint].torque_column(joint + 1);
    match doubt {
        Doubt::Sign { joint, slope } => format!(
            "{} moves against the torque that the links ask for (slope {slope:.2}), and no cause is named: is its sign, or that of joint \
             {}, the other way? A torque is positive where it moves the joint positively",
            column(*joint),
            joint + 1
        ),
        Doubt::Unit { slopes } => {
            let slopes: Vec<String> = (slopes.iter())
                .map(|(joint, slope)| format!("{} {slope:.3}", column(*joint)))
                .collect();
            format!(
                "the torques are not what the links ask for but multiples of it, and no cause is named: {} times. Are they in N mm, at the \
                 motors, or currents? A log has N m (of slides N) at the joints: multiply by gear ratios and torque constants",
                slopes.join(", ")
            )
        }
        Doubt::Driven { joint } => format!(
            "the friction in {} drives the motion, as no friction does, and no cause is named: is its sign, or that of joint {}, the \
             other way? A torque is positive where it moves the joint positively",
            column(*joint),
            joint + 1
        ),
        Doubt::Silent { joint } => format!(
            "{} does not follow the motion: it is no larger than its own scatter, though the links ask for more; no cause is named. Is it \
             the torque of this log and joint?",
            column(*joint)
        ),
    }
}

/// Joints whose torque is no larger than its noise.
fn drowned(examined: &Examined) -> impl Iterator<Item = usize> + '_ {
    let channels = examined.channels.iter();
    channels.filter_map(|own| own.scale.filter(Scale::is_noise).map(|_| own.joint))
}

/// Joints of whose torque nothing, or next to nothing, is said.
pub(super) fn silent(examined: &Examined) -> impl Iterator<Item = usize> + '_ {
    let constant = examined.constant.iter().map(|own| own.0);
    constant.chain(drowned(examined))
}

fn joints_of(joints: &[usize]) -> String {
    let numbers: Vec<String> = joints.iter().map(|own| (own + 1).to_string()).collect();
    let s = if joints.len() == 1 { "" } else { "s" };
    format!("joint{s} {}", numbers.join(", "))
}
