//! A structure that is not rigid: axes that wobble, a base and a tool that give, a tool put on anew.

use haptical_model::kinematics::nalgebra::Vector3;

use crate::effects::{Draw, Effect, Facts, Info};
use crate::laws::vector_gain;
use crate::rig::geometry::Flex;
use crate::rig::scene::Scene;

/// A bearing whose axis tilts as it turns.
#[derive(Debug)]
struct Wobble {
    info: Info,
    joint: usize,
    amplitude_rad: f64,
    phase_rad: f64,
    order: f64,
    /// Ratio of the short to the long axis of the tilt's ellipse.
    ellipse: f64,
}

impl Effect for Wobble {
    fn info(&self) -> &Info {
        &self.info
    }

    fn facts(&self, _scene: &Scene<'_>) -> Facts {
        Facts::default()
            .with("amplitude_rad", self.amplitude_rad)
            .with("order", self.order)
            .law("ellipse", self.ellipse)
    }

    fn flex(&self, scene: &Scene<'_>, flex: &mut Flex) {
        let tilts = scene.motion.angle_rad[self.joint]
            .iter()
            .map(|angle| {
                let (sin, cos) = libm::sincos(self.order * angle + self.phase_rad);
                let (home_sin, home_cos) = libm::sincos(self.phase_rad);
                [
                    self.amplitude_rad * (cos - home_cos),
                    self.amplitude_rad * self.ellipse * (sin - home_sin),
                    0.0,
                ]
            })
            .collect();
        add_tilt(flex, self.joint, tilts);
    }
}

/// What gives under loads, by `gain / (1 + |load| / hardening)` times the load.
fn hardening(loads: &[[f64; 3]], gain: f64, hardening: f64) -> Vec<[f64; 3]> {
    let give = |load: &[f64; 3]| {
        let factor = gain / (1.0 + Vector3::from(*load).norm() / hardening);
        load.map(|part| factor * part)
    };
    loads.iter().map(give).collect()
}

/// Adds rotation vectors at a joint.
fn add_tilt(flex: &mut Flex, joint: usize, tilts: Vec<[f64; 3]>) {
    match &mut flex.tilt_rad[joint] {
        Some(present) => {
            for (sum, tilt) in present.iter_mut().zip(tilts) {
                for (axis, value) in sum.iter_mut().zip(tilt) {
                    *axis += value;
                }
            }
        }
        empty => *empty = Some(tilts),
    }
}

/// Adds shifts of the hook.
fn add_shift(flex: &mut Flex, shifts: Vec<[f64; 3]>) {
    match &mut flex.tool_m {
        Some(present) => {
            for (sum, shift) in present.iter_mut().zip(shifts) {
                for (axis, value) in sum.iter_mut().zip(shift) {
                    *axis += value;
                }
            }
        }
        empty => *empty = Some(shifts),
    }
}

/// Run-out of a joint's axis, twice per turn.
pub(crate) fn axis_wobble(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    Box::new(Wobble {
        info: draw.at_joint("axis-wobble", &["axis-wobble"]),
        joint: draw.joint,
        amplitude_rad: draw.amplitude(1.5e-3),
        phase_rad: draw.random.phase_rad(),
        order: 2.0,
        ellipse: draw.random.sign() * draw.random.uniform(0.8, 1.0),
    })
}

/// A base plate that gives under its moment.
#[derive(Debug)]
struct Base {
    info: Info,
    rad_per_nm: f64,
    hardening_nm: f64,
}

impl Effect for Base {
    fn info(&self) -> &Info {
        &self.info
    }

    fn facts(&self, scene: &Scene<'_>) -> Facts {
        let tilts = hardening(&scene.base_moment_nm, -self.rad_per_nm, self.hardening_nm);
        let effective = -vector_gain(&scene.base_moment_nm, &tilts);
        Facts::default()
            .with("rad_per_nm", effective)
            .law("initial_rad_per_nm", self.rad_per_nm)
            .law("hardening_nm", self.hardening_nm)
    }

    fn flex(&self, scene: &Scene<'_>, flex: &mut Flex) {
        // the base carries the opposite of the moment on the first link
        let tilts = hardening(&scene.base_moment_nm, -self.rad_per_nm, self.hardening_nm);
        add_tilt(flex, 0, tilts);
    }
}

/// Compliance of the base, the same about every axis, a little harder under load.
pub(crate) fn base_compliance(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    Box::new(Base {
        info: draw.anywhere(
            "base-compliance",
            &["base-compliance", "lateral-compliance"],
        ),
        rad_per_nm: draw.amplitude(1.5e-3),
        hardening_nm: draw.random.uniform(15.0, 40.0),
    })
}

/// A handle that gives under the hand.
#[derive(Debug)]
struct Tool {
    info: Info,
    m_per_n: f64,
    hardening_n: f64,
}

impl Effect for Tool {
    fn info(&self) -> &Info {
        &self.info
    }

    fn facts(&self, scene: &Scene<'_>) -> Facts {
        let shifts = hardening(&scene.force_n, self.m_per_n, self.hardening_n);
        Facts::default()
            .with("m_per_n", vector_gain(&scene.force_n, &shifts))
            .law("initial_m_per_n", self.m_per_n)
            .law("hardening_n", self.hardening_n)
    }

    fn flex(&self, scene: &Scene<'_>, flex: &mut Flex) {
        let shifts = hardening(&scene.force_n, self.m_per_n, self.hardening_n);
        add_shift(flex, shifts);
    }
}

/// Compliance of the tool's connector.
pub(crate) fn tool_compliance(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    Box::new(Tool {
        info: draw.anywhere("tool-compliance", &["tool-compliance"]),
        m_per_n: draw.amplitude(1.5e-4),
        hardening_n: draw.random.uniform(20.0, 60.0),
    })
}

/// A tool that sits elsewhere from the second run on.
#[derive(Debug)]
struct Remounted {
    info: Info,
    shift_m: [f64; 3],
}

impl Effect for Remounted {
    fn info(&self) -> &Info {
        &self.info
    }

    fn facts(&self, _scene: &Scene<'_>) -> Facts {
        let [x_m, y_m, z_m] = self.shift_m;
        Facts::default()
            .with("shift_m", Vector3::from(self.shift_m).norm())
            .law("x_m", x_m)
            .law("y_m", y_m)
            .law("z_m", z_m)
    }

    fn flex(&self, scene: &Scene<'_>, flex: &mut Flex) {
        let shifts = scene
            .motion
            .run
            .iter()
            .map(|run| if *run > 0 { self.shift_m } else { [0.0; 3] })
            .collect();
        add_shift(flex, shifts);
    }
}

/// The tool was taken off and put on between two runs.
pub(crate) fn tool_changed(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let size_m = draw.amplitude(0.6e-3);
    let direction = Vector3::from_fn(|_, _| draw.random.normal());
    Box::new(Remounted {
        info: draw.anywhere("tool-changed", &["tool-changed"]),
        shift_m: (direction.normalize() * size_m).into(),
    })
}
