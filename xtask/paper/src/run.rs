//! One simulated calibration: the two steps of the paper's Figure 6 and the check on other poses.

use anyhow::{Context, Result, bail};
use haptical_calibration::{
    Channel, Options, ParameterFit, TransmissionFit, Weighting, Weights, fit_kinematics,
    fit_transmission, rows_with_known_errors,
};
use haptical_model::{Device, Recording, TransmissionError};

use xtask_blind::Random;

use crate::pose_error::PoseErrors;
use crate::scenario::Scenario;

#[derive(Debug, Clone)]
pub(crate) struct Run {
    pub(crate) transmissions: Vec<TransmissionFit>,
    /// Recordings of step 1, one per transmission.
    pub(crate) transmission_data: Vec<Recording>,
    pub(crate) kinematics: ParameterFit,
    pub(crate) pose: PoseErrors,
}

/// Capstan parameters in the paper's form: R_e, r_o, r_i, beta_o, beta_i (SI), with standard
/// deviations from the fit's covariance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CapstanEstimate {
    pub(crate) values: [f64; 5],
    pub(crate) standard_deviations: [f64; 5],
    pub(crate) covariance: [[f64; 5]; 5],
}

/// Poses to check on come from another stream of random numbers than those of the fit.
const EVALUATION_STREAM: u64 = 0x9E37_79B9_7F4A_7C15;

/// The scenario's, without condition and observability, which no table takes from a run.
fn options(scenario: &Scenario) -> Options {
    let mut options = scenario.options();
    options.rules.singular_values = false;
    options
}

/// Step 1 for joints 1 to 4 on simulated samples of each.
pub fn step_one(
    scenario: &Scenario,
    seed: u64,
) -> Result<(Device, Vec<TransmissionFit>, Vec<Recording>)> {
    let recorded = |joint| scenario.simulate_transmission(joint, seed);
    step_one_on(&scenario.nominal, &options(scenario), recorded)
}

/// Step 1 for joints 1 to 4, each on a recording of its own.
pub fn step_one_on(
    nominal: &Device,
    options: &Options,
    mut recorded: impl FnMut(usize) -> Result<Recording>,
) -> Result<(Device, Vec<TransmissionFit>, Vec<Recording>)> {
    let mut device = nominal.clone();
    let mut fits = Vec::new();
    let mut data = Vec::new();
    for joint in 0..4 {
        let recording = recorded(joint)?;
        let weights = Weights::stated(nominal, &[Channel::Output { joint }]);
        let fit = fit_transmission(nominal, joint, &recording, &weights, options)?;
        let Some(fitted) = &fit.fit else {
            bail!("joint {}: nothing fitted", joint + 1)
        };
        device.joints[joint].transmission_error =
            fitted.device.joints[joint].transmission_error.clone();
        fits.push(fit);
        data.push(recording);
    }
    Ok((device, fits, data))
}

/// Step 2 at the joint angles that step 1 corrects.
pub(crate) fn step_two(
    scenario: &Scenario,
    compensated: &Device,
    seed: u64,
) -> Result<ParameterFit> {
    let recording = scenario.simulate(scenario.poses, seed)?;
    step_two_on(compensated, &recording, &options(scenario))
}

/// Step 2 on a recording, without the rows that lie beyond what step 1 was fitted on (docs/assumptions.md).
pub fn step_two_on(
    compensated: &Device,
    recording: &Recording,
    options: &Options,
) -> Result<ParameterFit> {
    let recording = recording.select(&rows_with_known_errors(compensated, recording));
    let channels = [Channel::Cable { index: 0 }];
    let weights = Weights::stated(compensated, &channels);
    Ok(fit_kinematics(
        compensated,
        &recording,
        &channels,
        &weights,
        options,
    )?)
}

/// What both steps make of random rows of a recording, other ones for each fit.
pub(crate) struct OnSamples {
    /// The nominal device with the fitted transmissions.
    pub(crate) compensated: Device,
    pub(crate) transmissions: Vec<TransmissionFit>,
    pub(crate) transmission_data: Vec<Recording>,
    /// The rows of step 2.
    pub(crate) data: Recording,
    pub(crate) kinematics: ParameterFit,
}

/// Options of fits to recordings with roughness, which is larger than the noise that the device file states.
pub(crate) fn rough_options(scenario: &Scenario) -> Options {
    Options {
        weighting: Weighting::Estimated,
        ..scenario.options()
    }
}

pub(crate) fn sample(recording: &Recording, count: usize, random: &mut Random) -> Recording {
    let rows: Vec<usize> = (0..count).map(|_| random.index(recording.len())).collect();
    recording.select(&rows)
}

/// Both steps on random rows of a recording, as many as the scenario says.
pub(crate) fn on_samples(
    scenario: &Scenario,
    recording: &Recording,
    random: &mut Random,
) -> Result<OnSamples> {
    let options = rough_options(scenario);
    let (compensated, transmissions, transmission_data) =
        step_one_on(&scenario.nominal, &options, |_| {
            Ok(sample(recording, scenario.samples, random))
        })?;
    let data = sample(recording, scenario.poses, random);
    Ok(OnSamples {
        kinematics: step_two_on(&compensated, &data, &options)?,
        compensated,
        transmissions,
        transmission_data,
        data,
    })
}

/// Joint readings of the poses that a run is checked on.
pub fn evaluation_readings(scenario: &Scenario, seed: u64) -> Result<Recording> {
    let seed = seed.wrapping_add(EVALUATION_STREAM);
    scenario.simulate(scenario.evaluation_poses, seed)
}

/// Both steps and the check.
pub(crate) fn run(scenario: &Scenario, seed: u64) -> Result<Run> {
    let (compensated, transmissions, transmission_data) = step_one(scenario, seed)?;
    let kinematics =
        step_two(scenario, &compensated, seed).with_context(|| format!("seed {seed}"))?;
    let readings = evaluation_readings(scenario, seed)?;
    Ok(Run {
        pose: scenario.pose_errors(&kinematics.device, &readings)?,
        transmissions,
        transmission_data,
        kinematics,
    })
}

impl Run {
    /// Fitted deviation of a kinematic parameter from its nominal value, and its standard deviation;
    /// none where it was not identified.
    pub(crate) fn deviation(&self, nominal: &Device, name: &str) -> Option<(f64, f64)> {
        let mut estimates = self.kinematics.estimates.iter();
        let estimate = estimates.find(|estimate| estimate.name == name)?;
        let nominal = nominal.parameter(name).ok()?.value(nominal);
        Some((estimate.value? - nominal, estimate.standard_deviation?))
    }

    /// The estimate of capstan `joint` (0 to 2) in polar form.
    pub(crate) fn capstan(&self, joint: usize) -> Option<CapstanEstimate> {
        let fit = self.transmissions.get(joint)?.fit.as_ref()?;
        let TransmissionError::Capstan(error) = &fit.device.joints[joint].transmission_error else {
            return None;
        };
        let (output_radius, output_phase) = error.output_drum_polar();
        let (input_radius, input_phase) = error.input_drum_polar();
        // Cartesian parameters in the fit's order: R_e, x_o, y_o, x_i, y_i.
        let size = fit.uncertainty.columns.len();
        if size != 5 || output_radius == 0.0 || input_radius == 0.0 {
            return None;
        }
        let mut gradient = [[0.0; 5]; 5];
        gradient[0][0] = 1.0;
        for (radius, xy, first, radius_row, phase_row) in [
            (output_radius, error.output_drum_xy_m, 1, 1, 3),
            (input_radius, error.input_drum_xy_m, 3, 2, 4),
        ] {
            let (cosine, sine) = (xy[0] / radius, xy[1] / radius);
            gradient[radius_row][first] = cosine;
            gradient[radius_row][first + 1] = sine;
            gradient[phase_row][first] = -sine / radius;
            gradient[phase_row][first + 1] = cosine / radius;
        }
        let mut covariance = [[0.0; 5]; 5];
        for (a, row) in covariance.iter_mut().enumerate() {
            for (b, entry) in row.iter_mut().enumerate() {
                for i in 0..5 {
                    for j in 0..5 {
                        *entry +=
                            gradient[a][i] * fit.uncertainty.covariance[(i, j)] * gradient[b][j];
                    }
                }
            }
        }
        let mut standard_deviations = [0.0; 5];
        for (index, sd) in standard_deviations.iter_mut().enumerate() {
            *sd = covariance[index][index].sqrt();
        }
        Some(CapstanEstimate {
            values: [
                error.ratio_deviation,
                output_radius,
                input_radius,
                output_phase,
                input_phase,
            ],
            standard_deviations,
            covariance,
        })
    }
}
