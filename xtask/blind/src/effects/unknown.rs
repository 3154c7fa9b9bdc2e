//! Effects that no catalogue lists: dents, products, walks, vibrations, loosening, steps over the angle.

use std::f64::consts::TAU;

use crate::effects::added::{Added, Law, Place};
use crate::effects::{Draw, Effect, Facts, Info};
use crate::laws::{ramp, rms};
use crate::rig::scene::Scene;

/// Shape of a strange effect; its numbers set its size.
#[derive(Debug, Clone, Copy)]
enum Shape {
    /// A bump at one place of the signal.
    Dent { centre: f64, width: f64 },
    /// Product of the angles of two joints.
    Product { first: usize, second: usize },
    /// A random walk that reaches its size at the end of a minute.
    Walk { tag: u64 },
    /// Warming, in proportion to an angle.
    WarmAngle { joint: usize },
    /// A vibration whose frequency rises.
    Chirp { start_hz: f64, end_hz: f64 },
    /// A drive that gives from a time on.
    Loosening { joint: usize, tag: u64 },
    /// Steps over the signal: worn grooves.
    Square {
        period: f64,
        phase_rad: f64,
        sharpness: f64,
    },
    /// Rise with the square of the speed of a joint.
    Lift { joint: usize },
    /// The load of the drive times the joint's angle.
    LoadedAngle { joint: usize },
    /// Force of the hand along one axis, in a part of the range only.
    HalfRangeForce {
        axis: usize,
        joint: usize,
        centre: f64,
    },
    /// A transient that rings after a time.
    Ringing {
        tag: u64,
        rate_hz: f64,
        decay_s: f64,
    },
    /// Error of a joint that follows another joint's sense of motion.
    ForeignSense { joint: usize },
}

/// A strange effect at a place, scaled to a root mean square or a peak.
#[derive(Debug)]
struct Strange {
    shape: Shape,
    size: f64,
}

impl Strange {
    fn unscaled(&self, scene: &Scene<'_>, signal: &[f64]) -> Vec<f64> {
        let angle = |joint: usize| &scene.motion.angle_rad[joint];
        let rate = |joint: usize| &scene.motion.rate_rad_s[joint];
        let end_s = scene.elapsed_s(scene.len());
        let of_rows = |law: &dyn Fn(usize) -> f64| (0..signal.len()).map(law).collect();
        match self.shape {
            Shape::Dent { centre, width } => of_rows(&|row| {
                let x = (signal[row] - centre) / width;
                libm::exp(-0.5 * x * x)
            }),
            Shape::Product { first, second } => {
                of_rows(&|row| angle(first)[row] * angle(second)[row])
            }
            Shape::Walk { tag } => {
                let mut random = scene.events(tag);
                let step = libm::sqrt(scene.step_s / 60.0);
                let mut sum = 0.0;
                signal
                    .iter()
                    .map(|_| {
                        sum += step * random.normal();
                        sum
                    })
                    .collect()
            }
            Shape::WarmAngle { joint } => {
                of_rows(&|row| (scene.temperature_degc[row] - scene.cold_degc) * angle(joint)[row])
            }
            Shape::Chirp { start_hz, end_hz } => of_rows(&|row| {
                let time_s = scene.elapsed_s(row);
                let sweep = 0.5 * (end_hz - start_hz) * time_s / end_s;
                libm::sin(TAU * (start_hz + sweep) * time_s)
            }),
            Shape::Loosening { joint, tag } => {
                let start_s = end_s * scene.events(tag).uniform(0.3, 0.65);
                of_rows(&|row| {
                    ramp(scene.elapsed_s(row), start_s, 0.2) * scene.torque_nm[joint][row]
                })
            }
            Shape::Square {
                period,
                phase_rad,
                sharpness,
            } => of_rows(&|row| {
                let wave = libm::sin(TAU * signal[row] / period + phase_rad);
                libm::tanh(sharpness * wave)
            }),
            Shape::Lift { joint } => of_rows(&|row| rate(joint)[row] * rate(joint)[row]),
            Shape::LoadedAngle { joint } => {
                of_rows(&|row| scene.torque_nm[joint][row] * angle(joint)[row])
            }
            Shape::HalfRangeForce {
                axis,
                joint,
                centre,
            } => of_rows(&|row| {
                let share = 0.5 + 0.5 * libm::tanh((angle(joint)[row] - centre) / 0.05);
                scene.force_n[row][axis] * share
            }),
            Shape::Ringing {
                tag,
                rate_hz,
                decay_s,
            } => {
                let start_s = end_s * scene.events(tag).uniform(0.2, 0.7);
                of_rows(&|row| {
                    let since_s = scene.elapsed_s(row) - start_s;
                    if since_s < 0.0 {
                        return 0.0;
                    }
                    libm::exp(-since_s / decay_s) * libm::sin(TAU * rate_hz * since_s)
                })
            }
            Shape::ForeignSense { joint } => of_rows(&|row| libm::tanh(rate(joint)[row] / 0.05)),
        }
    }

    /// Stems of the columns that it depends on, at a place.
    fn depends_on(&self, place: Place) -> Vec<String> {
        let theta = |joint: usize| format!("theta{}", joint + 1);
        let torque = |joint: usize| format!("torque{}", joint + 1);
        let here = place.joint().map_or_else(|| "cable".to_owned(), theta);
        match self.shape {
            Shape::Dent { .. } | Shape::Square { .. } => vec![here],
            Shape::Product { first, second } => vec![theta(first), theta(second)],
            Shape::Walk { .. } | Shape::Chirp { .. } | Shape::Ringing { .. } => {
                vec!["t_s".to_owned()]
            }
            Shape::WarmAngle { joint } => vec!["temp".to_owned(), theta(joint)],
            Shape::Loosening { joint, .. } => vec![torque(joint), "t_s".to_owned()],
            Shape::Lift { joint } | Shape::ForeignSense { joint } => vec![theta(joint)],
            Shape::LoadedAngle { joint } => vec![torque(joint), theta(joint)],
            Shape::HalfRangeForce { axis, joint, .. } => {
                vec![["fx", "fy", "fz"][axis].to_owned(), theta(joint)]
            }
        }
    }

    /// Dents, waves and rings have the size as their height, the others as their root mean square.
    fn is_peak(&self) -> bool {
        matches!(
            self.shape,
            Shape::Dent { .. }
                | Shape::Chirp { .. }
                | Shape::Square { .. }
                | Shape::Ringing { .. }
                | Shape::Walk { .. }
                | Shape::ForeignSense { .. }
        )
    }
}

impl Law for Strange {
    fn deviation(&self, scene: &Scene<'_>, _place: Place, signal: &[f64]) -> Vec<f64> {
        let mut values = self.unscaled(scene, signal);
        let scale = if self.is_peak() {
            self.size
        } else {
            self.size / rms(&values).max(f64::MIN_POSITIVE)
        };
        values.iter_mut().for_each(|value| *value *= scale);
        values
    }

    fn facts(&self, _scene: &Scene<'_>, _place: Place) -> Facts {
        let facts = Facts::default().law("size", self.size);
        match self.shape {
            Shape::Dent { centre, width } => facts.law("centre", centre).law("width", width),
            Shape::Square {
                period, sharpness, ..
            } => facts.law("period", period).law("sharpness", sharpness),
            Shape::Chirp { start_hz, end_hz } => {
                facts.law("start_hz", start_hz).law("end_hz", end_hz)
            }
            _ => facts,
        }
    }
}

const UNKNOWN: [&str; 1] = ["unknown"];

/// Upstream of the joint's external encoder.
fn at_joint(draw: &Draw<'_>, name: &'static str, shape: Shape, size: f64) -> Box<dyn Effect> {
    placed(
        draw.at_joint(name, &UNKNOWN),
        Place::Upstream(draw.joint),
        shape,
        size,
    )
}

/// The same, with a name of the catalogue that describes a part of it.
fn with_part(
    draw: &Draw<'_>,
    name: &'static str,
    part: &'static str,
    shape: Shape,
    size: f64,
) -> Box<dyn Effect> {
    let info = Info {
        acceptable: vec![part],
        ..draw.at_joint(name, &UNKNOWN)
    };
    placed(info, Place::Upstream(draw.joint), shape, size)
}

fn at_cable(draw: &Draw<'_>, name: &'static str, shape: Shape, size: f64) -> Box<dyn Effect> {
    placed(draw.anywhere(name, &UNKNOWN), Place::Cable, shape, size)
}

fn placed(info: Info, place: Place, shape: Shape, size: f64) -> Box<dyn Effect> {
    let strange = Strange { shape, size };
    let depends_on = strange.depends_on(place);
    Added::boxed(Info { depends_on, ..info }, place, strange)
}

/// Another joint than the one at hand.
fn other_joint(draw: &mut Draw<'_>) -> usize {
    let joints = 0..draw.device.joints.len();
    let others: Vec<usize> = joints.filter(|joint| *joint != draw.joint).collect();
    draw.random.choose(&others).unwrap_or(0)
}

/// A place within the inner part of the joint's range.
fn inner_angle_rad(draw: &mut Draw<'_>) -> f64 {
    let joint = &draw.device.joints[draw.joint];
    let part = draw.random.uniform(-0.5, 0.5);
    let side = if part < 0.0 {
        -joint.lower_rad
    } else {
        joint.upper_rad
    };
    part * if side.is_finite() { side } else { 1.0 }
}

/// A dent in the drum.
pub(crate) fn drum_dent(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let centre = inner_angle_rad(draw);
    let width = draw.random.uniform(0.04, 0.12);
    let size = draw.signed(2.5e-3);
    at_joint(draw, "drum-dent", Shape::Dent { centre, width }, size)
}

/// The product of two other joints' angles.
pub(crate) fn angle_product(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let (first, second) = (other_joint(draw), other_joint(draw));
    let size = draw.signed(0.8e-3);
    at_joint(
        draw,
        "angle-product",
        Shape::Product { first, second },
        size,
    )
}

/// The joint's zero walks.
pub(crate) fn random_walk(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let (tag, size) = (draw.tag, draw.signed(2e-3));
    with_part(
        draw,
        "random-walk",
        "joint-drift",
        Shape::Walk { tag },
        size,
    )
}

/// The ratio changes as the device warms.
pub(crate) fn warm_ratio(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let (joint, size) = (draw.joint, draw.signed(0.8e-3));
    at_joint(draw, "warm-ratio", Shape::WarmAngle { joint }, size)
}

/// A vibration with a rising frequency.
pub(crate) fn chirp(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let start_hz = draw.random.uniform(0.3, 3.0);
    let end_hz = start_hz + draw.random.uniform(4.0, 12.0);
    let size = draw.signed(1e-3);
    at_joint(
        draw,
        "chirp-vibration",
        Shape::Chirp { start_hz, end_hz },
        size,
    )
}

/// The drive's cable loosens at a time.
pub(crate) fn loosening(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let (joint, tag) = (draw.joint, draw.tag);
    let size = draw.amplitude(1.2e-3);
    let shape = Shape::Loosening { joint, tag };
    with_part(draw, "loosening", "capstan-compliance", shape, size)
}

/// Worn grooves.
pub(crate) fn grooves(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let period = draw.random.uniform(0.25, 0.6);
    let sharpness = draw.random.uniform(3.0, 20.0);
    let (phase_rad, size) = (draw.random.phase_rad(), draw.signed(0.6e-3));
    let shape = Shape::Square {
        period,
        phase_rad,
        sharpness,
    };
    at_joint(draw, "worn-grooves", shape, size)
}

/// The cable lifts off at speed.
pub(crate) fn lift(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let (joint, size) = (draw.joint, draw.signed(0.8e-3));
    at_joint(draw, "speed-lift", Shape::Lift { joint }, size)
}

/// Load times angle.
pub(crate) fn loaded_angle(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let (joint, size) = (draw.joint, draw.signed(0.8e-3));
    let shape = Shape::LoadedAngle { joint };
    with_part(draw, "loaded-angle", "capstan-compliance", shape, size)
}

/// A part that only carries the hand's force in one half of the range.
pub(crate) fn half_range_force(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let (axis, joint) = (draw.random.index(3), draw.joint);
    let centre = inner_angle_rad(draw);
    let shape = Shape::HalfRangeForce {
        axis,
        joint,
        centre,
    };
    let size = draw.signed(0.8e-3);
    with_part(draw, "half-range-force", "capstan-compliance", shape, size)
}

/// A blow that rings.
pub(crate) fn ringing(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let rate_hz = draw.random.uniform(0.8, 6.0);
    let decay_s = draw.random.uniform(1.5, 6.0);
    let (tag, size) = (draw.tag, draw.signed(3e-3));
    let shape = Shape::Ringing {
        tag,
        rate_hz,
        decay_s,
    };
    at_joint(draw, "ringing", shape, size)
}

/// Another joint's sense of motion.
pub(crate) fn foreign_sense(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let (joint, size) = (other_joint(draw), draw.signed(0.8e-3));
    at_joint(draw, "foreign-sense", Shape::ForeignSense { joint }, size)
}

/// A knot in the measuring cable.
pub(crate) fn cable_knot(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let centre = draw.random.uniform(0.2, 0.4);
    let width = draw.random.uniform(0.008, 0.03);
    let size = draw.signed(250e-6);
    at_cable(draw, "cable-knot", Shape::Dent { centre, width }, size)
}

/// The measuring cable sings.
pub(crate) fn cable_chirp(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let start_hz = draw.random.uniform(0.3, 3.0);
    let end_hz = start_hz + draw.random.uniform(4.0, 12.0);
    let size = draw.signed(120e-6);
    at_cable(draw, "cable-chirp", Shape::Chirp { start_hz, end_hz }, size)
}

/// The measuring cable's zero walks.
pub(crate) fn cable_walk(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let (tag, size) = (draw.tag, draw.signed(300e-6));
    let info = Info {
        acceptable: vec!["cable-drift"],
        ..draw.anywhere("cable-walk", &UNKNOWN)
    };
    placed(info, Place::Cable, Shape::Walk { tag }, size)
}
