//! Logs of the template device in slow motion under a changing torque, with noise of the stated size.

use std::f64::consts::TAU;

use haptical_model::{Device, Recording};
use haptical_simulator::{apply_deviations, true_poses};

/// Rows and rate of a log.
pub(crate) const ROWS: usize = 1500;
const RATE_HZ: f64 = 50.0;

/// What the device deviates by from the template \[m, rad, 1\].
const DEVIATIONS: [(&str, f64); 8] = [
    ("ratio_deviation1", -0.025),
    ("output_drum_x2", 2.46e-4),
    ("output_drum_y3", 1.0e-4),
    ("length_deviation4[2]", -7e-4),
    ("a1", 1.1e-3),
    ("d3", -1.3e-3),
    ("alpha2", 1.4e-3),
    ("theta5", -1.2e-3),
];

/// A log as CSV with `t_s`, motor and external encoders, `cable_m` and `torque2_nm`. The drive of
/// joint 2 gives way by `compliance_rad_per_nm`; `part` is a number from which motion and noise are
/// made.
pub(crate) fn moving_log(template: &str, compliance_rad_per_nm: f64, part: u64) -> String {
    let device = Device::from_toml(template, "device.toml").unwrap().device;
    let truth = apply_deviations(&device, &DEVIATIONS).unwrap();
    let times: Vec<f64> = (0..ROWS).map(|row| row as f64 / RATE_HZ).collect();
    let wave = |hertz: f64, time: f64| (TAU * (hertz * time + hertz * part as f64)).sin();
    // What the readings would be without compliance: the link follows them.
    let joint: Vec<Vec<f64>> = device
        .joints
        .iter()
        .enumerate()
        .map(|(index, joint)| {
            let (middle, half) = (
                0.5 * (joint.lower_rad + joint.upper_rad),
                0.5 * (joint.upper_rad - joint.lower_rad),
            );
            let hertz = 0.051 + 0.017 * index as f64;
            let at = |&time: &f64| {
                middle + half * (0.6 * wave(hertz, time) + 0.3 * wave(2.3 * hertz, time))
            };
            times.iter().map(at).collect()
        })
        .collect();
    let torque: Vec<f64> = times
        .iter()
        .map(|&time| wave(0.23, time) + 0.5 * wave(0.09, time))
        .collect();
    let recording = Recording {
        joint,
        ..Recording::default()
    };
    let poses = true_poses(&truth, &recording).unwrap();
    let mut noise = Noise(part);
    let mut text = "t_s,".to_owned();
    let columns = |name: &str, count: usize| -> String {
        (1..=count)
            .map(|index| format!("{name}{index}_rad,"))
            .collect()
    };
    text.push_str(&columns("theta", device.joints.len()));
    text.push_str(&columns("out", 4));
    text.push_str("cable_m,torque2_nm\n");
    let cable_sd_m = device.cables[0].distance_sd_m.unwrap();
    let output_sd_rad = TAU / 20_000.0 / 3.0;
    for row in 0..ROWS {
        text.push_str(&format!("{},", times[row]));
        for (index, joint) in device.joints.iter().enumerate() {
            // The drive pushes the link with this torque, so the motor is ahead of it.
            let given = if index == 1 {
                torque[row] * compliance_rad_per_nm
            } else {
                0.0
            };
            let count = TAU / 20_000.0 / joint.transmission_ratio;
            let reading = ((recording.joint[index][row] + given) / count).round() * count;
            text.push_str(&format!("{reading},"));
        }
        for index in 0..4 {
            let reading = recording.joint[index][row];
            let error = truth.joints[index].error_rad(reading).unwrap();
            text.push_str(&format!(
                "{},",
                reading + error + output_sd_rad * noise.normal()
            ));
        }
        let distance_m = poses[row].position_m.norm() + cable_sd_m * noise.normal();
        text.push_str(&format!("{distance_m},{}\n", torque[row]));
    }
    text
}

/// Numbers that look random: splitmix64 (Steele, Lea, Flood, 2014).
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Nearly normal with standard deviation 1: the sum of twelve.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}
