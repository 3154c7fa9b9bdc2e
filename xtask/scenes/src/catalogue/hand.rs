//! The haptic device moved by a hand, with effects that its model leaves out, by the simulator's laws.

use anyhow::Result;
use haptical::model::Device as Model;
use haptical::simulator::{Effects, HandMotion, MotionSettings, apply_deviations, record_motion};
use haptical::{Device, Diagnose, Identify, diagnose, identify};

use crate::catalogue::rigs::haptic7_toml;
use crate::noise::Noise;
use crate::scene::{DeviceFile, Identified, Made, Scene, fixture, scenes};
use crate::table::Table;

pub(crate) const SCENES: &[Scene] = scenes! {
    "hand-clean" [] made("", 1);
    "hand-second-recording" ["capstan-compliance"] Ok(Made {
        validate: Some(log(STRETCH, 2)?),
        ..made(STRETCH, 1)?
    });
    "hand-without-name" [] Ok(Made {
        without: vec!["capstan-compliance"],
        identify: Identified::Nothing,
        ..made(STRETCH, 1)?
    });
    "hand-two-logs" ["cable-latency"] Ok(Made {
        also: Some(log(LATE_CABLE, 2)?),
        identify: Identified::Nothing,
        ..made(LATE_CABLE, 1)?
    });
    "hand-three-effects" ["capstan-compliance", "backlash", "cable-exit-geometry"]
        made(&fixture("fixtures/effects/example.toml")?, 1);
    "hand-elastic-joints" ["joint-compliance"] elastic_joints();
    "hand-elastic-joints-fitted" [] Ok(elastic_joints()?.with_joint_compliance());
    "hand-warming" ["thermal-drift"] made(WARMING, 1);
    "hand-lost-counts" ["encoder-count-loss"] made(LOST_COUNTS, 1);
    "hand-hysteresis" ["hysteresis"] made(HYSTERESIS, 1);
    "hand-unknown-dent" [] dent();
    "hand-noise-memory" [] noise_memory();
    "hand-earlier-model" ["joint-offset"] earlier_model();
    "hand-corrected-device" [] corrected();
};

/// The cable of joint 2 stretches.
const STRETCH: &str =
    "[[effect]]\nname = \"capstan-compliance\"\njoint = 2\nstiffness_nm_per_rad = 260.0\n";
/// The cable encoder is late.
const LATE_CABLE: &str = "[[effect]]\nname = \"cable-latency\"\ndelay_s = 0.004\n";
/// The measuring cable warms.
const WARMING: &str = "[[effect]]\nname = \"thermal-drift\"\nm_per_degc = 2e-5\n";
/// An encoder loses counts in the middle.
const LOST_COUNTS: &str =
    "[[effect]]\nname = \"encoder-count-loss\"\njoint = 2\ncounts = 30\ntime_s = 20.0\n";
/// A loop at joint 1.
const HYSTERESIS: &str =
    "[[effect]]\nname = \"hysteresis\"\njoint = 1\namplitude_rad = 3e-4\ntransition_rad = 0.003\n";
/// Length and rate of each recording.
const SECONDS: f64 = 40.0;
const RATE_HZ: f64 = 25.0;

/// The true device: that of the guides.
fn truth() -> Result<Model> {
    let text = fixture("fixtures/devices/haptic7-deviating.toml")?;
    Ok(Device::from_toml(&text, "haptic7-deviating.toml")?.model)
}

/// A motion of the true device with effects.
fn log(effects: &str, seed: u64) -> Result<Table> {
    log_of(&truth()?, effects, seed)
}

fn log_of(truth: &Model, effects: &str, seed: u64) -> Result<Table> {
    let effects = Effects::from_toml(effects, "effects.toml")?;
    let settings = MotionSettings {
        motion: HandMotion {
            seconds: SECONDS,
            rate_hz: RATE_HZ,
            ..HandMotion::default()
        },
        ..MotionSettings::default()
    };
    let recording = record_motion(truth, &effects, &settings, seed)?;
    Table::of(&recording, truth)
}

fn made(effects: &str, seed: u64) -> Result<Made> {
    let device = DeviceFile::toml(haptic7_toml()?);
    Ok(Made::new(device, log(effects, seed)?))
}

/// Every joint yields.
fn elastic_joints() -> Result<Made> {
    made(&fixture("fixtures/effects/elastic-joints.toml")?, 1)
}

/// A dent of a drum, in no catalogue.
fn dent() -> Result<Made> {
    let mut made = made("", 1)?;
    let angles = made.log.numbers("theta3_rad")?.to_vec();
    let outputs = made.log.numbers_mut("out3_rad")?;
    for (output, angle) in outputs.iter_mut().zip(angles) {
        *output += 2e-3 * libm::exp(-0.5 * ((angle - 0.2) / 0.04).powi(2));
    }
    Ok(made)
}

/// Noise of the external encoders that remembers.
fn noise_memory() -> Result<Made> {
    let mut made = made("", 1)?;
    for joint in 1..=4 {
        let outputs = made.log.numbers_mut(&format!("out{joint}_rad"))?;
        let more = Noise::new(joint).with_memory(outputs.len(), 1e-4, 0.6);
        for (output, more) in outputs.iter_mut().zip(more) {
            *output += more;
        }
    }
    Ok(made)
}

/// A model of last year, since when a joint was homed anew.
fn earlier_model() -> Result<Made> {
    let device = DeviceFile::toml(haptic7_toml()?);
    let opened = device.open()?;
    let before = log("", 3)?.log("before.csv", &opened)?;
    let model = identify(&opened, &before, &Identify::default())?;
    let homed = apply_deviations(&truth()?, &[("theta3", 4e-3)])?;
    Ok(Made {
        model: Some(model.to_toml().to_owned()),
        identify: Identified::Nothing,
        ..Made::new(device, log_of(&homed, "", 1)?)
    })
}

/// A device file with the effect that an earlier diagnosis named.
fn corrected() -> Result<Made> {
    let device = DeviceFile::toml(haptic7_toml()?);
    let opened = device.open()?;
    let before = log(STRETCH, 3)?.log("before.csv", &opened)?;
    let gap = diagnose(&opened, &before, &Diagnose::default())?;
    let text = gap.corrected_toml().unwrap_or_default().to_owned();
    Ok(Made::new(DeviceFile::toml(text), log(STRETCH, 1)?))
}
