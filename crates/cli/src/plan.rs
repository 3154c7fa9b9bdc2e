//! `haptical plan`: which rig tells which parameters, and the poses to measure next.

mod arguments;
mod outcome;
mod page;
mod text;

use std::path::{Path, PathBuf};

use haptical_calibration::CalibrationError;
use haptical_design::{DesignError, Posture};
use haptical_model::Device;

pub(crate) use arguments::{PlanArguments, help};

use crate::device_source::Equipment;
use crate::failure::Failure;
use crate::input_files::{InputFile, Source};
use crate::inputs::{InputDrumDenominators, read_recording};
use crate::output_files::{NewFile, check_folder, check_outputs, write_all};
use crate::provenance::{Record, VERSION, sealed_json};
use crate::terminal::{self, Progress};
use outcome::Plan;

/// What is written; the last with `--poses` only.
pub(crate) const FILES: [&str; 4] = ["plan.json", "report.html", "rigs.svg", "poses.csv"];

/// Runs the command.
pub(crate) fn run(arguments: &PlanArguments) -> Result<(), Failure> {
    if let Some(out) = &arguments.out {
        check_folder(out)?;
        check_outputs(&FILES.map(|name| out.join(name)), &arguments.inputs())?;
    } else if arguments.poses.is_some() {
        let what = "--poses without --out: the poses have no place to go";
        return Err(Failure::command_line("arguments", what, "give --out DIR"));
    }
    let progress = Progress::start("planning");
    let sources = Sources {
        device: Source::given(&arguments.device),
        equipment: arguments.device_options.equipment(),
        log: arguments.log.as_deref().map(Source::given),
    };
    let outcome = outcome(arguments, &sources, VERSION, &progress)
        .map_err(|failure| failure.with_equipment(&arguments.device, &arguments.device_options))?;
    let Outcome { plan, files, json } = outcome;
    let written = match &arguments.out {
        None => Vec::new(),
        Some(out) => write_all(out, &files)?,
    };
    drop(progress);
    terminal::warn(&plan.warnings);
    let said = match arguments.json {
        true => json,
        false => text::text(&plan, &written)?,
    };
    terminal::write_output(said.as_bytes())
}

/// Where the files are that a plan is made from.
pub(crate) struct Sources {
    pub(crate) device: Source,
    pub(crate) equipment: Equipment,
    pub(crate) log: Option<Source>,
}

/// A plan with the files that it gives.
pub(crate) struct Outcome {
    plan: Plan,
    pub(crate) files: Vec<NewFile<'static>>,
    json: String,
}

/// Plans, and makes the files in memory; `version` is the one that they name.
pub(crate) fn outcome(
    arguments: &PlanArguments,
    sources: &Sources,
    version: &str,
    progress: &Progress,
) -> Result<Outcome, Failure> {
    let (source, equipment) = (&sources.device, &sources.equipment);
    let (input, mut files) = equipment.read("device", source, InputDrumDenominators::Stated)?;
    let mut warnings = input.warnings;
    let measured = match &sources.log {
        None => Vec::new(),
        Some(log) => measured(&input.device, log, &mut files, &mut warnings)?,
    };
    let refuse = |error: DesignError| refusal(&error, &source.path);
    let request = arguments.request().map_err(refuse)?;
    let mut plan = Plan::new(&request, &input.device, &measured, progress).map_err(refuse)?;
    plan.device.clone_from(&source.label);
    plan.warnings = warnings;
    plan.provenance = arguments.record(files, version);
    let mut written: Vec<NewFile<'static>> = Vec::new();
    if !plan.rigs().is_empty() {
        let svg = page::picture(&plan)?;
        written.push((FILES[1], page::page(&plan, &svg)?.into_bytes()));
        written.push((FILES[2], svg.into_bytes()));
    }
    if let Some(next) = plan.next_poses() {
        written.push((FILES[3], poses_csv(&input.device, &next.postures)?));
    }
    plan.provenance = plan.provenance.with_outputs(&written);
    let json = sealed_json(&plan)?;
    written.insert(0, (FILES[0], json.clone().into_bytes()));
    Ok(Outcome {
        plan,
        files: written,
        json,
    })
}

/// Poses of a log.
fn measured(
    device: &Device,
    source: &Source,
    files: &mut Vec<InputFile>,
    warnings: &mut Vec<String>,
) -> Result<Vec<Posture>, Failure> {
    let mut input = read_recording(&source.path, device)?;
    source.relabel(&mut input.warnings);
    files.push(source.input("log", input.fingerprint));
    warnings.append(&mut input.warnings);
    let recording = &input.recording;
    let row = |row: usize| {
        let readings = recording.joint.iter().map(|column| column[row]).collect();
        Posture::free(readings)
    };
    Ok((0..recording.len()).map(row).collect())
}

/// poses.csv: the joints' columns of a log, to drive to and then to measure at.
fn poses_csv(device: &Device, poses: &[Posture]) -> Result<Vec<u8>, Failure> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let joints = device.joints.iter().enumerate();
    let mut header: Vec<String> = joints
        .map(|(index, joint)| format!("theta{}_{}", index + 1, joint.unit()))
        .collect();
    let has = |of: fn(&Posture) -> &String| poses.iter().any(|posture| !of(posture).is_empty());
    let contact = has(|posture| &posture.contact);
    let plane = has(|posture| &posture.plane);
    header.extend(contact.then(|| "contact".to_owned()));
    header.extend(plane.then(|| "plane".to_owned()));
    writer.write_record(&header).map_err(Failure::internal)?;
    for posture in poses {
        let mut cells: Vec<String> = posture.readings.iter().map(f64::to_string).collect();
        cells.extend(contact.then(|| posture.contact.clone()));
        cells.extend(plane.then(|| posture.plane.clone()));
        writer.write_record(&cells).map_err(Failure::internal)?;
    }
    writer.into_inner().map_err(Failure::internal)
}

/// What the library refuses, said of the argument or file that it came from.
fn refusal(error: &DesignError, device: &Path) -> Failure {
    let text = error.to_string();
    let (what, next) = text
        .split_once("; ")
        .or_else(|| text.split_once(": "))
        .unwrap_or((
            text.as_str(),
            "correct it; the kinds of measurement are in `haptical plan --help`",
        ));
    match error {
        DesignError::NothingIdentifiable { rig, reason } => {
            let (what, reason) = (format!("rig `{rig}`"), reason.clone());
            let error = CalibrationError::NothingIdentifiable { what, reason };
            Failure::calibration(&error, device, device)
        }
        DesignError::NoLimits { .. } | DesignError::Pose { .. } => {
            Failure::bad_input("device", what, device.display().to_string(), next)
        }
        DesignError::Calibration(error) => Failure::calibration(error, device, device),
        DesignError::Identification(_) => {
            let next = "give another rig, or correct the device file";
            Failure::bad_input("analysis", text.clone(), device.display().to_string(), next)
        }
        DesignError::Measure { item, message } => {
            let (message, next) = message
                .rsplit_once("; ")
                .or_else(|| message.rsplit_once(": "))
                .unwrap_or((message, "the kinds are in `haptical plan --help`"));
            Failure::command_line("measure", format!("measurement `{item}`: {message}"), next)
        }
        _ => Failure::command_line("arguments", what, next),
    }
}

impl PlanArguments {
    /// The files that are read.
    fn inputs(&self) -> Vec<&Path> {
        let further = [&self.device_options.rig, &self.log];
        std::iter::once(&self.device)
            .chain(further.into_iter().flatten())
            .map(PathBuf::as_path)
            .collect()
    }

    /// How the plan came about.
    fn record(&self, files: Vec<InputFile>, version: &str) -> Record {
        let mut flags: Vec<String> = files.iter().map(InputFile::argument).collect();
        flags.extend(self.device_options.chain.flags());
        flags.extend(self.flags());
        let mut record = Record::new(version, "plan", flags, files);
        record.seeds.insert("poses", self.seed);
        record
    }
}
