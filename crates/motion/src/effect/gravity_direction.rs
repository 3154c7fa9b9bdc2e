//! A mount that is tilted.

use std::rc::Rc;

use nalgebra::Vector3;

use super::{Candidate, Context, Effect, Found};
use crate::change::Change;

pub(crate) const EFFECT: Effect = Effect::new("gravity-direction", candidates)
    .exact()
    .changing(change);

fn change(found: &Found<'_>) -> Option<Change> {
    let gravity = found.arm.bodies.gravity_mps2();
    let [first, second] = axes(gravity)?;
    let [a, b] = *found.read_off.first_chunk::<2>()?;
    let size = gravity.norm();
    let turned = (gravity + (first * a + second * b) * size).normalize() * size;
    Some(Change::Gravity {
        gravity_mps2: turned.into(),
    })
}

/// The two axes across gravity, along which it moves when it tilts; none without gravity.
fn axes(gravity: &Vector3<f64>) -> Option<[Vector3<f64>; 2]> {
    let along = gravity.try_normalize(0.0)?;
    let other = match along.x.abs() < 0.9 {
        true => Vector3::x(),
        false => Vector3::y(),
    };
    let first = along.cross(&other).normalize();
    Some([first, along.cross(&first)])
}

/// Torques under gravity turned about the two axes across it, first order in the tilt.
fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    let problem = context.problem;
    let gravity = problem.arm.bodies.gravity_mps2();
    let size = gravity.norm();
    let Some([first, second]) = axes(gravity) else {
        return Vec::new();
    };
    let (steps, joints) = (problem.states.steps(), problem.arm.joints());
    let mut signals = [0, 1].map(|_| vec![vec![0.0; steps]; joints]);
    let mut q = vec![0.0; joints];
    for step in 0..steps {
        for joint in 0..joints {
            q[joint] = problem.states.link.q[joint][step];
        }
        let Ok(torques) = problem.arm.under_gravity(&q) else {
            return Vec::new();
        };
        for (signal, axis) in signals.iter_mut().zip([first, second]) {
            for joint in 0..joints {
                let of_axis = |k: usize| size * axis[k] * torques[k][joint];
                signal[joint][step] = (0..3).map(of_axis).sum();
            }
        }
    }
    let columns = signals.iter().map(|own| problem.of_joints(own));
    let numbers = |own: &[f64]| vec![("tilt_rad", own[0].hypot(own[1]))];
    let found = Candidate::new(EFFECT.name, None, columns.collect(), Rc::new(numbers));
    // the torques of a tilt are those of bodies that are off themselves
    vec![found.about_to(crate::thresholds::effect::BODIES_LAW_SD)]
}
