//! The nominal devices that trials are made of, and how far a manufactured one is from them.

use anyhow::Result;
use haptical_model::transmission::CapstanError;
use haptical_model::{Device, TransmissionError, TransmissionKind};

use crate::random::Random;

/// A nominal device with the text of its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Nominal {
    /// Short name, for folders.
    pub name: &'static str,
    /// Device file.
    pub toml: &'static str,
}

/// The nominal devices: the 7-DOF haptic device, a 6-DOF arm whose elbow has no external encoder and
/// one of whose wrist joints has one, a small 5-DOF arm with a parallelogram.
pub const NOMINALS: [Nominal; 3] = rows! {
    Nominal {name toml}
    "haptic7", include_str!("../../devices/haptic7.toml");
    "elbow6", include_str!("../../devices/elbow6.toml");
    "desk5", include_str!("../../devices/desk5.toml");
};

impl Nominal {
    /// The device.
    pub fn device(&self) -> Result<Device> {
        Ok(Device::from_toml(self.toml, self.name)?.device)
    }
}

/// Standard deviation of a length of the chain from the drawing \[m\].
const LENGTH_SD_M: f64 = 1.5e-3;
/// Standard deviation of a twist of the chain \[rad\].
const TWIST_SD_RAD: f64 = 1.0e-3;
/// Standard deviation of a joint's zero \[rad\].
const ZERO_SD_RAD: f64 = 1.5e-3;
/// Standard deviation of a ratio, relative.
const RATIO_SD: f64 = 2e-3;
/// Eccentricity of an output drum \[m\], of an input drum, of a bar of a parallelogram.
const OUTPUT_DRUM_M: f64 = 1.2e-4;
const INPUT_DRUM_M: f64 = 4e-6;
/// Behind a parallelogram the input drum is small enough for a polynomial of order 10 to hide it.
const HIDDEN_INPUT_DRUM_M: f64 = 2e-7;
const BAR_SD_M: f64 = 8e-5;
/// No deviation is larger than this many standard deviations.
const CUT: f64 = 2.5;

/// A manufactured device: lengths, angles, ratios, drums and bars off the drawing, home exact.
#[must_use]
pub fn perturbed(nominal: &Device, random: &mut Random) -> Device {
    let mut device = nominal.clone();
    let last = device.links.len().saturating_sub(1);
    for (row, link) in device.links.iter_mut().enumerate() {
        link.a_m += LENGTH_SD_M * random.normal_within(CUT);
        link.d_m += LENGTH_SD_M * random.normal_within(CUT);
        if row > 0 {
            link.theta_rad += ZERO_SD_RAD * random.normal_within(CUT);
        }
        if row > 0 && row < last {
            link.alpha_rad += TWIST_SD_RAD * random.normal_within(CUT);
        }
    }
    for joint in &mut device.joints {
        let is_loop = joint.transmission == TransmissionKind::Parallelogram;
        if joint.transmission == TransmissionKind::Direct {
            continue;
        }
        let input_drum_m = if is_loop {
            HIDDEN_INPUT_DRUM_M
        } else {
            INPUT_DRUM_M
        };
        let capstan = CapstanError {
            offset_rad: 0.0,
            ratio_deviation: joint.transmission_ratio * RATIO_SD * random.normal_within(CUT),
            output_drum_xy_m: eccentricity(OUTPUT_DRUM_M, random),
            input_drum_xy_m: eccentricity(input_drum_m, random),
        };
        joint.transmission_error = if is_loop {
            TransmissionError::Parallelogram {
                capstan,
                length_deviations_m: [(); 4].map(|()| BAR_SD_M * random.normal_within(CUT)),
            }
        } else {
            TransmissionError::Capstan(capstan)
        };
    }
    device
}

/// A random direction, and 0.4 to 1 of the largest radius.
fn eccentricity(largest_m: f64, random: &mut Random) -> [f64; 2] {
    let (sin, cos) = libm::sincos(random.phase_rad());
    let radius_m = largest_m * random.uniform(0.4, 1.0);
    [radius_m * cos, radius_m * sin]
}

/// Scale of each joint's torque reading: 1 with the stated relative standard deviation.
#[must_use]
pub fn torque_scales(device: &Device, random: &mut Random) -> Vec<f64> {
    let joints = device.joints.iter();
    joints
        .map(|joint| 1.0 + joint.torque_scale_sd * random.normal_within(CUT))
        .collect()
}
