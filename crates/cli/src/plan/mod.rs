//! `haptical plan`: which rig identifies which parameters, and the poses to measure next.

mod arguments;

use std::path::Path;

use haptical::files::{Overwrite, ResultKind};
use haptical::plan_as;
use haptical_design::Step;

pub(crate) use arguments::{PlanArguments, help};

use crate::failure::Failure;
use crate::result::{self, Inputs, MadeResult, ResultCommand};
use crate::terminal::Progress;

/// Runs the command.
pub(crate) fn run(arguments: &PlanArguments) -> Result<(), Failure> {
    let out = arguments.out.as_deref();
    if out.is_none() && arguments.poses.is_some() {
        let what = "--poses without --out: the poses have no place to go";
        return Err(Failure::command_line("arguments", what, "give --out DIR"));
    }
    result::run(arguments, out, arguments.json, |paths| {
        let lines = paths.iter().map(|path| format!("written: {path}\n"));
        lines.collect()
    })
}

impl ResultCommand for PlanArguments {
    fn kind(&self) -> ResultKind {
        ResultKind::PLAN
    }

    fn overwrite(&self) -> Overwrite {
        self.overwrite.overwrite()
    }

    fn inputs(&self) -> Vec<(&'static str, &Path)> {
        result::given(&[
            ("device", Some(&self.device)),
            ("rig", self.device_options.rig.as_ref()),
            ("log", self.log.as_ref()),
        ])
    }

    fn make(
        &self,
        version: &str,
        inputs: &Inputs,
        progress: &Progress,
    ) -> Result<MadeResult, Failure> {
        let device = inputs.device(self.device_options.equipment())?;
        let log = inputs.optional_log("log", &device)?;
        let step = |step: Step<'_>| {
            progress.say(match step {
                Step::Rig(name) => format!("rig {name}"),
                Step::Choosing { poses, candidates } => {
                    format!("choosing {poses} of {candidates} poses")
                }
            });
        };
        let request = self.request(&device)?;
        let plan = plan_as(version, &device, &request, log.as_ref(), &step)?;
        Ok(MadeResult {
            files: plan.files()?,
            warnings: plan.warnings.clone(),
            summary: plan.to_string(),
        })
    }
}
