//! `haptical diagnose`: reads, diagnoses, writes the files, prints the answer.

use std::path::{Path, PathBuf};

use haptical::files::{Source, check_folder, check_outputs};
use haptical::{Device, Diagnose, Diagnosed, Equipment, Log, diagnose};

use crate::arguments::DiagnoseArguments;
use crate::failure::Failure;
use crate::interrupt::write_all;
use crate::terminal::{self, Progress};

/// Runs the command.
pub(crate) fn run(arguments: &DiagnoseArguments) -> Result<(), Failure> {
    check_folder(&arguments.out)?;
    check_outputs(
        &Diagnosed::FILES.map(|name| arguments.out.join(name)),
        &arguments.inputs(),
    )?;
    let progress = Progress::start("reading");
    let equipment = arguments.device_options.equipment();
    let device = Device::open(&Source::given(&arguments.device), &equipment)?;
    let log = Log::read(&arguments.log, &device)?;
    let model = arguments.model.as_deref().map(Source::given);
    let model = model.map(|source| Device::open(&source, &Equipment::default()));
    let model = model.transpose()?;
    let second = arguments.validate.as_ref();
    let second = second.map(|path| Log::read(path, &device)).transpose()?;
    progress.say(format!(
        "diagnosing {} joints from {} rows",
        device.model.joints.len(),
        log.recording.len()
    ));
    let request = Diagnose {
        without: arguments.without.clone(),
        model: model.as_ref(),
        validate: second.as_ref(),
        ..Diagnose::default()
    };
    let gap = diagnose(&device, &log, &request)?;
    let files = gap.files()?;
    progress.say("writing");
    let written = write_all(&arguments.out, &files)?;
    drop(progress);
    terminal::warn(gap.warnings());
    if arguments.json {
        return terminal::write_output(&files[0].1);
    }
    let written: Vec<String> = written
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    let text = format!("{gap}{:<9}{}\n", "written", written.join("  "));
    terminal::write_output(text.as_bytes())
}

impl DiagnoseArguments {
    /// The files that are read.
    fn inputs(&self) -> Vec<&Path> {
        let further = [&self.device_options.rig, &self.model, &self.validate];
        [&self.device, &self.log]
            .into_iter()
            .chain(further.into_iter().flatten())
            .map(PathBuf::as_path)
            .collect()
    }
}
