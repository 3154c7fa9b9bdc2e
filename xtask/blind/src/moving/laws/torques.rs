//! Torques that the arm's file does not have: springs, magnets, cables, disturbances, what swings.

use std::f64::consts::TAU;

use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};

use super::{Draw, Drawn, Instant};
use crate::moving::motion::rigid::Link;
use crate::moving::motion::specimen::Specimen;

/// Adds torques on the joints.
fn adding(add: impl Fn(&Instant<'_>, &mut [f64]) + Send + Sync + 'static) -> Drawn {
    Drawn::new(|drawn| drawn.torque = Box::new(add))
}

/// A spring between a place beside the axis and one on the link: its pull times its lever,
/// `k a b sin(q - q0) (1 - L0 / L)` with `L^2 = a^2 + b^2 - 2 a b cos(q - q0)`.
pub(crate) fn spring(draw: &mut Draw<'_>) -> Drawn {
    let joint = draw.joint;
    // k a b
    let moment_nm = draw.of_range(0.1, 0.2);
    let angle_rad = draw.angle_at(0.5) + draw.random.sign() * draw.random.uniform(0.9, 1.6);
    // a / b, and L0 / b
    let levers = draw.random.uniform(0.3, 0.5);
    let rest = draw.random.uniform(0.1, 0.3);
    adding(move |instant, torque| {
        let (sine, cosine) = libm::sincos(instant.angle[joint] - angle_rad);
        let length = libm::sqrt(1.0 + levers * levers - 2.0 * levers * cosine);
        torque[joint] -= moment_nm * sine * (1.0 - rest / length);
    })
    .at(joint)
    .with_all(named!(moment_nm, angle_rad))
}

/// Magnets of a motor: once per turn of it, and a third as much twice.
pub(crate) fn cogging(draw: &mut Draw<'_>) -> Drawn {
    let joint = draw.joint;
    let size = draw.of_range(0.04, 0.07);
    let phase_rad = draw.random.phase_rad();
    let ratio = draw.arm.axes[joint].ratio;
    adding(move |instant, torque| {
        let turn = instant.motor[joint] * ratio;
        torque[joint] += size * (libm::sin(turn + phase_rad) + 0.3 * libm::sin(2.0 * turn));
    })
    .at(joint)
    .with("amplitude", size)
    .with("order", 1.0)
    .with("phase_rad", phase_rad)
}

/// Cables along two joints: the torques of the energy `size sin(q_a + phase) (q_b - rest)^2`.
pub(crate) fn bundle(draw: &mut Draw<'_>) -> Drawn {
    let first = draw.joint;
    let second = if draw.arm.axes[first + 1].slides {
        first + 2
    } else {
        first + 1
    };
    let [a, b] = [first, second].map(|joint| draw.arm.axes[joint].range);
    let size = draw.size * a.min(b) * draw.random.uniform(0.08, 0.14);
    let phase_rad = draw.random.phase_rad();
    let rest_rad = draw.random.uniform(-0.5, 0.5);
    adding(move |instant, torque| {
        let (sine, cosine) = libm::sincos(instant.angle[first] + phase_rad);
        let off = instant.angle[second] - rest_rad;
        torque[first] -= size * cosine * off * off;
        torque[second] -= 2.0 * size * sine * off;
    })
    .at(first)
    .with("size", size)
    .with("second_joint", second as f64 + 1.0)
}

/// Torques from outside with a spectrum of their own: many tones whose power falls with the square of their frequency.
pub(crate) fn coloured(draw: &mut Draw<'_>) -> Drawn {
    const COUNT: usize = 16;
    let joint = draw.joint;
    let rms = draw.of_range(0.03, 0.05);
    // frequency [Hz], amplitude, phase [rad]
    let mut tones: Vec<[f64; 3]> = (0..COUNT)
        .map(|_| {
            let hz = draw.random.around(1.2, 16.0);
            [hz, 1.0 / (0.6 + hz), draw.random.phase_rad()]
        })
        .collect();
    let power: f64 = tones.iter().map(|tone| 0.5 * tone[1] * tone[1]).sum();
    for tone in &mut tones {
        tone[1] *= rms / libm::sqrt(power);
    }
    adding(move |instant, torque| {
        let tone =
            |[hz, size, phase]: &[f64; 3]| size * libm::sin(TAU * hz * instant.time_s + phase);
        torque[joint] += tones.iter().map(tone).sum::<f64>();
    })
    .at(joint)
    .with("rms", rms)
}

/// A vessel at the flange whose liquid sways across it: a mass on springs in two directions. Source: Ibrahim, *Liquid Sloshing
/// Dynamics*, Cambridge 2005, chapter 5.
pub(crate) fn sloshing(draw: &mut Draw<'_>) -> Drawn {
    let arm_kg: f64 = draw.arm.axes.iter().map(|axis| axis.mass_kg).sum();
    let mass_kg = draw.size * arm_kg * draw.random.uniform(0.07, 0.12);
    let hz = draw.random.uniform(1.2, 2.2);
    let pulse = TAU * hz;
    let stiffness = mass_kg * pulse * pulse;
    let height_m = draw.random.uniform(0.05, 0.1);
    let drives = draw.arm.count();
    let build = move |specimen: &mut Specimen| {
        let chain = &mut specimen.chain;
        let flange_m = chain.flange_m;
        if let Some(last) = chain.links.last_mut() {
            super::masses::bolt(last, 0.3 * mass_kg, flange_m, 0.05);
        }
        let slide = |origin_m: Vector3<f64>, turn: Matrix3<f64>, mass_kg: f64| Link {
            slides: true,
            origin_m,
            turn,
            mass_kg,
            centre_m: Vector3::zeros(),
            inertia_kgm2: Matrix3::zeros(),
        };
        // z along the flange's x, then along its y
        let to_x = Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
        let above = flange_m + Vector3::new(0.0, 0.0, height_m);
        chain.links.push(slide(above, to_x, 0.0));
        chain.links.push(slide(Vector3::zeros(), to_x, mass_kg));
        chain.behind = 2;
        specimen.swing_damping = 2.0 * 0.05 * mass_kg * pulse;
    };
    let mut drawn = adding(move |instant, torque| {
        for slide in drives..drives + 2 {
            torque[slide] -= stiffness * instant.angle[slide];
        }
    });
    drawn.build = Box::new(build);
    drawn.with("mass_kg", mass_kg).with("frequency_hz", hz)
}
