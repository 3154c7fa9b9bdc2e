//! `haptical identify`: calibrate, put the three files together in memory, write them.

use std::path::Path;

use haptical_calibration::{Calibration, calibrate, force_direction};
use haptical_model::Recording;

use crate::arguments::IdentifyArguments;
use crate::failure::Failure;
use crate::identified::{Provenance, identified};
use crate::inputs::{read_device, read_recording};
use crate::output_files::{check_folder, check_outputs, write_all};
use crate::terminal::Progress;
use crate::{report, summary, terminal};

/// What is written.
const FILES: [&str; 3] = ["identified.toml", "identified.json", "report.html"];

/// Runs the command.
pub(crate) fn run(arguments: &IdentifyArguments) -> Result<(), Failure> {
    check_folder(&arguments.out)?;
    let outputs = FILES.map(|name| arguments.out.join(name));
    check_outputs(&outputs, &[&arguments.device, &arguments.log])?;
    let progress = Progress::start("reading");
    let input = read_device(&arguments.device, arguments.denominators())?;
    let (recording, log_warnings) = read_recording(&arguments.log, &input.device)?;
    let options = arguments.options();
    progress.say(format!(
        "calibrating {} joints from {} rows",
        input.device.joints.len(),
        recording.len()
    ));
    let calibration = calibrate(&input.device, &recording, &options)
        .map_err(|error| Failure::calibration(&error, &arguments.device, &arguments.log))?;
    refuse_overflow(&calibration, &recording, &arguments.log)?;
    progress.say("writing");
    let mut warnings = input.warnings.clone();
    warnings.extend(log_warnings);
    warnings.extend(calibration.warnings.iter().cloned());
    let provenance = Provenance {
        device: arguments.device.display().to_string(),
        log: arguments.log.display().to_string(),
        method: Calibration::method_name(options.method),
        rows: recording.len(),
    };
    let force = match &calibration.fitted.whole {
        Some(whole) => force_direction(whole, &recording)
            .map_err(|error| Failure::calibration(&error, &arguments.device, &arguments.log))?,
        None => None,
    };
    let result = identified(&calibration, &input.device, provenance, force, warnings);
    let device_text = calibration
        .device
        .to_toml(&input.text, &arguments.device.display().to_string())
        .map_err(|error| Failure::device_file(&error, &arguments.device))?;
    let mut json = serde_json::to_string_pretty(&result).map_err(Failure::internal)?;
    json.push('\n');
    let page = report::page(&result, &calibration, &input.device, &recording)?;
    let files = [
        (FILES[0], device_text.into_bytes()),
        (FILES[1], json.clone().into_bytes()),
        (FILES[2], page.into_bytes()),
    ];
    let written = write_all(&arguments.out, &files)?;
    drop(progress);
    terminal::warn(&result.warnings);
    if arguments.json {
        terminal::write_output(json.as_bytes())
    } else {
        terminal::write_output(summary::text(&result, &written)?.as_bytes())
    }
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
