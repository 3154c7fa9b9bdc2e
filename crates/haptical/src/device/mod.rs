//! Devices with the text, the files and the warnings that they came with.

mod text;

use std::path::Path;

use haptical_model::{Device as Model, Missing};
use haptical_urdf::BaseAndTip;

pub(crate) use self::text::{is_description, read_chain};
pub use self::text::{is_mjcf, is_urdf};
use self::text::{read, with_denominators};
use crate::error::Error;
use crate::files::{InputFile, Source};

/// A device, read once and used many times.
#[derive(Debug, Clone)]
pub struct Device {
    /// The device as numbers.
    pub model: Model,
    /// What is odd about its file.
    pub warnings: Vec<String>,
    text: String,
    source: Source,
    equipment: Equipment,
    files: Vec<InputFile>,
}

/// What a device is read with: the ends of a URDF's chain, sensors, numbers in the place of the file's.
#[derive(Debug, Clone, Default)]
pub struct Equipment {
    /// Link at which the chain of a URDF begins; none for the root link. It needs a tip.
    pub base: Option<String>,
    /// Link at which the chain of a URDF ends; none for the end of the longest chain.
    pub tip: Option<String>,
    /// Further links that are measured, each a hand of a device that branches; they need a tip.
    pub further_tips: Vec<String>,
    /// File with sensors that take the place of the device file's.
    pub rig: Option<Source>,
    /// Input drum denominators of equation (1).
    pub denominators: InputDrumDenominators,
}

/// Input drum denominators that replace the device file's.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum InputDrumDenominators {
    /// The file's.
    #[default]
    Stated,
    /// One for all joints with drums.
    Same(f64),
    /// 2.9 mm, joint 4: 2.6 mm, as the paper's tables imply.
    Paper,
}

impl InputDrumDenominators {
    fn for_joint(self, joint: usize) -> Option<f64> {
        match (self, joint) {
            (Self::Stated, _) => None,
            (Self::Same(length_m), _) => Some(length_m),
            (Self::Paper, 3) => Some(2.6e-3),
            (Self::Paper, _) => Some(2.9e-3),
        }
    }
}

impl Equipment {
    /// The ends as the reader of URDFs takes them.
    pub fn ends(&self) -> BaseAndTip<'_> {
        BaseAndTip {
            base: self.base.as_deref(),
            tip: self.tip.as_deref(),
            further_tips: &self.further_tips,
        }
    }

    /// The flags of the chain's ends, as results record them.
    pub fn chain_flags(&self) -> impl Iterator<Item = String> {
        let base = self.base.iter().map(|base| format!("--base={base}"));
        let tips = self.tip.iter().chain(&self.further_tips);
        base.chain(tips.map(|tip| format!("--tip={tip}")))
    }
}

impl Device {
    /// Reads a device file, TOML or, where its name ends in `.urdf` or `.xml`, URDF or MJCF: there the longest chain from
    /// the root link or the world is the device.
    ///
    /// # Errors
    /// A file that cannot be read, or that is no device file; the place is in the error.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::open(&Source::given(path.as_ref()), &Equipment::default())
    }

    /// Reads the chain of a URDF from its root link to `tip`.
    ///
    /// # Errors
    /// As [`Device::load`], and a link that is not there.
    pub fn from_urdf(path: impl AsRef<Path>, tip: &str) -> Result<Self, Error> {
        let equipment = Equipment {
            tip: Some(tip.to_owned()),
            ..Equipment::default()
        };
        Self::open(&Source::given(path.as_ref()), &equipment)
    }

    /// Reads the text of a device file (TOML); messages call the file by `name`.
    ///
    /// # Errors
    /// A text that is no device file.
    pub fn from_toml(text: &str, name: &str) -> Result<Self, Error> {
        Self::open(&Source::text(text, name), &Equipment::default())
    }

    /// Names of the columns of a log that hold the joints' readings: `theta1_rad`.
    pub(crate) fn joint_columns(&self) -> Vec<String> {
        let joints = self.model.joints.iter().zip(1..);
        let columns = joints.map(|(joint, number)| format!("theta{number}_{}", joint.unit()));
        columns.collect()
    }

    /// Which row each number in a parameter's name stands for, where the joints have names of their own; else empty.
    pub(crate) fn named_rows(&self) -> String {
        let joints = self.model.joints.iter().enumerate();
        let named: Vec<String> = joints
            .filter(|(_, joint)| joint.has_own_name())
            .filter_map(|(index, joint)| {
                let row = self.model.own_row(index)?;
                Some(format!("{row} is `{}`", joint.name))
            })
            .collect();
        let named = named.join(", ");
        match named.as_str() {
            "" => named,
            _ => format!("The number in a parameter's name is its row: 0 is the base, {named}."),
        }
    }

    /// What of the model's poses only an unknown tracker fixes; nothing where its place and what it sees are known.
    ///
    /// Such a recording is the same for an arm that is moved or turned as a whole, and for another flange: docs/equations.md,
    /// tracker in its own frame.
    pub(crate) fn relative_to_tracker(&self) -> Option<String> {
        let tracker = self.model.tracker?;
        let around = &self.model.surroundings;
        let is_fitted = around.tracker_base.is_some()
            || around.tracker_tool.is_some()
            || !around.run_bases.is_empty();
        let stand = "where the tracker stands was fitted with the arm, so all poses may be moved and turned on the true arm as one \
                     piece";
        let seen = "what the tracker sees was fitted with the arm, so the handle may sit elsewhere on it, and a path that turns \
                    the handle may have another shape";
        let what = match (tracker.base_known, tracker.tool_known) {
            _ if !is_fitted => return None,
            (true, true) => return None,
            (false, true) => stand.to_owned(),
            (true, false) => seen.to_owned(),
            (false, false) => format!("{stand}; {seen}"),
        };
        Some(format!(
            "{what}: measure that place, or touch known points, to fix it"
        ))
    }

    /// Reads a device with its equipment.
    ///
    /// # Errors
    /// As [`Device::load`], of the device file and of the rig file.
    pub fn open(source: &Source, equipment: &Equipment) -> Result<Self, Error> {
        let name = source.name();
        let parse = |text: &str| {
            Model::from_toml(text, &name).map_err(|error| Error::device_file(&error, &source.path))
        };
        let mut read = read(source, equipment)?;
        let mut loaded = parse(&read.text)?;
        read.warnings.append(&mut loaded.warnings);
        if equipment.denominators != InputDrumDenominators::Stated {
            let denominators = equipment.denominators;
            read.text = with_denominators(&read.text, &loaded.device, denominators, &name)?;
            loaded = parse(&read.text)?;
        }
        let mut model = loaded.device;
        // a device without a name is called by its file
        if model.name == name {
            model.name.clone_from(&source.label);
        }
        Error::refuse_effects(&model, &read.text, &source.path)?;
        if !is_description(&source.path) {
            // a description names its links itself
            read.warnings.extend(said_of_no_body(&model, &name));
        }
        source.relabel(&mut read.warnings);
        let own = source.input("device", source.fingerprint_text(&read.text));
        Ok(Self {
            model,
            warnings: read.warnings,
            text: read.text,
            source: source.clone(),
            equipment: equipment.clone(),
            files: std::iter::once(own).chain(read.rig).collect(),
        })
    }

    /// Reads another model of this device: the chain of a URDF runs between the same links as this device's.
    ///
    /// # Errors
    /// As [`Device::load`].
    pub fn open_model(&self, source: &Source) -> Result<Self, Error> {
        let equipment = match source.text.is_none() && is_description(&source.path) {
            true => Equipment {
                rig: None,
                denominators: InputDrumDenominators::Stated,
                ..self.equipment.clone()
            },
            false => Equipment::default(),
        };
        Self::open(source, &equipment)
    }

    /// Refuses a device with several hands for what is made of one chain; `what` says it.
    ///
    /// # Errors
    /// The device has hands.
    pub fn refuse_hands(&self, what: &str) -> Result<(), Error> {
        if !self.model.has_hands() {
            return Ok(());
        }
        let hands = self.model.hands.iter().map(|hand| hand.name.as_str());
        let hands = hands.collect::<Vec<_>>().join(", ");
        let what = format!("the device has the hands {hands}, and {what} is of one chain");
        let next = "give a device of one of them: of a URDF with one --tip, of a device file without the rows of the others and \
                    without [[hand]]";
        Err(Error::in_file(
            "several-hands",
            what,
            &self.source.path,
            next,
        ))
    }

    /// The text of its device file, TOML; a URDF's is written anew.
    pub fn to_toml(&self) -> &str {
        &self.text
    }

    /// Its origin.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// What it was read with.
    pub fn equipment(&self) -> &Equipment {
        &self.equipment
    }

    /// The files that it was read from: its own, given by `flag`, and the rig's.
    pub fn inputs(&self, flag: &str) -> Vec<InputFile> {
        let mut files = self.files.clone();
        if let Some(own) = files.first_mut() {
            flag.clone_into(&mut own.flag);
        }
        files
    }
}

/// Inertias of a device file that no body has.
fn said_of_no_body(model: &Model, file: &str) -> Vec<String> {
    // a device of transmissions alone has no rows
    let found = Missing::bodies(model).unwrap_or_default();
    let said = found.iter().map(|own| {
        format!(
            "{file}: {own}: correct it; a diagnosis and an export take a plausible one, and `simulate --forward` refuses it"
        )
    });
    said.collect()
}

/// The model must be of the same device: the same joints, in the same order, on as many links.
///
/// # Errors
/// It is not; `path` is the model's.
pub fn refuse_other_device(nominal: &Model, model: &Model, path: &Path) -> Result<(), Error> {
    let mut pairs = nominal.joints.iter().zip(&model.joints);
    let counts = |device: &Model| [device.joints.len(), device.links.len()];
    let hands = |device: &Model| -> Vec<(String, usize)> {
        let hands = device.hands.iter();
        hands.map(|hand| (hand.name.clone(), hand.row)).collect()
    };
    let counts = counts(nominal).into_iter().zip(counts(model));
    let mut counts = counts.zip(["joints", "links"]);
    let other = counts.find(|((wanted, got), _)| wanted != got);
    let what = if let Some(((wanted, got), what)) = other {
        format!("the model has {got} {what}, the device has {wanted}")
    } else if nominal.convention != model.convention {
        "the model has another convention of its links than the device".to_owned()
    } else if nominal.parents != model.parents {
        "the model's rows branch in another way than the device's".to_owned()
    } else if hands(nominal) != hands(model) {
        "the model has other hands than the device".to_owned()
    } else if let Some(joint) = pairs.position(|(own, other)| own.joint_type != other.joint_type) {
        let number = joint + 1;
        format!("joint {number} turns in one of model and device and slides in the other")
    } else {
        return Ok(());
    };
    let next = "give the identified.toml of this device";
    Err(Error::in_file("other-device", what, path, next))
}
