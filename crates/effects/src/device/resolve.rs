//! The law and the numbers of each effect of a device.

use haptical_model::{Device, DeviceEffect};

use crate::device::error::{DeviceEffectError, lacks_unit};
use crate::laws::FROM_RUN;
use crate::{
    Context, Effect, Follows, Further, Hook, Parameter, Role, Shape, Spec, catalogue, correction,
    drive_catalogue, names, specs,
};

/// An effect of a device with its law.
#[derive(Debug)]
pub struct OwnEffect {
    /// Position within [`Device::effects`].
    pub index: usize,
    /// The law at its place.
    pub effect: Box<dyn Effect>,
    /// The reported parameters, in their order; none where the effect is to be found and no number is known.
    pub values: Option<Vec<f64>>,
    /// The further ones.
    pub further: Vec<f64>,
}

impl OwnEffect {
    /// Amplitudes and shape on a recording; amplitudes of 0 where no number is known.
    pub fn amplitudes(&self, context: &Context<'_>) -> (Vec<f64>, f64) {
        match &self.values {
            Some(values) => self.effect.whole(context, values, &self.further),
            None => {
                let shapes = self.effect.shapes(context);
                // the plainest of a list, one in the middle of a range
                let place = match self.effect.spec().shape {
                    Shape::Continuous(_) => shapes.len() / 2,
                    _ => 0,
                };
                let first = shapes.get(place).copied().unwrap_or(0.0);
                let shape = self.shape_of_run().unwrap_or(first);
                (vec![0.0; self.effect.spec().amplitudes], shape)
            }
        }
    }

    /// The temperature at which nothing has grown, where its law has one.
    pub fn reference_degc(&self) -> Option<f64> {
        self.further("reference_degc")
    }

    /// Shape of a displacement that is stated to be there from a run on; none where no run, or the first, is stated.
    fn shape_of_run(&self) -> Option<f64> {
        let run = self.further(FROM_RUN.name)?;
        (self.effect.spec().follows == Follows::Run && run > 1.0).then_some(run - 1.0)
    }

    fn further(&self, name: &str) -> Option<f64> {
        let names = self.effect.spec().further.iter();
        let mut pairs = names.zip(&self.further);
        pairs
            .find(|(further, _)| further.name == name)
            .map(|(_, value)| *value)
            .filter(|value| value.is_finite())
    }
}

/// Whether an effect is a law that predicts readings, so that it can be part of a device; else why it is not.
///
/// # Errors
/// The reason.
pub fn is_law(spec: &Spec) -> Result<(), &'static str> {
    match (spec.hook, spec.shape) {
        (Hook::BaseModel, _) => Err("it is a number of [[link]] or [[joint]]"),
        (Hook::Command, _) => {
            Err("it is an answer to commands, of which a device file says nothing")
        }
        (_, Shape::Line) => Err(
            "its phase is another one in each run; take the source of the disturbance away, or filter the channel",
        ),
        (Hook::Readings, _) => Err("it is said of the readings, not of the device"),
        _ if ["unbalanced-gravity", "grip-force"].contains(&spec.name)
            || *spec == crate::force::PAYLOAD_ON_LINK =>
        {
            Err("give the masses and their centres in [[link]]")
        }
        _ if spec.needs.contains(&crate::Need::Inertia) => {
            Err("it is an effect of a moving arm's torques, and a device file does not hold those")
        }
        _ => Ok(()),
    }
}

/// Every law that can be part of a device.
pub fn laws() -> impl Iterator<Item = &'static Spec> {
    specs().filter(|spec| is_law(spec).is_ok())
}

/// The laws of a device's effects, with their numbers.
///
/// # Errors
/// [`DeviceEffectError`] for the first effect without a meaning.
///
/// ```
/// use haptical_effects::device::effects_of;
/// use haptical_model::Device;
/// let text = "[[joint]]\n[[effect]]\nname = \"backlash\"\njoint = 1\nwidth_rad = 2e-3\n";
/// let device = Device::from_toml(text, "one.toml")?.device;
/// let own = effects_of(&device)?;
/// assert_eq!(own[0].values.as_deref(), Some(&[2e-3][..]));
/// let text = "[[joint]]\n[[effect]]\nname = \"backlash\"\njoint = 1\nwidth = 2e-3\n";
/// let error = effects_of(&Device::from_toml(text, "one.toml")?.device).err().ok_or("taken")?;
/// assert!(error.to_string().contains("ends in its unit; write `width_rad`. Its parameters are"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn effects_of(device: &Device) -> Result<Vec<OwnEffect>, DeviceEffectError> {
    if device.effects.is_empty() {
        return Ok(Vec::new());
    }
    let entries = device.effects.iter().enumerate();
    entries
        .map(|(index, entry)| resolved(device, index, entry))
        .collect()
}

fn resolved(
    device: &Device,
    index: usize,
    entry: &DeviceEffect,
) -> Result<OwnEffect, DeviceEffectError> {
    let label = entry.label();
    if entry.name == correction::NAME {
        let (effect, range) = correction::resolved(device, index, entry)?;
        return Ok(OwnEffect {
            index,
            effect,
            values: Some(range),
            further: Vec::new(),
        });
    }
    let spec = spec_of(entry)?;
    if let Some(key) = entry.lists.keys().next() {
        return Err(DeviceEffectError::Parameter {
            label,
            key: key.clone(),
            nearest: None,
            known: known(spec),
        });
    }
    let is_it = |effect: &dyn Effect| {
        let number = |joint: usize| (joint + 1) as f64;
        let from = effect.other_joint().map(number);
        let cable = effect.further_cable().map(number);
        effect.spec() == spec
            && effect.joint() == entry.joint
            && (from.is_none() || from == entry.numbers.get("from_joint").copied())
            && (cable.is_none() || cable == entry.numbers.get("cable").copied())
    };
    let mut all = everywhere(device).into_iter();
    let Some(effect) = all.find(|effect| is_it(effect.as_ref())) else {
        return Err(refused_place(device, entry, spec));
    };
    // an event happens more than once: it has an instant
    let is_again = |other: &DeviceEffect| {
        let same = |key: &str| other.numbers.get(key) == entry.numbers.get(key);
        other.name == entry.name
            && other.joint == entry.joint
            && ["time_s", "order", "from_joint", "from_run", "cable"]
                .into_iter()
                .all(same)
            && spec_of(other).is_ok_and(|own| own == spec)
    };
    if device.effects[..index].iter().any(is_again) {
        return Err(DeviceEffectError::Twice { label });
    }
    let values = values_of(entry, spec)?;
    let number = |name: &str| entry.numbers.get(name).copied();
    let further = spec.further.iter().map(|further| {
        let stated = number(further.name).or(further.default);
        match stated {
            Some(value) => Ok(value),
            // a fit finds it, or the recording has it
            None if values.is_none() => Ok(f64::NAN),
            None => Err(DeviceEffectError::Missing {
                label: label.clone(),
                key: further.name,
                known: known(spec),
            }),
        }
    });
    let further = further.collect::<Result<Vec<f64>, _>>()?;
    Ok(OwnEffect {
        index,
        effect,
        values,
        further,
    })
}

/// Numbers that say where an effect is, not how large.
pub const PLACES: [&str; 4] = ["from_joint", "order", "cable", "from_run"];

pub(super) fn is_place(name: &str) -> bool {
    PLACES.contains(&name)
}

/// Every effect at every place of a device.
fn everywhere(device: &Device) -> Vec<Box<dyn Effect>> {
    let mut all = catalogue(device);
    all.extend(drive_catalogue(device));
    all
}

/// The one of the specs of a name whose parameters the entry has.
fn spec_of(entry: &DeviceEffect) -> Result<&'static Spec, DeviceEffectError> {
    let named: Vec<&'static Spec> = specs().filter(|spec| spec.name == entry.name).collect();
    let Some(first) = named.first() else {
        return Err(DeviceEffectError::Unknown {
            name: entry.name.clone(),
            nearest: nearest(&entry.name, &names()),
        });
    };
    let lawful = || named.iter().copied().filter(|spec| is_law(spec).is_ok());
    if let (None, Err(why)) = (lawful().next(), is_law(first)) {
        let name = entry.name.clone();
        return Err(DeviceEffectError::NoLaw { name, why });
    }
    let has = |spec: &Spec, key: &str| spec.parameter(key).is_some() || is_further(spec, key);
    let keys = || entry.numbers.keys();
    let fits = |spec: &&&'static Spec| {
        let needed = spec
            .parameters
            .iter()
            .all(|own| entry.numbers.contains_key(own.name) || entry.numbers.is_empty());
        keys().all(|key| has(spec, key)) && needed
    };
    let all: Vec<&'static Spec> = lawful().collect();
    // of several that the keys fit, the one of which none is missing
    let is_whole = |spec: &&&'static Spec| {
        let has = |own: &Further| own.default.is_some() || entry.numbers.contains_key(own.name);
        fits(spec) && spec.further.iter().all(has)
    };
    if let Some(spec) = all.iter().find(is_whole).or_else(|| all.iter().find(fits)) {
        return Ok(spec);
    }
    // the one that most keys are of says what is wrong
    let known_keys = |spec: &&'static Spec| keys().filter(|key| has(spec, key)).count();
    let likeliest = all.iter().copied().max_by_key(known_keys).unwrap_or(first);
    let label = entry.label();
    if let Some(key) = keys().find(|key| !has(likeliest, key)) {
        let all = likeliest.parameters.iter().map(|own| own.name);
        let all: Vec<&str> = all
            .chain(likeliest.further.iter().map(|own| own.name))
            .collect();
        let with_unit = all.iter().find(|name| lacks_unit(key, name));
        let with_unit = with_unit.map(|name| (*name).to_owned());
        return Err(DeviceEffectError::Parameter {
            label,
            key: key.clone(),
            nearest: with_unit.or_else(|| nearest(key, &all)),
            known: known(likeliest),
        });
    }
    Ok(likeliest)
}

fn is_further(spec: &Spec, key: &str) -> bool {
    spec.further.iter().any(|further| further.name == key)
}

/// Names of all parameters.
fn known(spec: &Spec) -> String {
    let reported = spec.parameters.iter().map(|own| own.name);
    let all = reported.chain(spec.further.iter().map(|own| own.name));
    all.collect::<Vec<&str>>().join(", ")
}

/// The reported parameters; none where a fit is to find them.
fn values_of(
    entry: &DeviceEffect,
    spec: &'static Spec,
) -> Result<Option<Vec<f64>>, DeviceEffectError> {
    let mut stated = spec.parameters.iter().filter(|own| !is_place(own.name));
    if entry.fit && !stated.any(|own| entry.numbers.contains_key(own.name)) {
        return Ok(None);
    }
    let value = |own: &Parameter| {
        let value = entry.numbers.get(own.name).copied();
        let value = value.ok_or_else(|| DeviceEffectError::Missing {
            label: entry.label(),
            key: own.name,
            known: known(spec),
        })?;
        let refuse = |allowed| {
            Err(DeviceEffectError::Number {
                label: entry.label(),
                key: own.name.to_owned(),
                value,
                allowed,
            })
        };
        match own.role {
            Role::Inverse if value <= 0.0 => refuse("it must be above zero"),
            Role::Transition if value <= 0.0 => refuse("it must be above zero"),
            Role::Size if spec.is_positive && value < 0.0 => refuse("it is not negative"),
            Role::Number if value < 0.0 => refuse("it is not negative"),
            _ => Ok(value),
        }
    };
    let values: Result<Vec<f64>, DeviceEffectError> = spec.parameters.iter().map(value).collect();
    values.map(Some)
}

/// Why a device cannot have an effect there.
fn refused_place(device: &Device, entry: &DeviceEffect, spec: &Spec) -> DeviceEffectError {
    let label = entry.label();
    let all = everywhere(device);
    let own: Vec<_> = all
        .iter()
        .filter(|effect| effect.name() == spec.name)
        .collect();
    let at_joints = own.iter().any(|effect| effect.joint().is_some());
    let why = match entry.joint {
        None if entry.numbers.contains_key("cable") => {
            let cables = device.cables.len();
            format!(
                "this device has {cables} cables: give the number of one as `cable`, or leave it out for the first"
            )
        }
        None if at_joints => "it is of a joint: give `joint`, from 1".to_owned(),
        Some(_) if !own.is_empty() && !at_joints => {
            "it is of the whole device: leave `joint` out".to_owned()
        }
        Some(_) if entry.numbers.contains_key("order") => {
            "its `order` is none that is fitted at that joint".to_owned()
        }
        Some(joint) if own.iter().any(|effect| effect.joint() == Some(joint)) => {
            let joints = device.joints.len();
            format!("give `from_joint`, another joint from 1 to {joints}")
        }
        Some(joint) => {
            let own = &device.joints[joint];
            let kind = match (own.transmission, own.joint_type) {
                (haptical_model::TransmissionKind::Direct, _) => {
                    "has a direct drive, without drums"
                }
                (_, haptical_model::JointType::Prismatic) => "slides",
                _ => "has another drive",
            };
            format!("joint {} {kind}, and cannot have it", joint + 1)
        }
        None => "this device cannot have it".to_owned(),
    };
    DeviceEffectError::Place { label, why }
}

/// Likeness (Jaro & Winkler's) from which a name is offered in place of another.
const LIKENESS: f64 = 0.75;

fn nearest(name: &str, names: &[&str]) -> Option<String> {
    let likeness = |other: &str| strsim::jaro_winkler(name, other);
    let best = names
        .iter()
        .max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
    best.filter(|other| likeness(other) > LIKENESS)
        .map(|other| (*other).to_owned())
}
