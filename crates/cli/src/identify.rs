//! `haptical identify`: values, intervals and reasons of a device's parameters, as files.

use std::path::Path;

use haptical::files::ResultKind;
use haptical::{DYNAMICS, identify_as, identify_dynamics_as, is_urdf};

use crate::arguments::IdentifyArguments;
use crate::failure::Failure;
use crate::flags::{OverwriteOptions, word};
use crate::progress::Progress;
use crate::result::{self, Inputs, MadeResult, ResultCommand};

/// Runs the command.
pub(crate) fn run(arguments: &IdentifyArguments) -> Result<(), Failure> {
    result::run(arguments, Some(&arguments.out), arguments.json, &|paths| {
        let lines = paths.iter().map(|path| format!("  {path}\n"));
        let written = lines.collect::<String>();
        format!("\nWritten:\n{written}\nNext:\n{}", arguments.diagnosis())
    })
}

impl ResultCommand for IdentifyArguments {
    fn kind(&self) -> ResultKind {
        ResultKind::IDENTIFICATION
    }

    fn as_identification(&self) -> Option<&IdentifyArguments> {
        let is_of_dynamics = self.with.iter().any(|word| word == DYNAMICS);
        (!is_of_dynamics).then_some(self)
    }

    fn overwrite(&self) -> OverwriteOptions {
        self.overwrite
    }

    fn inputs(&self) -> Vec<(&'static str, &Path)> {
        result::given(&[
            ("device", Some(&self.device)),
            ("log", Some(&self.log)),
            ("rig", self.device_options.rig.as_ref()),
            ("validate", self.validate.as_ref()),
        ])
        .into_iter()
        .chain(self.causes().map(|path| ("with", path)))
        .collect()
    }

    fn make(
        &self,
        version: &str,
        inputs: &Inputs,
        progress: &Progress,
    ) -> Result<MadeResult, Failure> {
        let device = inputs.device(self.equipment())?;
        let log = inputs.log(&device)?;
        let (joints, rows) = (device.model.joints.len(), log.recording.len());
        if self.is_of_dynamics()? {
            progress.say(format!("identifying {joints} joints from {rows} rows"));
            let validate = inputs.optional_log("validate", &device)?;
            let found =
                identify_dynamics_as(version, &device, &log, validate.as_ref(), self.band_hz)?;
            let made = MadeResult::of(found.files()?, found.warnings(), &found);
            return Ok(made.with_next(self.export(device.model.has_links())));
        }
        progress.say(format!("calibrating {joints} joints from {rows} rows"));
        let mut request = self.request();
        request.with_causes = inputs.optional("with").cloned();
        let found = identify_as(version, &device, &log, &request)?;
        let made = MadeResult::of(found.files()?, found.warnings(), &found);
        Ok(made.with_next(self.export(device.model.has_links())))
    }
}

impl IdentifyArguments {
    /// What one would type next.
    fn diagnosis(&self) -> String {
        let (device, log) = (self.device_options.typed(&self.device), word(&self.log));
        let (hold, gap) = (self.hold.typed(), self.next_to("gap"));
        format!("  haptical diagnose{device} --log {log}{hold} --out {gap}\n")
    }

    /// The identified device in another program's format; none of drives alone, which have no handle.
    fn export(&self, has_links: bool) -> Vec<(&'static str, String)> {
        let format = match is_urdf(&self.device) {
            true => format!(
                "urdf --urdf {}{} --out {}",
                word(&self.device),
                self.device_options.typed_chain(),
                self.next_to("calibrated.urdf")
            ),
            false => format!("rust --out {}", self.next_to("model.rs")),
        };
        let export = format!("haptical export --device identified.toml --format {format}");
        has_links.then_some(("", export)).into_iter().collect()
    }

    /// A file in the folder in which that of the result is.
    fn next_to(&self, name: &str) -> String {
        word(&self.out.with_file_name(name))
    }

    /// Whether the dynamics alone are asked for.
    fn is_of_dynamics(&self) -> Result<bool, Failure> {
        let is_asked = self.with.iter().any(|word| word == DYNAMICS);
        if is_asked && self.with.len() > 1 {
            let said = "--with dynamics is given with other effects; give `--with dynamics` alone; `haptical diagnose` names effects \
                        beside the dynamics";
            return Err(Failure::arguments(said));
        }
        let is_extra = self.validate.is_some() || self.band_hz.is_some();
        if is_extra && !is_asked {
            let said = "--validate and --band-hz belong to `--with dynamics`; leave them out: --held-out and --folds keep rows of the log \
                        out of other fits; another recording is held against a result by \
                        haptical diagnose --device DEVICE --model OUT/identified.toml --log SECOND";
            return Err(Failure::arguments(said));
        }
        Ok(is_asked)
    }
}
