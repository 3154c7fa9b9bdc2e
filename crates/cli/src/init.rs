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

/// Deviations of the simulated device, a name and a number \[m, rad, 1\] in each line: sizes as in the paper's
/// Tables 2 and 3.
const DEVIATIONS: &str = include_str!("../assets/haptic7-deviations.txt");

/// Runs the command.
pub(crate) fn run(arguments: &InitArguments) -> Result<(), Failure> {
    let folder = &arguments.dir;
    check_folder(folder)?;
    for name in [DEVICE_FILE, LOG_FILE] {
        let path = folder.join(name);
        if path.exists() && !arguments.force {
            let next = "give another folder, or --force to overwrite it";
            return Err(Failure::in_file(
                "exists",
                "the file exists already",
                &path,
                next,
            ));
        }
    }
    let files = [
        (DEVICE_FILE, TEMPLATE.as_bytes().to_vec()),
        (LOG_FILE, sample_log()?),
    ];
    write_all(folder, &files)?;
    let (device, log) = (folder.join(DEVICE_FILE), folder.join(LOG_FILE));
    let text = format!(
        "Written:\n  {}: the template, to be changed into your device\n  {}: {ROWS} simulated \
         rows of a device that deviates from it\n\nNext:\n  haptical identify --device {} \
         --log {} --out {}\n",
        device.display(),
        log.display(),
        shell_path(&device),
        shell_path(&log),
        shell_path(&folder.join("result")),
    );
    terminal::write_output(text.as_bytes())
}

fn sample_log() -> Result<Vec<u8>, Failure> {
    let device = Device::from_toml(TEMPLATE, DEVICE_FILE)
        .map_err(Failure::internal)?
        .device;
    let deviation = |line: &'static str| {
        Some((
            line.split_once(' ')?.0,
            line.split_once(' ')?.1.parse().ok()?,
        ))
    };
    let deviations: Vec<(&str, f64)> = DEVIATIONS.lines().filter_map(deviation).collect();
    let truth = apply_deviations(&device, &deviations).map_err(Failure::internal)?;
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
