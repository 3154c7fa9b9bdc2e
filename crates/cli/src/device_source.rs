//! Reads the device that a command was given: TOML or URDF, with the sensors of a rig file.

use std::path::{Path, PathBuf};

use clap::Args;
use haptical_model::{Device, read_toml_text};
use haptical_urdf::{BaseAndTip, device_from_urdf, read_urdf_text};

use crate::failure::Failure;
use crate::input_files::{Fingerprint, InputFile, Source};
use crate::inputs::{DeviceInput, InputDrumDenominators, read_equipped_device};

/// Flags beside `--device`.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct DeviceOptions {
    #[command(flatten)]
    pub(crate) chain: ChainOptions,
    /// Sensors around the device (TOML: `[cable_encoder]`, `[[cable]]`, `[tracker]`, `[[contact_pair]]`,
    /// `[gravity]`), in the place of the device file's
    #[arg(long, value_name = "FILE")]
    pub(crate) rig: Option<PathBuf>,
}

/// Links between which the chain of a URDF runs.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct ChainOptions {
    /// Link at which the chain of a URDF begins, frame (-1), such as the other hand; without it the root link;
    /// needs --tip
    #[arg(long, value_name = "LINK")]
    pub(crate) base: Option<String>,
    /// Link at which the chain of a URDF ends; without it the longest chain is taken
    #[arg(long, value_name = "LINK")]
    pub(crate) tip: Option<String>,
}

impl ChainOptions {
    /// As the library takes them.
    pub(crate) fn ends(&self) -> BaseAndTip<'_> {
        BaseAndTip {
            base: self.base.as_deref(),
            tip: self.tip.as_deref(),
        }
    }

    /// The flags, as results record them.
    pub(crate) fn flags(&self) -> impl Iterator<Item = String> {
        let base = self.base.iter().map(|base| format!("--base={base}"));
        base.chain(self.tip.iter().map(|tip| format!("--tip={tip}")))
    }
}

/// Text of a device file, from whatever was given, and what is odd about it.
pub(crate) struct DeviceText {
    pub(crate) text: String,
    pub(crate) warnings: Vec<String>,
}

/// Whether a file is a URDF, by its name.
pub(crate) fn is_urdf(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("urdf"))
}

/// The device file's text, the rig's sensors in it; that of a URDF is written anew.
pub(crate) fn read_device_text(
    path: &Path,
    ends: BaseAndTip<'_>,
    rig: Option<&Path>,
) -> Result<DeviceText, Failure> {
    let name = path.display().to_string();
    let refuse = |error: &_| Failure::device_file(error, path);
    let (mut text, mut warnings) = if is_urdf(path) {
        let refuse_urdf = |error| Failure::urdf(&error, path);
        let urdf = read_urdf_text(path).map_err(refuse_urdf)?;
        let read = device_from_urdf(&urdf, &name, ends).map_err(refuse_urdf)?;
        let text = read.device.to_new_toml().map_err(|error| refuse(&error))?;
        (text, read.warnings)
    } else {
        let flags = [("--base", ends.base), ("--tip", ends.tip)];
        if let Some((flag, _)) = flags.iter().find(|(_, link)| link.is_some()) {
            return Err(Failure::command_line(
                "arguments",
                format!("{flag} names a link of a URDF, and {name} is none"),
                format!("leave {flag} out, or give a .urdf file"),
            ));
        }
        (
            read_toml_text(path).map_err(|error| refuse(&error))?,
            Vec::new(),
        )
    };
    if let Some(rig) = rig {
        let refuse_rig = |error: &_| Failure::device_file(error, rig);
        let rig_text = read_toml_text(rig).map_err(|error| refuse_rig(&error))?;
        let rig_name = rig.display().to_string();
        // its own faults first, at its own places
        Device::from_toml(&text, &name).map_err(|error| refuse(&error))?;
        let merged = Device::with_rig(&text, &name, &rig_text, &rig_name);
        let (merged, odd) = merged.map_err(|error| refuse_rig(&error))?;
        text = merged;
        warnings.extend(odd);
    }
    Ok(DeviceText { text, warnings })
}

/// The ends of a URDF's chain and a rig file with the name that results give it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Equipment {
    pub(crate) chain: ChainOptions,
    pub(crate) rig: Option<Source>,
}

impl DeviceOptions {
    /// As given on the command line.
    pub(crate) fn equipment(&self) -> Equipment {
        Equipment {
            chain: self.chain.clone(),
            rig: self.rig.as_deref().map(Source::given),
        }
    }
}

impl Equipment {
    /// Reads a device with this equipment; returns the files that were read too, the device first.
    pub(crate) fn read(
        &self,
        flag: &str,
        device: &Source,
        denominators: InputDrumDenominators,
    ) -> Result<(DeviceInput, Vec<InputFile>), Failure> {
        let rig = self.rig.as_ref();
        let rig_path = rig.map(|rig| rig.path.as_path());
        let ends = self.chain.ends();
        let mut input = read_equipped_device(&device.path, ends, rig_path, denominators)?;
        let mut files = vec![device.input(flag, device.fingerprint_device(&mut input))];
        if let Some(rig) = rig {
            rig.relabel(&mut input.warnings);
            let fingerprint = Fingerprint::of_file(&rig.path).map_err(Failure::internal)?;
            files.push(rig.input("rig", fingerprint));
        }
        Ok((input, files))
    }
}
