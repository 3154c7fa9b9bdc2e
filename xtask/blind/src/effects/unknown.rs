//! Effects that no catalogue lists: dents, products, walks, vibrations, loosening, steps over the angle.

use std::f64::consts::TAU;

use crate::effects::{Draw, Effect, Facts, Info, Stage, UNKNOWN, fixed, theta};
use crate::laws::{ramp, rms};
use crate::rig::scene::Scene;

/// What the size of a strange effect is of.
#[derive(Debug, Clone, Copy)]
enum Size {
    /// Its height.
    Peak(f64),
    Rms(f64),
}

/// A strange effect upstream of the joint's external encoder, or on the cable where it has no joint.
fn strange(
    info: Info,
    size: Size,
    law: &[(&'static str, f64)],
    shape: impl Fn(&Scene<'_>, &[f64]) -> Vec<f64> + Send + Sync + 'static,
) -> Effect {
    let scaled = move |scene: &Scene<'_>, signal: &[f64]| {
        let mut values = shape(scene, signal);
        let scale = match size {
            Size::Peak(size) => size,
            Size::Rms(size) => size / rms(&values).max(f64::MIN_POSITIVE),
        };
        values.iter_mut().for_each(|value| *value *= scale);
        values
    };
    let stage = match info.joint {
        Some(_) => Stage::Upstream,
        None => Stage::Cable,
    };
    let (Size::Peak(number) | Size::Rms(number)) = size;
    let facts = Facts::default().laws(law.iter().copied());
    let facts = facts.law("size", number);
    Effect::added(info, stage, fixed(facts), scaled)
}

/// The same, row by row.
fn by_rows(
    info: Info,
    size: Size,
    law: &[(&'static str, f64)],
    shape: impl Fn(&Scene<'_>, usize) -> f64 + Send + Sync + 'static,
) -> Effect {
    strange(info, size, law, move |scene, signal| {
        (0..signal.len()).map(|row| shape(scene, row)).collect()
    })
}

impl Draw<'_> {
    /// Info of a strange effect at the joint, by the stems of the columns that it depends on.
    fn strange(&self, name: &'static str, depends_on: &[String]) -> Info {
        Info {
            depends_on: depends_on.to_vec(),
            ..self.at_joint(name, &UNKNOWN)
        }
    }

    /// The same, with a name of the catalogue that describes a part of it.
    fn with_part(&self, name: &'static str, part: &'static str, depends_on: &[String]) -> Info {
        Info {
            acceptable: vec![part],
            ..self.strange(name, depends_on)
        }
    }

    /// The same on the measuring cable.
    fn on_cable(&self, name: &'static str, column: &str) -> Info {
        Info {
            depends_on: vec![column.to_owned()],
            ..self.anywhere(name, &UNKNOWN)
        }
    }

    /// A place within the inner part of the joint's range.
    fn inner_angle_rad(&mut self) -> f64 {
        let joint = &self.device.joints[self.joint];
        let part = self.random.uniform(-0.5, 0.5);
        let side = if part < 0.0 {
            -joint.lower_rad
        } else {
            joint.upper_rad
        };
        part * if side.is_finite() { side } else { 1.0 }
    }
}

fn torque(joint: usize) -> String {
    format!("torque{}", joint + 1)
}

fn time() -> [String; 1] {
    ["t_s".to_owned()]
}

/// A bump at one place of the signal.
fn bump(info: Info, centre: f64, width: f64, size: f64) -> Effect {
    let law = [("centre", centre), ("width", width)];
    strange(info, Size::Peak(size), &law, move |_, signal| {
        let away = signal.iter().map(|value| (value - centre) / width);
        away.map(|x| libm::exp(-0.5 * x * x)).collect()
    })
}

/// A vibration whose frequency rises.
fn chirping(info: Info, start_hz: f64, end_hz: f64, size: f64) -> Effect {
    let law = [("start_hz", start_hz), ("end_hz", end_hz)];
    by_rows(info, Size::Peak(size), &law, move |scene, row| {
        let (time_s, end_s) = (scene.elapsed_s(row), scene.elapsed_s(scene.len()));
        let sweep = 0.5 * (end_hz - start_hz) * time_s / end_s;
        libm::sin(TAU * (start_hz + sweep) * time_s)
    })
}

/// A random walk that reaches its size at the end of a minute.
fn walk(info: Info, tag: u64, size: f64) -> Effect {
    strange(info, Size::Peak(size), &[], move |scene, signal| {
        let mut random = scene.events(tag);
        let step = libm::sqrt(scene.step_s / 60.0);
        let mut sum = 0.0;
        let next = |_: &f64| {
            sum += step * random.normal();
            sum
        };
        signal.iter().map(next).collect()
    })
}

pub(crate) fn drum_dent(draw: &mut Draw<'_>) -> Effect {
    let centre = draw.inner_angle_rad();
    let width = draw.random.uniform(0.04, 0.12);
    let info = draw.strange("drum-dent", &[theta(draw.joint)]);
    bump(info, centre, width, draw.signed(2.5e-3))
}

pub(crate) fn angle_product(draw: &mut Draw<'_>) -> Effect {
    let (first, second) = (draw.other_joint(), draw.other_joint());
    let info = draw.strange("angle-product", &[theta(first), theta(second)]);
    let size = Size::Rms(draw.signed(0.8e-3));
    by_rows(info, size, &[], move |scene, row| {
        let angle = &scene.motion.angle_rad;
        angle[first][row] * angle[second][row]
    })
}

/// The joint's zero walks.
pub(crate) fn random_walk(draw: &mut Draw<'_>) -> Effect {
    let info = draw.with_part("random-walk", "joint-drift", &time());
    walk(info, draw.tag, draw.signed(2e-3))
}

pub(crate) fn warm_ratio(draw: &mut Draw<'_>) -> Effect {
    let joint = draw.joint;
    let info = draw.strange("warm-ratio", &["temp".to_owned(), theta(joint)]);
    let size = Size::Rms(draw.signed(0.8e-3));
    by_rows(info, size, &[], move |scene, row| {
        (scene.temperature_degc[row] - scene.cold_degc) * scene.motion.angle_rad[joint][row]
    })
}

pub(crate) fn chirp(draw: &mut Draw<'_>) -> Effect {
    let start_hz = draw.random.uniform(0.3, 3.0);
    let end_hz = start_hz + draw.random.uniform(4.0, 12.0);
    let info = draw.strange("chirp-vibration", &time());
    chirping(info, start_hz, end_hz, draw.signed(1e-3))
}

/// The drive's cable loosens: it gives from a time on.
pub(crate) fn loosening(draw: &mut Draw<'_>) -> Effect {
    let (joint, tag) = (draw.joint, draw.tag);
    let columns = [torque(joint), "t_s".to_owned()];
    let info = draw.with_part("loosening", "capstan-compliance", &columns);
    let size = Size::Rms(draw.amplitude(1.2e-3));
    strange(info, size, &[], move |scene, signal| {
        let end_s = scene.elapsed_s(scene.len());
        let start_s = end_s * scene.events(tag).uniform(0.3, 0.65);
        let at =
            |row: usize| ramp(scene.elapsed_s(row), start_s, 0.2) * scene.torque_nm[joint][row];
        (0..signal.len()).map(at).collect()
    })
}

/// Worn grooves: steps over the angle.
pub(crate) fn grooves(draw: &mut Draw<'_>) -> Effect {
    let period = draw.random.uniform(0.25, 0.6);
    let sharpness = draw.random.uniform(3.0, 20.0);
    let (phase_rad, size) = (draw.random.phase_rad(), Size::Peak(draw.signed(0.6e-3)));
    let info = draw.strange("worn-grooves", &[theta(draw.joint)]);
    let law = [("period", period), ("sharpness", sharpness)];
    strange(info, size, &law, move |_, signal| {
        let waves = signal.iter();
        let waves = waves.map(|value| libm::sin(TAU * value / period + phase_rad));
        waves.map(|wave| libm::tanh(sharpness * wave)).collect()
    })
}

/// The cable lifts off at speed, with its square.
pub(crate) fn lift(draw: &mut Draw<'_>) -> Effect {
    let joint = draw.joint;
    let info = draw.strange("speed-lift", &[theta(joint)]);
    let size = Size::Rms(draw.signed(0.8e-3));
    by_rows(info, size, &[], move |scene, row| {
        let rate = scene.motion.rate_rad_s[joint][row];
        rate * rate
    })
}

/// The load of the drive times the joint's angle.
pub(crate) fn loaded_angle(draw: &mut Draw<'_>) -> Effect {
    let joint = draw.joint;
    let columns = [torque(joint), theta(joint)];
    let info = draw.with_part("loaded-angle", "capstan-compliance", &columns);
    let size = Size::Rms(draw.signed(0.8e-3));
    by_rows(info, size, &[], move |scene, row| {
        scene.torque_nm[joint][row] * scene.motion.angle_rad[joint][row]
    })
}

/// A part that only carries the hand's force in one half of the range, along one axis.
pub(crate) fn half_range_force(draw: &mut Draw<'_>) -> Effect {
    let (axis, joint) = (draw.random.index(3), draw.joint);
    let centre = draw.inner_angle_rad();
    let columns = [["fx", "fy", "fz"][axis].to_owned(), theta(joint)];
    let info = draw.with_part("half-range-force", "capstan-compliance", &columns);
    let size = Size::Rms(draw.signed(0.8e-3));
    by_rows(info, size, &[], move |scene, row| {
        let away = (scene.motion.angle_rad[joint][row] - centre) / 0.05;
        scene.force_n[row][axis] * (0.5 + 0.5 * libm::tanh(away))
    })
}

/// A blow that rings after a time.
pub(crate) fn ringing(draw: &mut Draw<'_>) -> Effect {
    let rate_hz = draw.random.uniform(0.8, 6.0);
    let decay_s = draw.random.uniform(1.5, 6.0);
    let tag = draw.tag;
    let info = draw.strange("ringing", &time());
    let size = Size::Peak(draw.signed(3e-3));
    strange(info, size, &[], move |scene, signal| {
        let end_s = scene.elapsed_s(scene.len());
        let start_s = end_s * scene.events(tag).uniform(0.2, 0.7);
        let at = |row: usize| {
            let since_s = scene.elapsed_s(row) - start_s;
            if since_s < 0.0 {
                return 0.0;
            }
            libm::exp(-since_s / decay_s) * libm::sin(TAU * rate_hz * since_s)
        };
        (0..signal.len()).map(at).collect()
    })
}

/// Error of a joint that follows another joint's sense of motion.
pub(crate) fn foreign_sense(draw: &mut Draw<'_>) -> Effect {
    let joint = draw.other_joint();
    let info = draw.strange("foreign-sense", &[theta(joint)]);
    let size = Size::Peak(draw.signed(0.8e-3));
    by_rows(info, size, &[], move |scene, row| {
        libm::tanh(scene.motion.rate_rad_s[joint][row] / 0.05)
    })
}

pub(crate) fn cable_knot(draw: &mut Draw<'_>) -> Effect {
    let centre = draw.random.uniform(0.2, 0.4);
    let width = draw.random.uniform(0.008, 0.03);
    let info = draw.on_cable("cable-knot", "cable");
    bump(info, centre, width, draw.signed(250e-6))
}

/// The measuring cable sings.
pub(crate) fn cable_chirp(draw: &mut Draw<'_>) -> Effect {
    let start_hz = draw.random.uniform(0.3, 3.0);
    let end_hz = start_hz + draw.random.uniform(4.0, 12.0);
    let info = draw.on_cable("cable-chirp", "t_s");
    chirping(info, start_hz, end_hz, draw.signed(120e-6))
}

pub(crate) fn cable_walk(draw: &mut Draw<'_>) -> Effect {
    let info = Info {
        acceptable: vec!["cable-drift"],
        ..draw.on_cable("cable-walk", "t_s")
    };
    walk(info, draw.tag, draw.signed(300e-6))
}
