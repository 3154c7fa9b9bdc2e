//! `haptical simulate --forward`: a log's motion out of its torques or its commands.

use std::path::Path;

use haptical::files::{Record, Source, VERSION, sealed_json};
use haptical::{Device, Drive, Forward, Log, forward};
use haptical_model::{check_toml_syntax, read_toml_text};
use haptical_simulator::ControllerFile;
use serde::Serialize;

use super::{COMMAND, SimulateArguments, effects_refusal};
use crate::failure::Failure;
use crate::flags::folder_and_name;
use crate::interrupt::write_all;
use crate::terminal::{self, Progress};

/// What was written.
#[derive(Debug, Serialize)]
struct Written<'a> {
    /// The log with predictions beside it.
    predictions: String,
    page: String,
    log: String,
    rows: usize,
    /// `torques` or `controller`.
    driven_by: &'static str,
    #[serde(flatten)]
    told: &'a Forward,
    haptical_version: &'static str,
    provenance: Record,
}

/// Runs the command.
pub(super) fn run(arguments: &SimulateArguments, path: &Path) -> Result<(), Failure> {
    let (folder, name) = folder_and_name(&arguments.out)?;
    let (page, beside) = (format!("{name}.html"), format!("{name}.provenance.json"));
    let rule = arguments.overwrite.rule(COMMAND);
    let place = folder.join(&page);
    rule.check(&[folder.join(&beside), arguments.out.clone(), place.clone()])?;
    let progress = Progress::start("reading");
    let equipment = arguments.device_options.equipment();
    let device = Device::open(&Source::given(&arguments.device), &equipment)?;
    device.refuse_hands("a forward prediction")?;
    let log = Log::open(&Source::given(path), &device)?;
    let with = match &arguments.with {
        Some(path) => Some(device.open_model(&Source::given(path))?),
        None => None,
    };
    let mut files = device.inputs("device");
    files.extend(with.iter().flat_map(|with| with.inputs("with")));
    files.extend(log.input("log"));
    let controller = match &arguments.controller {
        None => None,
        Some(path) => {
            let (controller, text) = read_controller(path, device.model.joints.len())?;
            let source = Source::given(path);
            files.push(source.input("controller", source.fingerprint_text(&text)));
            Some(controller)
        }
    };
    let drive = controller
        .as_ref()
        .map_or(Drive::Torques, Drive::Controller);
    progress.say("predicting");
    let told = match &with {
        Some(with) => forward(&[("before", &device), ("after", with)], &log, drive)?,
        None => forward(&[("device", &device)], &log, drive)?,
    };
    let csv = told.csv(&device, &log).into_bytes();
    let html = told.page(&device, &log)?.into_bytes();
    let flags = files.iter().map(haptical::files::InputFile::argument);
    let mut flags: Vec<String> = std::iter::once("--forward".to_owned())
        .chain(flags)
        .collect();
    flags.extend(equipment.chain_flags());
    let mut written = vec![(name, csv), (page.as_str(), html)];
    let record = Record::new(VERSION, COMMAND, flags, files).with_outputs(&written);
    let mut summary = Written {
        predictions: Source::given(&arguments.out).label,
        page: page.clone(),
        log: Source::given(path).label,
        rows: log.recording.len(),
        driven_by: if controller.is_some() {
            "controller"
        } else {
            "torques"
        },
        told: &told,
        haptical_version: VERSION,
        provenance: record,
    };
    let json = sealed_json(&summary)?;
    written.push((beside.as_str(), json.into_bytes()));
    write_all(&rule, folder, &written)?;
    drop(progress);
    terminal::warn(&device.warnings);
    terminal::warn(&log.warnings);
    terminal::warn(&told.warnings);
    summary.predictions = arguments.out.display().to_string();
    if arguments.json {
        return terminal::write_json(&summary);
    }
    let table = told.table(&device)?.to_terminal();
    let text = format!(
        "{table}\n{}Written: {}, {}\n",
        halved(&told, &device),
        summary.predictions,
        place.display()
    );
    terminal::write_output(text.as_bytes())
}

/// What the step of the integration leaves.
fn halved(told: &Forward, device: &Device) -> String {
    let mut text = String::new();
    for own in &told.devices {
        let joints = device.model.joints.iter().zip(&own.halved_step_moves);
        let moved: Vec<String> = joints
            .map(|(joint, moved)| haptical::units::Shown::fine(joint.unit()).text(*moved))
            .collect();
        text += &format!(
            "{}: steps of {:.3} ms; half of them move predictions of 1 s by {} (root mean square)\n",
            own.name,
            1e3 * own.step_s,
            moved.join(", ")
        );
    }
    text
}

fn read_controller(path: &Path, joints: usize) -> Result<(ControllerFile, String), Failure> {
    let name = path.display().to_string();
    let refuse = |error| Failure::device_file(&error, path);
    let text = read_toml_text(path).map_err(refuse)?;
    check_toml_syntax(&text, &name).map_err(refuse)?;
    let controller = ControllerFile::from_toml(&text, &name, joints);
    let controller = controller.map_err(|error| effects_refusal(&error, &name))?;
    Ok((controller, text))
}
