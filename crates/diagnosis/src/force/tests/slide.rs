//! A slide whose row has a length behind it: its mass is where the device file has it.

use haptical_model::{Device, Recording};

use super::arm::Noise;
use super::examined_as;

const GRAVITY_MPS2: f64 = 9.81;

/// An arm that swings in a vertical plane, and a slide of 2 kg along it; 0.3 m of the slide's row are behind its motion.
const FILE: &str = r#"
[device]
name = "swinging slide"
dof = 2
convention = "modified"
[[link]]
a_m = 0.0
alpha_rad = 0.0
d_m = 0.0
[[link]]
a_m = 0.0
alpha_rad = 0.0
d_m = 0.0
mass_kg = 1.0
centre_of_mass_m = [0.1, 0.0, 0.0]
[[link]]
a_m = 0.0
alpha_rad = -1.5707963267948966
d_m = 0.3
mass_kg = 2.0
centre_of_mass_m = [0.0, 0.0, 0.1]
[[joint]]
lower_rad = -1.5
upper_rad = 1.5
[[joint]]
type = "prismatic"
lower_rad = -0.2
upper_rad = 0.2
home_rad = 0.4
[gravity]
vector_mps2 = [0.0, -9.81, 0.0]
"#;

/// Value, rate and acceleration of a sum of sines, each of an amplitude, a rate and a phase.
fn waves(parts: [[f64; 3]; 3], time_s: f64) -> [f64; 3] {
    parts.iter().fold([0.0; 3], |sum, [size, rate, phase]| {
        let (sine, cosine) = (rate * time_s + phase).sin_cos();
        let derivatives = [sine, rate * cosine, -rate * rate * sine];
        [0, 1, 2].map(|order| sum[order] + size * derivatives[order])
    })
}

/// A minute of motion with the torques of the two point masses, in polar coordinates.
fn recording() -> Recording {
    let mut noise = Noise(1);
    let turns = [[0.6, 0.5, 0.3], [0.4, 1.1, 1.0], [0.2, 1.9, 2.0]];
    let slides = [[0.08, 0.7, 0.8], [0.05, 1.3, 0.1], [0.03, 2.3, 0.5]];
    let (mut joint, mut torque_nm) = (vec![Vec::new(); 2], [Vec::new(), Vec::new()]);
    let time_s: Vec<f64> = (0..6000).map(|row| 0.01 * f64::from(row)).collect();
    for time_s in &time_s {
        let [q, dq, ddq] = waves(turns, *time_s);
        let [s, ds, dds] = waves(slides, *time_s);
        // home and centre; the slide is along y of the swinging arm
        let r = s + 0.4 + 0.1;
        let arm = 0.01 * ddq + GRAVITY_MPS2 * 0.1 * q.cos();
        let turning = 2.0 * (r * r * ddq + 2.0 * r * ds * dq - GRAVITY_MPS2 * r * q.sin()) + arm;
        let sliding = 2.0 * (dds - r * dq * dq + GRAVITY_MPS2 * q.cos());
        for (column, value) in joint.iter_mut().zip([q, s]) {
            column.push((value / 1e-6).round() * 1e-6);
        }
        for (column, value) in torque_nm.iter_mut().zip([turning, sliding]) {
            column.push(value + 0.01 * noise.normal());
        }
    }
    Recording {
        line: (2..6002).collect(),
        time_s: Some(time_s),
        joint,
        output: vec![None; 2],
        torque_nm: torque_nm.map(Some).into(),
        ..Recording::default()
    }
}

#[test]
fn the_weight_of_a_slide_is_no_gap() {
    let device = Device::from_toml(FILE, "swinging-slide.toml")
        .unwrap()
        .device;
    let answer = examined_as(&device, &recording());
    assert!(
        !answer.significant && answer.findings.is_empty(),
        "{answer:?}"
    );
}
