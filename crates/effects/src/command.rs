//! Effects that a joint's answer to its command shows: `haptical-servo` has their laws.

use crate::base_model::JOINT_OFFSET;
use crate::force::in_motion::COMMAND_LATENCY;
use crate::force::joint_friction;
use crate::transmission::backlash;
use crate::{Family, Form, Hook, Need, Parameter, Spec};

/// What they have in common.
const ANSWER: Spec = Spec {
    hook: Hook::Command,
    needs: &[Need::Time, Need::Command],
    ..Spec::COMMON
};

/// The zero of the joint's sensor, or of its horn on the shaft.
pub const OFFSET: Spec = Spec {
    name: JOINT_OFFSET.name,
    meaning: JOINT_OFFSET.meaning,
    inspect: JOINT_OFFSET.inspect,
    adds: "o",
    family: Family::Step,
    form: Form::Offset,
    parameters: &[Parameter::size("offset_rad", 0.0, f64::MAX)],
    ..ANSWER
};

/// Bus, controller and driver.
pub const LATENCY: Spec = Spec {
    name: COMMAND_LATENCY.name,
    meaning: COMMAND_LATENCY.meaning,
    inspect: COMMAND_LATENCY.inspect,
    adds: "c(t - d) - c(t)",
    family: Family::Lag,
    form: Form::Delay,
    parameters: &[Parameter::size("delay_s", 0.0, f64::MAX)],
    ..ANSWER
};

/// A low gain of the position loop.
pub const STIFFNESS: Spec = Spec {
    name: "servo-stiffness",
    meaning: "the position loop gives way: a low gain makes it lag, and droop under a load",
    inspect: "the proportional gain of the position loop, and whether it has an integral one",
    adds: "-tau / k, and x'' / w^2 + T x' + x = u",
    family: Family::Lag,
    parameters: &[
        Parameter::size("stiffness_nm_per_rad", 0.0, f64::MAX),
        Parameter::size("droop_rad", 0.0, f64::MAX),
        Parameter::size("lag_s", 0.0, f64::MAX),
        Parameter::size("natural_rad_per_s", 0.0, f64::MAX),
    ],
    ..ANSWER
};

/// Friction of the gears against a finite gain.
pub const FRICTION: Spec = Spec {
    name: joint_friction::SPEC.name,
    meaning: joint_friction::SPEC.meaning,
    inspect: joint_friction::SPEC.inspect,
    adds: "a play of width w",
    family: Family::Loop,
    form: Form::Play,
    parameters: &[Parameter::size("width_rad", 0.0, f64::MAX)],
    ..ANSWER
};

/// The controller's dead zone.
pub const DEAD_ZONE: Spec = Spec {
    name: "dead-zone",
    meaning: "the controller ignores an error that is small enough",
    inspect: "the dead zone (or minimum start force) in the servo's settings",
    ..FRICTION
};

/// Play in front of the sensor.
pub const BACKLASH: Spec = Spec {
    name: backlash::SPEC.name,
    meaning: backlash::SPEC.meaning,
    inspect: backlash::SPEC.inspect,
    ..FRICTION
};

/// The scale of the answer.
pub const GAIN: Spec = Spec {
    name: "servo-gain",
    meaning: "the joint moves by a factor more, or less, than its command",
    inspect: "the scale between counts and angles, and the range that the servo is calibrated to",
    adds: "(g - 1) u",
    form: Form::Scale,
    parameters: &[Parameter::size("factor", 0.0, f64::MAX)],
    ..ANSWER
};

/// The limit of the speed.
pub const SPEED_SATURATION: Spec = Spec {
    name: "speed-saturation",
    meaning: "the drive turns no faster than its limit of torque or voltage allows",
    inspect: "the limits of torque and speed in the servo's settings, and the voltage of the supply",
    adds: "|dx/dt| <= v",
    family: Family::Lag,
    parameters: &[Parameter::size("limit_rad_per_s", 0.0, f64::MAX)],
    ..ANSWER
};

/// Whether a name is that of an effect on the answer to a command.
pub fn is_on_answer(name: &str) -> bool {
    crate::specs().any(|spec| spec.hook == Hook::Command && spec.name == name)
}
