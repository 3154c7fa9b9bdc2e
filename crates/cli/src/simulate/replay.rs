//! `haptical simulate --replay`: a recorded motion through a model.

use std::path::Path;

use haptical::files::{Fingerprint, Record, Source, VERSION, file_name, make_folder, sealed_json};
use haptical::{Device, Log, ReplayedChannel, replay};
use serde::Serialize;

use super::{COMMAND, SimulateArguments};
use crate::failure::Failure;
use crate::flags::folder_and_name;
use crate::interrupt::{Writing, write_all};
use crate::terminal::{self, Progress};

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
    let (folder, name) = folder_and_name(&arguments.out)?;
    let (residuals_name, beside) = (
        format!("{name}.residuals.csv"),
        format!("{name}.provenance.json"),
    );
    let place = folder.join(&residuals_name);
    let rule = arguments.overwrite.rule(COMMAND);
    rule.check(&[folder.join(&beside), arguments.out.clone(), place.clone()])?;
    let progress = Progress::start("reading");
    let equipment = arguments.device_options.equipment();
    let device = Device::open(&Source::given(&arguments.device), &equipment)?;
    let log = Log::open(&Source::given(path), &device)?;
    progress.say("replaying");
    let replayed = replay(&device, &log)?;
    {
        let writing = Writing::begin();
        let _folder = make_folder(folder)?;
        writing.go_on(&arguments.out)?;
        let shape = replayed.shape(&device);
        haptical_data::write_log(&arguments.out, &replayed.predicted, &shape)?;
    }
    let mut files = device.inputs("device");
    files.extend(log.input("replay"));
    let mut flags: Vec<String> = files
        .iter()
        .map(haptical::files::InputFile::argument)
        .collect();
    flags.extend(equipment.chain_flags());
    let record = Record::new(VERSION, COMMAND, flags, files);
    let made = Source::given(&arguments.out);
    let hashed = Fingerprint::of_file(&arguments.out)
        .map_err(|error| Failure::internal(format!("the log that was written: {error}")))?;
    let text = replayed.residuals_csv(&log).into_bytes();
    let mut written = vec![(residuals_name.as_str(), text)];
    let mut record = record.with_outputs(&written);
    record
        .outputs
        .insert(0, hashed.output(&file_name(&made.path)));
    let mut summary = Written {
        log: made.label,
        residuals: residuals_name.clone(),
        device: Source::given(&arguments.device).label,
        replayed: Source::given(path).label,
        rows: log.recording.len(),
        channels: &replayed.channels,
        haptical_version: VERSION,
        provenance: record,
    };
    let json = sealed_json(&summary)?;
    written.push((beside.as_str(), json.into_bytes()));
    write_all(&rule, folder, &written)?;
    drop(progress);
    terminal::warn(&device.warnings);
    terminal::warn(&log.warnings);
    terminal::warn(&replayed.warnings);
    summary.log = arguments.out.display().to_string();
    if arguments.json {
        return terminal::write_json(&summary);
    }
    terminal::write_output(summary.text(&place).as_bytes())
}

impl Written<'_> {
    fn text(&self, residuals: &Path) -> String {
        let mut text = format!(
            "{} rows of {} through {}\nchannel       prediction minus measurement, root mean square; stated noise\n",
            self.rows, self.replayed, self.device
        );
        for channel in self.channels {
            let shown = haptical::units::Shown::fine(&channel.unit);
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
