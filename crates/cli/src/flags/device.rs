//! Flags that go with `--device`: the chain of a URDF or an MJCF, a rig file.

use std::path::{Path, PathBuf};

use clap::Args;
use haptical::files::{Source, shell_word};
use haptical::{Device, Equipment};

use crate::failure::Failure;

/// Flags that go with `--device`.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct DeviceOptions {
    #[command(flatten)]
    pub(crate) chain: ChainOptions,
    /// Sensors around the device (TOML: `[cable_encoder]`, `[[cable]]`, `[tracker]`, `[[contact_pair]]`,
    /// `[gravity]`), in the place of the device file's
    #[arg(long, value_name = "FILE")]
    pub(crate) rig: Option<PathBuf>,
}

/// Links between which the chain of a URDF or an MJCF runs.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct ChainOptions {
    /// Link of a URDF or body of an MJCF at which the chain begins, frame (-1), such as the other hand; without it the
    /// root link or the world; needs --tip
    #[arg(long, value_name = "LINK")]
    pub(crate) base: Option<String>,
    /// Link of a URDF, or body or site of an MJCF, at which the chain ends; without it the longest chain is taken. Repeated, as in --tip left_hand
    /// --tip right_hand, each is a hand of one device, whose chains share what they have in common
    #[arg(long, value_name = "LINK")]
    pub(crate) tip: Vec<String>,
}

/// A path as a word of a command line.
pub(crate) fn word(path: &Path) -> String {
    shell_word(&path.display().to_string())
}

impl DeviceOptions {
    /// As the library takes them.
    pub(crate) fn equipment(&self) -> Equipment {
        Equipment {
            base: self.chain.base.clone(),
            tip: self.chain.tip.first().cloned(),
            further_tips: self.chain.tip.iter().skip(1).cloned().collect(),
            rig: self.rig.as_deref().map(Source::given),
            ..Equipment::default()
        }
    }

    /// Reads a device that results and messages call by its name.
    pub(crate) fn read(&self, device: &Path) -> Result<Device, Failure> {
        Device::open(&Source::given(device), &self.equipment())
    }

    /// The flags as one would type them, with that of the device file; a blank before each.
    pub(crate) fn typed(&self, device: &Path) -> String {
        let own = std::iter::once(format!(" --device {}", word(device)));
        let rig = self.rig.iter().map(|rig| format!(" --rig {}", word(rig)));
        own.chain(rig).chain([self.typed_chain()]).collect()
    }

    /// Of them those that say which part of a robot description it is.
    pub(crate) fn typed_chain(&self) -> String {
        let named = |flag: &str, link: &String| format!(" --{flag} {}", shell_word(link));
        let base = self.chain.base.iter().map(|link| named("base", link));
        let tips = self.chain.tip.iter().map(|link| named("tip", link));
        base.chain(tips).collect()
    }

    /// Reads a device that messages call by its whole path.
    pub(crate) fn read_by_path(&self, device: &Path) -> Result<Device, Failure> {
        let equipment = Equipment {
            rig: self.rig.as_deref().map(Source::by_path),
            ..self.equipment()
        };
        Device::open(&Source::by_path(device), &equipment)
    }
}
