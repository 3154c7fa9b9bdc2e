//! `haptical init`: a template device file and a small simulated log of a device that deviates.

use std::path::Path;

use haptical::files::{check_folder, shell_word};
use haptical_data::{LogShape, write_log_to};
use haptical_model::Device;
use haptical_simulator::{CableSigma, Settings, apply_deviations, simulate};

use crate::arguments::InitArguments;
use crate::failure::Failure;
use crate::interrupt::write_all;
use crate::terminal;

/// The template: the 7-DOF device of the paper.
const TEMPLATE: &str = include_str!("../assets/haptic7.toml");
/// Names of the two files.
const DEVICE_FILE: &str = "device.toml";
const LOG_FILE: &str = "log.csv";
/// Rows and seed of the sample log.
const ROWS: usize = 400;
const SEED: u64 = 1;

/// Deviations of the simulated device \[m, rad, 1\]: sizes as in the paper's Tables 2 and 3.
const DEVIATIONS: [(&str, f64); 45] = [
    ("ratio_deviation1", -0.025),
    ("output_drum_x1", -5.2e-5),
    ("output_drum_y1", -1.93e-4),
    ("input_drum_x1", 4.8e-6),
    ("input_drum_y1", -1.3e-6),
    ("ratio_deviation2", -0.020),
    ("output_drum_x2", 2.46e-4),
    ("output_drum_y2", -4.3e-5),
    ("input_drum_x2", -1.9e-6),
    ("input_drum_y2", 1.6e-6),
    ("ratio_deviation3", 0.015),
    ("output_drum_x3", -1.73e-4),
    ("output_drum_y3", 1.0e-4),
    ("input_drum_x3", -0.7e-6),
    ("input_drum_y3", -3.9e-6),
    ("ratio_deviation4", 0.02),
    ("output_drum_x4", 7.7e-5),
    ("output_drum_y4", -6.4e-5),
    ("length_deviation4[1]", -5e-4),
    ("length_deviation4[2]", -7e-4),
    ("a0", 1.9e-3),
    ("a1", -1.1e-3),
    ("a2", 1.6e-3),
    ("a3", -1.2e-3),
    ("a4", 1.4e-3),
    ("a5", -1.5e-3),
    ("a6", 1.4e-3),
    ("a7", -1.3e-3),
    ("d1", 1.2e-3),
    ("d2", -1.5e-3),
    ("d3", 1.3e-3),
    ("d4", -1.3e-3),
    ("d5", 1.4e-3),
    ("d6", -1.2e-3),
    ("d7", 1.0e-3),
    ("alpha1", -1.5e-3),
    ("alpha2", 1.3e-3),
    ("alpha3", -1.4e-3),
    ("alpha4", 1.2e-3),
    ("theta2", 1.7e-3),
    ("theta3", -1.3e-3),
    ("theta4", 1.0e-3),
    ("theta5", -1.2e-3),
    ("theta6", -1.0e-3),
    ("theta7", 1.1e-3),
];

/// Runs the command.
pub(crate) fn run(arguments: &InitArguments) -> Result<(), Failure> {
    let folder = &arguments.dir;
    check_folder(folder)?;
    for name in [DEVICE_FILE, LOG_FILE] {
        let path = folder.join(name);
        if path.exists() && !arguments.force {
            return Err(Failure::bad_input(
                "exists",
                "the file exists already",
                path.display().to_string(),
                "give another folder, or --force to overwrite it",
            ));
        }
    }
    let files = [
        (DEVICE_FILE, TEMPLATE.as_bytes().to_vec()),
        (LOG_FILE, sample_log()?),
    ];
    write_all(folder, &files)?;
    let (device, log) = (folder.join(DEVICE_FILE), folder.join(LOG_FILE));
    terminal::write_output(
        format!(
            "Written:\n  {}: the template, to be changed into your device\n  {}: {ROWS} simulated \
             rows of a device that deviates from it\n\nNext:\n  haptical identify --device {} \
             --log {} --out {}\n",
            device.display(),
            log.display(),
            shell_path(&device),
            shell_path(&log),
            shell_path(&folder.join("result")),
        )
        .as_bytes(),
    )
}

fn sample_log() -> Result<Vec<u8>, Failure> {
    let device = Device::from_toml(TEMPLATE, DEVICE_FILE)
        .map_err(Failure::internal)?
        .device;
    let truth = apply_deviations(&device, &DEVIATIONS).map_err(Failure::internal)?;
    let settings = Settings {
        motor_counts: true,
        cable_sigma: CableSigma::Stated,
        ..Settings::paper()
    };
    let recording = simulate(&truth, &settings, ROWS, SEED).map_err(Failure::internal)?;
    let mut log = Vec::new();
    write_log_to(&mut log, &recording, &LogShape::from(&device)).map_err(Failure::internal)?;
    Ok(log)
}

fn shell_path(path: &Path) -> String {
    shell_word(&path.display().to_string())
}
