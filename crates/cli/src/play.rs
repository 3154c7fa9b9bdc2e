//! `haptical play`: one page that plays a log, the nominal arm and the calibrated one side by side.

mod page;
mod recorded;
mod summary;

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use haptical::files::{InputFile, Record, Source, VERSION, WriteRule, file_name, sealed_text};
use haptical::{Device, Equipment, Log, refuse_other_device};

use crate::arguments::one_or_more;
use crate::failure::Failure;
use crate::flags::{DeviceOptions, OverwriteOptions, folder_and_name};
use crate::interrupt::write_all;
use crate::play::recorded::Recorded;
use crate::progress::Progress;
use crate::terminal;

/// Size above which a page is slow to open, in bytes; thinning that is left to the command stays
/// below it.
const LARGE_PAGE_BYTES: usize = 3_000_000;

/// Its name.
const COMMAND: &str = "play";

#[derive(Debug, Args)]
pub(crate) struct PlayArguments {
    /// Device file (TOML, URDF or MJCF): the nominal device
    #[arg(long, value_name = "FILE")]
    device: PathBuf,
    #[command(flatten)]
    device_options: DeviceOptions,
    /// Calibrated device, the identified.toml of this device; without it only the nominal arm is
    /// drawn
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Log (CSV, Parquet, MCAP, .db3 or JSON lines)
    #[arg(long, value_name = "FILE")]
    log: PathBuf,
    /// Page to write (HTML)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    overwrite: OverwriteOptions,
    /// Keep every N-th row; without it as many rows as a page of 3 MB holds
    #[arg(long, value_name = "N", value_parser = one_or_more, allow_negative_numbers = true)]
    every: Option<NonZeroUsize>,
    /// Print what was written as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &PlayArguments) -> Result<(), Failure> {
    let rule = check_place(arguments)?;
    let progress = Progress::start("reading");
    let nominal = arguments.device_options.read(&arguments.device)?;
    let mut files = nominal.inputs("device");
    refuse_no_links(&nominal)?;
    nominal.refuse_hands("the drawing")?;
    let mut warnings = nominal.warnings.clone();
    let model = match &arguments.model {
        None => None,
        Some(path) => {
            let model = Device::open(&Source::given(path), &Equipment::default())?;
            files.extend(model.inputs("model"));
            warnings.extend(model.warnings);
            let (model, nominal) = (model.model, &nominal.model);
            refuse_other_device(nominal, &model, path)?;
            if nominal.name != model.name {
                warnings.push(format!(
                    "the model is called \"{}\", the device \"{}\": both must be the same device",
                    model.name, nominal.name
                ));
            }
            Some(model)
        }
    };
    // messages call the log by its whole path
    let log = Log::open(&Source::by_path(&arguments.log), &nominal)?;
    let file = log.input("log").map(|input| InputFile {
        file: Source::given(&arguments.log).label,
        ..input
    });
    files.extend(file);
    let recording = log.recording;
    warnings.extend(log.warnings);
    progress.say(format!("placing the arm at {} rows", recording.len()));
    let recorded = Recorded::new(
        &nominal.model,
        model.as_ref(),
        &recording,
        &recorded::Request {
            every: arguments.every.map(NonZeroUsize::get),
            device_file: &arguments.device,
            model_file: arguments.model.as_ref().unwrap_or(&arguments.device),
            log_file: &arguments.log,
        },
        &mut warnings,
    )?;
    progress.say("writing");
    let every = format!("--every={}", recorded.every);
    let flags = nominal.equipment().chain_flags().chain([every]);
    let record = Record::of(VERSION, COMMAND, files, flags);
    let page = page::page(&recorded, &file_name(&arguments.log), &record)?;
    let page = sealed_text(&page, &format!("haptical {COMMAND}"), ["<!-- ", " -->"]);
    if page.len() > LARGE_PAGE_BYTES {
        warnings.push(format!(
            "the page has {:.1} MB and may be slow to open: a larger --every makes it smaller",
            1e-6 * page.len() as f64
        ));
    }
    let (folder, name) = folder_and_name(&arguments.out)?;
    let size = page.len();
    write_all(&rule, folder, &[(name, page.into_bytes())])?;
    drop(progress);
    terminal::warn(&warnings);
    let written = summary::Written::new(&recorded, &arguments.out, size, warnings);
    terminal::tell(arguments.json, &written, written.text()?)
}

/// Refuses a place for the page that cannot be written to, before any work.
fn check_place(arguments: &PlayArguments) -> Result<WriteRule, Failure> {
    let out = &arguments.out;
    if out.is_dir() || out.file_name().is_none() {
        let said = "cannot write: it is a folder; give the name of a file, such as page.html";
        return Err(Failure::of_file("unwritable", said, out));
    }
    let rule = arguments.overwrite.rule(COMMAND);
    rule.check(std::slice::from_ref(out))?;
    Ok(rule)
}

fn refuse_no_links(device: &Device) -> Result<(), Failure> {
    let said = "the device has no [[link]] rows, so there is no arm to draw; add the Denavit-Hartenberg rows as [[link]] tables; \
                errors of transmissions alone are in the identify.html of `haptical identify`";
    match device.model.has_links() {
        true => Ok(()),
        false => Err(Failure::of_file("no-links", said, &device.source().path)),
    }
}
