//! `haptical diagnose`: the effect that causes what a calibration leaves, as a page and as JSON.

use std::path::Path;

use haptical::{Diagnose, Diagnosed, diagnose_as};

use crate::arguments::DiagnoseArguments;
use crate::failure::Failure;
use crate::result::{self, Inputs, MadeResult, ResultCommand};
use crate::terminal::Progress;

/// Runs the command.
pub(crate) fn run(arguments: &DiagnoseArguments) -> Result<(), Failure> {
    result::run(arguments, Some(&arguments.out), arguments.json, |paths| {
        format!("{:<9}{}\n", "written", paths.join("  "))
    })
}

impl ResultCommand for DiagnoseArguments {
    fn name(&self) -> &'static str {
        "diagnose"
    }

    fn files(&self) -> &'static [&'static str] {
        &Diagnosed::FILES
    }

    fn result_file(&self) -> &'static str {
        Diagnosed::FILES[0]
    }

    fn inputs(&self) -> Vec<(&'static str, &Path)> {
        result::given(&[
            ("device", Some(&self.device)),
            ("log", Some(&self.log)),
            ("rig", self.device_options.rig.as_ref()),
            ("model", self.model.as_ref()),
            ("validate", self.validate.as_ref()),
        ])
    }

    fn make(
        &self,
        version: &str,
        inputs: &Inputs,
        progress: &Progress,
    ) -> Result<MadeResult, Failure> {
        let device = inputs.device(self.device_options.equipment())?;
        let log = inputs.log(&device)?;
        let model = inputs.model()?;
        let second = inputs.optional_log("validate", &device)?;
        let (joints, rows) = (device.model.joints.len(), log.recording.len());
        progress.say(format!("diagnosing {joints} joints from {rows} rows"));
        let request = Diagnose {
            without: self.without.clone(),
            model: model.as_ref(),
            validate: second.as_ref(),
            ..Diagnose::default()
        };
        let gap = diagnose_as(version, &device, &log, &request)?;
        Ok(MadeResult {
            files: gap.files()?,
            warnings: gap.warnings().to_vec(),
            summary: gap.to_string(),
        })
    }
}
