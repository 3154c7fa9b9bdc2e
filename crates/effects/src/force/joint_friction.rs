//! Friction that a drive overcomes: Coulomb's, which changes sides over a travel or over a rate, viscous, and Stribeck's
//! at low rates.

use std::ops::Range;

use haptical_model::JointType;
use haptical_model::transmission::loops::{STRIBECK_M_PER_S, STRIBECK_RAD_PER_S};

use crate::laws::{Input, Law};
use crate::signal::{LocalMotion, dahl};
use crate::{Family, Follows, Form, Hook, LawError, Need, Parameter, Shape, Spec};

const COULOMB: Parameter = Parameter::size("coulomb_nm", 0.0, 0.3).times_ratio();
const VISCOUS: Parameter = Parameter::size("viscous_nm_s_per_rad", 0.0, f64::MAX);
const STRIBECK: Parameter = Parameter::size("stribeck_nm", 0.0, f64::MAX);

/// Coulomb's friction changes sides over a travel.
pub const SPEC: Spec = Spec {
    name: "joint-friction",
    meaning: "friction of a joint that the model lacks",
    inspect: "bearings, gears and cable of the joint, and the gain that works against them",
    adds: "h, omega, h exp(-(omega / 0.1)^2), Dahl's state h",
    source: "E6",
    hook: Hook::Torque,
    family: Family::Loop,
    form: Form::Friction,
    needs: &[Need::Time, Need::Torque],
    parameters: &[
        COULOMB,
        VISCOUS,
        STRIBECK,
        Parameter::transition("transition_rad", f64::MAX),
    ],
    amplitudes: 3,
    shape: Shape::Continuous(&[1e-3, 1e-2, 0.1]),
    follows: Follows::Speed,
    law_error: LawError::of(Family::Shape),
    ..Spec::COMMON
};
/// It changes sides over a rate.
pub(crate) const SLIDING: Spec = Spec {
    adds: "h, omega, h exp(-(omega / 0.1)^2), h = tanh(omega / v)",
    parameters: &[
        COULOMB,
        VISCOUS,
        STRIBECK,
        Parameter::transition("transition_rad_per_s", f64::MAX),
    ],
    shape: Shape::Continuous(&[0.02]),
    ..SPEC
};

/// The first, of a joint that slides: forces.
pub(crate) const OF_SLIDE: Spec = Spec {
    parameters: &[
        Parameter::size("coulomb_n", 0.0, 30.0).times_ratio(),
        Parameter::size("viscous_n_s_per_m", 0.0, f64::MAX),
        Parameter::size("stribeck_n", 0.0, f64::MAX),
        Parameter::transition("transition_m", f64::MAX),
    ],
    shape: Shape::Continuous(&[1e-4, 1e-3, 1e-2]),
    ..SPEC
};
/// The second, of a joint that slides.
pub(crate) const SLIDING_OF_SLIDE: Spec = Spec {
    parameters: &[
        Parameter::size("coulomb_n", 0.0, 30.0).times_ratio(),
        Parameter::size("viscous_n_s_per_m", 0.0, f64::MAX),
        Parameter::size("stribeck_n", 0.0, f64::MAX),
        Parameter::transition("transition_m_per_s", f64::MAX),
    ],
    shape: Shape::Continuous(&[2e-3]),
    ..SLIDING
};

/// Share of the power that Coulomb's friction may seem to give back where it is hard to tell from viscous friction.
const GIVEN_BACK: f64 = 0.25;

/// Side on which Coulomb's friction is at each row, -1 to 1, for a transition.
#[derive(Debug)]
pub(crate) struct Friction(fn(&LocalMotion, f64, &[Range<usize>]) -> Vec<f64>);

pub(crate) const LAW: Friction =
    Friction(|motion, transition, runs| dahl(&motion.value, transition, runs));
pub(crate) const SLIDING_LAW: Friction = Friction(|motion, transition, _| {
    let rates = motion.velocity.iter();
    rates.map(|rate| (rate / transition).tanh()).collect()
});

impl Law for Friction {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], shape: f64) -> Option<Vec<Vec<f64>>> {
        let motion = input.drive_motion()?;
        let side = (self.0)(&motion, shape, &input.context.runs);
        let rate = motion.velocity;
        let slides = input.joint()?.joint_type == JointType::Prismatic;
        let stribeck = if slides {
            STRIBECK_M_PER_S
        } else {
            STRIBECK_RAD_PER_S
        };
        let slow = |(side, rate): (&f64, &f64)| side * (-(rate / stribeck).powi(2)).exp();
        let slow = side.iter().zip(&rate).map(slow).collect();
        Some(vec![side, rate, slow])
    }

    /// Whether it takes energy over the motion.
    fn is_possible(&self, input: Input<'_, '_>, amplitudes: &[f64]) -> bool {
        let Some(LocalMotion { velocity: rate, .. }) = input.drive_motion() else {
            return false;
        };
        let count = rate.len().max(1) as f64;
        let mean = rate.iter().map(|rate| rate.abs()).sum::<f64>() / count;
        let square = rate.iter().map(|rate| rate * rate).sum::<f64>() / count;
        let power = amplitudes[0] * mean + amplitudes[1] * square;
        power > 0.0 && amplitudes[0] * mean > -GIVEN_BACK * power
    }
}
