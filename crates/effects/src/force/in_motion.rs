//! Effects that the torques of a moving arm show beside its equations of motion: `haptical-motion` has their laws.

use crate::{Family, Follows, Form, Hook, Need, Parameter, Spec};

/// What they have in common.
const MOVING: Spec = Spec {
    hook: Hook::Torque,
    needs: &[Need::Time, Need::Torque, Need::Inertia],
    follows: Follows::Speed,
    ..Spec::COMMON
};

/// A mass at the flange that the model lacks, by its weight and its inertia.
pub const PAYLOAD: Spec = Spec {
    name: "payload",
    meaning: super::payload::SPEC.meaning,
    inspect: super::payload::SPEC.inspect,
    adds: "another mass, centre and inertia behind the flange",
    family: Family::Tool,
    form: Form::Mass,
    parameters: &[
        Parameter::size("mass_kg", 0.0, f64::MAX),
        Parameter::size("moment_x_kg_m", 0.0, f64::MAX),
        Parameter::size("moment_y_kg_m", 0.0, f64::MAX),
        Parameter::size("moment_z_kg_m", 0.0, f64::MAX),
    ],
    ..MOVING
};

/// Friction that is higher near rest.
pub const STRIBECK_FRICTION: Spec = Spec {
    name: "stribeck-friction",
    meaning: "a joint's friction is higher near rest than Coulomb's",
    inspect: "bearings, seals and grease of the joint",
    adds: "s(omega) h exp(-(omega / v)^2)",
    family: Family::Loop,
    parameters: &[
        Parameter::size("torque_nm", 0.0, f64::MAX),
        Parameter::transition("speed_rad_per_s", f64::MAX),
    ],
    ..MOVING
};

/// Friction that grows with the load.
pub const LOAD_FRICTION: Spec = Spec {
    name: "load-friction",
    meaning: "a joint's friction grows with the torque that it carries",
    inspect: "gears and bearings of the joint",
    adds: "s(omega) c |tau|",
    family: Family::Load,
    parameters: &[Parameter::size("share", 0.0, 1.0)],
    follows: Follows::Torque,
    ..MOVING
};

/// Friction that is another in each direction.
pub const FRICTION_ASYMMETRY: Spec = Spec {
    name: "friction-asymmetry",
    meaning: "a joint's friction is not the same in both directions",
    inspect: "the joint's preload and its cables",
    adds: "|s(omega)| h + |omega| b",
    family: Family::Shape,
    parameters: &[
        Parameter::size("coulomb_nm", 0.0, f64::MAX),
        Parameter::size("viscous_nm_s_per_rad", 0.0, f64::MAX),
    ],
    look_alikes: &["torque-offset"],
    ..MOVING
};

/// Friction that changes while the log runs.
pub const FRICTION_DRIFT: Spec = Spec {
    name: "friction-drift",
    meaning: "a joint's friction changes while it moves",
    inspect: "grease, temperature, seals of the joint",
    adds: "(s(omega) h + omega b) f(t)",
    family: Family::Drift,
    parameters: &[
        Parameter::size("coulomb_nm", 0.0, f64::MAX),
        Parameter::size("viscous_nm_s_per_rad", 0.0, f64::MAX),
    ],
    follows: Follows::Time,
    ..MOVING
};

/// Friction that builds up over a travel.
pub const PRESLIDING: Spec = Spec {
    name: "presliding",
    meaning: "a joint's friction builds up over a travel after each reversal",
    inspect: "seals, cables and preloaded bearings of the joint",
    adds: "h z, dz = (sign(omega) - z) |omega| / x dt",
    family: Family::Loop,
    parameters: &[
        Parameter::size("torque_nm", 0.0, f64::MAX),
        Parameter::transition("travel_rad", f64::MAX),
    ],
    ..MOVING
};

/// A constant that is added to a torque.
pub const TORQUE_OFFSET: Spec = Spec {
    name: "torque-offset",
    meaning: "a constant is added to a joint's torque",
    inspect: "the zero of the torque or current sensor",
    adds: "a constant",
    form: Form::Offset,
    parameters: &[Parameter::size("torque_nm", 0.0, f64::MAX)],
    look_alikes: &["friction-asymmetry"],
    ..MOVING
};

/// A torque that ends.
pub const TORQUE_SATURATION: Spec = Spec {
    name: "torque-saturation",
    meaning: "a joint's torque, or what is read of it, ends at a limit",
    inspect: "limits of the drive and of its sensor",
    adds: "what is beyond the limit",
    parameters: &[Parameter::size("limit_nm", 0.0, f64::MAX)],
    follows: Follows::Torque,
    ..MOVING
};

/// A torque that is logged late.
pub const TORQUE_LATENCY: Spec = Spec {
    name: "torque-latency",
    meaning: "a joint's torque is logged later than its position",
    inspect: "filters and clocks of the torque's way to the log",
    adds: "-delay dtau/dt",
    family: Family::Lag,
    form: Form::Delay,
    parameters: &[Parameter::size("delay_s", 0.0, 0.5)],
    follows: Follows::Torque,
    ..MOVING
};

/// A force on the flange for a part of the log.
pub const CONTACT: Spec = Spec {
    name: "contact",
    meaning: "something pushes at the flange for a part of the log",
    inspect: "what stands in the arm's way",
    adds: "-J^T f(t)",
    family: Family::Tool,
    parameters: &[
        Parameter::number("share", 1.0),
        Parameter::size("force_n", 0.0, f64::MAX),
    ],
    follows: Follows::Time,
    ..MOVING
};

/// A spring or a counterweight.
pub const GRAVITY_SPRING: Spec = Spec {
    name: "gravity-spring",
    meaning: "a spring or a counterweight acts on a joint",
    inspect: "counterbalances, hoses and cables along the joint",
    adds: "k theta + c",
    family: Family::Shape,
    parameters: &[Parameter::size("stiffness_nm_per_rad", 0.0, f64::MAX)],
    follows: Follows::Angle,
    ..MOVING
};
/// The same with a sine of the angle.
pub const COUNTERWEIGHT: Spec = Spec {
    adds: "m sin(theta + phase)",
    parameters: &[Parameter::size("moment_nm", 0.0, f64::MAX)],
    ..GRAVITY_SPRING
};

/// An armature that is another than the stated one.
pub const ARMATURE: Spec = Spec {
    name: "armature",
    meaning: "a drive's inertia is not the stated one",
    inspect: "inertia of rotor and gear, and the ratio",
    adds: "I domega/dt",
    form: Form::Armature,
    parameters: &[Parameter::size("inertia_kgm2", 0.0, f64::MAX)],
    ..MOVING
};

/// A link's mass that is another.
pub const LINK_INERTIA: Spec = Spec {
    name: "link-inertia",
    meaning: "a link's mass or its centre is not the model's",
    inspect: "what is mounted on the link",
    adds: "another mass of a link",
    form: Form::Mass,
    parameters: &[Parameter::size("mass_kg", 0.0, f64::MAX)],
    follows: Follows::Angle,
    ..MOVING
};
/// A link's centre of mass that is another.
pub const LINK_CENTRE: Spec = Spec {
    adds: "another centre of mass of a link",
    parameters: &[
        Parameter::size("centre_x_m", 0.0, 0.5),
        Parameter::size("centre_y_m", 0.0, 0.5),
        Parameter::size("centre_z_m", 0.0, 0.5),
    ],
    ..LINK_INERTIA
};

/// A joint whose zero is another.
pub const JOINT_OFFSET: Spec = Spec {
    name: "joint-offset",
    meaning: "the home of the joint is not where the device file, or its command, says",
    inspect: "the homing stop or the reference pose",
    adds: "tau(theta + o) - tau(theta)",
    form: Form::Offset,
    parameters: &[Parameter::size("offset_rad", 0.0, 0.5)],
    follows: Follows::Angle,
    ..MOVING
};

/// One factor on all torques.
pub const TORQUE_FACTOR: Spec = Spec {
    name: "torque-gain",
    meaning: "the torque's scale is not the stated one",
    inspect: "the motor's constant and the amplifier's gain",
    adds: "f tau of all joints",
    form: Form::Scale,
    parameters: &[Parameter::number("factor", f64::MAX)],
    follows: Follows::Torque,
    ..MOVING
};

/// A mount that is tilted.
pub const GRAVITY_DIRECTION: Spec = Spec {
    name: "gravity-direction",
    meaning: "the mount is tilted against the model's",
    inspect: "the mount with a level",
    adds: "another direction of gravity",
    family: Family::Place,
    form: Form::Tilt,
    parameters: &[Parameter::size("tilt_rad", 0.0, 3.2)],
    follows: Follows::Angle,
    ..MOVING
};

/// Rows that are missing or repeated.
pub const SAMPLING: Spec = Spec {
    name: "sampling",
    meaning: "rows of the log are missing or repeated",
    inspect: "the recorder: its buffer, its rate, its clock",
    adds: "jumps of all columns at once",
    family: Family::Step,
    parameters: &[Parameter::number("share", 1.0)],
    follows: Follows::Time,
    ..MOVING
};

/// Commands that a controller hears late.
pub const COMMAND_LATENCY: Spec = Spec {
    name: "command-latency",
    meaning: "the controller hears its commands late",
    inspect: "bus, buffers and interpolation between the sender of commands and the drives",
    confirm: "to confirm {name}: command a step of one joint and log at a higher rate; a delay shows as the time until the \
              torque answers, and a controller that is softer does not",
    adds: "the controller's law of c(t - d) in the place of c(t)",
    family: Family::Lag,
    form: Form::Delay,
    parameters: &[Parameter::size("delay_s", 0.0, 0.1)],
    follows: Follows::Time,
    needs: &[Need::Time, Need::Torque, Need::Inertia, Need::Command],
    ..MOVING
};

/// A drive that loads another joint.
pub const CROSS_COUPLING: Spec = Spec {
    name: crate::transmission::cross_coupling::SPEC.name,
    meaning: "one joint moves or loads another: a cable, shaft or differential passes it",
    inspect: "cables, pulleys, shafts and differentials of one joint that pass the other",
    adds: "c tau_from",
    family: Family::Coupling,
    form: Form::Coupling,
    parameters: &[
        Parameter::size("gain", 0.0, 1.0),
        Parameter::number("from_joint", f64::MAX),
    ],
    follows: Follows::Torque,
    ..MOVING
};
