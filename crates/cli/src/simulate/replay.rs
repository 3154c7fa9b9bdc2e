//! `haptical simulate --replay`: a recorded motion through a model.

use std::path::Path;

use haptical::files::{Record, Source, VERSION};
use haptical::units::Shown;
use haptical::{Log, ReplayedChannel, replay};
use serde::Serialize;

use super::{COMMAND, SimulateArguments};
use crate::failure::Failure;
use crate::flags::outputs::Outputs;
use crate::progress::Progress;
use crate::terminal;

/// End of the name of the table of all readings.
const RESIDUALS: &str = ".residuals.csv";

/// What was written.
#[derive(Debug, Serialize)]
struct Written<'a> {
    /// The log with predictions in the place of measurements.
    log: String,
    /// Reading by reading.
    residuals: String,
    device: String,
    replayed: String,
    rows: usize,
    channels: &'a [ReplayedChannel],
    haptical_version: &'static str,
    provenance: Record,
}

/// Runs the command.
pub(super) fn run(arguments: &SimulateArguments, path: &Path) -> Result<(), Failure> {
    let rule = arguments.overwrite.rule(COMMAND);
    let outputs = Outputs::check(&arguments.out, rule, &[RESIDUALS])?;
    let progress = Progress::start("reading");
    let device = arguments.device_options.read(&arguments.device)?;
    let log = Log::open(&Source::given(path), &device)?;
    progress.say("replaying");
    let replayed = replay(&device, &log)?;
    outputs.write_log(&replayed.predicted, &replayed.shape(&device))?;
    let mut files = device.inputs("device");
    files.extend(log.input("replay"));
    let record = Record::of(VERSION, COMMAND, files, device.equipment().chain_flags());
    let residuals = outputs.name(RESIDUALS);
    let text = replayed.residuals_csv(&log).into_bytes();
    let written = vec![(residuals.as_str(), text)];
    let mut record = record.with_outputs(&written);
    record.outputs.insert(0, outputs.written()?);
    let mut summary = Written {
        log: Source::given(&arguments.out).label,
        residuals: residuals.clone(),
        device: device.source().label.clone(),
        replayed: log.source().label.clone(),
        rows: log.recording.len(),
        channels: &replayed.channels,
        haptical_version: VERSION,
        provenance: record,
    };
    outputs.write(written, &summary)?;
    drop(progress);
    terminal::warn(&[&*device.warnings, &log.warnings, &replayed.warnings].concat());
    summary.log = arguments.out.display().to_string();
    let text = summary.text(&outputs.place(RESIDUALS));
    terminal::tell(arguments.json, &summary, text)
}

impl Written<'_> {
    fn text(&self, residuals: &Path) -> String {
        let mut text = format!(
            "{} rows of {} through {}\nchannel       prediction minus measurement, root mean square; stated noise\n",
            self.rows, self.replayed, self.device
        );
        for channel in self.channels {
            let shown = Shown::fine(&channel.unit);
            text.push_str(&format!(
                "{:<14}{}; {}\n",
                channel.channel,
                shown.text(channel.rms),
                shown.text(channel.noise_floor)
            ));
        }
        text + &format!("Written: {}, {}\n", self.log, residuals.display())
    }
}
