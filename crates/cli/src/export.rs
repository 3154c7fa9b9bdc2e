//! `haptical export`: a calibrated device for a control loop (Rust, C, JSON) or a simulator (URDF, MJCF).

mod c_effects;
mod c_header;
mod compensation;
mod described;
mod description;
mod flat_json;
mod rust_module;

use std::path::{Path, PathBuf};

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use haptical::files::{Source, VERSION, check_folder, check_outputs, file_name, sealed_text};
use serde_json::json;

use self::described::Described;
use crate::failure::Failure;
use crate::flags::{DeviceOptions, OverwriteOptions, folder_and_name};
use crate::interrupt::write_all;
use crate::terminal;

/// Its name.
const COMMAND: &str = "export";

/// Flags of `haptical export`.
#[derive(Debug, Args)]
pub(crate) struct ExportArguments {
    /// Device file (TOML, URDF or MJCF), usually identified.toml
    #[arg(long, value_name = "FILE")]
    device: PathBuf,
    #[command(flatten)]
    device_options: DeviceOptions,
    /// What to write
    #[arg(long, value_enum)]
    format: FormatName,
    /// File to write; its folder is made if it is missing
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    overwrite: OverwriteOptions,
    /// URDF that the device came from, with --format urdf: its text with corrected origins is written;
    /// --base and --tip name the links between which the chain ran
    #[arg(long, value_name = "FILE")]
    urdf: Option<PathBuf>,
    /// MJCF that the device came from, with --format mjcf: its text with corrected places of bodies, and with the friction
    /// of joints, is written; --base and --tip name the bodies or sites between which the chain ran
    #[arg(long, value_name = "FILE")]
    mjcf: Option<PathBuf>,
    /// Put springs, plays and couplings into the MJCF given by --mjcf as joints of their own, and into its keyframes: joints
    /// behind them have later places in qpos
    #[arg(long, requires = "mjcf")]
    new_joints: bool,
    /// Print what was written as JSON
    #[arg(long)]
    json: bool,
}

/// Forms of an export.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FormatName {
    /// A module with the device as a constant of haptical-runtime, checked by the compiler
    Rust,
    /// A C99 header with the numbers and the functions that use them
    CHeader,
    /// Flat arrays with names and units
    Json,
    /// A device file with all that a URDF and a rig file say, to be edited
    Toml,
    /// The URDF given by --urdf with corrected origins, or a minimal new one
    Urdf,
    /// The MJCF given by --mjcf with corrected places, or a new model for MuJoCo that can be simulated
    Mjcf,
}

impl FormatName {
    /// Beginning and end of a comment; none for JSON, which holds its own hash.
    fn comment(self) -> Option<[&'static str; 2]> {
        match self {
            Self::Rust => Some(["// ", ""]),
            Self::CHeader => Some(["/* ", " */"]),
            Self::Json => None,
            Self::Toml => Some(["# ", ""]),
            Self::Urdf | Self::Mjcf => Some(["<!-- ", " -->"]),
        }
    }
}

/// The origin of an export.
#[derive(Debug, Clone, PartialEq)]
struct Provenance {
    /// Name of the device.
    device: String,
    /// Name of the device file, without its folder.
    file: String,
    /// SHA-256 of the device file.
    sha256: String,
}

/// Runs the command.
pub(crate) fn run(arguments: &ExportArguments) -> Result<(), Failure> {
    let (folder, name) = folder_and_name(&arguments.out)?;
    check_folder(folder)?;
    let mut inputs: Vec<&Path> = vec![&arguments.device];
    inputs.extend(arguments.urdf.as_deref());
    inputs.extend(arguments.mjcf.as_deref());
    inputs.extend(arguments.device_options.rig.as_deref());
    check_outputs(std::slice::from_ref(&arguments.out), &inputs)?;
    arguments.overwrite.check_file(&arguments.out, COMMAND)?;
    let mut input = description::read(arguments)?;
    let provenance = Provenance {
        device: input.model.name.clone(),
        file: file_name(&arguments.device),
        sha256: Source::given(&arguments.device)
            .fingerprint_text(input.to_toml())
            .sha256,
    };
    let takes_hands = [FormatName::Toml, FormatName::Urdf, FormatName::Mjcf];
    if !takes_hands.contains(&arguments.format) {
        input.refuse_hands("this form")?;
    }
    let mut left_out = Vec::new();
    let mut described = || {
        let described = Described::new(&input.model, &arguments.device)?;
        left_out.extend(described.compensation.warnings());
        Ok::<_, Failure>(described)
    };
    let content = match arguments.format {
        FormatName::Rust => rust_module::text(&described()?, &provenance),
        FormatName::CHeader => c_header::text(&described()?, &provenance)?,
        FormatName::Json => flat_json::text(&described()?, &provenance)?,
        FormatName::Toml => input.to_toml().to_owned(),
        FormatName::Urdf | FormatName::Mjcf => {
            let (text, warnings) = description::text(arguments, &input.model)?;
            input.warnings.extend(warnings);
            text
        }
    };
    input.warnings.extend(left_out);
    let content = match arguments.format.comment() {
        Some(comment) => sealed_text(&content, &format!("haptical {COMMAND}"), comment),
        None => content,
    };
    write_all(folder, &[(name, content.into_bytes())])?;
    terminal::warn(&input.warnings);
    let (written, joints) = (arguments.out.display(), input.model.joints.len());
    if arguments.json {
        let format = arguments.format.to_possible_value();
        return terminal::write_json(&json!({
            "written": written.to_string(),
            "format": format.as_ref().map(PossibleValue::get_name),
            "device": provenance.device,
            "device_file": arguments.device.display().to_string(),
            "device_sha256": provenance.sha256,
            "joints": joints,
            "version": VERSION,
            "warnings": input.warnings,
        }));
    }
    let device = one_line(&provenance.device);
    let text = format!("Written:\n  {written}: {joints} joints of `{device}`\n");
    terminal::write_output(text.as_bytes())
}

/// Neither a control character nor one that changes the direction of text, which rustc refuses.
fn is_plain(c: char) -> bool {
    ['\'', '"', '\\'].contains(&c) || c.escape_debug().eq([c])
}

/// A name as part of one line of a comment, in which it can end nothing.
fn one_line(text: &str) -> String {
    text.chars()
        .map(|c| if is_plain(c) { c } else { ' ' })
        .collect::<String>()
        .replace("*/", "* /")
        .replace("/*", "/ *")
}
