//! Compliance: pre-tensioned cable strands, links behind the encoder, creep, slip at peaks.

use haptical_model::TransmissionKind;

use crate::effects::{Draw, Effect, Facts, Stage};
use crate::laws::{ramp, slope_beside, slope_of};
use crate::rig::scene::Scene;
use crate::truth::Event;

/// Names that data cannot tell apart where no external encoder sits between them.
const EITHER_COMPLIANCE: [&str; 2] = ["capstan-compliance", "joint-compliance"];
/// Order of the polynomial in place of a parallelogram's error.
const POLYNOMIAL_ORDER: i32 = 10;

/// Shapes over the joint's angle that its transmission's errors take up (eqs. (1) and (2)): weight hangs on the
/// angle, and a spring that is not linear has another slope in what is left.
fn taken_up(scene: &Scene<'_>, joint: usize) -> Vec<Vec<f64>> {
    let angle = &scene.motion.angle_rad[joint];
    let shape = |of: &dyn Fn(f64) -> f64| angle.iter().map(|angle| of(*angle)).collect();
    let description = &scene.device.joints[joint];
    if description.output_sd_rad().is_none() {
        return Vec::new();
    }
    match description.transmission {
        TransmissionKind::Direct => Vec::new(),
        TransmissionKind::Capstan => vec![shape(&|a| a), shape(&libm::sin), shape(&libm::cos)],
        TransmissionKind::Parallelogram => (1..=POLYNOMIAL_ORDER)
            .map(|order| shape(&|a| libm::pow(a, f64::from(order))))
            .collect(),
    }
}

/// Two pre-tensioned strands: stiff together, half as stiff once one is slack, each a little harder
/// the further it is drawn (a stranded rope settles).
fn strands(
    draw: &mut Draw<'_>,
    name: &'static str,
    stage: Stage,
    (stiffness_nm_per_rad, sign): (f64, f64),
) -> Effect {
    let stiffness = draw.random.around(stiffness_nm_per_rad, 3.0);
    let compliance_rad_per_nm = draw.size / stiffness;
    // load at which one strand is slack, and at which settling has made the strands stiffer by half
    let slack_nm = draw.random.uniform(1.0, 2.5);
    let settling_nm = draw.random.uniform(6.0, 15.0);
    let joint = draw.joint;
    let deflection_rad = move |torque_nm: &f64| {
        let load = torque_nm.abs();
        let taut = load / (1.0 + load / (2.0 * settling_nm));
        let beyond = (load - slack_nm).max(0.0);
        sign * compliance_rad_per_nm * torque_nm.signum() * (taut + beyond)
    };
    let law = move |scene: &Scene<'_>, _: &[f64]| -> Vec<f64> {
        scene.torque_nm[joint].iter().map(deflection_rad).collect()
    };
    let facts = move |scene: &Scene<'_>| {
        let facts = Facts::default()
            .law("initial_compliance_rad_per_nm", compliance_rad_per_nm)
            .laws(named!(slack_nm, settling_nm));
        let taken_up = match stage {
            Stage::Upstream => taken_up(scene, joint),
            _ => Vec::new(),
        };
        let compliance = slope_beside(&scene.torque_nm[joint], &law(scene, &[]), &taken_up).abs();
        if compliance > 0.0 {
            facts.with("stiffness_nm_per_rad", 1.0 / compliance)
        } else {
            facts
        }
    };
    let info = match draw.has_external() {
        true => draw.at_joint(name, &[name]),
        false => draw.at_joint(name, &EITHER_COMPLIANCE),
    };
    Effect::added(info, stage, facts, law)
}

/// Stretch of the capstan's cable: the motor leads by the deflection.
pub(crate) fn capstan_compliance(draw: &mut Draw<'_>) -> Effect {
    strands(draw, "capstan-compliance", Stage::Upstream, (260.0, 1.0))
}

/// A link that gives behind the external encoder: it stays behind by the deflection.
pub(crate) fn joint_compliance(draw: &mut Draw<'_>) -> Effect {
    strands(draw, "joint-compliance", Stage::Link, (420.0, -1.0))
}

/// Creep of the cable on its drum, by micro-slip of the wraps: a little more with every travel under load.
pub(crate) fn capstan_creep(draw: &mut Draw<'_>) -> Effect {
    let per_nm = draw.amplitude(2e-4);
    let exponent = draw.random.uniform(0.95, 1.1);
    let joint = draw.joint;
    let creep = move |scene: &Scene<'_>, per_nm: f64, exponent: f64| -> Vec<f64> {
        let signal = &scene.motion.angle_rad[joint];
        let mut sum = 0.0;
        let mut before = signal.first().copied().unwrap_or(0.0);
        let rows = signal.iter().zip(&scene.torque_nm[joint]);
        rows.map(|(&now, &torque)| {
            let size = libm::pow(torque.abs(), exponent);
            sum += per_nm * torque.signum() * size * (now - before).abs();
            before = now;
            sum
        })
        .collect()
    };
    let facts = move |scene: &Scene<'_>| {
        let effective = slope_of(&creep(scene, 1.0, 1.0), &creep(scene, per_nm, exponent));
        Facts::default()
            .law("creep_per_nm", per_nm)
            .law("exponent", exponent)
            .with("creep_per_nm", effective)
    };
    let law = move |scene: &Scene<'_>, _: &[f64]| creep(scene, per_nm, exponent);
    let info = draw.at_joint("capstan-creep", &["capstan-creep"]);
    Effect::added(info, Stage::Upstream, facts, law)
}

/// Times and signs of the highest torque peaks of a joint, at least 5 s apart, not in the outer tenths.
fn peaks(scene: &Scene<'_>, joint: usize, count: usize) -> Vec<(f64, f64)> {
    let torque = &scene.torque_nm[joint];
    let rows = torque.len();
    let mean = torque.iter().sum::<f64>() / rows.max(1) as f64;
    let mut order: Vec<usize> = (rows / 10..rows - rows / 10).collect();
    order.sort_by(|a, b| {
        let away = |row: usize| (torque[row] - 0.5 * mean).abs();
        away(*b).total_cmp(&away(*a))
    });
    let mut times: Vec<(f64, f64)> = Vec::new();
    for row in order {
        let time_s = scene.elapsed_s(row);
        if times.len() < count && times.iter().all(|(t, _)| (t - time_s).abs() > 5.0) {
            times.push((time_s, torque[row].signum()));
        }
    }
    times.sort_by(|a, b| a.0.total_cmp(&b.0));
    times
}

/// Gross slip of the cable on its drum at the largest torques: fast, but not instantaneous. Without its ramp it is a loss of
/// counts.
pub(crate) fn capstan_slip(draw: &mut Draw<'_>) -> Effect {
    let slip_rad = draw.amplitude(2e-3);
    let count = 1 + draw.random.index(3);
    let rise_s = draw.random.uniform(0.03, 0.08);
    let joint = draw.joint;
    let law = move |scene: &Scene<'_>, signal: &[f64]| -> Vec<f64> {
        let times = peaks(scene, joint, count);
        let slipped = |row: usize| {
            let time_s = scene.elapsed_s(row);
            let parts = times.iter();
            let parts = parts.map(|(at, sign)| sign * ramp(time_s, *at, rise_s));
            slip_rad * parts.sum::<f64>()
        };
        (0..signal.len()).map(slipped).collect()
    };
    let facts = move |scene: &Scene<'_>| {
        let times = peaks(scene, joint, count).into_iter();
        let events = times.map(|(time_s, sign)| Event {
            time_s,
            size: sign * slip_rad,
        });
        Facts::default()
            .law("rise_s", rise_s)
            .happening("slip_rad", events.collect())
    };
    let info = draw.at_joint("capstan-slip", &["capstan-slip", "encoder-count-loss"]);
    Effect::added(info, Stage::Upstream, facts, law)
}
