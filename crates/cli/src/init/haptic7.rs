//! Examples of the paper's device: the template with a sample log, and two recordings with a gap to find.

use haptical_model::Device;
use haptical_simulator::{
    CableSigma, Effects, HandMotion, MotionSettings, Settings, apply_deviations, record_motion,
    simulate,
};

use super::{Contents, DEVICE_FILE, LOG_FILE, command, log};
use crate::failure::Failure;

/// The template: the 7-DOF device of the paper.
const TEMPLATE: &str = include_str!("../../assets/haptic7.toml");
/// Deviations of the simulated device, a name and a number \[m, rad, 1\] in each line: sizes as in the paper's
/// Tables 2 and 3.
const DEVIATIONS: &str = include_str!("../../assets/haptic7-deviations.txt");
/// Rows and seed of the sample log.
const ROWS: usize = 400;
const SEED: u64 = 1;

/// What the device of the gap has and the template leaves out.
const GAP: &str = "\
# The effect that log.csv and second.csv have and device.toml leaves out: the cable of joint 2 stretches.

[[effect]]
name = \"capstan-compliance\"
joint = 2
stiffness_nm_per_rad = 260.0
";
/// Each recording of the gap \[s, Hz\].
const GAP_SECONDS: f64 = 30.0;
const GAP_RATE_HZ: f64 = 100.0;
/// Seeds of the two recordings: other motions, loads and noise.
const GAP_SEEDS: [u64; 2] = [1, 2];

/// The template and a log of random postures.
pub(super) fn paper() -> Result<Contents, Failure> {
    let (device, truth) = devices()?;
    let settings = Settings {
        motor_counts: true,
        cable_sigma: CableSigma::Stated,
        ..Settings::paper()
    };
    let recording = simulate(&truth, &settings, ROWS, SEED).map_err(Failure::internal)?;
    Ok(Contents {
        files: vec![
            (
                DEVICE_FILE,
                TEMPLATE.into(),
                "the template, to be changed into your device",
            ),
            (
                LOG_FILE,
                log(&recording, &device)?,
                "400 simulated rows of a device that deviates from it",
            ),
        ],
        next: vec![command(
            "haptical identify --device =device.toml --log =log.csv --out =result",
        )],
    })
}

/// The template and two recordings of a device that a hand moves, one of whose cables stretches.
pub(super) fn gap() -> Result<Contents, Failure> {
    let (device, truth) = devices()?;
    let effects = Effects::from_toml(GAP, "answer.toml").map_err(Failure::internal)?;
    let settings = MotionSettings {
        motion: HandMotion {
            seconds: GAP_SECONDS,
            rate_hz: GAP_RATE_HZ,
            ..HandMotion::default()
        },
        ..MotionSettings::default()
    };
    let mut logs = Vec::new();
    for seed in GAP_SEEDS {
        let made = record_motion(&truth, &effects, &settings, seed).map_err(Failure::internal)?;
        logs.push(log(&made, &device)?);
    }
    let second = logs.pop().unwrap_or_default();
    let first = logs.pop().unwrap_or_default();
    Ok(Contents {
        files: vec![
            (
                DEVICE_FILE,
                TEMPLATE.into(),
                "the device as it was designed",
            ),
            (
                LOG_FILE,
                first,
                "30 s of the device as it is, moved by a hand: encoders, a cable, torques (simulated)",
            ),
            (
                "second.csv",
                second,
                "30 s of another motion, to check an answer on",
            ),
            (
                "answer.toml",
                GAP.into(),
                "what was added to the device; look at it afterwards",
            ),
        ],
        next: vec![command(
            "haptical diagnose --device =device.toml --log =log.csv --validate =second.csv --out =gap",
        )],
    })
}

/// The template, and the device that deviates from it.
fn devices() -> Result<(Device, Device), Failure> {
    let device = Device::from_toml(TEMPLATE, DEVICE_FILE)
        .map_err(Failure::internal)?
        .device;
    let deviation = |line: &'static str| {
        let (name, value) = line.split_once(' ')?;
        Some((name, value.parse().ok()?))
    };
    let deviations: Vec<(&str, f64)> = DEVIATIONS.lines().filter_map(deviation).collect();
    let truth = apply_deviations(&device, &deviations).map_err(Failure::internal)?;
    Ok((device, truth))
}
