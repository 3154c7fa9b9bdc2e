//! `haptical identify`: reads, identifies, writes the three files, prints the summary.

use haptical::files::{Source, check_folder, check_outputs};
use haptical::{Device, Found, Log, identify};

use crate::arguments::IdentifyArguments;
use crate::failure::Failure;
use crate::interrupt::write_all;
use crate::terminal::{self, Progress};

/// Runs the command.
pub(crate) fn run(arguments: &IdentifyArguments) -> Result<(), Failure> {
    check_folder(&arguments.out)?;
    let outputs = Found::FILES.map(|name| arguments.out.join(name));
    check_outputs(&outputs, &[&arguments.device, &arguments.log])?;
    let progress = Progress::start("reading");
    let device = Device::open(&Source::given(&arguments.device), &arguments.equipment())?;
    let log = Log::read(&arguments.log, &device)?;
    progress.say(format!(
        "calibrating {} joints from {} rows",
        device.model.joints.len(),
        log.recording.len()
    ));
    let found = identify(&device, &log, &arguments.request())?;
    let files = found.files()?;
    progress.say("writing");
    let written = write_all(&arguments.out, &files)?;
    drop(progress);
    terminal::warn(found.warnings());
    if arguments.json {
        return terminal::write_output(&files[1].1);
    }
    let mut text = format!("{found}\nWritten:\n");
    for path in written {
        text.push_str(&format!("  {}\n", path.display()));
    }
    terminal::write_output(text.as_bytes())
}
