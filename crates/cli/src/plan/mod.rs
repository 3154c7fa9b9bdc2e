//! `haptical plan`: which rig identifies which parameters, and the poses to measure next.

mod arguments;

use std::path::Path;

use haptical::files::{ResultKind, Source};
use haptical::{Device, GapFile, Log, plan_as, settle_as};
use haptical_design::Step;

pub(crate) use arguments::{PlanArguments, help};

use crate::failure::Failure;
use crate::flags::OverwriteOptions;
use crate::progress::Progress;
use crate::result::{self, Inputs, MadeResult, ResultCommand};

/// Runs the command.
pub(crate) fn run(arguments: &PlanArguments) -> Result<(), Failure> {
    let out = arguments.out.as_deref();
    if out.is_none() && arguments.poses.is_some() {
        let said = "--poses without --out: the poses have no place to go; give --out DIR";
        return Err(Failure::arguments(said));
    }
    result::run(arguments, out, arguments.json, &|paths| {
        let lines = paths.iter().map(|path| format!("written: {path}\n"));
        lines.collect()
    })
}

impl ResultCommand for PlanArguments {
    fn kind(&self) -> ResultKind {
        ResultKind::PLAN
    }

    fn overwrite(&self) -> OverwriteOptions {
        self.overwrite
    }

    fn inputs(&self) -> Vec<(&'static str, &Path)> {
        let mut inputs = result::given(&[
            ("device", Some(&self.device)),
            ("rig", self.device_options.rig.as_ref()),
            ("settle", self.settle.as_ref()),
        ]);
        inputs.extend(self.log.iter().map(|log| ("log", log.as_path())));
        inputs
    }

    fn make(
        &self,
        version: &str,
        inputs: &Inputs,
        progress: &Progress,
    ) -> Result<MadeResult, Failure> {
        let device = inputs.device(self.device_options.equipment())?;
        if let Some(gap) = inputs.optional("settle") {
            return self.settled(version, &device, gap, inputs, progress);
        }
        if self.log.len() > 1 {
            let said = "--log is given more than once: a plan of rigs adds to one log; give one log, or --settle for the logs of \
                        a diagnosis";
            return Err(Failure::arguments(said));
        }
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
        Ok(MadeResult::of(plan.files()?, &plan.warnings, &plan))
    }
}

impl PlanArguments {
    /// The recording that settles a diagnosis.
    fn settled(
        &self,
        version: &str,
        device: &Device,
        gap: &Source,
        inputs: &Inputs,
        progress: &Progress,
    ) -> Result<MadeResult, Failure> {
        let gap = GapFile::open(gap)?;
        let first = inputs.log(device)?;
        let further = inputs.further_logs(device)?;
        let logs: Vec<&Log> = std::iter::once(&first).chain(&further).collect();
        let (request, candidates) = (self.settling(), gap.question().candidates.len());
        let motions = request.candidates;
        progress.say(format!(
            "telling {candidates} candidates apart by {motions} motions"
        ));
        let settled = settle_as(version, device, &logs, &gap, &request)?;
        Ok(MadeResult::of(
            settled.files()?,
            &settled.warnings,
            &settled,
        ))
    }
}
