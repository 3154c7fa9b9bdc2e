//! The forms in lanes give what the general form gives, row by row, for random devices.

use haptical_calibration::{
    CalibrationMethod, Channel, Degree, DeviceProblem, FitRequest, HeldOut, Options, ParameterFit,
    Weighting, Weights, fit_kinematics, fit_parameters, fit_transmission, parameter_infos,
    preference_order,
};
use haptical_identification::{
    IdentificationError, Matrix, NoiseScale, Problem, Reduction, Status, analyse,
    evaluate_jacobian, solve, uncertainty,
};
use haptical_model::transmission::CapstanError;
use haptical_model::{Device, ParameterId, Recording, TransmissionError};
use haptical_simulator::{Settings, simulate, simulate_transmission};
use proptest::prelude::*;
use rayon::prelude::*;

use crate::haptic;

/// Of a standard deviation: the default search ends within 1e-8 sqrt(cost) of them, where both searches take
/// the same steps.
const PARAMETER_TOLERANCE: f64 = 1e-7;
/// Of the cost: its rounding. Searches with other numbers of steps end anywhere that it cannot tell apart.
const COST_ROUNDING: f64 = 1e-13;
/// Relative, of standard deviations and the cost.
const RELATIVE_TOLERANCE: f64 = 1e-9;
/// Of residuals in standard deviations: 1e-7 of the parameters' times their effect.
const RESIDUAL_TOLERANCE: f64 = 1e-6;

/// A problem that says nothing of its form: what `fit_parameters` did for every problem.
struct RowByRow<'p>(DeviceProblem<'p>);

impl Problem for RowByRow<'_> {
    fn parameter_count(&self) -> usize {
        self.0.parameter_count()
    }

    fn residual_count(&self) -> usize {
        self.0.residual_count()
    }

    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        self.0.evaluate(parameters, residuals, jacobian)
    }
}

fn options(singular_values: bool) -> Options {
    let mut options = Options {
        method: CalibrationMethod::TwoStep,
        degree: Degree::Fixed(10),
        zeroed_at_home: true,
        weighting: Weighting::Stated,
        held_out: HeldOut::None,
        ..Options::default()
    };
    options.rules.singular_values = singular_values;
    options
}

/// Without counts of the motors' encoders: every row weighs the same.
fn nominal() -> Option<Device> {
    let mut device = haptic::haptic7()?;
    for joint in &mut device.joints {
        joint.encoder_counts_per_rev = None;
    }
    Some(device)
}

/// Compares a fit with solving and judging the same problem row by row.
fn compare(
    fit: &ParameterFit,
    device: &Device,
    recording: &Recording,
    channel: Channel,
) -> Result<(), TestCaseError> {
    let weights = Weights::stated(device, &[channel]);
    let problem = DeviceProblem::new(device, recording, &[channel], &fit.parameters, &weights);
    let problem = RowByRow(problem.unwrap());
    let options = options(true);
    let start = problem.0.start();
    let slow = solve(&problem, &start, &fit.fitted, &options.search).unwrap();
    let spread = uncertainty(
        &slow.reduction,
        &(0..fit.fitted.len()).collect::<Vec<_>>(),
        slow.cost,
        NoiseScale::Stated,
    )
    .unwrap();
    prop_assert!((fit.cost / slow.cost - 1.0).abs() < RELATIVE_TOLERANCE);
    let same_steps = fit.iterations == slow.iterations;
    let allowed = match same_steps {
        true => PARAMETER_TOLERANCE,
        false => (COST_ROUNDING * slow.cost).sqrt(),
    };
    for (position, &index) in fit.fitted.iter().enumerate() {
        let sd = spread.standard_deviation(position);
        let estimate = &fit.estimates[index];
        let apart = (estimate.value.unwrap() - slow.parameters[index]) / sd;
        prop_assert!(apart.abs() < allowed, "{}: {apart:e} sd", estimate.name);
        // by the noise: what is held is the fit's own matter
        let ratio = fit.uncertainty.standard_deviation(position) / sd;
        prop_assert!(
            !same_steps || (ratio - 1.0).abs() < RELATIVE_TOLERANCE,
            "{}: {ratio}",
            estimate.name
        );
    }
    if !same_steps {
        // derivatives at other places differ by themselves
        return Ok(());
    }
    for (a, b) in fit.residuals.iter().zip(&slow.residuals) {
        prop_assert!((a - b).abs() < RESIDUAL_TOLERANCE, "{a} {b}");
    }
    prop_assert_eq!(fit.residuals.len(), slow.residuals.len());

    let all: Vec<usize> = (0..fit.parameters.len()).collect();
    let infos = parameter_infos(device, &fit.parameters);
    for (found, values, first) in [
        (&fit.nominal_identifiability, &start, &[][..]),
        (
            &fit.identifiability,
            &slow.parameters,
            fit.fitted.as_slice(),
        ),
    ] {
        let (jacobian, residuals) = evaluate_jacobian(&problem, values, &all).unwrap();
        let reduction = Reduction::new(&jacobian, &residuals).unwrap();
        let mut order = preference_order(&fit.parameters);
        order.sort_by_key(|index| !first.contains(index));
        let judged = analyse(&reduction, &infos, &order, &options.rules).unwrap();
        prop_assert_eq!(
            (found.rank, found.singular_rank, &found.independent),
            (judged.rank, judged.singular_rank, &judged.independent)
        );
        prop_assert!(found.is_clear());
        prop_assert!(found.condition_unit_norm >= (1.0 - 1e-9) * judged.condition_unit_norm);
        for (a, b) in found.statuses.iter().zip(&judged.statuses) {
            prop_assert_eq!(std::mem::discriminant(a), std::mem::discriminant(b));
            if let (
                Status::Identifiable {
                    standard_deviation: a,
                },
                Status::Identifiable {
                    standard_deviation: b,
                },
            ) = (a, b)
            {
                prop_assert!((a / b - 1.0).abs() < 1e-7, "{a} {b}");
            }
        }
    }
    Ok(())
}

/// Offsets of the links in mm and mrad, and each capstan's parameters as shares of its largest.
fn truth(nominal: &Device, links: &[f64], capstans: &[[f64; 5]]) -> Device {
    let mut truth = nominal.clone();
    for (parameter, offset) in nominal.link_parameters(false).into_iter().zip(links) {
        parameter.set(&mut truth, parameter.value(nominal) + offset);
    }
    for (joint, [ratio, ro, bo, ri, bi]) in capstans.iter().enumerate() {
        let error =
            CapstanError::from_polar(0.0, 0.03 * ratio, 4e-4 * ro, 3.0 * bo, 1e-5 * ri, 3.0 * bi);
        truth.joints[joint].transmission_error = if joint < 3 {
            TransmissionError::Capstan(error)
        } else {
            TransmissionError::Parallelogram {
                capstan: error,
                length_deviations_m: [5e-4 * ratio, -7e-4 * ro, 0.0, 0.0],
            }
        };
    }
    truth
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn two_steps_are_those_of_the_general_form(
        links in prop::collection::vec(-2e-3..2e-3_f64, 32),
        capstans in prop::collection::vec(prop::array::uniform5(-1.0..1.0_f64), 4),
        (rows, seed) in (60..400_usize, any::<u64>()),
    ) {
        let Some(nominal) = nominal() else { return Ok(()) };
        let truth = truth(&nominal, &links, &capstans);
        let options = options(seed % 2 == 0);
        let mut device = nominal.clone();
        for joint in 0..4 {
            let recording =
                simulate_transmission(&truth, &Settings::paper(), joint, rows, seed).unwrap();
            let channel = Channel::Output { joint };
            let weights = Weights::stated(&nominal, &[channel]);
            let fit = fit_transmission(&nominal, joint, &recording, &weights, &options).unwrap();
            let fit = fit.fit.unwrap();
            let fitted = fit.device.joints[joint].transmission_error.clone();
            let mut start = nominal.clone();
            if let TransmissionError::Chebyshev { range_rad, coefficients } = &fitted {
                start.joints[joint].transmission_error = TransmissionError::Chebyshev {
                    range_rad: *range_rad,
                    coefficients: vec![0.0; coefficients.len()],
                };
            }
            compare(&fit, &start, &recording, channel)?;
            device.joints[joint].transmission_error = fitted;
        }
        let recording = simulate(&truth, &Settings::paper(), rows, seed).unwrap();
        let channel = Channel::Cable { index: 0 };
        let weights = Weights::stated(&device, &[channel]);
        let fit = fit_kinematics(&device, &recording, &[channel], &weights, &options).unwrap();
        compare(&fit, &device, &recording, channel)?;
    }

    /// Eccentricities that leave the range of the short series, and all six parameters.
    #[test]
    fn large_eccentricities_too(
        share in 0.05..0.5_f64,
        (angle, seed) in (-3.0..3.0_f64, any::<u64>()),
    ) {
        let Some(nominal) = nominal() else { return Ok(()) };
        let mut truth = nominal.clone();
        let distance_m = nominal.joints[0].drum_distance_m.unwrap();
        truth.joints[0].transmission_error = TransmissionError::Capstan(
            CapstanError::from_polar(1e-3, 0.02, share * distance_m, angle, 1e-2 * distance_m, 1.0),
        );
        let recording = simulate_transmission(&truth, &Settings::paper(), 0, 200, seed).unwrap();
        let channel = Channel::Output { joint: 0 };
        let weights = Weights::stated(&nominal, &[channel]);
        let parameters: Vec<ParameterId> =
            (0..6).map(|index| ParameterId::Transmission { joint: 0, index }).collect();
        let what = "a far drum";
        let fit = fit_parameters(&FitRequest { what, device: &nominal, recording: &recording, channels: &[channel], parameters: &parameters, unsupported: &[], weights: &weights, options: &options(false), start: None, yielded: None }).unwrap();
        compare(&fit, &nominal, &recording, channel)?;
    }
}

/// A batch of devices has the same bits on any number of threads.
#[test]
fn threads_change_no_bit() {
    let Some(nominal) = nominal() else { return };
    let truth = haptic::truth_of(&nominal, 0.3);
    let recordings: Vec<Recording> = (0..12)
        .map(|seed| simulate(&truth, &Settings::paper(), 200, seed).unwrap())
        .collect();
    let channels = [Channel::Cable { index: 0 }];
    let weights = Weights::stated(&nominal, &channels);
    let mut compensated = nominal.clone();
    for (joint, true_joint) in compensated.joints.iter_mut().zip(&truth.joints) {
        joint.transmission_error = true_joint.transmission_error.clone();
    }
    let bits = |threads: usize| -> Vec<Vec<u64>> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| {
            recordings
                .par_iter()
                .map(|recording| {
                    let options = options(false);
                    let fit =
                        fit_kinematics(&compensated, recording, &channels, &weights, &options)
                            .unwrap();
                    let values = fit.estimates.iter().filter_map(|estimate| estimate.value);
                    let deviations = fit
                        .estimates
                        .iter()
                        .filter_map(|estimate| estimate.standard_deviation);
                    values
                        .chain(deviations)
                        .chain(fit.residuals.iter().copied())
                        .map(f64::to_bits)
                        .collect()
                })
                .collect()
        })
    };
    let one = bits(1);
    assert!(one == bits(2) && one == bits(3));
}

/// A reading that is no number is refused with its line, as the general form does.
#[test]
fn a_bad_reading_keeps_its_line() {
    let Some(nominal) = nominal() else { return };
    let truth = haptic::truth_of(&nominal, 0.3);
    let channels = [Channel::Cable { index: 0 }];
    let weights = Weights::stated(&nominal, &channels);
    let mut recording = simulate(&truth, &Settings::paper(), 200, 1).unwrap();
    recording.joint[2][17] = f64::NAN;
    let error = fit_kinematics(&nominal, &recording, &channels, &weights, &options(false));
    let line = recording.line[17];
    let text = error.unwrap_err().to_string();
    assert!(text.contains(&format!("line {line}")), "{text}");
}
