//! `haptical watch`: a log that grows, judged as it comes.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use haptical::Device;
use haptical::files::{Source, WriteRule};
use haptical::watch::{Feed, Watch, WatchEvent, WatchOptions, WatchState, WatchVerdict};
use serde::Serialize;

use crate::arguments::above_zero;
use crate::failure::Failure;
use crate::flags::{DeviceOptions, OverwriteOptions, folder_and_name};
use crate::interrupt::Writing;
use crate::{STATUS_SUCCESS, STATUS_UNIDENTIFIABLE, terminal};

/// Its name.
const COMMAND: &str = "watch";
/// Exit status where the calibration is no longer true.
const STATUS_UNTRUE: u8 = 4;
/// How long nothing new is waited for.
const PAUSE: Duration = Duration::from_millis(200);

pub(crate) const HELP: &str = "\
Examples:
  haptical watch --device gap/corrected.toml today.csv
  haptical watch --device gap/corrected.toml --reference good.csv --once new.csv
  recorder | haptical watch --device gap/corrected.toml --page watch.html -

The log is a CSV file that grows, a folder into which logs arrive, or `-`: CSV or JSON lines on standard input. Rows are
judged in blocks against a reference: --reference, or else the first rows, ten minutes of them or as long as the
noise remembers. An alarm says since when, with a 95 % interval, and what moved; then the rows since are diagnosed.

On a terminal a line a minute is printed, in a pipe JSON lines. Ctrl-C ends with a summary.
Exit status at the end: 0 true, 4 no longer true, 3 too few rows to judge.";

/// Arguments of `watch`.
#[derive(Debug, Args)]
pub(crate) struct WatchArguments {
    /// Log, folder of logs, or `-` for standard input
    #[arg(value_name = "LOG|DIR|-")]
    pub(crate) log: PathBuf,
    /// Calibrated device file: identified.toml, corrected.toml
    #[arg(long, value_name = "FILE")]
    pub(crate) device: PathBuf,
    #[command(flatten)]
    pub(crate) device_options: DeviceOptions,
    /// Log of the device while its calibration was true; without it the first rows are the reference
    #[arg(long, value_name = "LOG")]
    pub(crate) reference: Option<PathBuf>,
    /// Least seconds of a reference that the first rows are; a log given with --reference may be shorter, down to 60 s
    #[arg(long, value_name = "S", default_value = "600", value_parser = above_zero, allow_negative_numbers = true)]
    pub(crate) reference_s: f64,
    /// Rows a second, of a log without t_s
    #[arg(long, value_name = "HERTZ", value_parser = above_zero, allow_negative_numbers = true)]
    pub(crate) rate_hz: Option<f64>,
    /// False alarms in an hour of rows, at most, on average
    #[arg(long, value_name = "RATE", default_value = "0.001", value_parser = above_zero, allow_negative_numbers = true)]
    pub(crate) false_alarms_per_hour: f64,
    /// What the mean residual of a channel may be off without being another, in m or rad, as in cable=1e-4, beside
    /// what the reference does not know; a tenth of its stated noise unless stated
    #[arg(long, value_name = "CHANNEL=SIZE", value_delimiter = ',', value_parser = tolerance)]
    pub(crate) tolerance: Vec<(String, f64)>,
    /// Judge what is there, and end
    #[arg(long)]
    pub(crate) once: bool,
    /// Page that is written again each time, and that asks the browser to load it again
    #[arg(long, value_name = "FILE")]
    pub(crate) page: Option<PathBuf>,
    /// Seconds between two lines and two pages
    #[arg(long, value_name = "S", default_value = "60", value_parser = above_zero, allow_negative_numbers = true)]
    pub(crate) every_s: f64,
    /// Folder for the rows of an alarm and their diagnosis
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) overwrite: OverwriteOptions,
    /// Lines for people or for programs; by the kind of the output unless stated
    #[arg(long, value_enum, value_name = "FORM")]
    pub(crate) lines: Option<Lines>,
}

/// What the lines are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Lines {
    /// People
    Text,
    /// Programs: a JSON object a line
    Json,
}

fn tolerance(text: &str) -> Result<(String, f64), String> {
    let wanted = "as in cable=1e-4, the size in m or rad and above 0";
    let (name, size) = text.split_once('=').ok_or(wanted)?;
    Ok((name.to_owned(), above_zero(size).map_err(|_| wanted)?))
}

/// A state among the events.
#[derive(Serialize)]
struct Stated<'s> {
    event: &'static str,
    #[serde(flatten)]
    state: &'s WatchState,
}

/// Where lines and pages go.
struct Output<'a> {
    lines: Lines,
    page: Option<&'a Path>,
    rule: WriteRule,
    every: Duration,
    /// All is said in the summary.
    is_brief: bool,
    last: Option<Instant>,
}

/// Runs the command.
pub(crate) fn run(arguments: &WatchArguments) -> Result<u8, Failure> {
    let options = options(arguments);
    check_outputs(arguments, &options)?;
    let equipment = arguments.device_options.equipment();
    let device = Device::open(&Source::given(&arguments.device), &equipment)?;
    terminal::warn(&device.warnings);
    let rule = options.rule.clone();
    let mut watch = Watch::new(device, options)?;
    let mut output = Output {
        lines: arguments
            .lines
            .unwrap_or(match std::io::stdout().is_terminal() {
                true => Lines::Text,
                false => Lines::Json,
            }),
        page: arguments.page.as_deref(),
        rule,
        every: Duration::from_secs_f64(arguments.every_s.min(1e9)),
        is_brief: arguments.once,
        last: None,
    };
    // Ctrl-C is asked for, so that the summary is still said
    let asked = Writing::begin();
    if let Some(reference) = &arguments.reference {
        watch.begin_reference();
        let mut feed = Feed::open(reference)?;
        while !asked.is_interrupted() {
            let fed = feed.look(&mut watch, true)?;
            output.events(&fed.events)?;
            if fed.ended {
                break;
            }
        }
        output.events(&watch.end_reference()?)?;
    }
    let mut feed = match arguments.log.as_os_str() == "-" {
        true => Feed::pipe(std::io::stdin(), "standard input"),
        false => Feed::open(&arguments.log)?,
    };
    while !asked.is_interrupted() {
        let fed = feed.look(&mut watch, arguments.once)?;
        output.events(&fed.events)?;
        if fed.ended {
            break;
        }
        output.state(&watch, !fed.events.is_empty())?;
        if !fed.grew {
            std::thread::sleep(PAUSE);
        }
    }
    output.events(&watch.finish()?)?;
    output.end(&watch)?;
    drop(asked);
    Ok(match watch.verdict() {
        WatchVerdict::True => STATUS_SUCCESS,
        WatchVerdict::Untrue => STATUS_UNTRUE,
        WatchVerdict::NotJudged => STATUS_UNIDENTIFIABLE,
    })
}

/// Refuses, before any work, files that must not be written; rows of an alarm in the folder that is watched would be judged again.
fn check_outputs(arguments: &WatchArguments, options: &WatchOptions) -> Result<(), Failure> {
    options.check_outputs(arguments.page.as_deref())?;
    let place = |path: &Path| path.canonicalize().ok();
    let out = arguments.out.as_deref().and_then(place);
    if out.is_some() && arguments.log.is_dir() && out == place(&arguments.log) {
        let said = "--out is the folder that is watched: the rows of an alarm would be read as a log of it; give another --out";
        return Err(Failure::of_file("unwritable", said, &arguments.log));
    }
    Ok(())
}

fn options(arguments: &WatchArguments) -> WatchOptions {
    WatchOptions {
        false_alarms_per_hour: arguments.false_alarms_per_hour,
        reference_s: arguments.reference_s,
        rate_hz: arguments.rate_hz,
        tolerances: arguments.tolerance.clone(),
        out: arguments.out.clone(),
        rule: arguments.overwrite.rule(COMMAND),
        ..WatchOptions::default()
    }
}

impl Output<'_> {
    fn events(&self, events: &[WatchEvent]) -> Result<(), Failure> {
        for event in events {
            let is_said_later = self.is_brief && !matches!(event, WatchEvent::Note { .. });
            match self.lines {
                Lines::Text if is_said_later => {}
                _ => self.say(event.line() + "\n", event)?,
            }
        }
        Ok(())
    }

    /// A text for people, or a value in a line for programs.
    fn say(&self, text: String, value: &impl Serialize) -> Result<(), Failure> {
        let json = || serde_json::to_string(value).map_err(Failure::internal);
        let said = match self.lines {
            Lines::Text => text,
            Lines::Json => json()? + "\n",
        };
        terminal::write_output(said.as_bytes())
    }

    fn say_state(
        &self,
        text: String,
        event: &'static str,
        state: &WatchState,
    ) -> Result<(), Failure> {
        self.say(text, &Stated { event, state })
    }

    /// The line and the page of a state, where it is time for them.
    fn state(&mut self, watch: &Watch, is_news: bool) -> Result<(), Failure> {
        let is_due = self.last.is_none_or(|last| last.elapsed() >= self.every);
        if !is_due && !is_news {
            return Ok(());
        }
        let state = watch.state();
        if is_due && self.last.replace(Instant::now()).is_some() {
            self.say_state(state.line() + "\n", "state", &state)?;
        }
        let refresh_s = self.every.as_secs_f64().clamp(1.0, 3600.0) as u32;
        self.write_page(&state, refresh_s)
    }

    fn end(&self, watch: &Watch) -> Result<(), Failure> {
        let state = watch.state();
        self.say_state(state.summary(), "end", &state)?;
        // nothing more comes
        self.write_page(&state, 0)
    }

    fn write_page(&self, state: &WatchState, refresh_s: u32) -> Result<(), Failure> {
        if let Some(path) = self.page {
            let (folder, name) = folder_and_name(path)?;
            let page = state.page(refresh_s)?.into_bytes();
            self.rule.write(folder, &[(name, page)], &|| false)?;
        }
        Ok(())
    }
}
