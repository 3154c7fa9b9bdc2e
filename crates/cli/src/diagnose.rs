//! `haptical diagnose`: diagnose, put the files together in memory, write them.

use std::path::{Path, PathBuf};

use haptical_diagnosis::{Diagnosis, Options, Prediction, diagnose};
use haptical_model::{Device, Recording};

use crate::arguments::DiagnoseArguments;
use crate::failure::Failure;
use crate::gap_file::GapFile;
use crate::inputs::{InputDrumDenominators, read_device, read_recording, refuse_other_device};
use crate::output_files::{check_folder, check_outputs, write_all};
use crate::terminal::Progress;
use crate::{gap_report, gap_summary, terminal};

/// Header of predictions.csv, in the order of [`Prediction`].
const PREDICTION_COLUMNS: [&str; 5] = ["row", "channel", "measured", "before", "after"];

/// What is written; the last with a second log only.
const FILES: [&str; 3] = ["gap.json", "report.html", "predictions.csv"];

/// Runs the command.
pub(crate) fn run(arguments: &DiagnoseArguments) -> Result<(), Failure> {
    check_folder(&arguments.out)?;
    check_outputs(
        &FILES.map(|name| arguments.out.join(name)),
        &arguments.inputs(),
    )?;
    let progress = Progress::start("reading");
    let input = read_device(&arguments.device, InputDrumDenominators::Stated)?;
    let (recording, log_warnings) = read_recording(&arguments.log, &input.device)?;
    let mut warnings = input.warnings;
    warnings.extend(log_warnings);
    let model = read_model(arguments, &input.device, &mut warnings)?;
    let validation = read_validation(arguments, &input.device, &mut warnings)?;
    progress.say(format!(
        "diagnosing {} joints from {} rows",
        input.device.joints.len(),
        recording.len()
    ));
    let options = Options {
        without: arguments.without.clone(),
        model: model.as_ref(),
        validation: validation.as_ref(),
    };
    let mut diagnosis = diagnose(&input.device, &recording, &options)
        .map_err(|error| Failure::diagnosis(&error, &arguments.device, &arguments.log))?;
    refuse_overflow(&diagnosis, arguments)?;
    progress.say("writing");
    warnings.append(&mut diagnosis.warnings);
    diagnosis.warnings = warnings;
    let gap = GapFile::new(&diagnosis, arguments);
    let json = gap.to_json()?;
    let page = gap_report::page(&gap)?;
    let mut files = vec![
        (FILES[0], json.clone().into_bytes()),
        (FILES[1], page.into_bytes()),
    ];
    if validation.is_some() {
        files.push((FILES[2], predictions_csv(&diagnosis.predictions)?));
    }
    let written = write_all(&arguments.out, &files)?;
    drop(progress);
    terminal::warn(&diagnosis.warnings);
    if arguments.json {
        terminal::write_output(json.as_bytes())
    } else {
        terminal::write_output(gap_summary::text(&diagnosis, &written).as_bytes())
    }
}

impl DiagnoseArguments {
    /// The files that are read.
    fn inputs(&self) -> Vec<&Path> {
        let further = [&self.model, &self.validate];
        [&self.device, &self.log]
            .into_iter()
            .chain(further.into_iter().flatten())
            .map(PathBuf::as_path)
            .collect()
    }
}

/// The model identified earlier; it must be of the same device.
fn read_model(
    arguments: &DiagnoseArguments,
    device: &Device,
    warnings: &mut Vec<String>,
) -> Result<Option<Device>, Failure> {
    let Some(path) = &arguments.model else {
        return Ok(None);
    };
    let model = read_device(path, InputDrumDenominators::Stated)?;
    warnings.extend(model.warnings);
    refuse_other_device(device, &model.device, path)?;
    Ok(Some(model.device))
}

/// The second recording.
fn read_validation(
    arguments: &DiagnoseArguments,
    device: &Device,
    warnings: &mut Vec<String>,
) -> Result<Option<Recording>, Failure> {
    let Some(path) = &arguments.validate else {
        return Ok(None);
    };
    let (recording, more) = read_recording(path, device)?;
    warnings.extend(more);
    Ok(Some(recording))
}

/// A reading such as 1e300 is met by nobody before its square is taken.
fn refuse_overflow(diagnosis: &Diagnosis, arguments: &DiagnoseArguments) -> Result<(), Failure> {
    let odd = diagnosis.gap.channels.iter().find(|channel| {
        let sizes = [channel.rms_before, channel.rms_after, channel.noise_floor];
        sizes.iter().any(|size| !size.is_finite())
    });
    match odd {
        None => Ok(()),
        Some(channel) => Err(Failure::bad_input(
            "overflow",
            format!(
                "a residual of {} is too large to be squared",
                channel.channel
            ),
            arguments.log.display().to_string(),
            format!(
                "correct the reading of {} or leave its cell empty",
                channel.channel
            ),
        )),
    }
}

/// predictions.csv: a header even without rows.
fn predictions_csv(predictions: &[Prediction]) -> Result<Vec<u8>, Failure> {
    let mut writer = csv::WriterBuilder::new()
        .has_headers(false)
        .from_writer(Vec::new());
    writer
        .write_record(PREDICTION_COLUMNS)
        .map_err(Failure::internal)?;
    for prediction in predictions {
        writer.serialize(prediction).map_err(Failure::internal)?;
    }
    writer.into_inner().map_err(Failure::internal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn predictions_keep_all_digits_and_have_a_header() {
        let row = Prediction {
            row: 7,
            channel: "out2".to_owned(),
            measured: 0.1 + 0.2,
            before: -1e-9,
            after: 0.25,
        };
        let text = String::from_utf8(predictions_csv(&[row]).unwrap()).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "row,channel,measured,before,after");
        let cells: Vec<&str> = lines[1].split(',').collect();
        assert_eq!(cells[..2], ["7", "out2"]);
        let numbers: Vec<f64> = cells[2..]
            .iter()
            .map(|cell| cell.parse().unwrap())
            .collect();
        assert_eq!(numbers, [0.1 + 0.2, -1e-9, 0.25]);
        let empty = String::from_utf8(predictions_csv(&[]).unwrap()).unwrap();
        assert_eq!(empty, "row,channel,measured,before,after\n");
    }
}
