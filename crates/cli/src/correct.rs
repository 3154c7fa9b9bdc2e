//! `haptical correct`: waypoints of the nominal device as commands of the corrected one.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use haptical::files::{Record, Source, VERSION};
use haptical::units::Shown;
use haptical::{Correct, Corrected, Match, Waypoints, correct};
use serde::Serialize;

use crate::arguments::above_zero;
use crate::failure::Failure;
use crate::flags::outputs::Outputs;
use crate::flags::{DeviceOptions, OverwriteOptions};
use crate::progress::Progress;
use crate::terminal;

/// Its name.
const COMMAND: &str = "correct";

/// End of its help.
pub(crate) const HELP: &str = "\
Example:
  haptical correct --device device.toml --model result/identified.toml --waypoints path.csv --out corrected.csv

A path is a table as a log: joint readings of the nominal device (theta1_rad, ...), whose poses are wanted, or poses of the
handle in the frame of the base (x_m, y_m, z_m, with qw, qx, qy, qz or without); with both the poses are wanted and the search starts
from the readings. Times and conditions that bend the arm (torque1_nm, fx_n, temp_degc) may stand beside them.

corrected.csv has the commands in the place of the readings, the wanted poses, and what is left of each in rest_m and
rest_rad. Of the model count geometry, drives, what joints yield under the arm's masses, and the effects that depend on the
posture; what depends on the motion (plays, delays) is left out and named. Readings stay within the limits of --model; where
a pose leaves a choice they change least. Where a waypoint cannot be reached its row is named, and nothing is written.";

/// Flags of `haptical correct`.
#[derive(Debug, Args)]
pub(crate) struct CorrectArguments {
    /// Path (CSV)
    #[arg(long, value_name = "FILE")]
    waypoints: PathBuf,
    /// Device file (TOML, URDF or MJCF) that the path was made with
    #[arg(long, value_name = "FILE")]
    device: PathBuf,
    #[command(flatten)]
    device_options: DeviceOptions,
    /// The corrected device: identified.toml or corrected.toml
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// File to write; its folder is made if it is missing
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    overwrite: OverwriteOptions,
    /// What is to be reached; the position alone by an arm with less than six joints, unless stated
    #[arg(long = "match", value_enum, default_value_t = MatchName::Auto)]
    to_match: MatchName,
    /// Distance to a waypoint that may be left
    #[arg(long, value_name = "METRES", default_value = "1e-6", value_parser = above_zero, allow_negative_numbers = true)]
    within_m: f64,
    /// Turn to a waypoint's orientation that may be left
    #[arg(long, value_name = "RADIANS", default_value = "1e-6", value_parser = above_zero, allow_negative_numbers = true)]
    within_rad: f64,
    /// Print what was written as JSON
    #[arg(long)]
    json: bool,
}

/// Parts of a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MatchName {
    /// Position and orientation where the arm has six joints or more, else the position
    Auto,
    /// Position and orientation
    Pose,
    /// The position
    Position,
}

/// What was written.
#[derive(Debug, Serialize)]
struct Written {
    written: String,
    waypoints: usize,
    with_orientations: bool,
    /// Of the path's own readings; null where it has none.
    before_rms_m: Option<f64>,
    before_largest_m: Option<f64>,
    before_largest_row: Option<usize>,
    largest_rest_m: f64,
    largest_rest_rad: Option<f64>,
    warnings: Vec<String>,
    haptical_version: &'static str,
    provenance: Record,
}

/// Runs the command.
pub(crate) fn run(arguments: &CorrectArguments) -> Result<(), Failure> {
    let outputs = Outputs::check(&arguments.out, arguments.overwrite.rule(COMMAND), &[])?;
    let progress = Progress::start("reading");
    let device = arguments.device_options.read(&arguments.device)?;
    let model = device.open_model(&Source::given(&arguments.model))?;
    let path = Waypoints::read(&Source::given(&arguments.waypoints), &device)?;
    progress.say("correcting");
    let corrected = correct(&device, &model, &path, &arguments.request())?;
    let mut files = device.inputs("device");
    files.extend(model.inputs("model"));
    files.extend(path.log.input("waypoints"));
    let flags = device.equipment().chain_flags().chain(arguments.flags());
    let record = Record::of(VERSION, COMMAND, files, flags);
    let text = vec![(outputs.name, corrected.to_csv()?)];
    let warnings = [&device.warnings, &path.log.warnings, &corrected.warnings];
    let warnings = warnings.map(Clone::clone).concat();
    let written = Written::new(arguments, &corrected, warnings, record.with_outputs(&text));
    outputs.write(text, &written)?;
    drop(progress);
    terminal::warn(&written.warnings);
    terminal::tell(arguments.json, &written, written.text())
}

impl CorrectArguments {
    fn request(&self) -> Correct {
        Correct {
            to_match: match self.to_match {
                MatchName::Auto => Match::Auto,
                MatchName::Pose => Match::Pose,
                MatchName::Position => Match::Position,
            },
            within_m: self.within_m,
            within_rad: self.within_rad,
        }
    }

    /// Flags that change the result, where they are not what they are by themselves.
    fn flags(&self) -> Vec<String> {
        let mut flags = Vec::new();
        match self.to_match {
            MatchName::Auto => {}
            MatchName::Pose => flags.push("--match=pose".to_owned()),
            MatchName::Position => flags.push("--match=position".to_owned()),
        }
        let usual = Correct::default();
        if self.within_m != usual.within_m {
            flags.push(format!("--within-m={}", self.within_m));
        }
        if self.within_rad != usual.within_rad {
            flags.push(format!("--within-rad={}", self.within_rad));
        }
        flags
    }
}

impl Written {
    fn new(
        arguments: &CorrectArguments,
        corrected: &Corrected,
        warnings: Vec<String>,
        provenance: Record,
    ) -> Self {
        let (largest_rest_m, largest_rest_rad) = corrected.largest_rest();
        let before = corrected.before_m();
        Self {
            written: arguments.out.display().to_string(),
            waypoints: corrected.waypoints.len(),
            with_orientations: corrected.with_orientations,
            before_rms_m: before.map(|(rms, ..)| rms),
            before_largest_m: before.map(|(_, largest, _)| largest),
            before_largest_row: before.map(|(.., row)| row),
            largest_rest_m,
            largest_rest_rad,
            warnings,
            haptical_version: VERSION,
            provenance,
        }
    }

    fn text(&self) -> String {
        let way = |own| small("m", own);
        let mut text = format!("{} waypoints, by the model\n", self.waypoints);
        if let (Some(rms), Some(largest), Some(row)) = (
            self.before_rms_m,
            self.before_largest_m,
            self.before_largest_row,
        ) {
            text.push_str(&format!(
                "before   the path's own readings leave {} root mean square, {} at most (row {row})\n",
                way(rms),
                way(largest)
            ));
        }
        let rest = match self.largest_rest_rad {
            Some(turn) => format!("{} and {}", way(self.largest_rest_m), small("rad", turn)),
            None => way(self.largest_rest_m),
        };
        let turns = match self.with_orientations {
            true => "",
            false => "; orientations are as they come",
        };
        text + &format!(
            "after    the commands leave {rest} at most{turns}\nWritten: {}\n",
            self.written
        )
    }
}

/// A rest as people read it: digits of rounding say nothing.
fn small(unit: &str, value: f64) -> String {
    match (unit, value < 1e-9) {
        ("m", true) => "less than 0.001 µm".to_owned(),
        (_, true) => "less than 0.001 µrad".to_owned(),
        (unit, false) => Shown::fine(unit).text(value),
    }
}
