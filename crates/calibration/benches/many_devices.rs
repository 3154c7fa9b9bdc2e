//! Calibrates many simulated devices in two steps, in parallel, and says how long one takes.
//!
//! `cargo bench -p haptical-calibration --bench many_devices -- [DEVICES] [ROUNDS] [FILE]`: recordings are
//! made first and do not count; the best of the rounds does. FILE gets every value and standard deviation, line by
//! line, so that two versions of the program can be compared.
#![allow(
    missing_docs,
    clippy::print_stdout,
    reason = "a program that measures prints, and its numbers are known to be sound"
)]

use std::error::Error;
use std::fmt::Write as _;
use std::time::Instant;

use haptical_calibration::{
    CalibrationMethod, Channel, Degree, HeldOut, Options, ParameterFit, Weighting, Weights,
    fit_kinematics, fit_transmission, rows_with_known_errors,
};
use haptical_identification::IdentifiabilityRules;
use haptical_model::transmission::CapstanError;
use haptical_model::{Device, Recording, TransmissionError, TransmissionKind};
use haptical_simulator::{Settings, simulate, simulate_transmission};
use rayon::prelude::*;

const SAMPLES: usize = 200;
const POSES: usize = 200;

/// What the two steps are given.
struct Simulated {
    transmissions: Vec<Recording>,
    poses: Recording,
}

fn main() -> Result<(), Box<dyn Error>> {
    // cargo itself adds --bench
    let mut arguments = std::env::args()
        .skip(1)
        .filter(|word| !word.starts_with("--"));
    let devices: u64 = arguments.next().map_or(Ok(1000), |text| text.parse())?;
    let rounds: usize = arguments.next().map_or(Ok(5), |text| text.parse())?;
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../fixtures/devices/haptic7.toml"
    );
    let mut nominal = Device::load(path.as_ref())?.device;
    // The paper's simulation adds Gaussian noise only: no count of a motor-side encoder.
    for joint in &mut nominal.joints {
        joint.encoder_counts_per_rev = None;
    }
    let simulated: Vec<Simulated> = (0..devices)
        .into_par_iter()
        .map(|seed| simulated(&nominal, seed).map_err(|error| error.to_string()))
        .collect::<Result<_, _>>()?;
    let mut best_s = f64::INFINITY;
    let mut lines = Vec::new();
    for _ in 0..rounds {
        let start = Instant::now();
        let fits: Vec<Vec<ParameterFit>> = simulated
            .par_iter()
            .map(|simulated| calibrated(&nominal, simulated).map_err(|error| error.to_string()))
            .collect::<Result<_, _>>()?;
        best_s = best_s.min(start.elapsed().as_secs_f64());
        lines = fits.iter().map(|fits| line(fits)).collect();
    }
    if let Some(file) = arguments.next() {
        std::fs::write(file, lines.concat())?;
    }
    let threads = rayon::current_num_threads();
    println!(
        "{devices} devices, {threads} threads: {best_s:.3} s, {:.3} ms of one thread each",
        1e3 * best_s * threads as f64 / devices as f64
    );
    Ok(())
}

/// A device whose lengths are off by up to 2 mm and whose angles by up to 2 mrad, and its recordings.
fn simulated(nominal: &Device, seed: u64) -> Result<Simulated, Box<dyn Error>> {
    let mut truth = nominal.clone();
    let mut number = 1000 * seed;
    let mut random = || {
        number += 1;
        spread(number)
    };
    for parameter in nominal.link_parameters(false) {
        parameter.set(&mut truth, parameter.value(nominal) + 2e-3 * random());
    }
    let mut capstan = || {
        CapstanError::from_polar(
            0.0,
            0.025 * random(),
            2e-4 * (1.5 + random()),
            3.0 * random(),
            4e-6 * (1.5 + random()),
            3.0 * random(),
        )
    };
    for joint in 0..3 {
        truth.joints[joint].transmission_error = TransmissionError::Capstan(capstan());
    }
    truth.joints[3].transmission_error = TransmissionError::Parallelogram {
        capstan: capstan(),
        length_deviations_m: [-5e-4, -7e-4, 0.0, 0.0],
    };
    let settings = Settings::paper();
    let driven = (0..truth.joints.len())
        .filter(|&joint| truth.joints[joint].transmission != TransmissionKind::Direct);
    Ok(Simulated {
        transmissions: driven
            .map(|joint| simulate_transmission(&truth, &settings, joint, SAMPLES, seed))
            .collect::<Result<_, _>>()?,
        poses: simulate(&truth, &settings, POSES, seed)?,
    })
}

/// The paper's options.
fn options() -> Options {
    let rules = IdentifiabilityRules {
        // condition and observability of each device are not reported
        singular_values: false,
        ..IdentifiabilityRules::default()
    };
    Options {
        rules,
        method: CalibrationMethod::TwoStep,
        degree: Degree::Fixed(10),
        zeroed_at_home: true,
        weighting: Weighting::Stated,
        held_out: HeldOut::None,
        ..Options::default()
    }
}

/// Both steps: four transmissions and the kinematics.
fn calibrated(
    nominal: &Device,
    simulated: &Simulated,
) -> Result<Vec<ParameterFit>, Box<dyn Error>> {
    let options = options();
    let mut device = nominal.clone();
    let mut fits = Vec::with_capacity(5);
    for (joint, recording) in simulated.transmissions.iter().enumerate() {
        let weights = Weights::stated(nominal, &[Channel::Output { joint }]);
        let fit = fit_transmission(nominal, joint, recording, &weights, &options)?;
        let fit = fit.fit.ok_or("nothing fitted")?;
        device.joints[joint].transmission_error =
            fit.device.joints[joint].transmission_error.clone();
        fits.push(fit);
    }
    let poses = &simulated.poses;
    let poses = poses.select(&rows_with_known_errors(&device, poses));
    let channels = [Channel::Cable { index: 0 }];
    let weights = Weights::stated(&device, &channels);
    fits.push(fit_kinematics(
        &device, &poses, &channels, &weights, &options,
    )?);
    Ok(fits)
}

/// Every number of a device's fits that a report would show.
fn line(fits: &[ParameterFit]) -> String {
    let mut line = String::new();
    for fit in fits {
        for estimate in &fit.estimates {
            let _ = write!(
                line,
                "{:e} {:e} ",
                estimate.value.unwrap_or(f64::NAN),
                estimate.standard_deviation.unwrap_or(f64::NAN)
            );
        }
        let (judged, nominal) = (&fit.identifiability, &fit.nominal_identifiability);
        let (gap, cost) = (judged.gap[0], fit.cost);
        let _ = write!(line, "{cost:e} {} {} {gap:e} ", judged.rank, nominal.rank);
        let sum: f64 = fit.residuals.iter().map(|value| value.abs()).sum();
        let _ = write!(line, "{sum:e} ");
    }
    line.push('\n');
    line
}

/// Numbers in [-1, 1) without a visible order (SplitMix64).
fn spread(index: u64) -> f64 {
    let mut z = (index + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}
