//! `haptical report --budget`: the uncertainty of the handle's position, from a fit and the certificates of its instruments.

use std::path::PathBuf;

use clap::Args;
use haptical::files::Source;
use haptical::{Budget, BudgetOptions, Instruments, Log, budget};

use crate::arguments::number;
use crate::failure::Failure;
use crate::flags::OverwriteOptions;
use crate::interrupt::write_all;
use crate::progress::Progress;
use crate::result::Inputs;
use crate::terminal;
use crate::verify::{recorded, sought};

pub(crate) const HELP: &str = "\
Example:
  haptical report result --budget instruments.toml --out budget
  haptical report result --budget instruments.toml --region=0.3,0.6,-0.2,0.2,0,0.4 --out budget

Identifies the device anew from the inputs that the result names, and again with each instrument off by what it may be.
Writes budget.json and budget.html: contributions, sensitivities, degrees of freedom, coverage factor and expanded
uncertainty (JCGM 100), and the same by draws (JCGM 101).";

/// Name of the command in results.
const COMMAND: &str = "report";

/// Arguments of `report`.
#[derive(Debug, Args)]
pub(crate) struct ReportArguments {
    /// Folder of `haptical identify`, or its identified.json
    #[arg(value_name = "RESULT")]
    result: PathBuf,
    /// File of instruments (TOML: `[[instrument]]`): certificates, what they are known to, the readings they act on
    #[arg(long, value_name = "FILE")]
    budget: PathBuf,
    /// Folder for the files; made if it is missing
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    overwrite: OverwriteOptions,
    /// Postures that count: a log, of which the joint readings are read; the fit's own unless stated
    #[arg(long, value_name = "LOG")]
    poses: Option<PathBuf>,
    /// Only postures with the handle between these ends, in m, in the frame of the result: the tracker's, or frame (-1)
    #[arg(
        long,
        value_name = "X,X,Y,Y,Z,Z",
        value_delimiter = ',',
        num_args = 1,
        allow_hyphen_values = true
    )]
    region: Vec<f64>,
    /// Level of confidence
    #[arg(long, value_name = "P", default_value = "0.95", value_parser = level, allow_negative_numbers = true)]
    level: f64,
    /// Draws for the check
    #[arg(long, value_name = "N", default_value = "100000", value_parser = clap::value_parser!(u32).range(10_000..=10_000_000))]
    draws: u32,
    /// Where the device file is now
    #[arg(long, value_name = "FILE")]
    device: Option<PathBuf>,
    /// Where the rig file is now
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,
    /// Where the log is now
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// Print budget.json instead of the summary
    #[arg(long)]
    json: bool,
}

fn level(text: &str) -> Result<f64, String> {
    let is_level = |level: f64| level > 0.5 && level < 0.9999;
    number(text, is_level, "a level from 0.5 to 0.9999")
}

/// Runs the command.
pub(crate) fn run(arguments: &ReportArguments) -> Result<(), Failure> {
    let region_m = region(&arguments.region)?;
    let rule = arguments.overwrite.rule(COMMAND);
    rule.check(&Budget::FILES.map(|name| arguments.out.join(name)))?;
    let progress = Progress::start("reading");
    let (file, next) = (&arguments.budget, "check the path and its permissions");
    let text = std::fs::read_to_string(file);
    let text = text.map_err(|error| Failure::unreadable(&error, file, next))?;
    let instruments = Instruments::from_toml(&text, file)?;
    let (device, log, request) = inputs(arguments)?;
    let open = |path| Log::open(&Source::given(path), &device);
    let poses = arguments.poses.as_deref().map(open).transpose()?;
    let fits = instruments.instrument.len() + 1;
    progress.say(format!("identifying {fits} times"));
    let options = BudgetOptions {
        level: arguments.level,
        region_m,
        draws: arguments.draws as usize,
    };
    let made = budget(
        &device,
        &log,
        &request,
        &instruments,
        poses.as_ref(),
        &options,
    )?;
    let files = made.files()?;
    let paths = write_all(&rule, &arguments.out, &files)?;
    drop(progress);
    terminal::warn(&made.warnings);
    if arguments.json {
        return terminal::write_output(&files[0].1);
    }
    let paths: Vec<String> = paths
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    terminal::write_output(format!("{made}written  {}\n", paths.join("  ")).as_bytes())
}

fn region(ends: &[f64]) -> Result<Option<[f64; 6]>, Failure> {
    if ends.is_empty() {
        return Ok(None);
    }
    let ends: Option<[f64; 6]> = ends.try_into().ok();
    let is_region = |ends: &[f64; 6]| ends.chunks_exact(2).all(|pair| pair[0] <= pair[1]);
    ends.filter(is_region).map(Some).ok_or_else(|| {
        Failure::arguments(
            "--region has not the six ends of a box; give least and largest x, least and largest y, least and largest z in m, \
             with commas",
        )
    })
}

/// What the fit was made from, and how.
fn inputs(
    arguments: &ReportArguments,
) -> Result<(haptical::Device, Log, haptical::Identify), Failure> {
    let found = recorded::read(&arguments.result)?;
    let mut refused = None;
    for (_, result) in found {
        let result = match result {
            Ok(result) => result,
            Err(failure) => {
                refused = Some(failure);
                continue;
            }
        };
        let Some(own) = result.command.as_identification() else {
            continue;
        };
        let mut sources = Vec::new();
        for (flag, name) in result.command.inputs() {
            let given = match flag {
                "device" => arguments.device.as_deref(),
                "rig" => arguments.rig.as_deref(),
                "log" => arguments.log.as_deref(),
                _ => None,
            };
            let (source, _) = sought::find(&result, (flag, 0), name, given)?;
            sources.push((flag, source));
        }
        let inputs = Inputs(sources);
        let device = inputs.device(own.equipment())?;
        let log = inputs.log(&device)?;
        let mut request = own.request();
        request.with_causes = inputs.optional("with").cloned();
        return Ok((device, log, request));
    }
    Err(refused.unwrap_or_else(|| {
        let said = "there is no identified.json of a calibration; give the folder that `haptical identify` wrote";
        Failure::of_file("no-result", said, &arguments.result)
    }))
}
