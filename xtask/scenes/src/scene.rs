//! A scene: a device, its logs, and what is asked of them.

use anyhow::Result;
use haptical::calibration::{HeldOut, Options};
use haptical::files::Source;
use haptical::{Device, Equipment, Identify};

use crate::table::Table;

/// A scene by its name, made when it is asked for: the same bits each time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    /// Effects that it has and that may be named; empty for a sound device, and where the catalogue has no name.
    pub(crate) truth: &'static [&'static str],
    pub(crate) make: fn() -> Result<Made>,
}

/// A list of scenes, a row each: its name, what it has, and what makes it.
macro_rules! scenes {
    ($($name:literal $truth:tt $made:expr;)*) => {
        &[$(Scene { name: $name, truth: &$truth, make: || $made },)*]
    };
}
pub(crate) use scenes;

/// What a device is read from.
#[derive(Debug, Clone)]
pub(crate) struct DeviceFile {
    /// TOML, or what the file's name says.
    pub(crate) text: String,
    pub(crate) name: &'static str,
    pub(crate) rig: Option<String>,
    pub(crate) tips: Vec<&'static str>,
}

#[derive(Debug, Clone)]
pub(crate) enum Identified {
    Geometry(Box<Identify>),
    /// `--with dynamics`.
    Dynamics,
    /// Nothing: another scene asks it of the same log.
    Nothing,
}

#[derive(Debug, Clone)]
pub(crate) struct Made {
    pub(crate) device: DeviceFile,
    pub(crate) log: Table,
    /// `diagnose --log` once more.
    pub(crate) also: Option<Table>,
    /// `diagnose --validate`.
    pub(crate) validate: Option<Table>,
    /// A log of the same arm before anything of the scene's truth came to it, of scenes of moving arms.
    pub(crate) sound: Option<Table>,
    /// Text of `diagnose --model`.
    pub(crate) model: Option<String>,
    /// `diagnose --without`.
    pub(crate) without: Vec<&'static str>,
    /// `diagnose --with joint-compliance`.
    pub(crate) joint_compliance: bool,
    pub(crate) identify: Identified,
    /// Whether links are where the motors say: encoders on links would read as those do.
    pub(crate) links_follow: bool,
    /// Whether its device file has the true geometry.
    pub(crate) is_of_true_geometry: bool,
}

impl DeviceFile {
    /// A device file (TOML) alone.
    pub(crate) fn toml(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            name: "device.toml",
            rig: None,
            tips: Vec::new(),
        }
    }

    /// A file of the project.
    pub(crate) fn read(path: &str, name: &'static str) -> Result<Self> {
        Ok(Self {
            name,
            ..Self::toml(fixture(path)?)
        })
    }

    /// With sensors that take the place of the device's.
    pub(crate) fn rigged(mut self, rig: impl Into<String>) -> Self {
        self.rig = Some(rig.into());
        self
    }

    pub(crate) fn open(&self) -> Result<Device, haptical::Error> {
        let mut tips = self.tips.iter().map(|tip| (*tip).to_owned());
        let equipment = Equipment {
            rig: self.rig.as_ref().map(|rig| Source::text(rig, "rig.toml")),
            tip: tips.next(),
            further_tips: tips.collect(),
            ..Equipment::default()
        };
        Device::open(&Source::text(&self.text, self.name), &equipment)
    }
}

impl Made {
    /// A device and a log, asked as the command asks without flags.
    pub(crate) fn new(device: DeviceFile, log: Table) -> Self {
        Self {
            device,
            log,
            also: None,
            validate: None,
            sound: None,
            model: None,
            without: Vec::new(),
            joint_compliance: false,
            identify: Identified::Geometry(Box::default()),
            links_follow: false,
            is_of_true_geometry: false,
        }
    }

    /// The same with its logs changed, the first one first.
    pub(crate) fn with_each_log(
        &self,
        mut change: impl FnMut(&Table) -> Result<Table>,
    ) -> Result<Self> {
        Ok(Self {
            log: change(&self.log)?,
            also: self.also.as_ref().map(&mut change).transpose()?,
            validate: self.validate.as_ref().map(change).transpose()?,
            ..self.clone()
        })
    }

    pub(crate) fn without_identification(&self) -> Self {
        Self {
            identify: Identified::Nothing,
            ..self.clone()
        }
    }

    /// Whether its log is one of single postures, without time.
    pub(crate) fn is_of_postures(&self) -> bool {
        !self.log.has("t_s")
    }

    /// With `identify --folds`.
    pub(crate) fn folds(mut self, folds: usize) -> Self {
        let ask = Identify::default();
        self.identify = Identified::Geometry(Box::new(Identify {
            options: Options {
                held_out: HeldOut::Folds(folds),
                ..ask.options
            },
            ..ask
        }));
        self
    }

    /// With `--with joint-compliance`.
    pub(crate) fn with_joint_compliance(mut self) -> Self {
        self.identify = Identified::Geometry(Box::new(Identify {
            with: vec!["joint-compliance".to_owned()],
            ..Identify::default()
        }));
        self.joint_compliance = true;
        self
    }
}

/// The text of a file of the project, by its path from the project's root.
pub(crate) fn fixture(path: &str) -> Result<String> {
    use anyhow::Context as _;
    std::fs::read_to_string(root(path)).with_context(|| path.to_owned())
}

/// A file of the project.
pub(crate) fn root(path: &str) -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(path)
}
