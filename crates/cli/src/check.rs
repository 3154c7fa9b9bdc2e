//! `haptical check`: describes a device file and a log, and what the log could identify.

use haptical::files::Source;
use haptical::{Identify, Log, check};

use crate::arguments::CheckArguments;
use crate::failure::Failure;
use crate::terminal::{self, Progress};

/// Runs the command.
pub(crate) fn run(arguments: &CheckArguments) -> Result<(), Failure> {
    let progress = Progress::start("checking");
    let device = arguments.device_options.read_by_path(&arguments.device)?;
    let request = Identify {
        hold: arguments.hold.hold.clone(),
        deviations: arguments.hold.deviation.clone(),
        ..Identify::default()
    };
    // a wrong word is refused before the log is read
    request.hold(&mut device.model.clone())?;
    let log = arguments.log.as_deref().map(Source::by_path);
    let log = log.map(|source| Log::open(&source, &device)).transpose()?;
    let found = check(&device, log.as_ref(), &request)?;
    drop(progress);
    terminal::warn(&found.warnings);
    if arguments.json {
        return terminal::write_json(&found);
    }
    terminal::write_output(found.to_string().as_bytes())
}
