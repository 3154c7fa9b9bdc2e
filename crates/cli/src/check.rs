//! `haptical check`: describes a device file and a log, and what the log could identify.

use haptical::files::Source;
use haptical::{CheckedLog, Identify, Log, check};

use crate::arguments::CheckArguments;
use crate::failure::Failure;
use crate::flags::word;
use crate::progress::Progress;
use crate::terminal;

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
    let mut said = found.to_string();
    let identifies = |log: &CheckedLog| !log.identifiable.is_empty();
    let log = arguments.log.as_deref();
    if let Some(log) = log.filter(|_| found.log.as_ref().is_some_and(identifies)) {
        let device = arguments.device_options.typed(&arguments.device);
        let (log, hold) = (word(log), arguments.hold.typed());
        said += &format!("\nNext:\n  haptical identify{device} --log {log}{hold} --out result\n");
    }
    terminal::tell(arguments.json, &found, said)
}
