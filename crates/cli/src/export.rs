//! `haptical export`: a calibrated device for a control loop (Rust, C, JSON) or a simulator (URDF, MJCF).

mod c_header;
mod described;
mod description;
mod flat_json;
mod rust_module;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use haptical::files::{Source, check_folder, check_outputs};
use haptical_model::Device;
use serde_json::json;

use self::described::Described;
use crate::failure::Failure;
use crate::flags::DeviceOptions;
use crate::interrupt::write_all;
use crate::terminal;

/// Flags of `haptical export`.
#[derive(Debug, Args)]
pub(crate) struct ExportArguments {
    /// Device file (TOML or URDF), usually identified.toml
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
    /// URDF that the device came from, with --format urdf: its text with corrected origins is written;
    /// --base and --tip name the links between which the chain ran
    #[arg(long, value_name = "FILE")]
    urdf: Option<PathBuf>,
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
    /// A minimal model for MuJoCo
    Mjcf,
}

impl FormatName {
    fn name(self) -> &'static str {
        match self {
            Self::Rust => "rust",
            Self::CHeader => "c-header",
            Self::Json => "json",
            Self::Toml => "toml",
            Self::Urdf => "urdf",
            Self::Mjcf => "mjcf",
        }
    }
}

/// Where an export comes from.
#[derive(Debug, Clone, PartialEq)]
struct Provenance {
    /// Name of the device.
    device: String,
    /// Name of the device file, without its folder.
    file: String,
    /// SHA-256 of the device file.
    sha256: String,
}

/// Version of the command, part of each export.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Runs the command.
pub(crate) fn run(arguments: &ExportArguments) -> Result<(), Failure> {
    let (folder, name) = place(&arguments.out)?;
    check_folder(folder)?;
    let mut inputs: Vec<&Path> = vec![&arguments.device];
    inputs.extend(arguments.urdf.as_deref());
    inputs.extend(arguments.device_options.rig.as_deref());
    check_outputs(std::slice::from_ref(&arguments.out), &inputs)?;
    let mut input = description::read(arguments)?;
    let provenance = Provenance {
        device: input.model.name.clone(),
        file: file_name(&arguments.device),
        sha256: Source::given(&arguments.device)
            .fingerprint_text(input.to_toml())
            .sha256,
    };
    let described = || Described::new(&input.model, &arguments.device);
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
    if arguments.format != FormatName::Toml {
        input.warnings.extend(said_of_compliance(&input.model));
    }
    write_all(folder, &[(name, content.into_bytes())])?;
    terminal::warn(&input.warnings);
    if arguments.json {
        let report = json!({
            "written": arguments.out.display().to_string(),
            "format": arguments.format.name(),
            "device": provenance.device,
            "device_file": arguments.device.display().to_string(),
            "device_sha256": provenance.sha256,
            "joints": input.model.joints.len(),
            "version": VERSION,
            "warnings": input.warnings,
        });
        terminal::write_output(format!("{report:#}\n").as_bytes())
    } else {
        let said = format!(
            "Written:\n  {}: {} joints of `{}`\n",
            arguments.out.display(),
            input.model.joints.len(),
            one_line(&provenance.device),
        );
        terminal::write_output(said.as_bytes())
    }
}

/// What an export with rigid joints leaves out.
fn said_of_compliance(device: &Device) -> Option<String> {
    let yields = |joint: &usize| device.compliance_rad_per_nm(*joint) != 0.0;
    let joints: Vec<String> = (0..device.joints.len())
        .filter(yields)
        .map(|joint| (joint + 1).to_string())
        .collect();
    let which = match joints.as_slice() {
        [] => return None,
        [one] => format!("joint {one} yields"),
        several => format!("joints {} yield", several.join(", ")),
    };
    Some(format!(
        "{which} to torque, and this form has rigid joints: take compliance times torque off each joint's angle before you \
         use it; the compliances are in the device file"
    ))
}

/// Folder and name of the file to write.
fn place(out: &Path) -> Result<(&Path, &str), Failure> {
    match (out.parent(), out.file_name().and_then(|name| name.to_str())) {
        (Some(folder), Some(name)) if folder.as_os_str().is_empty() => Ok((Path::new("."), name)),
        (Some(folder), Some(name)) => Ok((folder, name)),
        _ => Err(Failure::command_line(
            "arguments",
            format!("--out is {}, which names no file", out.display()),
            "give the path of the file to write",
        )),
    }
}

fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
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
