//! `haptical diagnose`: the effect that causes what a calibration leaves, as a page and as JSON.

use std::path::Path;

use haptical::files::ResultKind;
use haptical::{Diagnose, diagnose_as};

use crate::arguments::DiagnoseArguments;
use crate::failure::Failure;
use crate::flags::OverwriteOptions;
use crate::progress::Progress;
use crate::result::{self, Inputs, MadeResult, ResultCommand};
use crate::terminal;

/// Runs the command.
pub(crate) fn run(arguments: &DiagnoseArguments) -> Result<(), Failure> {
    result::run(arguments, Some(&arguments.out), arguments.json, &|paths| {
        format!("{:<9}{}\n", "written", paths.join("  "))
    })
}

impl ResultCommand for DiagnoseArguments {
    fn kind(&self) -> ResultKind {
        ResultKind::DIAGNOSIS
    }

    fn overwrite(&self) -> OverwriteOptions {
        self.overwrite
    }

    fn inputs(&self) -> Vec<(&'static str, &Path)> {
        let mut inputs = result::given(&[("device", Some(&self.device))]);
        inputs.extend(self.log.iter().map(|log| ("log", log.as_path())));
        inputs.extend(result::given(&[
            ("rig", self.device_options.rig.as_ref()),
            ("model", self.model.as_ref()),
            ("validate", self.validate.as_ref()),
        ]));
        inputs
    }

    fn make(
        &self,
        version: &str,
        inputs: &Inputs,
        progress: &Progress,
    ) -> Result<MadeResult, Failure> {
        let device = inputs.device(self.device_options.equipment())?;
        let log = inputs.log(&device)?;
        let further = inputs.further_logs(&device)?;
        let model = inputs.model(&device)?;
        let second = inputs.optional_log("validate", &device)?;
        let logs = std::iter::once(&log).chain(&further);
        let rows: usize = logs.map(|log| log.recording.len()).sum();
        let joints = device.model.joints.len();
        progress.say(format!("diagnosing {joints} joints from {rows} rows"));
        let request = Diagnose {
            without: self.without.clone(),
            model: model.as_ref(),
            also: further.iter().collect(),
            validate: second.as_ref(),
            loss: self.loss.choice(),
            joint_compliance: !self.with.is_empty(),
            hold: self.hold.hold.clone(),
            deviations: self.hold.deviation.clone(),
            repair: self.repair,
            ..Diagnose::default()
        };
        let gap = diagnose_as(version, &device, &log, &request)?;
        let summary = match terminal::is_one() {
            true => gap.brief(),
            false => gap.to_string(),
        };
        let next = gap.commands().into_iter();
        let next = next.map(|step| (step.label, step.command)).collect();
        Ok(MadeResult::of(gap.files()?, gap.warnings(), &summary).with_next(next))
    }
}
