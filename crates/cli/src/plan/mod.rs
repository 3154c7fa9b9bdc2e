//! `haptical plan`: which rig identifies which parameters, and the poses to measure next.

mod arguments;

use std::path::{Path, PathBuf};

use haptical::files::{Source, check_folder, check_outputs};
use haptical::{Device, Log, Planned, plan_as};
use haptical_design::Step;

pub(crate) use arguments::{PlanArguments, help};

use crate::failure::Failure;
use crate::interrupt::write_all;
use crate::terminal::{self, Progress};

/// Runs the command.
pub(crate) fn run(arguments: &PlanArguments) -> Result<(), Failure> {
    if let Some(out) = &arguments.out {
        check_folder(out)?;
        check_outputs(
            &Planned::FILES.map(|name| out.join(name)),
            &arguments.inputs(),
        )?;
    } else if arguments.poses.is_some() {
        let what = "--poses without --out: the poses have no place to go";
        return Err(Failure::command_line("arguments", what, "give --out DIR"));
    }
    let progress = Progress::start("planning");
    let equipment = arguments.device_options.equipment();
    let device = Device::open(&Source::given(&arguments.device), &equipment)?;
    let log = arguments.log.as_ref();
    let log = log.map(|path| Log::read(path, &device)).transpose()?;
    let step = |step: Step<'_>| {
        progress.say(match step {
            Step::Rig(name) => format!("rig {name}"),
            Step::Choosing { poses, candidates } => {
                format!("choosing {poses} of {candidates} poses")
            }
        });
    };
    let request = arguments.request(&device)?;
    let plan = plan_as(
        haptical::files::VERSION,
        &device,
        &request,
        log.as_ref(),
        &step,
    )?;
    let files = plan.files()?;
    let written = match &arguments.out {
        None => Vec::new(),
        Some(out) => write_all(out, &files)?,
    };
    drop(progress);
    terminal::warn(&plan.warnings);
    if arguments.json {
        return terminal::write_output(&files[0].1);
    }
    let mut text = plan.to_string();
    for path in written {
        text.push_str(&format!("written: {}\n", path.display()));
    }
    terminal::write_output(text.as_bytes())
}

impl PlanArguments {
    /// The files that are read.
    fn inputs(&self) -> Vec<&Path> {
        let further = [&self.device_options.rig, &self.log];
        std::iter::once(&self.device)
            .chain(further.into_iter().flatten())
            .map(PathBuf::as_path)
            .collect()
    }
}
