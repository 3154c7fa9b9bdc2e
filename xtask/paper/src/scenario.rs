//! The simulated device of the paper: nominal, with the assigned deviations, and how it is measured.

use anyhow::{Context, Result, ensure};
use haptical_calibration::{CalibrationMethod, Degree, HeldOut, Options, Weighting};
use haptical_identification::Settings as Search;
use haptical_model::{Device, Recording, TransmissionError, TransmissionKind};
use haptical_simulator::{Settings, apply_deviations, simulate, simulate_transmission};

use crate::pose_error::PoseErrors;
use crate::published::{Paper, Rows, capstan};

const NOMINAL: &str = include_str!("../../../fixtures/devices/haptic7.toml");

/// Everything that one simulated calibration depends on, besides the seed.
#[derive(Debug, Clone)]
pub struct Scenario {
    /// What is known before.
    pub nominal: Device,
    /// What is simulated.
    pub truth: Device,
    /// Noise and ranges.
    pub settings: Settings,
    /// Poses for step 2.
    pub poses: usize,
    /// Samples for each transmission.
    pub samples: usize,
    /// Poses to check on.
    pub evaluation_poses: usize,
    /// Degree of the polynomial of the fourth transmission.
    pub degree: usize,
    /// Rules of the search.
    pub search: Search,
}

/// Denominators of the input drums' terms that bring the printed ripple and the printed precision of
/// r_i together (docs/assumptions.md).
pub(crate) const PRESET_DENOMINATORS_M: [f64; 4] = [2.9e-3, 2.9e-3, 2.9e-3, 2.6e-3];

/// The nominal device: the given file, or the one that the paper's tables imply.
pub fn nominal_device(path: Option<&std::path::Path>) -> Result<Device> {
    let device = match path {
        Some(path) => Device::load(path)?.device,
        None => Device::from_toml(NOMINAL, "fixtures/devices/haptic7.toml")?.device,
    };
    ensure!(
        device.joints.len() == 7 && device.links.len() == 8,
        "the paper's tables belong to a 7-joint device with 8 link rows; `{}` has {} joints",
        device.name,
        device.joints.len()
    );
    let kinds = device.joints.iter().take(4).map(|joint| joint.transmission);
    let kinds: Vec<TransmissionKind> = kinds.collect();
    let [capstan, fourth] = [TransmissionKind::Capstan, TransmissionKind::Parallelogram];
    ensure!(
        kinds == [capstan, capstan, capstan, fourth],
        "joints 1 to 3 must be capstans and joint 4 a parallelogram, as in the paper"
    );
    Ok(device)
}

impl Scenario {
    /// The paper's simulation on a nominal device.
    pub fn paper(mut nominal: Device, paper: &Paper, preset: bool) -> Result<Self> {
        for (joint, denominator) in nominal.joints.iter_mut().zip(PRESET_DENOMINATORS_M) {
            if preset {
                joint.input_drum_denominator_m = Some(denominator);
            }
        }
        // The paper's simulation adds Gaussian noise only: no count of a motor-side encoder.
        for joint in &mut nominal.joints {
            joint.encoder_counts_per_rev = None;
        }
        let truth = true_device(&nominal, paper, 1.0)?;
        Ok(Self {
            nominal,
            truth,
            settings: Settings::paper(),
            poses: 200,
            samples: 200,
            evaluation_poses: 200,
            degree: 10,
            search: Search::default(),
        })
    }

    /// Readings of random poses of the true device.
    pub fn simulate(&self, poses: usize, seed: u64) -> Result<Recording> {
        Ok(simulate(&self.truth, &self.settings, poses, seed)?)
    }

    /// Samples of one transmission of the true device.
    pub fn simulate_transmission(&self, joint: usize, seed: u64) -> Result<Recording> {
        let (truth, settings) = (&self.truth, &self.settings);
        let samples = self.samples;
        Ok(simulate_transmission(
            truth, settings, joint, samples, seed,
        )?)
    }

    /// Errors of the handle at some readings before a calibration and after it.
    pub fn pose_errors(&self, calibrated: &Device, readings: &Recording) -> Result<PoseErrors> {
        PoseErrors::new(&self.truth, &self.nominal, calibrated, readings)
    }

    /// Options of the two fits: the paper's choices.
    pub fn options(&self) -> Options {
        Options {
            method: CalibrationMethod::TwoStep,
            degree: Degree::Fixed(self.degree),
            zeroed_at_home: true,
            weighting: Weighting::Stated,
            held_out: HeldOut::None,
            search: self.search.clone(),
            ..Options::default()
        }
    }
}

/// The nominal device with Table 2's transmission errors and `scale` times Table 3's deviations.
pub fn true_device(nominal: &Device, paper: &Paper, scale: f64) -> Result<Device> {
    let deviations = paper.table3.iter();
    let deviations = deviations.map(|row| (row.name.as_str(), row.assigned));
    let others = paper.unidentified.iter();
    let others = others.map(|(name, value)| (name.as_str(), *value));
    let deviations = deviations.chain(others);
    let deviations = deviations.map(|(name, assigned)| (name, scale * assigned));
    let deviations: Vec<(&str, f64)> = deviations.collect();
    let mut truth = apply_deviations(nominal, &deviations).context("assigning Table 3")?;
    let table = &paper.table2;
    let (radii, angles) = (
        [&table.ro_mm, &table.ri_mm],
        [&table.beta_o_deg, &table.beta_i_deg],
    );
    for joint in 0..3 {
        let of = |rows: &Rows| rows.assigned[joint];
        let ([ro, ri], [beta_o, beta_i]) = (radii.map(of), angles.map(of));
        let error = capstan([of(&table.ratio_deviation), ro, beta_o, ri, beta_i]);
        truth.joints[joint].transmission_error = TransmissionError::Capstan(error);
    }
    let fourth = &table.parallelogram_assigned;
    let [first, second] = paper.length_deviations_m;
    truth.joints[3].transmission_error = TransmissionError::Parallelogram {
        capstan: capstan([
            fourth.ratio_deviation,
            fourth.ro4_mm,
            fourth.beta_o4_deg,
            fourth.ri4_mm,
            fourth.beta_i4_deg,
        ]),
        length_deviations_m: [first, second, 0.0, 0.0],
    };
    Ok(truth)
}
