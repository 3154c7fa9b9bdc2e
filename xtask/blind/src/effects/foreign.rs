//! Torques and forces that no catalogue lists: tones, bumps, walks, steps, products, switching offsets.

use std::f64::consts::TAU;

use crate::effects::forces::GRIP;
use crate::effects::{Draw, Effect, Facts, Info, Stage, UNKNOWN, theta};
use crate::laws::rms;
use crate::rig::scene::Scene;

/// Strong sizes: a joint's friction is 0.06 N m, a sensor's bias 0.3 N.
const STRONG_NM: f64 = 0.15;
const STRONG_N: f64 = 0.6;

/// Scaled to a root mean square of 1.
fn unit(mut values: Vec<f64>) -> Vec<f64> {
    let scale = 1.0 / rms(&values).max(f64::MIN_POSITIVE);
    values.iter_mut().for_each(|value| *value *= scale);
    values
}

/// A course that is read on one column, at the size that is its height, of walks and products its root mean square.
fn read(
    info: Info,
    (stage, column): (Stage, usize),
    law: &[(&'static str, f64)],
    size: f64,
    course: impl Fn(&Scene<'_>) -> Vec<f64> + Send + Sync + 'static,
) -> Effect {
    let act = move |scene: &Scene<'_>, columns: &mut [Vec<f64>]| {
        for (reading, value) in columns[column].iter_mut().zip(course(scene)) {
            *reading += size * value;
        }
    };
    Effect::of_columns(
        info,
        stage,
        Facts::default().laws(law.iter().copied()).law("size", size),
        act,
    )
}

fn of_torque(
    draw: &mut Draw<'_>,
    name: &'static str,
    depends_on: Vec<String>,
    law: &[(&'static str, f64)],
    course: impl Fn(&Scene<'_>) -> Vec<f64> + Send + Sync + 'static,
) -> Effect {
    let info = Info {
        depends_on,
        ..draw.at_joint(name, &UNKNOWN)
    };
    let size = draw.signed(STRONG_NM);
    read(info, (Stage::Torque, draw.joint), law, size, course)
}

/// What depends on time alone.
fn on_time() -> Vec<String> {
    vec!["t_s".to_owned()]
}

/// A tone on a torque, of a rate that the device does not have.
pub(crate) fn torque_tone(draw: &mut Draw<'_>) -> Effect {
    let rate_hz = draw.random.uniform(0.3, 2.0);
    let phase_rad = draw.random.phase_rad();
    let law = [("rate_hz", rate_hz)];
    of_torque(draw, "torque-tone", on_time(), &law, move |scene| {
        let wave = |row: usize| libm::sin(TAU * rate_hz * scene.elapsed_s(row) + phase_rad);
        (0..scene.len()).map(wave).collect()
    })
}

/// A bump of a torque at one place of the joint's range.
pub(crate) fn torque_bump(draw: &mut Draw<'_>) -> Effect {
    let joint = draw.joint;
    let centre = draw.random.uniform(0.3, 0.7);
    let width_rad = draw.random.uniform(0.05, 0.15);
    let (angles, law) = (vec![theta(joint)], [("width_rad", width_rad)]);
    of_torque(draw, "torque-bump", angles, &law, move |scene| {
        let angle = &scene.motion.angle_rad[joint];
        let low = angle.iter().copied().fold(f64::INFINITY, f64::min);
        let high = angle.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let middle = low + centre * (high - low);
        let away = angle.iter().map(|angle| (angle - middle) / width_rad);
        away.map(|x| libm::exp(-0.5 * x * x)).collect()
    })
}

pub(crate) fn torque_walk(draw: &mut Draw<'_>) -> Effect {
    let tag = draw.tag;
    of_torque(draw, "torque-walk", on_time(), &[], move |scene| {
        let mut random = scene.events(tag);
        let mut sum = 0.0;
        let step = |_| {
            sum += random.normal();
            sum
        };
        unit((0..scene.len()).map(step).collect())
    })
}

pub(crate) fn torque_step(draw: &mut Draw<'_>) -> Effect {
    let tag = draw.tag;
    of_torque(draw, "torque-step", on_time(), &[], move |scene| {
        let end_s = scene.elapsed_s(scene.len());
        let start_s = end_s * scene.events(tag).uniform(0.3, 0.7);
        let is_on = |row: usize| f64::from(u8::from(scene.elapsed_s(row) >= start_s));
        (0..scene.len()).map(is_on).collect()
    })
}

pub(crate) fn torque_product(draw: &mut Draw<'_>) -> Effect {
    let (first, second) = (draw.joint, (draw.joint + 1) % draw.device.joints.len());
    let both = vec![theta(first), theta(second)];
    of_torque(draw, "torque-product", both, &[], move |scene| {
        let angles = &scene.motion.angle_rad;
        let pairs = angles[first].iter().zip(&angles[second]);
        unit(pairs.map(|(a, b)| a * b).collect())
    })
}

/// An offset of the force sensor that comes and goes.
pub(crate) fn force_switching(draw: &mut Draw<'_>) -> Effect {
    let tag = draw.tag;
    let info = Info {
        depends_on: on_time(),
        // the same equation: a force that does not pass the sensor
        acceptable: vec![GRIP],
        ..draw.anywhere("force-switching", &UNKNOWN)
    };
    let axis = draw.random.index(3);
    let size = draw.signed(STRONG_N);
    read(info, (Stage::Force, axis), &[], size, move |scene| {
        let mut random = scene.events(tag);
        let (rate_hz, phase_rad) = (random.uniform(0.05, 0.15), random.phase_rad());
        let wave = |row: usize| libm::sin(TAU * rate_hz * scene.elapsed_s(row) + phase_rad);
        let on = |row: usize| f64::from(u8::from(wave(row) > 0.4));
        (0..scene.len()).map(on).collect()
    })
}
