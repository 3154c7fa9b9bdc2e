//! `haptical import`: recordings of other makers as logs of this program, written whole or not at all.

#[cfg(any(feature = "mcap", feature = "rosbag2"))]
mod bag;
#[cfg(feature = "parquet")]
pub(crate) mod lerobot;
mod mukca;
mod poses;
mod renamed;
mod sockets;
mod table;

pub(crate) use table::refused;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use haptical::files::WriteRule;
use haptical_data::{JointShape, LogShape, write_log_to};
use haptical_model::Recording;
use serde_json::json;

use crate::failure::Failure;
use crate::flags::{folder_and_name, rule};
use crate::interrupt::write_all;
use crate::terminal;

/// End of the help of `haptical import`.
pub(crate) const HELP: &str = "\
Tables of any kind, in two steps; docs/guides/import.md has the mapping file:
  haptical import --guess table.xlsx --out columns.toml      read it, correct it
  haptical import --columns columns.toml table.xlsx --out log.csv
Recordings whose form is known:
  haptical import mukca panda_1 --out log.csv
  haptical import bag bag.db3 --device arm.urdf --out log.csv";

/// Flags of `haptical import`.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(crate) struct ImportArguments {
    #[command(subcommand)]
    from: Option<From>,
    #[command(flatten)]
    table: table::TableArguments,
}

/// Origin of a recording.
#[derive(Debug, Subcommand)]
enum From {
    /// Postures with a ball in one of two sockets: `DIR/POSITION/hole_{0,1}.csv`
    #[command(after_help = mukca::HELP)]
    Mukca(mukca::MukcaArguments),
    /// One table, its columns renamed and scaled by flags
    #[command(after_help = poses::HELP)]
    Poses(poses::PosesArguments),
    /// Joint states (and poses) of ROS 2 in a bag (.mcap, .db3), the joints chosen by name
    #[cfg(any(feature = "mcap", feature = "rosbag2"))]
    #[command(after_help = bag::HELP, alias = "mcap")]
    Bag(bag::BagArguments),
    /// A LeRobot data set: its actions as commands, its observed states as joints, its episodes as runs
    #[cfg(feature = "parquet")]
    #[command(after_help = lerobot::HELP)]
    Lerobot(lerobot::LerobotArguments),
}

/// Runs the command.
pub(crate) fn run(arguments: &ImportArguments) -> Result<(), Failure> {
    let Some(from) = &arguments.from else {
        return table::run(&arguments.table);
    };
    match from {
        From::Mukca(arguments) => mukca::run(arguments),
        From::Poses(arguments) => poses::run(arguments),
        #[cfg(any(feature = "mcap", feature = "rosbag2"))]
        From::Bag(arguments) => bag::run(arguments),
        #[cfg(feature = "parquet")]
        From::Lerobot(arguments) => lerobot::run(arguments),
    }
}

/// The file that an import writes, and the form of its summary.
#[derive(Debug, Args)]
struct Target {
    /// Log to write (CSV); its folder is made if it is missing
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Overwrite files at --out with other content; a log does not say who wrote it
    #[arg(long)]
    force: bool,
    /// Print what was written as JSON
    #[arg(long)]
    json: bool,
}

/// What an import found.
struct Imported {
    log: Vec<u8>,
    rows: usize,
    joints: usize,
    /// Further file: the end of its name, and its content.
    beside: Option<(&'static str, Vec<u8>)>,
    warnings: Vec<String>,
}

impl Imported {
    /// A recording as a log.
    fn of(recording: &Recording, shape: &LogShape, warnings: Vec<String>) -> Result<Self, Failure> {
        let mut log = Vec::new();
        write_log_to(&mut log, recording, shape)?;
        Ok(Self {
            log,
            rows: recording.len(),
            joints: shape.joints.len(),
            beside: None,
            warnings,
        })
    }
}

impl Target {
    /// Folder and name of the log.
    fn place(&self) -> Result<(&Path, &str), Failure> {
        let (folder, name) = folder_and_name(&self.out)?;
        let is = |end: &&str| name.to_ascii_lowercase().ends_with(end);
        if [".gz", ".parquet", ".mcap", ".toml"].iter().any(is) {
            let out = self.out.display();
            let what = format!("--out is {out}, and a log is written as CSV");
            let next = "give a name that ends in .csv";
            return Err(Failure::command_line("arguments", what, next));
        }
        Ok((folder, name))
    }

    /// Path of a further file: the log's name without `.csv`, then `end`.
    fn beside(&self, end: &str) -> PathBuf {
        self.out.with_extension(end)
    }

    /// Refuses what cannot be written, before any work.
    fn check(&self, end: Option<&str>) -> Result<(), Failure> {
        self.place()?;
        let mut outputs = vec![self.out.clone()];
        outputs.extend(end.map(|end| self.beside(end)));
        self.rule().check_inputs(&outputs)
    }

    /// What may be written: a log does not say who wrote it, so that only one with the same content is there already.
    fn rule(&self) -> WriteRule {
        rule("import", self.force)
    }

    /// Writes a text that is no log.
    fn write_text(&self, text: String) -> Result<(), Failure> {
        let (folder, name) = folder_and_name(&self.out)?;
        write_all(&self.rule(), folder, &[(name, text.into_bytes())])?;
        let written = self.out.display().to_string();
        let text =
            format!("Written:\n  {written}: read it, correct it, and give it as --columns\n");
        terminal::tell(self.json, &json!({"written": [written]}), text)
    }

    /// Writes the log and the further file: both or none.
    fn write(&self, imported: Imported) -> Result<(), Failure> {
        let (folder, name) = self.place()?;
        let Imported {
            log,
            rows,
            joints,
            beside,
            warnings,
        } = imported;
        let further = beside.as_ref().map(|(end, _)| self.beside(end));
        let further_name = further.as_ref().and_then(|path| path.file_name()?.to_str());
        let mut files = vec![(name, log)];
        if let (Some(name), Some((_, content))) = (further_name, beside) {
            files.push((name, content));
        }
        write_all(&self.rule(), folder, &files)?;
        terminal::warn(&warnings);
        let written = std::iter::once(&self.out).chain(&further);
        let written: Vec<String> = written.map(|path| path.display().to_string()).collect();
        let log = &written[0];
        let mut text = format!("Written:\n  {log}: {rows} rows of {joints} joints\n");
        if let Some(further) = written.get(1) {
            text.push_str(&format!("  {further}: give it as --rig\n"));
        }
        let value = json!({
            "written": written,
            "rows": rows,
            "joints": joints,
            "warnings": warnings,
        });
        terminal::tell(self.json, &value, text)
    }
}

/// A log of joints without limits; `is_prismatic` by joint.
fn shape_without_limits(is_prismatic: &[bool], cable_count: usize) -> LogShape {
    let joints = is_prismatic.iter().enumerate();
    let joints = joints.map(|(index, &prismatic)| JointShape {
        name: (index + 1).to_string(),
        prismatic,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
    });
    LogShape {
        joints: joints.collect(),
        cable_count,
        hands: Vec::new(),
    }
}
