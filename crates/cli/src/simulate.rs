//! `haptical simulate`: a log of a device that a hand moves, written row by row, or of single postures.

mod forward;
mod made;
mod poses;
mod replay;
mod truth;

use std::path::{Path, PathBuf};

use clap::Args;
use haptical::files::{InputFile, NewFile, Record, Source, VERSION};
use haptical::true_device;
use haptical_model::{check_toml_syntax, read_toml_text};
use haptical_simulator::{
    Effect, EffectError, Effects, HandMotion, SimulatorError, simulated_effects,
};
use serde::Serialize;

use crate::arguments::{above_zero, whole_number};
use crate::failure::Failure;
use crate::flags::outputs::{Outputs, RECORD};
use crate::flags::{DeviceOptions, OverwriteOptions};
use crate::terminal;

use self::truth::truth_text;

/// Its name.
const COMMAND: &str = "simulate";

/// End of the name of a true device that was drawn.
const TRUTH: [&str; 1] = [".truth.toml"];

/// Largest size of an effect in SI units; a stiffness comes nearest to it.
const LARGEST_SIZE: f64 = 1e12;

/// The arguments of the command.
#[derive(Debug, Args)]
pub(crate) struct SimulateArguments {
    /// Device file (TOML, URDF or MJCF): what the log is to be read with
    #[arg(long, value_name = "FILE")]
    device: PathBuf,
    #[command(flatten)]
    device_options: DeviceOptions,
    /// Device file whose numbers are the true ones; without it the device has no errors
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    /// Draw the true device: numbers of links, drums and unknown cables differ from the device file by normal numbers,
    /// this share of their plausible size (5 mm, 20 mrad); OUT.truth.toml has it
    #[arg(long, value_name = "SHARE", conflicts_with = "truth", value_parser = above_zero, allow_negative_numbers = true)]
    deviate: Option<f64>,
    /// Effects that the model leaves out (TOML)
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    /// Single postures in place of a hand's motion: the poses.csv of `haptical plan`, or a log. Rows that touch something
    /// (contact, plane) or are held (fixture1_rad) are led to where the true device meets it
    #[arg(long, value_name = "FILE", conflicts_with_all = ["replay", "seconds", "rate_hz"])]
    poses: Option<PathBuf>,
    /// What is read at --poses: a rig as `haptical plan` names it; OUT.rig.toml is its file for --rig. Without it: what the
    /// device file describes
    #[arg(long, value_name = "RIG", requires = "poses")]
    measure: Option<String>,
    /// Log whose motion, loads and times are run through the device with its effects, in place of a hand's motion: predicted
    /// channels go to --out, and OUT.residuals.csv has them beside the measured ones
    #[arg(long, value_name = "FILE", conflicts_with_all = ["truth", "deviate", "effects", "seconds", "rate_hz", "seed"])]
    replay: Option<PathBuf>,
    /// Move the device by the torques of --log, or by a --controller that follows its commands, and say joint by joint how
    /// far that drifts from the log within 0.1, 0.5, 1 and 5 s and over each run, begun again from the log's state; --out is a CSV
    /// with the log and the predictions of 1 s, OUT.html a page
    #[arg(long, requires = "log", conflicts_with_all = ["truth", "deviate", "effects", "poses", "replay", "seconds", "rate_hz", "seed"])]
    forward: bool,
    /// Log of --forward: t_s, theta1_rad, ... and torque1_nm, ... or command1_rad, ...
    #[arg(long, value_name = "FILE", requires = "forward")]
    log: Option<PathBuf>,
    /// A second device of --forward, such as a corrected one: the table has both
    #[arg(long, value_name = "FILE", requires = "forward")]
    with: Option<PathBuf>,
    /// Controller (TOML) that moves the devices of --forward: kp_nm_per_rad, kd_nm_s_per_rad (lists), gravity_compensation
    /// (of --device), rate_hz, velocity_lowpass_hz
    #[arg(long, value_name = "FILE", requires = "forward")]
    controller: Option<PathBuf>,
    /// Length of the recording in s
    #[arg(long, value_name = "SECONDS", default_value_t = 100.0, value_parser = above_zero, allow_negative_numbers = true)]
    seconds: f64,
    /// Rows per second
    #[arg(long, value_name = "HZ", default_value_t = 1000.0, value_parser = above_zero, allow_negative_numbers = true)]
    rate_hz: f64,
    /// Seed of motion, force and noise: the same seed gives the same log
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole_number, allow_negative_numbers = true)]
    seed: u64,
    /// Log to be written (CSV; gzip if the name ends in .gz)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    overwrite: OverwriteOptions,
    /// Print what was written as JSON
    #[arg(long)]
    json: bool,
}

/// What was written.
#[derive(Debug, Serialize)]
struct Written<'a> {
    /// Its place on standard output, its name in the provenance file.
    log: String,
    rows: u64,
    seconds: f64,
    rate_hz: f64,
    seed: u64,
    device: String,
    truth: Option<String>,
    effects: &'a [Effect],
    haptical_version: &'static str,
    provenance: Record,
}

/// Example and the names of the effects, for `--help`.
pub(crate) fn help() -> String {
    format!(
        "\
Example:
  haptical simulate --device device.toml --effects effects.toml --out log.csv.gz

  haptical plan --device device.toml --measure out,contact:2:0.2 --poses 60 --out plan
  haptical simulate --device device.toml --deviate 0.2 --poses plan/poses.csv --measure out,contact:2:0.2 --out log.csv
  haptical identify --device device.toml --rig log.csv.rig.toml --log log.csv --out result

  haptical simulate --device corrected.toml --out log.csv.gz
  haptical simulate --device corrected.toml --replay log.csv.gz --out predicted.csv.gz

  haptical simulate --forward --device nominal.toml --with corrected.toml --log log.csv.gz --out forward.csv

Effects of the device file (`[[effect]]`) are part of the device, every law of `haptical diagnose --list`; an arm
with a [tracker] gets its positions and orientations. With --poses OUT.truth.toml is the true device with the
places of all that it touched, and of the tracker. --effects adds effects by laws of the simulator's own to a hand's
motion, with an effects.toml such as
  [[effect]]
  name = \"capstan-compliance\"
  joint = 2
  stiffness_nm_per_rad = 260.0

Names of effects: {}",
        simulated_effects().join(", ")
    )
}

/// Runs the command.
pub(crate) fn run(arguments: &SimulateArguments) -> Result<(), Failure> {
    if let Some(log) = arguments.log.as_ref().filter(|_| arguments.forward) {
        return forward::run(arguments, log);
    }
    if let Some(log) = &arguments.replay {
        return replay::run(arguments, log);
    }
    if let Some(path) = &arguments.poses {
        return poses::run(arguments, path);
    }
    let rule = arguments.overwrite.rule(COMMAND);
    rule.check_inputs(std::slice::from_ref(&arguments.out))?;
    let ends = arguments.deviate.map_or(&[][..], |_| &TRUTH);
    let outputs = Outputs::check(&arguments.out, rule, ends)?;
    let mut device = arguments.device_options.read(&arguments.device)?;
    device.refuse_hands("a simulated log")?;
    let mut files = device.inputs("device");
    let truth_path = arguments.truth.as_ref().unwrap_or(&arguments.device);
    let other = arguments.read_truth(&mut device, &mut files)?;
    let truth = &true_device(&device, arguments.truth(other.as_ref()), arguments.seed)?;
    let effects = match &arguments.effects {
        None => Effects::none(),
        Some(path) => {
            let (effects, file) = read_effects(path)?;
            files.push(file);
            effects
        }
    };
    let refuse = |error: SimulatorError| refusal(&error, truth_path, arguments);
    let rows = made::write((arguments, &outputs), truth, &effects, &refuse)?;
    let truth_name = outputs.name(TRUTH[0]);
    let mut written = Vec::new();
    if arguments.deviate.is_some() {
        written.push((truth_name.as_str(), truth_text(truth)?.into_bytes()));
    }
    let mut summary = Written {
        log: Source::given(&arguments.out).label,
        rows,
        seconds: arguments.seconds,
        rate_hz: arguments.rate_hz,
        seed: arguments.seed,
        device: device.source().label.clone(),
        truth: arguments.truth_label(),
        effects: effects.as_slice(),
        haptical_version: VERSION,
        provenance: arguments.record(files, &outputs, &written)?,
    };
    outputs.write(written, &summary)?;
    terminal::warn(&device.warnings);
    summary.log = arguments.out.display().to_string();
    let record = outputs.place(RECORD);
    let text = summary.text() + &format!("Provenance: {}\n", record.display());
    terminal::tell(arguments.json, &summary, text)
}

impl SimulateArguments {
    /// How the log and the files beside it came about.
    fn record(
        &self,
        files: Vec<InputFile>,
        outputs: &Outputs<'_>,
        beside: &[NewFile<'_>],
    ) -> Result<Record, Failure> {
        let mut flags: Vec<String> = self.device_options.equipment().chain_flags().collect();
        flags.extend(self.deviate.map(|share| format!("--deviate={share}")));
        flags.extend(self.measure.iter().map(|rig| format!("--measure={rig}")));
        if self.poses.is_none() {
            flags.push(format!("--seconds={}", self.seconds));
            flags.push(format!("--rate-hz={}", self.rate_hz));
        }
        flags.push(format!("--seed={}", self.seed));
        let mut record = Record::of(VERSION, COMMAND, files, flags).with_outputs(beside);
        record.seeds.insert("simulation", self.seed);
        record.outputs.insert(0, outputs.written()?);
        Ok(record)
    }

    fn truth_label(&self) -> Option<String> {
        let truth = self.truth.as_deref();
        truth.map(|path| Source::given(path).label)
    }
}

impl Written<'_> {
    fn text(&self) -> String {
        let mut text = format!(
            "Written: {}, {} rows, {} s at {} Hz, seed {}\n",
            self.log, self.rows, self.seconds, self.rate_hz, self.seed
        );
        for effect in self.effects {
            let place = effect.joint().map(|joint| format!(" of joint {joint}"));
            let place = place.unwrap_or_default();
            text.push_str(&format!("  with {}{place}\n", effect.name()));
        }
        text
    }
}

fn read_effects(path: &Path) -> Result<(Effects, InputFile), Failure> {
    let name = path.display().to_string();
    let refuse = |error| Failure::device_file(&error, path);
    let text = read_toml_text(path).map_err(refuse)?;
    check_toml_syntax(&text, &name).map_err(refuse)?;
    let refuse = |error: EffectError| effects_refusal(&error, &name);
    let effects = Effects::from_toml(&text, &name).map_err(refuse)?;
    refuse_huge(&effects, &name)?;
    let source = Source::given(path);
    let file = source.input("effects", source.fingerprint_text(&text));
    Ok((effects, file))
}

/// Refuses sizes with which the simulation would leave the range of numbers.
fn refuse_huge(effects: &Effects, file: &str) -> Result<(), Failure> {
    for (index, effect) in effects.as_slice().iter().enumerate() {
        let fields = serde_json::to_value(effect).map_err(Failure::internal)?;
        let mut fields = fields.as_object().into_iter().flatten();
        let huge = fields.find(|(_, value)| value.as_f64().is_some_and(|v| v.abs() > LARGEST_SIZE));
        if let Some((parameter, value)) = huge {
            let (number, name) = (index + 1, effect.name());
            return Err(Failure::bad_input(
                "effects",
                format!("effect {number} (`{name}`): `{parameter}` is {value}"),
                file,
                format!("give it in SI units, at most {LARGEST_SIZE:e}"),
            ));
        }
    }
    Ok(())
}

fn effects_refusal(error: &EffectError, file: &str) -> Failure {
    let text = error.to_string();
    let text = text.strip_prefix(file).unwrap_or(&text);
    let text = text.trim_start_matches([':', ',', ' ']);
    let split = text.split_once("; ").or_else(|| text.split_once(", but "));
    let usual = "correct it; an example is in `haptical simulate --help`";
    let (what, next) = split.unwrap_or((text, usual));
    // What the reader of TOML calls by the names of types.
    let what = what
        .replace("expected f64", "a number is expected")
        .replace("expected usize", "a joint's number is expected, from 1")
        .replace("is NaN", "is not a number");
    Failure::bad_input("effects", what, file, next)
}

/// What the simulator refuses, said of the argument or file that it came from.
fn refusal(error: &SimulatorError, truth: &Path, arguments: &SimulateArguments) -> Failure {
    let text = error.to_string();
    match error {
        SimulatorError::Effects(error) => {
            let file = arguments.effects.as_deref().unwrap_or(Path::new(""));
            effects_refusal(error, &file.display().to_string())
        }
        SimulatorError::Setting {
            setting: "seconds", ..
        } => {
            let what = format!("a recording of {} s is asked for", arguments.seconds);
            let rests_s = 2.0 * HandMotion::default().home_rest_s;
            let next = format!("give --seconds above {rests_s}, the rests at home, and up to 1e7");
            Failure::command_line("arguments", what, next)
        }
        SimulatorError::Setting {
            setting: "seconds x rate_hz",
            value,
            allowed,
        } => {
            let what = format!("a log of {value:e} rows is asked for");
            let next = format!("give other --seconds or --rate-hz: allowed are {allowed}");
            Failure::command_line("arguments", what, next)
        }
        SimulatorError::Setting { allowed, .. } => {
            let what = text.split_once("; ").map_or(&*text, |(what, _)| what);
            Failure::command_line("arguments", what, format!("allowed: {allowed}"))
        }
        _ => {
            let next = "correct the device file, or the effects, or take another --seed";
            Failure::in_file("device", text, truth, next)
        }
    }
}

#[cfg(test)]
mod tests {
    use haptical_simulator::{simulated_effects, simulated_keys};

    /// Which side drives a loop is the recording's, not the effect's.
    const OF_THE_RECORDING: [&str; 2] = ["joint", "driven_by"];

    /// Effects are put on the first cable.
    const OF_FURTHER_CABLES: &str = "cable";

    /// What `simulate` alone knows: drums without a law that a diagnosis could name.
    const WITHOUT_A_LAW: &str = "drum-roughness";

    #[test]
    fn names_and_keys_of_effects_are_those_of_the_catalogue() {
        let named = simulated_effects()
            .into_iter()
            .filter(|&name| name != WITHOUT_A_LAW);
        for name in named {
            let specs = haptical_effects::specs().filter(|spec| spec.name == name);
            let mut known: Vec<&str> = specs
                .flat_map(|spec| spec.parameters)
                .map(|parameter| parameter.name)
                .collect();
            let mut taken: Vec<&str> = simulated_keys(name).unwrap().to_vec();
            taken.retain(|key| !OF_THE_RECORDING.contains(key));
            known.sort_unstable();
            known.dedup();
            known.retain(|key| *key != OF_FURTHER_CABLES);
            taken.sort_unstable();
            assert!(
                !known.is_empty() && taken == known,
                "{name}: {taken:?} {known:?}"
            );
        }
    }
}
