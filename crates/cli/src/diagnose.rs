//! `haptical diagnose`: diagnose, put the files together in memory, write them.

use std::path::{Path, PathBuf};

use haptical_diagnosis::{BOOTSTRAP_SEED, Diagnosis, Options, Prediction, diagnose};
use haptical_model::{Device, Recording};

use crate::arguments::DiagnoseArguments;
use crate::device_source::Equipment;
use crate::failure::Failure;
use crate::gap_file::GapFile;
use crate::input_files::{InputFile, Source};
use crate::inputs::{InputDrumDenominators, read_recording, refuse_other_device};
use crate::output_files::{NewFile, check_folder, check_outputs, write_all};
use crate::provenance::{Record, VERSION};
use crate::terminal::Progress;
use crate::{gap_report, gap_summary, terminal};

/// Header of predictions.csv, in the order of [`Prediction`].
const PREDICTION_COLUMNS: [&str; 5] = ["row", "channel", "measured", "before", "after"];

/// What is written; the last with a second log only.
pub(crate) const FILES: [&str; 3] = ["gap.json", "report.html", "predictions.csv"];

/// The files that are read.
pub(crate) struct Sources {
    pub(crate) device: Source,
    pub(crate) equipment: Equipment,
    pub(crate) log: Source,
    pub(crate) model: Option<Source>,
    pub(crate) validate: Option<Source>,
}

/// A diagnosis with the files that it gives.
pub(crate) struct Outcome {
    diagnosis: Diagnosis,
    pub(crate) files: Vec<NewFile<'static>>,
    json: String,
}

/// Runs the command.
pub(crate) fn run(arguments: &DiagnoseArguments) -> Result<(), Failure> {
    check_folder(&arguments.out)?;
    check_outputs(
        &FILES.map(|name| arguments.out.join(name)),
        &arguments.inputs(),
    )?;
    let progress = Progress::start("reading");
    let given = |path: &Option<PathBuf>| path.as_deref().map(Source::given);
    let sources = Sources {
        device: Source::given(&arguments.device),
        equipment: arguments.device_options.equipment(),
        log: Source::given(&arguments.log),
        model: given(&arguments.model),
        validate: given(&arguments.validate),
    };
    let outcome = outcome(&arguments.without, &sources, VERSION, &progress)?;
    progress.say("writing");
    let written = write_all(&arguments.out, &outcome.files)?;
    drop(progress);
    terminal::warn(&outcome.diagnosis.warnings);
    if arguments.json {
        terminal::write_output(outcome.json.as_bytes())
    } else {
        terminal::write_output(gap_summary::text(&outcome.diagnosis, &written).as_bytes())
    }
}

/// Diagnoses `without` these effects, and makes the files in memory; `version` is the one that the
/// files name.
pub(crate) fn outcome(
    without: &[String],
    sources: &Sources,
    version: &str,
    progress: &Progress,
) -> Result<Outcome, Failure> {
    let (device, log) = (&sources.device, &sources.log);
    let mut read = Read::default();
    let nominal = read.device("device", device, &sources.equipment)?;
    let recording = read.log("log", log, &nominal)?;
    let model = match &sources.model {
        None => None,
        Some(source) => {
            let model = read.device("model", source, &Equipment::default())?;
            refuse_other_device(&nominal, &model, &source.path)?;
            Some(model)
        }
    };
    let validation = match &sources.validate {
        None => None,
        Some(source) => {
            let second = read.log("validate", source, &nominal)?;
            refuse_same_log(&read.files, second == recording, source)?;
            Some(second)
        }
    };
    progress.say(format!(
        "diagnosing {} joints from {} rows",
        nominal.joints.len(),
        recording.len()
    ));
    let options = Options {
        without: without.to_vec(),
        model: model.as_ref(),
        validation: validation.as_ref(),
    };
    let mut diagnosis = diagnose(&nominal, &recording, &options)
        .map_err(|error| Failure::diagnosis(&error, &device.path, &log.path))?;
    refuse_overflow(&diagnosis, &log.path)?;
    read.warnings.append(&mut diagnosis.warnings);
    diagnosis.warnings = read.warnings;
    let mut arguments: Vec<String> = read.files.iter().map(InputFile::argument).collect();
    arguments.extend(sources.equipment.chain.flags());
    if !without.is_empty() {
        arguments.push(format!("--without={}", without.join(",")));
    }
    let mut record = Record::new(version, "diagnose", arguments, read.files);
    record.seeds.insert("bootstrap", BOOTSTRAP_SEED);
    let label = |source: &Option<Source>| source.as_ref().map(|source| source.label.clone());
    let mut gap = GapFile {
        diagnosis: &diagnosis,
        device: device.label.clone(),
        log: log.label.clone(),
        validate: label(&sources.validate),
        model: label(&sources.model),
        record,
    };
    let [json_name, page_name, predictions_name] = FILES;
    let mut files = vec![(page_name, gap_report::page(&gap)?.into_bytes())];
    if validation.is_some() {
        files.push((predictions_name, predictions_csv(&diagnosis.predictions)?));
    }
    gap.record = gap.record.with_outputs(&files);
    let json = gap.to_json()?;
    files.insert(0, (json_name, json.clone().into_bytes()));
    Ok(Outcome {
        diagnosis,
        files,
        json,
    })
}

/// What was read so far, and what is odd about it.
#[derive(Default)]
struct Read {
    files: Vec<InputFile>,
    warnings: Vec<String>,
}

impl Read {
    fn device(
        &mut self,
        flag: &str,
        source: &Source,
        equipment: &Equipment,
    ) -> Result<Device, Failure> {
        let stated = InputDrumDenominators::Stated;
        let (mut input, files) = equipment.read(flag, source, stated)?;
        self.files.extend(files);
        self.warnings.append(&mut input.warnings);
        Ok(input.device)
    }

    fn log(&mut self, flag: &str, source: &Source, device: &Device) -> Result<Recording, Failure> {
        let mut input = read_recording(&source.path, device)?;
        source.relabel(&mut input.warnings);
        self.files.push(source.input(flag, input.fingerprint));
        self.warnings.append(&mut input.warnings);
        Ok(input.recording)
    }
}

/// Rows of the fit say nothing of rows that the fit did not see: the second log must be another one. A copy
/// that was compressed or renamed has the `same_readings`.
fn refuse_same_log(
    files: &[InputFile],
    same_readings: bool,
    second: &Source,
) -> Result<(), Failure> {
    let hash = |flag: &str| {
        let file = files.iter().find(|file| file.flag == flag);
        file.map(|file| file.sha256.as_str())
    };
    if !same_readings && hash("log") != hash("validate") {
        return Ok(());
    }
    Err(Failure::bad_input(
        "same-log",
        "the log of --validate is that of --log: the fit has seen every row of it",
        second.path.display().to_string(),
        "give --validate another recording of the same device, or leave it out: then blocks of the log are held \
         back from the fit",
    ))
}

impl DiagnoseArguments {
    /// The files that are read.
    fn inputs(&self) -> Vec<&Path> {
        let further = [&self.device_options.rig, &self.model, &self.validate];
        [&self.device, &self.log]
            .into_iter()
            .chain(further.into_iter().flatten())
            .map(PathBuf::as_path)
            .collect()
    }
}

/// A reading such as 1e300 is met by nobody before its square is taken.
fn refuse_overflow(diagnosis: &Diagnosis, log: &Path) -> Result<(), Failure> {
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
            log.display().to_string(),
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
