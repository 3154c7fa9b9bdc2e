//! `haptical identify`: calibrate, put the three files together in memory, write them.

use std::path::Path;

use haptical_calibration::{Calibration, calibrate, force_direction, without_copies};
use haptical_model::{Recording, TransmissionKind};

use crate::arguments::{IdentifyArguments, NoiseName};
use crate::device_source::{DeviceOptions, Equipment};
use crate::failure::Failure;
use crate::identified::{Described, Identified, identified};
use crate::input_files::{InputFile, Source};
use crate::inputs::read_recording;
use crate::method::{degree_text, loss_text};
use crate::output_files::{NewFile, check_folder, check_outputs, write_all};
use crate::provenance::{Record, Thresholds, VERSION, sealed_json, without_comments};
use crate::terminal::Progress;
use crate::{report, summary, terminal};

/// What is written.
pub(crate) const FILES: [&str; 3] = ["identified.toml", "identified.json", "report.html"];

/// An identification with the files that it gives.
pub(crate) struct Outcome {
    result: Identified,
    pub(crate) files: Vec<NewFile<'static>>,
    json: String,
}

/// Runs the command.
pub(crate) fn run(arguments: &IdentifyArguments) -> Result<(), Failure> {
    check_folder(&arguments.out)?;
    let outputs = FILES.map(|name| arguments.out.join(name));
    check_outputs(&outputs, &[&arguments.device, &arguments.log])?;
    let progress = Progress::start("reading");
    let sources = [&arguments.device, &arguments.log].map(|path| Source::given(path));
    let equipment = arguments.device_options.equipment();
    let outcome = outcome(arguments, &sources, &equipment, VERSION, &progress)?;
    progress.say("writing");
    let written = write_all(&arguments.out, &outcome.files)?;
    drop(progress);
    terminal::warn(&outcome.result.warnings);
    if arguments.json {
        terminal::write_output(outcome.json.as_bytes())
    } else {
        terminal::write_output(summary::text(&outcome.result, &written)?.as_bytes())
    }
}

/// Identifies, and makes the files in memory. Device file and log are where `[device, log]` say, the
/// options as in `arguments`; `version` is the one that the files name.
pub(crate) fn outcome(
    arguments: &IdentifyArguments,
    [device, log]: &[Source; 2],
    equipment: &Equipment,
    version: &str,
    progress: &Progress,
) -> Result<Outcome, Failure> {
    let denominators = arguments.denominators();
    let (mut input, mut inputs) = equipment.read("device", device, denominators)?;
    let mut read = read_recording(&log.path, &input.device)?;
    log.relabel(&mut read.warnings);
    // behind the device, before the rig: the order of the flags
    inputs.insert(1, log.input("log", read.fingerprint));
    let (recording, copies) = without_copies(read.recording);
    read.warnings.extend(copies);
    let options = arguments.options();
    if arguments
        .with
        .iter()
        .any(|effect| effect == "joint-compliance")
    {
        input.device.fit_compliance();
    }
    arguments.hold.apply(&mut input.device)?;
    progress.say(format!(
        "calibrating {} joints from {} rows",
        input.device.joints.len(),
        recording.len()
    ));
    let refuse = |error| Failure::calibration(&error, &device.path, &log.path);
    let calibration = calibrate(&input.device, &recording, &options).map_err(refuse)?;
    refuse_overflow(&calibration, &recording, &log.path)?;
    let mut warnings = input.warnings;
    warnings.extend(read.warnings);
    warnings.extend(calibration.warnings.iter().cloned());
    let mut record = Record::new(version, "identify", recorded(arguments, &inputs), inputs);
    record.thresholds = Some(Thresholds::of(&options));
    let described = Described {
        device: device.label.clone(),
        log: log.label.clone(),
        method: Calibration::method_name(options.method),
        rows: recording.len(),
        record,
    };
    let force = match &calibration.fitted.whole {
        // an arm without drives of this kind renders no force at its handle
        Some(whole)
            if input
                .device
                .joints
                .iter()
                .any(|joint| joint.transmission != TransmissionKind::Direct) =>
        {
            force_direction(whole, &recording).map_err(refuse)?
        }
        _ => None,
    };
    let mut result = identified(
        &calibration,
        &calibration.nominal,
        described,
        force,
        warnings,
    );
    let calibrated = calibration
        .device
        .to_toml(without_comments(&input.text), &device.label)
        .map_err(|error| Failure::device_file(&error, &device.path))?;
    let toml = result.provenance.toml_comments()? + &calibrated;
    let page = report::page(&result, &calibration, &calibration.nominal, &recording)?;
    let [toml_name, json_name, page_name] = FILES;
    let mut files = vec![
        (toml_name, toml.into_bytes()),
        (page_name, page.into_bytes()),
    ];
    result.provenance = result.provenance.with_outputs(&files);
    let json = sealed_json(&result)?;
    files.insert(1, (json_name, json.clone().into_bytes()));
    Ok(Outcome {
        result,
        files,
        json,
    })
}

/// The flags that decide the result, defaults included.
fn recorded(arguments: &IdentifyArguments, inputs: &[InputFile]) -> Vec<String> {
    // Without `..`, so that a new flag is not forgotten here: `verify` runs what is recorded.
    let IdentifyArguments {
        device: _,
        device_options: DeviceOptions { chain, rig: _ },
        log: _,
        out: _,
        json: _,
        method: _,
        held_out,
        folds,
        with,
        hold,
        degree,
        noise,
        loss,
        input_drum_denominator_m,
        paper_preset,
    } = arguments;
    let method = Calibration::method_name(arguments.options().method);
    let noise = match noise {
        NoiseName::Stated => "stated",
        NoiseName::Estimated => "estimated",
    };
    let mut recorded: Vec<String> = inputs.iter().map(InputFile::argument).collect();
    recorded.extend([
        format!("--method={method}"),
        match folds {
            Some(folds) => format!("--folds={folds}"),
            None => format!("--held-out={held_out}"),
        },
        format!("--degree={}", degree_text(*degree)),
        format!("--noise={noise}"),
        format!("--loss={}", loss_text(*loss)),
    ]);
    recorded.extend(with.iter().map(|effect| format!("--with={effect}")));
    recorded.extend(hold.flags());
    if let Some(length_m) = input_drum_denominator_m {
        recorded.push(format!("--input-drum-denominator-m={length_m}"));
    }
    recorded.extend(chain.flags());
    if *paper_preset {
        recorded.push("--paper-preset".to_owned());
    }
    recorded
}

/// A reading such as 1e308 in a row that the fit did not see is met by nobody before its square is
/// taken.
fn refuse_overflow(
    calibration: &Calibration,
    recording: &Recording,
    log: &Path,
) -> Result<(), Failure> {
    let reports = calibration
        .held_out_channels
        .iter()
        .chain(&calibration.fit_channels);
    for report in reports {
        if report.rms_before.is_finite() && report.rms_after.is_finite() {
            continue;
        }
        let by_size = |a: &(usize, &f64), b: &(usize, &f64)| a.1.abs().total_cmp(&b.1.abs());
        let width = (report.before.len() / report.rows.len().max(1)).max(1);
        let largest = report.before.iter().enumerate().max_by(by_size);
        let line = largest.map(|(index, _)| recording.line[report.rows[index / width]]);
        return Err(Failure::log_line(
            "overflow",
            format!(
                "the residual of {} is too large to be squared",
                report.channel
            ),
            log,
            line,
            format!(
                "correct the reading of {} or leave its cell empty",
                report.channel
            ),
        ));
    }
    Ok(())
}
