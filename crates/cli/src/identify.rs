//! `haptical identify`: values, intervals and reasons of a device's parameters, as files.

use std::path::Path;

use haptical::files::{Overwrite, ResultKind};
use haptical::identify_as;

use crate::arguments::IdentifyArguments;
use crate::failure::Failure;
use crate::result::{self, Inputs, MadeResult, ResultCommand};
use crate::terminal::Progress;

/// Runs the command.
pub(crate) fn run(arguments: &IdentifyArguments) -> Result<(), Failure> {
    result::run(arguments, Some(&arguments.out), arguments.json, |paths| {
        let lines = paths.iter().map(|path| format!("  {path}\n"));
        format!("\nWritten:\n{}", lines.collect::<String>())
    })
}

impl ResultCommand for IdentifyArguments {
    fn kind(&self) -> ResultKind {
        ResultKind::IDENTIFICATION
    }

    fn overwrite(&self) -> Overwrite {
        self.overwrite.overwrite()
    }

    fn inputs(&self) -> Vec<(&'static str, &Path)> {
        result::given(&[
            ("device", Some(&self.device)),
            ("log", Some(&self.log)),
            ("rig", self.device_options.rig.as_ref()),
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
        progress.say(format!("calibrating {joints} joints from {rows} rows"));
        let mut request = self.request();
        request.with_causes = inputs.optional("with").cloned();
        let found = identify_as(version, &device, &log, &request)?;
        Ok(MadeResult {
            files: found.files()?,
            warnings: found.warnings().to_vec(),
            summary: found.to_string(),
        })
    }
}
