//! `haptical simulate --poses`: a log of single postures.

use std::path::Path;

use haptical::files::{Record, Source, VERSION};
use haptical::{Log, simulate_postures};
use haptical_data::LogShape;
use haptical_design::Rig;
use serde::Serialize;

use super::truth::truth_text;
use super::{COMMAND, SimulateArguments};
use crate::failure::Failure;
use crate::flags::outputs::Outputs;
use crate::progress::Progress;
use crate::terminal;

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

/// Ends of the names of the files next to the log: the true device, the rig.
const BESIDE: [&str; 2] = [".truth.toml", ".rig.toml"];

/// Runs the command.
pub(super) fn run(arguments: &SimulateArguments, path: &Path) -> Result<(), Failure> {
    if let Some(effects) = &arguments.effects {
        let said = "--effects is of a device that a hand moves, and --poses of single postures; write its [[effect]] tables into the \
                    device file of --truth or --device: names and numbers are the same";
        return Err(Failure::of_file("arguments", said, effects));
    }
    let outputs = Outputs::check(&arguments.out, arguments.overwrite.rule(COMMAND), &BESIDE)?;
    let progress = Progress::start("reading");
    let mut device = arguments.device_options.read(&arguments.device)?;
    let mut files = device.inputs("device");
    let truth = arguments.read_truth(&mut device, &mut files)?;
    let postures = Log::open(&Source::given(path), &device)?;
    files.extend(postures.input("poses"));
    let rig = arguments.measure.as_deref().map(Rig::parse).transpose();
    let rig = rig.map_err(|error| Failure::design(&error, &arguments.device))?;
    progress.say("leading the device to its postures");
    let truth = arguments.truth(truth.as_ref());
    let made = simulate_postures(&device, truth, &postures, rig.as_ref(), arguments.seed)?;
    let [truth_name, rig_name] = BESIDE.map(|end| outputs.name(end));
    let mut written = vec![(truth_name.as_str(), truth_text(&made.truth)?.into_bytes())];
    let rig = made.rig.as_ref().map(|text| text.clone().into_bytes());
    written.extend(rig.map(|text| (rig_name.as_str(), text)));
    outputs.write_log(&made.recording, &LogShape::from(&made.truth))?;
    let mut summary = Written {
        log: Source::given(&arguments.out).label,
        truth_file: truth_name.clone(),
        rig_file: made.rig.as_ref().map(|_| rig_name.clone()),
        rows: made.recording.len(),
        seed: arguments.seed,
        device: device.source().label.clone(),
        truth: arguments.truth_label(),
        deviate: arguments.deviate,
        poses: postures.source().label.clone(),
        measure: arguments.measure.as_deref(),
        haptical_version: VERSION,
        provenance: arguments.record(files, &outputs, &written)?,
    };
    outputs.write(written, &summary)?;
    drop(progress);
    terminal::warn(&[&*device.warnings, &postures.warnings, &made.warnings].concat());
    summary.log = arguments.out.display().to_string();
    let mut text = format!(
        "Written: {}, {} postures, seed {}\nTrue device: {}\n",
        summary.log,
        summary.rows,
        summary.seed,
        outputs.place(BESIDE[0]).display()
    );
    if summary.rig_file.is_some() {
        text += &format!("Rig: {}, for --rig\n", outputs.place(BESIDE[1]).display());
    }
    terminal::tell(arguments.json, &summary, text)
}
