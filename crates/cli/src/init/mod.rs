//! `haptical init`: an example to begin with: a device, a log of it, and what to ask of them.

mod arm6;
mod arm7;
#[cfg(feature = "parquet")]
mod data_set;
mod haptic7;

use std::path::Path;

use clap::{Args, ValueEnum};
use haptical::files::{check_folder, shell_word};
use haptical_data::{LogShape, write_log_to};
use haptical_model::{Device, Recording};

use crate::failure::Failure;
use crate::flags::rule;
use crate::interrupt::write_all;
use crate::terminal;

/// Name of a device file.
const DEVICE_FILE: &str = "device.toml";
/// Name of the log.
const LOG_FILE: &str = "log.csv";

/// The arguments of the command.
#[derive(Debug, Args)]
pub(crate) struct InitArguments {
    /// Folder for the files; made if it is missing
    #[arg(default_value = ".")]
    dir: std::path::PathBuf,
    /// What to begin with
    #[arg(long, value_name = "KIND", value_enum, default_value_t = Example::Paper)]
    example: Example,
    /// Overwrite files that exist
    #[arg(long)]
    force: bool,
}

/// Kinds of examples. All logs but the data set are simulated, with a seed: the same bytes each time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Example {
    /// A 7-DOF haptic device with capstan drives, external encoders and a cable encoder: a template with comments
    Paper,
    /// A six-axis arm described by a URDF, and a tracker anywhere in the room
    UrdfArm,
    /// The same arm with a ball in two sockets, the cheapest rig
    Sockets,
    /// Two recordings of the haptic device, with a gap that calibration leaves: which effect causes it?
    Gap,
    /// An arm whose motors' torques a log has: what does its description lack?
    MovingArm,
    /// Ten episodes of a robot's arm in LeRobot's format: which of them can be used?
    #[cfg(feature = "parquet")]
    DataSet,
}

/// What an example consists of.
struct Contents {
    /// Names, contents, and what is in each.
    files: Vec<(&'static str, Vec<u8>, &'static str)>,
    /// Commands to go on with, on files of the folder.
    next: Vec<Vec<Word>>,
}

/// A word of a command.
enum Word {
    /// As it is.
    Plain(&'static str),
    /// A file of the folder.
    Path(&'static str),
}

/// A command on the files of the folder: words that are in `files`, or begin with `=`, are paths in it.
fn command(words: &'static str) -> Vec<Word> {
    let word = |word: &'static str| match word.strip_prefix('=') {
        Some(file) => Word::Path(file),
        None => Word::Plain(word),
    };
    words.split(' ').map(word).collect()
}

impl Example {
    fn contents(self) -> Result<Contents, Failure> {
        match self {
            Self::Paper => haptic7::paper(),
            Self::Gap => haptic7::gap(),
            Self::UrdfArm => arm6::tracker(),
            Self::Sockets => arm6::sockets(),
            Self::MovingArm => Ok(arm7::moving()),
            #[cfg(feature = "parquet")]
            Self::DataSet => Ok(data_set::faults()),
        }
    }
}

/// A recording of a device as a log.
fn log(recording: &Recording, device: &Device) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    write_log_to(&mut bytes, recording, &LogShape::from(device)).map_err(Failure::internal)?;
    Ok(bytes)
}

/// Runs the command.
pub(crate) fn run(arguments: &InitArguments) -> Result<(), Failure> {
    let folder = &arguments.dir;
    check_folder(folder)?;
    let contents = arguments.example.contents()?;
    let mut text = "Written:\n".to_owned();
    for (name, _, what) in &contents.files {
        text.push_str(&format!("  {}: {what}\n", folder.join(name).display()));
    }
    text.push_str("\nNext:\n");
    for words in &contents.next {
        text.push_str(&format!("  {}\n", written(words, folder)));
    }
    let files = contents.files.into_iter();
    let files: Vec<_> = files.map(|(name, bytes, _)| (name, bytes)).collect();
    write_all(&rule("init", arguments.force), folder, &files)?;
    terminal::write_output(text.as_bytes())
}

/// The command for a shell.
fn written(words: &[Word], folder: &Path) -> String {
    let word = |word: &Word| match word {
        Word::Plain(word) => (*word).to_owned(),
        Word::Path(name) if folder == Path::new(".") => (*name).to_owned(),
        Word::Path(".") => shell_word(&folder.display().to_string()),
        Word::Path(name) => shell_word(&folder.join(name).display().to_string()),
    };
    words.iter().map(word).collect::<Vec<_>>().join(" ")
}
