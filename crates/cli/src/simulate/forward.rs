//! `haptical simulate --forward`: a log's motion out of its torques or its commands.

use std::path::Path;

use haptical::files::{Record, Source, VERSION};
use haptical::units::Shown;
use haptical::{Device, Drive, Forward, Log, forward};
use haptical_model::{check_toml_syntax, read_toml_text};
use haptical_simulator::ControllerFile;
use serde::Serialize;

use super::{COMMAND, SimulateArguments, effects_refusal};
use crate::failure::Failure;
use crate::flags::outputs::Outputs;
use crate::progress::Progress;
use crate::terminal;

/// End of the name of the page.
const PAGE: &str = ".html";

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
    let outputs = Outputs::check(&arguments.out, arguments.overwrite.rule(COMMAND), &[PAGE])?;
    let progress = Progress::start("reading");
    let device = arguments.device_options.read(&arguments.device)?;
    device.refuse_hands("a forward prediction")?;
    let log = Log::open(&Source::given(path), &device)?;
    let with = arguments.with.as_deref().map(Source::given);
    let with = with.map(|source| device.open_model(&source)).transpose()?;
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
    let page = outputs.name(PAGE);
    let csv = told.csv(&device, &log).into_bytes();
    let html = told.page(&device, &log)?.into_bytes();
    let written = vec![(outputs.name, csv), (page.as_str(), html)];
    let mut record = Record::of(VERSION, COMMAND, files, device.equipment().chain_flags());
    record.arguments.insert(0, "--forward".to_owned());
    let mut summary = Written {
        predictions: Source::given(&arguments.out).label,
        page: page.clone(),
        log: log.source().label.clone(),
        rows: log.recording.len(),
        driven_by: match controller {
            Some(_) => "controller",
            None => "torques",
        },
        told: &told,
        haptical_version: VERSION,
        provenance: record.with_outputs(&written),
    };
    outputs.write(written, &summary)?;
    drop(progress);
    terminal::warn(&[&*device.warnings, &log.warnings, &told.warnings].concat());
    summary.predictions = arguments.out.display().to_string();
    let text = format!(
        "{}\n{}Written: {}, {}\n",
        told.table(&device)?.to_terminal(),
        halved(&told, &device),
        summary.predictions,
        outputs.place(PAGE).display()
    );
    terminal::tell(arguments.json, &summary, text)
}

/// What the step of the integration leaves.
fn halved(told: &Forward, device: &Device) -> String {
    let mut text = String::new();
    for own in &told.devices {
        let joints = device.model.joints.iter().zip(&own.halved_step_moves);
        let moved: Vec<String> = joints
            .map(|(joint, moved)| Shown::fine(joint.unit()).text(*moved))
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
