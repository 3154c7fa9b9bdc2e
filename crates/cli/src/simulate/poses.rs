//! `haptical simulate --poses`: a log of single postures.

use std::path::{Path, PathBuf};

use haptical::files::{Fingerprint, Record, Source, VERSION, make_folder, sealed_json};
use haptical::{Device, Log, SimulatedPostures, simulate_postures};
use haptical_data::LogShape;
use haptical_design::Rig;
use serde::Serialize;

use super::truth::truth_text;
use super::{COMMAND, SimulateArguments};
use crate::failure::Failure;
use crate::flags::folder_and_name;
use crate::interrupt::{Writing, write_all};
use crate::terminal::{self, Progress};

/// What was written.
#[derive(Debug, Serialize)]
struct Written<'a> {
    /// Its place on standard output, its name in the provenance file.
    log: String,
    /// The true device with the places of all that is around it.
    truth_file: String,
    /// What the log is read with, where a rig was named.
    rig_file: Option<String>,
    rows: usize,
    seed: u64,
    device: String,
    truth: Option<String>,
    deviate: Option<f64>,
    poses: String,
    measure: Option<&'a str>,
    haptical_version: &'static str,
    provenance: Record,
}

/// The files beside the log.
struct Beside {
    provenance: String,
    truth: String,
    rig: String,
}

/// Runs the command.
pub(super) fn run(arguments: &SimulateArguments, path: &Path) -> Result<(), Failure> {
    if let Some(effects) = &arguments.effects {
        return Err(Failure::in_file(
            "arguments",
            "--effects is of a device that a hand moves, and --poses of single postures",
            effects,
            "write its [[effect]] tables into the device file of --truth or --device: names and numbers are the same",
        ));
    }
    let (folder, name) = folder_and_name(&arguments.out)?;
    let beside = Beside {
        provenance: format!("{name}.provenance.json"),
        truth: format!("{name}.truth.toml"),
        rig: format!("{name}.rig.toml"),
    };
    let place = |name: &str| folder.join(name);
    let rule = arguments.overwrite.rule(COMMAND);
    rule.check(&[
        place(&beside.provenance),
        arguments.out.clone(),
        place(&beside.truth),
        place(&beside.rig),
    ])?;
    let progress = Progress::start("reading");
    let equipment = arguments.device_options.equipment();
    let mut device = Device::open(&Source::given(&arguments.device), &equipment)?;
    let mut files = device.inputs("device");
    let truth = arguments.read_truth(&mut device, &mut files)?;
    let postures = Log::open(&Source::given(path), &device)?;
    files.extend(postures.input("poses"));
    let rig = arguments.measure.as_deref().map(Rig::parse).transpose();
    let rig = rig.map_err(|error| Failure::design(&error, &arguments.device))?;
    progress.say("leading the device to its postures");
    let truth = arguments.truth(truth.as_ref());
    let made = simulate_postures(&device, truth, &postures, rig.as_ref(), arguments.seed)?;
    let mut written = vec![(beside.truth.as_str(), truth_text(&made.truth)?.into_bytes())];
    let rig_text = made.rig.clone();
    written.extend(rig_text.map(|text| (beside.rig.as_str(), text.into_bytes())));
    write_log(arguments, folder, &made)?;
    let log = Source::given(&arguments.out);
    let hashed = Fingerprint::of_file(&arguments.out)
        .map_err(|error| Failure::internal(format!("the log that was written: {error}")))?;
    let label = |path: &PathBuf| Source::given(path).label;
    let mut summary = Written {
        log: log.label.clone(),
        truth_file: beside.truth.clone(),
        rig_file: made.rig.as_ref().map(|_| beside.rig.clone()),
        rows: made.recording.len(),
        seed: arguments.seed,
        device: label(&arguments.device),
        truth: arguments.truth.as_ref().map(label),
        deviate: arguments.deviate,
        poses: Source::given(path).label,
        measure: arguments.measure.as_deref(),
        haptical_version: VERSION,
        provenance: arguments.record(files, (&log, hashed), &written),
    };
    let json = sealed_json(&summary)?;
    written.push((beside.provenance.as_str(), json.into_bytes()));
    write_all(&rule, folder, &written)?;
    drop(progress);
    terminal::warn(&device.warnings);
    terminal::warn(&postures.warnings);
    terminal::warn(&made.warnings);
    summary.log = arguments.out.display().to_string();
    if arguments.json {
        return terminal::write_json(&summary);
    }
    terminal::write_output(summary.text(folder).as_bytes())
}

fn write_log(
    arguments: &SimulateArguments,
    folder: &Path,
    made: &SimulatedPostures,
) -> Result<(), Failure> {
    let writing = Writing::begin();
    let _folder = make_folder(folder)?;
    writing.go_on(&arguments.out)?;
    let shape = LogShape::from(&made.truth);
    haptical_data::write_log(&arguments.out, &made.recording, &shape)?;
    Ok(())
}

impl Written<'_> {
    fn text(&self, folder: &Path) -> String {
        let mut text = format!(
            "Written: {}, {} postures, seed {}\nTrue device: {}\n",
            self.log,
            self.rows,
            self.seed,
            folder.join(&self.truth_file).display()
        );
        if let Some(rig) = &self.rig_file {
            let rig = folder.join(rig);
            text.push_str(&format!("Rig: {}, for --rig\n", rig.display()));
        }
        text
    }
}
