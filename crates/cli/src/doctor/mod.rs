//! `haptical doctor`: what is wrong with a recording of many episodes, joint by joint and episode by episode.

mod comment;
mod json;
mod page;
mod pictures;
mod recording;
mod text;
mod words;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum as _};
use haptical::files::{UNSEALED, sealed_json, sealed_text};
use haptical::servo::{EpisodeLog, EpisodeReport, JointColumns, examine_episodes};

use self::recording::Recorded;
use crate::failure::Failure;
use crate::flags::{Units, rule};
use crate::interrupt::write_all;
use crate::progress::Progress;
use crate::{STATUS_SUCCESS, terminal};

/// Its name.
const COMMAND: &str = "doctor";
/// Exit status where something was found.
const STATUS_FOUND: u8 = 4;

pub(crate) const HELP: &str = "\
Examples:
  haptical doctor my_dataset
  haptical doctor my_dataset --out doctor        page with a picture of each finding, doctor.json, comment.md
  haptical doctor logs/ --json                   a folder of logs, each an episode

PATH is a LeRobot data set (version 2.1 or 3), one of its Parquet files, a log with a column `run`, or a folder of logs
(.csv, .tsv, .xlsx, .npz, .mat, .jsonl, .mcap, .db3), each an episode. No device file is needed: a joint is compared with itself. A fault is said with
its size and the episode since which it is there: offset, gain, delay, a dead joint, swapped joints, a position that ends at a
value, lost and repeated rows. What a joint does in all episodes alike is its answer: `haptical diagnose` names its cause.

Exit status: 0 nothing was found, 4 something was, 2 bad input.";

/// Arguments of `doctor`.
#[derive(Debug, Args)]
pub(crate) struct DoctorArguments {
    /// Data set (folder with meta/info.json and data/), Parquet file, log with several runs, or folder of logs
    #[arg(value_name = "PATH")]
    recording: PathBuf,
    /// Folder for doctor.html, doctor.json and comment.md; made if it is missing
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Overwrite files at --out that no `haptical doctor` wrote
    #[arg(long)]
    force: bool,
    /// Print the findings as JSON
    #[arg(long)]
    json: bool,
    /// Print them as Markdown, to paste into the data set's page
    #[arg(long, conflicts_with = "json")]
    comment: bool,
    /// Unit of the data set's numbers; without it radians where none is beyond 7, degrees where one is beyond 101
    #[arg(long)]
    units: Option<Units>,
    /// Key of the joints' positions; without it `observation.state` or the key of such words
    #[arg(long, value_name = "KEY")]
    state: Option<String>,
    /// Key of their commands; without it `action` or the key of such words
    #[arg(long, value_name = "KEY")]
    action: Option<String>,
}

/// A recording and what was found in it.
struct Examined {
    /// Path as the user gave it.
    path: PathBuf,
    recorded: Recorded,
    report: EpisodeReport,
}

/// Runs the command.
pub(crate) fn run(arguments: &DoctorArguments) -> Result<u8, Failure> {
    let rule = rule(COMMAND, arguments.force);
    if let Some(out) = &arguments.out {
        let files = ["doctor.html", "doctor.json", "comment.md"].map(|name| out.join(name));
        rule.check(&files)?;
    }
    let progress = Progress::start("reading");
    let keys = [&arguments.state, &arguments.action].map(Option::as_deref);
    let recorded = recording::read(&arguments.recording, keys, arguments.units)?;
    progress.say("examining the joints");
    let report = examine(&recorded);
    let examined = Examined {
        path: arguments.recording.clone(),
        recorded,
        report,
    };
    if let Some(out) = &arguments.out {
        progress.say("drawing");
        write(&examined, out, &rule)?;
    }
    drop(progress);
    terminal::warn(&examined.recorded.warnings);
    match arguments.comment {
        true => terminal::write_output(comment::comment(&examined)?.as_bytes())?,
        false => terminal::tell(
            arguments.json,
            &json::json(&examined),
            text::text(&examined, arguments.out.as_deref())?,
        )?,
    }
    Ok(match examined.report.is_sound() {
        true => STATUS_SUCCESS,
        false => STATUS_FOUND,
    })
}

/// The findings of a recording as JSON.
pub(crate) fn report(
    path: &Path,
    units: Option<&str>,
    keys: [Option<&str>; 2],
) -> Result<serde_json::Value, Failure> {
    let units = units.map(|word| Units::from_str(word, false)).transpose();
    let units =
        units.map_err(|_| Failure::arguments("units are `radians`, `degrees` or `percent`"))?;
    let recorded = recording::read(path, keys, units)?;
    let report = examine(&recorded);
    Ok(json::json(&Examined {
        path: path.to_owned(),
        recorded,
        report,
    }))
}

fn examine(recorded: &Recorded) -> EpisodeReport {
    let joints: Vec<JointColumns<'_>> = (recorded.position.iter().enumerate())
        .map(|(joint, position)| JointColumns {
            position,
            command: recorded.command.get(joint).map(Vec::as_slice),
        })
        .collect();
    examine_episodes(&EpisodeLog {
        time_s: &recorded.time_s,
        episodes: &recorded.episodes,
        joints: &joints,
        described_rows: &recorded.described_rows,
        least_offset: recorded.unit.least_offset(),
    })
}

fn write(
    examined: &Examined,
    out: &Path,
    rule: &haptical::files::WriteRule,
) -> Result<(), Failure> {
    let by = format!("haptical {COMMAND}");
    let sealed = |text: &str| sealed_text(text, &by, ["<!-- ", " -->"]).into_bytes();
    let mut report = json::json(examined);
    if let Some(report) = report.as_object_mut() {
        // by these a later run knows its files
        report.insert("command".to_owned(), COMMAND.into());
        report.insert("result_sha256".to_owned(), UNSEALED.into());
    }
    let files = vec![
        ("doctor.html", sealed(&page::page(examined)?)),
        ("doctor.json", sealed_json(&report)?.into_bytes()),
        ("comment.md", sealed(&comment::comment(examined)?)),
    ];
    write_all(rule, out, &files).map(|_| ())
}
