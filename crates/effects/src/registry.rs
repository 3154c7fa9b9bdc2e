//! The one list of effects. A new one is a file and a line here.

use std::slice::from_ref;

use haptical_model::{Device, Joint, JointType, TransmissionKind};

use crate::force::in_motion;
use crate::laws::{Law, Placed};
use crate::{Effect, Form, Hook, Parameter, Spec};
use crate::{
    base_model, cable, command, external_encoder, force, motor_encoder, noise, structure,
    transmission,
};

/// Where an effect can occur, and how it is made there.
enum Site {
    /// At each joint of a kind.
    Joint(fn(&Joint) -> bool, fn(usize) -> Box<dyn Effect>),
    /// At each joint of a kind, from each other joint.
    Pair(fn(&Joint) -> bool, fn(usize, usize) -> Box<dyn Effect>),
    /// On a device, at places of its own.
    Device(fn(&Device) -> Vec<Box<dyn Effect>>),
    /// Found outside the scans.
    Elsewhere,
}

/// A line of the registry.
struct Line {
    /// One, or one for each kind of place where the effect's numbers differ.
    specs: &'static [Spec],
    site: Site,
}

fn any(_: &Joint) -> bool {
    true
}

fn has_drums(joint: &Joint) -> bool {
    joint.transmission != TransmissionKind::Direct
}

fn turns(joint: &Joint) -> bool {
    joint.joint_type == JointType::Revolute
}

fn slides(joint: &Joint) -> bool {
    !turns(joint)
}

fn turns_by_drums(joint: &Joint) -> bool {
    turns(joint) && has_drums(joint)
}

fn placed<L: Law + 'static>(spec: &'static Spec, joint: Option<usize>, law: L) -> Box<dyn Effect> {
    Box::new(Placed { spec, joint, law })
}

macro_rules! at_joints {
    ($kind:ident, $file:path) => {
        at_joints!($kind, $file, SPEC, LAW)
    };
    ($kind:ident, $file:path, $spec:ident, $law:ident) => {{
        use $file as file;
        Line {
            specs: from_ref(&file::$spec),
            site: Site::Joint($kind, |joint| placed(&file::$spec, Some(joint), file::$law)),
        }
    }};
}

macro_rules! on_device {
    ($file:path) => {
        on_device!($file, SPEC, LAW)
    };
    ($file:path, $spec:ident, $law:ident) => {{
        use $file as file;
        Line {
            specs: from_ref(&file::$spec),
            site: Site::Device(|_| vec![placed(&file::$spec, None, file::$law)]),
        }
    }};
}

/// At each cable but the first.
macro_rules! further_cables {
    ($spec:ident, $reads_m:ident) => {{
        use cable::further::{Further, $reads_m, $spec};
        Line {
            specs: from_ref(&$spec),
            site: Site::Device(|device| {
                let cables = 1..device.cables.len();
                let reads_m = $reads_m;
                let made = cables.map(|cable| placed(&$spec, None, Further { cable, reads_m }));
                made.collect()
            }),
        }
    }};
}

const fn elsewhere(spec: &'static Spec) -> Line {
    Line {
        specs: from_ref(spec),
        site: Site::Elsewhere,
    }
}

/// Order matters: of effects that explain equally much the first is taken.
const REGISTRY: &[Line] = &[
    at_joints!(any, transmission::capstan_compliance),
    at_joints!(any, structure::joint_compliance),
    at_joints!(has_drums, transmission::capstan_creep),
    at_joints!(any, transmission::backlash),
    at_joints!(any, transmission::hysteresis),
    at_joints!(any, external_encoder::windup),
    at_joints!(any, transmission::viscous_lag),
    at_joints!(any, external_encoder::latency),
    at_joints!(any, motor_encoder::encoder_count_loss),
    at_joints!(turns, motor_encoder::zero_changed),
    at_joints!(slides, motor_encoder::zero_changed, OF_SLIDE, LAW),
    at_joints!(any, external_encoder::count_loss),
    at_joints!(has_drums, transmission::capstan_slip),
    at_joints!(any, transmission::joint_drift),
    at_joints!(any, transmission::joint_drift, WARM, WARM_LAW),
    at_joints!(any, external_encoder::drift),
    at_joints!(turns, external_encoder::eccentricity),
    at_joints!(turns_by_drums, transmission::drum_eccentricity),
    at_joints!(any, transmission::ratio_error),
    at_joints!(turns_by_drums, transmission::drum_out_of_round),
    at_joints!(turns_by_drums, transmission::input_drum_harmonic),
    at_joints!(turns, motor_encoder::device_encoder_eccentricity),
    at_joints!(turns_by_drums, transmission::cable_pitch),
    Line {
        specs: from_ref(&transmission::cross_coupling::SPEC),
        site: Site::Pair(turns, |joint, from| {
            let law = transmission::cross_coupling::CrossCoupling { from };
            placed(&transmission::cross_coupling::SPEC, Some(joint), law)
        }),
    },
    Line {
        specs: from_ref(&transmission::coupled_backlash::SPEC),
        site: Site::Pair(turns, |joint, from| {
            let law = transmission::coupled_backlash::CoupledBacklash { from };
            placed(&transmission::coupled_backlash::SPEC, Some(joint), law)
        }),
    },
    at_joints!(turns, structure::axis_wobble),
    at_joints!(turns, structure::lateral_compliance),
    on_device!(structure::base_compliance),
    on_device!(structure::tool_compliance),
    on_device!(cable::hysteresis),
    on_device!(cable::latency),
    Line {
        specs: from_ref(&motor_encoder::encoder_latency::SPEC),
        site: Site::Device(|_| vec![Box::new(motor_encoder::encoder_latency::EncoderLatency)]),
    },
    Line {
        specs: from_ref(&structure::tracker_latency::SPEC),
        site: Site::Device(|_| vec![Box::new(structure::tracker_latency::TrackerLatency)]),
    },
    on_device!(cable::count_loss),
    on_device!(cable::drift),
    on_device!(cable::warming),
    on_device!(structure::warming),
    on_device!(cable::zero_offset),
    on_device!(cable::scale),
    on_device!(cable::stretch),
    further_cables!(ZERO, constant),
    further_cables!(SCALE, proportional),
    further_cables!(STRETCH, proportional),
    on_device!(cable::sag),
    on_device!(cable::twist),
    on_device!(cable::drum_eccentricity),
    on_device!(cable::exit_geometry),
    on_device!(structure::tool_changed),
    on_device!(structure::tracker_moved),
    on_device!(structure::tracker_scale),
    Line {
        specs: &noise::periodic_disturbance::SPECS,
        site: Site::Device(noise::periodic_disturbance::on_channels),
    },
    elsewhere(&noise::NOISE_LEVEL),
    elsewhere(&noise::DROPOUTS),
    elsewhere(&noise::OUTLIERS),
    elsewhere(&base_model::PARALLELOGRAM_ERROR),
    elsewhere(&base_model::JOINT_OFFSET),
    elsewhere(&base_model::LINK_GEOMETRY),
    on_device!(force::bias),
    on_device!(force::bias, WARM, WARM_LAW),
    on_device!(force::gain),
    on_device!(force::crosstalk),
    on_device!(force::hysteresis),
    on_device!(force::payload),
    elsewhere(&force::PAYLOAD_ON_LINK),
    at_joints!(turns, force::joint_friction),
    at_joints!(turns, force::joint_friction, SLIDING, SLIDING_LAW),
    at_joints!(slides, force::joint_friction, OF_SLIDE, LAW),
    at_joints!(slides, force::joint_friction, SLIDING_OF_SLIDE, SLIDING_LAW),
    at_joints!(turns, force::motor_cogging),
    at_joints!(slides, force::motor_cogging, OF_SLIDE, LAW),
    at_joints!(any, force::torque_gain),
    elsewhere(&force::UNBALANCED_GRAVITY),
    elsewhere(&force::GRIP_FORCE),
    elsewhere(&force::MAGNETIC_SATURATION),
    elsewhere(&force::TORQUE_CONSTANT_DRIFT),
    elsewhere(&in_motion::PAYLOAD),
    elsewhere(&in_motion::STRIBECK_FRICTION),
    elsewhere(&in_motion::LOAD_FRICTION),
    elsewhere(&in_motion::FRICTION_ASYMMETRY),
    elsewhere(&in_motion::FRICTION_DRIFT),
    elsewhere(&in_motion::PRESLIDING),
    elsewhere(&in_motion::TORQUE_OFFSET),
    elsewhere(&in_motion::TORQUE_SATURATION),
    elsewhere(&in_motion::TORQUE_LATENCY),
    elsewhere(&in_motion::CONTACT),
    elsewhere(&in_motion::GRAVITY_SPRING),
    elsewhere(&in_motion::COUNTERWEIGHT),
    elsewhere(&in_motion::ARMATURE),
    elsewhere(&in_motion::LINK_INERTIA),
    elsewhere(&in_motion::LINK_CENTRE),
    elsewhere(&in_motion::JOINT_OFFSET),
    elsewhere(&in_motion::TORQUE_FACTOR),
    elsewhere(&in_motion::GRAVITY_DIRECTION),
    elsewhere(&in_motion::SAMPLING),
    elsewhere(&in_motion::COMMAND_LATENCY),
    elsewhere(&in_motion::CROSS_COUPLING),
    elsewhere(&command::OFFSET),
    elsewhere(&command::LATENCY),
    elsewhere(&command::STIFFNESS),
    elsewhere(&command::FRICTION),
    elsewhere(&command::DEAD_ZONE),
    elsewhere(&command::BACKLASH),
    elsewhere(&command::GAIN),
    elsewhere(&command::SPEED_SATURATION),
];

impl Line {
    /// Whether torques of the drives show the effect, and no position does.
    fn is_on_drives(&self) -> bool {
        self.specs.iter().all(|spec| spec.hook.is_on_drives())
    }

    /// Whether a device can have the effect.
    fn occurs_on(&self, device: &Device) -> bool {
        match self.site {
            Site::Joint(is_kind, _) => device.joints.iter().any(is_kind),
            Site::Pair(is_kind, _) => device.joints.len() > 1 && device.joints.iter().any(is_kind),
            Site::Device(_) | Site::Elsewhere => true,
        }
    }
}

/// Every effect that positions show, at every place of a device where it can occur.
pub fn catalogue(device: &Device) -> Vec<Box<dyn Effect>> {
    let shown = |line: &Line| !line.is_on_drives();
    let mut effects = at_each_joint(device, shown);
    effects.extend(once(device, shown));
    effects
}

/// Every effect that recorded torques of the drives show, at every place of a device where it can occur.
pub fn drive_catalogue(device: &Device) -> Vec<Box<dyn Effect>> {
    let shown = |line: &Line| line.is_on_drives();
    let mut effects = once(device, shown);
    effects.extend(at_each_joint(device, shown));
    effects
}

fn at_each_joint(device: &Device, shown: impl Fn(&Line) -> bool) -> Vec<Box<dyn Effect>> {
    let mut effects: Vec<Box<dyn Effect>> = Vec::new();
    let joints = device.joints.len();
    for (joint, own) in device.joints.iter().enumerate() {
        for line in REGISTRY.iter().filter(|line| shown(line)) {
            match line.site {
                Site::Joint(is_kind, make) if is_kind(own) => effects.push(make(joint)),
                Site::Pair(is_kind, make) if is_kind(own) => {
                    let others = (0..joints).filter(|&from| from != joint);
                    effects.extend(others.map(|from| make(joint, from)));
                }
                _ => {}
            }
        }
    }
    effects
}

fn once(device: &Device, shown: impl Fn(&Line) -> bool) -> Vec<Box<dyn Effect>> {
    let lines = REGISTRY.iter().filter(|line| shown(line));
    let made = lines.filter_map(|line| match line.site {
        Site::Device(make) => Some(make(device)),
        _ => None,
    });
    made.flatten().collect()
}

/// What is known of every effect, in the order of the registry.
pub fn specs() -> impl Iterator<Item = &'static Spec> {
    REGISTRY.iter().flat_map(|line| line.specs)
}

/// Every name, once.
pub fn names() -> Vec<&'static str> {
    let mut names: Vec<&'static str> = Vec::new();
    for spec in specs() {
        if !names.contains(&spec.name) {
            names.push(spec.name);
        }
    }
    names
}

/// The first effect of a name; an index of the joint (`name@3`) is ignored.
pub fn spec(name: &str) -> Option<&'static Spec> {
    let name = name.split('@').next()?;
    specs().find(|spec| spec.name == name)
}

/// Where the first effect of a name enters, and the mathematics of its law.
pub fn law(name: &str) -> Option<(Hook, Form)> {
    spec(name).map(|spec| (spec.hook, spec.form))
}

/// A parameter of an effect.
pub fn parameter(effect: &str, parameter: &str) -> Option<&'static Parameter> {
    let mut named = specs().filter(|spec| spec.name == effect);
    named.find_map(|spec| spec.parameter(parameter))
}

/// Smallest and largest magnitude of an effect's parameter that a sound device can show: ten times wider than its
/// usual range. None where a device cannot have the effect or it has no such parameter.
///
/// ```
/// use haptical_effects::plausible_range;
/// let text = "[[joint]]\nname = \"one\"\n";
/// let device = haptical_model::Device::from_toml(text, "one.toml")?.device;
/// let [_, largest] = plausible_range(&device, "backlash", "width_rad").ok_or("no backlash")?;
/// assert!(largest > 1e-3 && largest < 1.0);
/// assert!(plausible_range(&device, "backlash", "stiffness").is_none());
/// assert!(plausible_range(&device, "capstan-slip", "slip_rad").is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn plausible_range(device: &Device, effect: &str, parameter: &str) -> Option<[f64; 2]> {
    let lines = REGISTRY.iter();
    let specs = lines.filter(|line| line.occurs_on(device));
    let specs = specs.flat_map(|line| line.specs);
    let mut specs = specs.filter(|spec| spec.name == effect);
    let found = specs.find_map(|spec| spec.parameter(parameter))?;
    Some(found.plausible)
}
