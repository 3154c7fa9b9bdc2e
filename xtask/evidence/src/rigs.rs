//! Simulated devices around the paper's, and how they are recorded for the trials of intervals.

use anyhow::{Context, Result, anyhow};
use haptical_calibration::{CalibrationMethod, Degree, HeldOut, Options, Weighting};
use haptical_model::kinematics::Pose;
use haptical_model::{Device, Parameter, ParameterId, Recording, TransmissionError};
use haptical_simulator::{CableSigma, Noise, Settings, simulate, true_poses};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, StudentT};
use xtask_paper::nominal_device;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rig {
    /// One cable encoder.
    Cable,
    /// A tracker of the handle's position, 0.05 mm on each axis.
    Tracker,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Errors {
    /// Normal, of the stated sizes.
    Gaussian,
    /// Rounding to whole counts of every encoder, the motors' included, and nothing else.
    Counts,
    /// Normal, each channel 0.5 to 3 times its stated size.
    Unequal,
    /// Student's t with three degrees of freedom, of the stated standard deviations: 1.4 % of the readings are
    /// beyond three of these, five times as many as of normal ones.
    Tails,
}

/// Standard deviation of a tracker's coordinate \[m\].
pub(super) const TRACKER_SD_M: f64 = 5e-5;
/// Degree of joint 4's polynomial, in the truth and in the fit.
pub(super) const DEGREE: usize = 4;
/// Standard deviation of the true coefficients of joint 4's polynomial \[rad\].
const COEFFICIENT_SD_RAD: f64 = 5e-3;

/// The nominal device as a rig's device file describes it.
pub(super) fn nominal(rig: Rig, errors: Errors) -> Result<Device> {
    let mut device = nominal_device(None)?;
    for joint in &mut device.joints {
        if errors == Errors::Counts {
            // a device file that describes encoders by their counts alone
            joint.external_encoder_sd_rad = None;
        } else {
            joint.encoder_counts_per_rev = None;
        }
    }
    for cable in &mut device.cables {
        // drums and trackers are exact here: what the noise does is counted
        cable.scale_sd = Some(0.0);
        if errors == Errors::Counts {
            cable.distance_sd_m = None;
        }
    }
    if rig == Rig::Tracker {
        let text = format!(
            "[tracker]\nbase = \"known\"\ntool = \"known\"\nposition_sd_m = {TRACKER_SD_M}\nscale_sd = 0.0\n[[joint]]\n"
        );
        device.tracker = Device::from_toml(&text, "tracker.toml")?.device.tracker;
    }
    Ok(device)
}

/// Options of a fit whose weights are estimated.
pub(super) fn estimated(method: CalibrationMethod) -> Options {
    let mut options = Options {
        method,
        degree: Degree::Fixed(DEGREE),
        weighting: Weighting::Estimated,
        held_out: HeldOut::None,
        ..Options::default()
    };
    options.rules.singular_values = false;
    options
}

/// Settings of a simulation with this noise on external encoders and distances, of the stated sizes, and no counts of motors.
pub(super) fn with_noise(noise: Noise) -> Settings {
    Settings {
        output_noise: noise,
        cable_noise: noise,
        motor_counts: false,
        cable_sigma: CableSigma::Stated,
        ..Settings::paper()
    }
}

/// One generator for each purpose of a seed.
pub(super) fn generator(seed: u64, purpose: u64) -> ChaCha8Rng {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(purpose);
    generator
}

/// A true device: normal deviations of the plausible sizes in every link parameter and every term of the
/// capstans, a polynomial at joint 4. alpha7, which turns the handle about itself, stays.
pub(super) fn true_device(nominal: &Device, seed: u64) -> Device {
    let mut generator = generator(seed, 1);
    let mut normal = || -> f64 { StandardNormal.sample(&mut generator) };
    let mut truth = nominal.clone();
    let last = truth.links.len() - 1;
    for parameter in nominal.link_parameters(false) {
        let twists_the_handle = matches!(
            parameter,
            ParameterId::Link { row, parameter: Parameter::Alpha } if row == last
        );
        let deviation = parameter.plausible_size(nominal) * normal();
        if !twists_the_handle {
            parameter.set(&mut truth, parameter.value(nominal) + deviation);
        }
    }
    for joint in 0..3 {
        for parameter in nominal.transmission_parameters(joint) {
            let size = parameter.plausible_size(nominal);
            parameter.set(&mut truth, size * normal());
        }
    }
    truth.joints[3].transmission_error = TransmissionError::Chebyshev {
        range_rad: [nominal.joints[3].lower_rad, nominal.joints[3].upper_rad],
        coefficients: (0..=DEGREE)
            .map(|_| COEFFICIENT_SD_RAD * normal())
            .collect(),
    };
    truth
}

pub(super) fn record(
    truth: &Device,
    (rig, errors): (Rig, Errors),
    rows: usize,
    seed: u64,
) -> Result<Recording> {
    let mut noisy = truth.clone();
    let mut random = generator(seed, 2);
    let mut factor = || match errors {
        Errors::Unequal => 0.5 * 6.0_f64.powf(random.random_range(0.0..1.0)),
        Errors::Gaussian | Errors::Counts | Errors::Tails => 1.0,
    };
    for joint in &mut noisy.joints {
        joint.external_encoder_sd_rad = joint.external_encoder_sd_rad.map(|sd| sd * factor());
    }
    for cable in &mut noisy.cables {
        cable.distance_sd_m = cable.distance_sd_m.map(|sd| sd * factor());
    }
    let tracker_sd_m = TRACKER_SD_M * factor();
    let noise = match errors {
        Errors::Counts => Noise::Counts,
        Errors::Gaussian | Errors::Unequal => Noise::Gaussian,
        Errors::Tails => Noise::None,
    };
    let settings = Settings {
        motor_counts: errors == Errors::Counts,
        ..with_noise(noise)
    };
    let mut seen = simulate(&noisy, &settings, rows, seed)?;
    if errors == Errors::Tails {
        add_tails(&mut seen, truth, seed)?;
    }
    if rig == Rig::Tracker {
        let poses = true_poses(truth, &seen)?;
        let mut normal = generator(seed, 3);
        seen.position_m = Some(tracked(&poses, tracker_sd_m, &mut normal));
        seen.cable_m = seen.cable_m.iter().map(|_| None).collect();
    }
    Ok(seen)
}

/// Positions as a tracker with normal errors reads them, axis by axis.
pub(super) fn tracked(poses: &[Pose], sd_m: f64, random: &mut ChaCha8Rng) -> [Vec<f64>; 3] {
    [0, 1, 2].map(|axis| {
        let readings = poses.iter().map(|pose| {
            let error: f64 = StandardNormal.sample(random);
            pose.position_m[axis] + sd_m * error
        });
        readings.collect()
    })
}

/// Adds heavy-tailed errors to external encoders and cables.
fn add_tails(seen: &mut Recording, truth: &Device, seed: u64) -> Result<()> {
    let mut random = generator(seed, 4);
    let student = StudentT::new(3.0).map_err(|error| anyhow!("Student's t: {error}"))?;
    // its variance is 3
    let mut error = |sd: f64| sd / 3.0_f64.sqrt() * student.sample(&mut random);
    for (joint, column) in truth.joints.iter().zip(&mut seen.output) {
        let sd = joint.output_sd_rad().unwrap_or(0.0);
        for reading in column.iter_mut().flatten() {
            *reading += error(sd);
        }
    }
    for (cable, column) in seen.cable_m.iter_mut().enumerate() {
        let sd = truth.cable_sd_m(cable).unwrap_or(0.0);
        for reading in column.iter_mut().flatten() {
            *reading += error(sd);
        }
    }
    Ok(())
}

/// Postures that predictions are tried at: the same ones for every device.
pub(super) fn postures(nominal: &Device, count: usize) -> Result<Recording> {
    const SEED: u64 = 0x0070_6f73;
    let settings = Settings {
        output_noise: Noise::None,
        cable_noise: Noise::None,
        ..Settings::paper()
    };
    simulate(nominal, &settings, count, SEED).context("postures for predictions")
}
