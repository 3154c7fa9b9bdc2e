//! Motors with currents and torques beside their angles, at 200 Hz.

use crate::noise::Noise;
use crate::scene::{DeviceFile, Identified, Made, Scene, scenes};
use crate::table::Table;

pub(crate) const SCENES: &[Scene] = scenes! {
    "motor-saturates" ["magnetic-saturation"] Ok(made());
};

const ROWS: usize = 4000;
const STEP_S: f64 = 0.005;
/// Torque constants, each with the share of it that an ampere takes.
const MOTORS: [[f64; 2]; 2] = [[2.0, 0.0], [3.0, 0.02]];
/// Noise of current and torque.
const CURRENT_SD_A: f64 = 0.02;
const TORQUE_SD_NM: f64 = 0.1;

/// Two motors, of which the second one's constant falls with its current.
fn made() -> Made {
    let mut noise = Noise::new(1);
    let times: Vec<f64> = (0..ROWS).map(|row| row as f64 * STEP_S).collect();
    let mut log = Table::default();
    log.push("t_s", times.clone());
    for (joint, [constant, falls]) in (1..).zip(MOTORS) {
        let phase = f64::from(joint);
        let (mut angles, mut currents, mut torques) = (Vec::new(), Vec::new(), Vec::new());
        for time_s in &times {
            let current = 3.0 * libm::sin(2.3 * time_s + phase) + 1.5 * libm::sin(5.1 * time_s);
            let torque = constant * (1.0 - falls * current.abs()) * current;
            angles.push(0.8 * libm::sin(1.7 * time_s + 0.3 * phase));
            currents.push(current + noise.normal(CURRENT_SD_A));
            torques.push(torque + noise.normal(TORQUE_SD_NM));
        }
        log.push(format!("theta{joint}_rad"), angles);
        log.push(format!("torque{joint}_nm"), torques);
        log.push(format!("current{joint}_a"), currents);
    }
    log.push("supply_v", vec![48.0; ROWS]);
    let joints = "[[joint]]\ntransmission = \"direct\"\n".repeat(MOTORS.len());
    let device = DeviceFile::toml(format!(
        "[device]\nname = \"two motors\"\ndof = 2\n{joints}"
    ));
    Made {
        identify: Identified::Nothing,
        ..Made::new(device, log)
    }
}
