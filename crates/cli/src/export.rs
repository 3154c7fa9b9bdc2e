//! `haptical export`: a calibrated device for a control loop (Rust, C, JSON), a simulator (URDF, MJCF) or ROS 2.

use std::path::PathBuf;

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use haptical::files::{Source, VERSION};
use haptical::{Device, Equipment, Export, Form, export, is_mjcf, is_urdf};
use haptical_urdf::Loader;
use serde_json::json;

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
    /// URDF that the device came from, with --format urdf: its text with corrected origins is written, under the same names
    /// of links and joints; with --format kinematics-yaml the origins alone; --base and --tip name the links between which
    /// the chain ran
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
    /// Program that reads the URDF, with --format urdf: what it ignores or takes otherwise is named, and a new URDF has what it
    /// asks for
    #[arg(long = "for", value_name = "PROGRAM", value_enum)]
    program: Option<ProgramName>,
    /// Print what was written as JSON
    #[arg(long)]
    json: bool,
}

/// Programs that read URDF.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ProgramName {
    Pinocchio,
    Drake,
    /// Isaac Sim and Isaac Lab
    Isaac,
    /// MoveIt 2
    Moveit,
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
    /// A xacro macro with a ros2_control block: offsets and reductions of the drives as transmissions
    Ros2Control,
    /// Corrected origins of the URDF given by --urdf as parameters of a xacro, in the form of ur_description
    KinematicsYaml,
}

impl FormatName {
    fn form(self) -> Form {
        match self {
            Self::Rust => Form::Rust,
            Self::CHeader => Form::CHeader,
            Self::Json => Form::Json,
            Self::Toml => Form::Toml,
            Self::Urdf => Form::Urdf,
            Self::Mjcf => Form::Mjcf,
            Self::Ros2Control => Form::Ros2Control,
            Self::KinematicsYaml => Form::KinematicsYaml,
        }
    }
}

impl ProgramName {
    fn loader(self) -> Loader {
        match self {
            Self::Pinocchio => Loader::Pinocchio,
            Self::Drake => Loader::Drake,
            Self::Isaac => Loader::Isaac,
            Self::Moveit => Loader::Moveit,
        }
    }
}

/// Runs the command.
pub(crate) fn run(arguments: &ExportArguments) -> Result<(), Failure> {
    let (folder, name) = folder_and_name(&arguments.out)?;
    let rule = arguments.overwrite.rule(COMMAND);
    rule.check(std::slice::from_ref(&arguments.out))?;
    let device = arguments.read()?;
    let equipment = arguments.device_options.equipment();
    let request = Export {
        form: arguments.format.form(),
        urdf: arguments.urdf.as_deref(),
        mjcf: arguments.mjcf.as_deref(),
        ends: equipment.ends(),
        new_joints: arguments.new_joints,
        loader: arguments.program.map(ProgramName::loader),
    };
    let exported = export(&device, &request)?;
    write_all(&rule, folder, &[(name, exported.text.into_bytes())])?;
    terminal::warn(&exported.warnings);
    let (written, joints) = (arguments.out.display(), device.model.joints.len());
    let format = arguments.format.to_possible_value();
    let value = json!({
        "written": written.to_string(),
        "format": format.as_ref().map(PossibleValue::get_name),
        "device": device.model.name,
        "device_file": arguments.device.display().to_string(),
        "device_sha256": exported.device_sha256,
        "joints": joints,
        "version": VERSION,
        "warnings": exported.warnings,
    });
    let name = device.model.name.replace(char::is_control, " ");
    let text = format!("Written:\n  {written}: {joints} joints of `{name}`\n");
    terminal::tell(arguments.json, &value, text)
}

impl ExportArguments {
    /// Reads the device. `--base` and `--tip` are about whichever URDF or MJCF is given.
    fn read(&self) -> Result<Device, Failure> {
        let options = &self.device_options;
        let is_new = self.urdf.is_none() && self.mjcf.is_none();
        if is_new || is_urdf(&self.device) || is_mjcf(&self.device) {
            return options.read_by_path(&self.device);
        }
        let equipment = Equipment {
            rig: options.rig.as_deref().map(Source::by_path),
            ..Equipment::default()
        };
        Device::open(&Source::by_path(&self.device), &equipment)
    }
}
