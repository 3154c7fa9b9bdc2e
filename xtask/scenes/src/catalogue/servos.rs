//! Servos that answer position commands: commands and angles alone, in counts at 50 Hz.

use std::f64::consts::TAU;

use anyhow::Result;

use crate::noise::Noise;
use crate::scene::{DeviceFile, Identified, Made, Scene, scenes};
use crate::table::Table;

pub(crate) const SCENES: &[Scene] = scenes! {
    "servo-clean" [] made(|_| {});
    "servo-late" ["command-latency"] made(|own| own.late_s = 0.08);
    "servo-late-then-later" ["command-latency"] made(|own| (own.late_s, own.later_s) = (0.04, Some(0.1)));
    "servo-dead-zone" ["dead-zone", "joint-friction", "backlash"] made(|own| own.width_rad = 0.02);
    "servo-offset-and-outputs" ["joint-offset"]
        made(|own| (own.offset_rad, own.has_outputs) = (0.03, true));
};

/// What two servos do to their commands.
#[derive(Debug, Clone, Copy, Default)]
struct Servo {
    late_s: f64,
    /// How late it is in the second half.
    later_s: Option<f64>,
    /// It does not follow within half of this.
    width_rad: f64,
    /// Of the first one.
    offset_rad: f64,
    /// Whether links have encoders of their own.
    has_outputs: bool,
}

const ROWS: usize = 1500;
const STEP_S: f64 = 0.02;

fn device_toml(has_outputs: bool) -> String {
    let encoder = match has_outputs {
        true => "external_encoder_sd_rad = 3e-4\n",
        false => "",
    };
    let joint = |name: &str| {
        format!(
            "[[joint]]\nname = \"{name}\"\ntransmission = \"direct\"\nencoder_counts_per_rev = 4096\n\
             lower_rad = -1.9\nupper_rad = 1.9\n{encoder}"
        )
    };
    let [pan, lift] = ["pan", "lift"].map(joint);
    format!("[device]\nname = \"two servos\"\ndof = 2\n{pan}{lift}")
}

/// Two servos that have something of this.
fn made(change: fn(&mut Servo)) -> Result<Made> {
    let mut servo = Servo::default();
    change(&mut servo);
    let mut noise = Noise::new(1);
    let count = TAU / 4096.0;
    let times: Vec<f64> = (0..ROWS).map(|row| row as f64 * STEP_S).collect();
    let mut log = Table::default();
    log.push("t_s", times.clone());
    for joint in 1..=2 {
        let phase = joint as f64;
        let command = |time_s: f64| {
            0.4 * libm::sin(1.3 * time_s + 0.5 * phase) + 0.2 * libm::sin(2.9 * time_s + phase)
        };
        let (mut commands, mut readings, mut outputs) = (Vec::new(), Vec::new(), Vec::new());
        let mut follows = command(0.0);
        for (row, time_s) in times.iter().enumerate() {
            let late_s = match servo.later_s.filter(|_| row >= ROWS / 2) {
                Some(later_s) => later_s,
                None => servo.late_s,
            };
            let wanted = command(time_s - late_s);
            let half = 0.5 * servo.width_rad;
            follows = f64::clamp(follows, wanted - half, wanted + half);
            let angle = follows + noise.normal(1e-4);
            let read = angle + if joint == 1 { servo.offset_rad } else { 0.0 };
            commands.push(command(*time_s));
            readings.push(libm::round(read / count) * count);
            outputs.push(follows + noise.normal(3e-4));
        }
        log.push(format!("command{joint}_rad"), commands);
        log.push(format!("theta{joint}_rad"), readings);
        if servo.has_outputs {
            log.push(format!("out{joint}_rad"), outputs);
        }
    }
    Ok(Made {
        identify: match servo.has_outputs {
            true => Identified::Geometry(Box::default()),
            false => Identified::Nothing,
        },
        links_follow: servo.offset_rad == 0.0,
        ..Made::new(DeviceFile::toml(device_toml(servo.has_outputs)), log)
    })
}
