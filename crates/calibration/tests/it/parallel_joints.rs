//! An arm with parallel joints: the combination that the data cannot tell is named and gets no interval.

use std::f64::consts::{FRAC_PI_2, PI};

use haptical_calibration::{
    Channel, FitRequest, HeldOut, Options, Weighting, Weights, calibrate, fit_parameters,
    predict_positions,
};
use haptical_identification::Status;
use haptical_model::kinematics::Convention;
use haptical_model::{Device, ParameterId, Recording, Tracker};
use haptical_simulator::true_poses;

use crate::chain::pseudo_random;
use crate::rig_scene::{plain, poses, readings, table};

/// Rows 1 to 6 of an arm like the UR10 in the modified convention (a, alpha, theta, d), then its tool behind a
/// joint that rests; joints 2 and 3 are parallel, joint 4 is not.
const ROWS: [[f64; 4]; 8] = [
    [0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.1273],
    [0.0, FRAC_PI_2, PI, 0.0],
    [0.612, 0.0, 0.0, 0.0],
    [0.5723, 0.9, 0.0, 0.163_941],
    [0.0, -FRAC_PI_2, 0.0, 0.1157],
    [0.0, FRAC_PI_2, PI, 0.0922],
    [0.07, 0.0, 0.0, 0.11],
];
/// Noise of a coordinate \[m\].
const SD_M: f64 = 5e-5;

fn arm() -> Device {
    let mut text = "[device]\nconvention = \"modified\"\n".to_owned();
    for [a, alpha, theta, d] in ROWS {
        text += &format!(
            "[[link]]\na_m = {a:?}\nalpha_rad = {alpha:?}\ntheta_offset_rad = {theta:?}\nd_m = {d:?}\n"
        );
    }
    text += &"[[joint]]\ntransmission = \"direct\"\ntransmission_ratio = 1.0\n".repeat(7);
    text += "[tracker]\nbase = \"known\"\ntool = \"known\"\nposition_sd_m = 5e-5\n";
    Device::from_toml(&text, "arm.toml").unwrap().device
}

fn record(truth: &Device, sd_m: f64, seed: u64) -> Recording {
    let joint = |index: u64| -> Vec<f64> {
        let reach = if index < 6 { 2.5 } else { 0.0 };
        (0..200)
            .map(|row| reach * pseudo_random(seed + index, row))
            .collect()
    };
    let mut recording = Recording {
        line: (2..202).collect(),
        joint: (0..7).map(joint).collect(),
        output: vec![None; 7],
        ..Recording::default()
    };
    let poses = true_poses(truth, &recording).unwrap();
    let axis = |axis: usize| -> Vec<f64> {
        let noise =
            |row: usize| sd_m * 3f64.sqrt() * pseudo_random(seed + 10 + axis as u64, row as u64);
        let rows = poses.iter().enumerate();
        rows.map(|(row, pose)| pose.position_m[axis] + noise(row))
            .collect()
    };
    recording.position_m = Some([axis(0), axis(1), axis(2)]);
    recording
}

#[test]
fn the_slide_along_parallel_axes_is_named_and_refused() {
    let nominal = arm();
    let is_row =
        |parameter: &ParameterId| matches!(parameter, ParameterId::Link { row: 1..=6, .. });
    let parameters: Vec<ParameterId> = nominal
        .link_parameters(false)
        .into_iter()
        .filter(is_row)
        .collect();
    assert_eq!(parameters.len(), 24);
    // exactly parallel, and so nearly that the slide is fixed to metres or centimetres
    for (twist_rad, seed) in [(0.0, 100), (1e-4, 200), (1e-3, 300)] {
        let mut truth = nominal.clone();
        for (k, parameter) in parameters.iter().enumerate() {
            let amount = pseudo_random(seed, k as u64);
            let amount = match parameter.unit(&nominal) {
                "m" => 2e-3 * amount,
                _ if parameter.name(&nominal) == "alpha3" => twist_rad,
                _ => 5e-3 * amount,
            };
            parameter.set(&mut truth, parameter.value(&nominal) + amount);
        }
        let recording = record(&truth, SD_M, seed + 1);
        let channels = [Channel::Position];
        let weights = Weights::stated(&nominal, &channels);
        let options = Options {
            weighting: Weighting::Stated,
            ..Options::default()
        };
        let fit = fit_parameters(&FitRequest {
            what: "arm",
            device: &nominal,
            recording: &recording,
            channels: &channels,
            parameters: &parameters,
            unsupported: &[],
            weights: &weights,
            options: &options,
            start: None,
            yielded: None,
        });
        let fit = fit.unwrap();
        assert_eq!(fit.nominal_identifiability.rank, 23);
        let of = |name: &str| fit.estimates.iter().position(|e| e.name == name).unwrap();
        let reason = fit.nominal_identifiability.reason(of("d3")).unwrap();
        assert_eq!(reason, "d3 acts like +1.000000 d2");
        let slide = &fit.estimates[of("d3")];
        assert_eq!((slide.value, slide.ci95), (None, None));
        let is_refused = matches!(slide.status, Status::Dependent { .. } | Status::Weak { .. });
        assert!(is_refused, "{twist_rad}: {:?}", slide.status);
        let unseen = record(&truth, 0.0, seed + 50);
        let predicted = predict_positions(&fit, &unseen).unwrap();
        let axes = unseen.position_m.as_ref().unwrap();
        let mut square = 0.0;
        for (row, predictions) in predicted.iter().enumerate() {
            for (axis, prediction) in predictions.iter().enumerate() {
                let error = prediction.value - axes[axis][row];
                // what slides is not seen: every coordinate is fixed
                let sd = prediction.standard_deviation.unwrap();
                assert!(
                    error.abs() < 5.0 * sd,
                    "{twist_rad}, row {row}: {error} of {sd}"
                );
                square += error * error / (3 * predicted.len()) as f64;
            }
        }
        // 23 parameters of 600 readings: sqrt(23 / 600) of the noise
        assert!(
            square.sqrt() < 2.0 * SD_M * (23.0_f64 / 600.0).sqrt(),
            "{square}"
        );
        // every interval that is given holds the truth or nearly so; those of the slide's partners too, but for
        // the part that they take of it where the axes are exactly parallel
        for (parameter, estimate) in parameters.iter().zip(&fit.estimates) {
            let takes_part = twist_rad == 0.0 && estimate.name == "d2";
            if let (false, Some(value), Some(sd)) =
                (takes_part, estimate.value, estimate.standard_deviation)
            {
                let error = (value - parameter.value(&truth)) / sd;
                assert!(error.abs() < 5.0, "{twist_rad}, {}: {error}", estimate.name);
            }
        }
    }
}

/// Positions at random postures, without noise.
fn seen(truth: &Device, seed: u64) -> Recording {
    let mut recording = plain(readings(truth, 200, 1.8, seed));
    let places = poses(truth, &recording);
    let axis = |axis: usize| places.iter().map(|pose| pose.position_m[axis]).collect();
    recording.position_m = Some([axis(0), axis(1), axis(2)]);
    recording
}

/// An arm whose tracker sees the handle in frame (-1).
fn tracked_arm(convention: Convention) -> Device {
    let mut arm = table(5);
    arm.convention = convention;
    arm.tracker = Some(Tracker {
        base_known: true,
        base_per_run: false,
        tool_known: true,
        position_sd_m: Some(SD_M),
        rotation_sd_rad: None,
        scale_sd: Some(0.0),
    });
    arm
}

fn unchecked() -> Options {
    Options {
        held_out: HeldOut::None,
        ..Options::default()
    }
}

/// A row's twist lies between two axes, the base's z among them: tilted about y against each other they need beta.
#[test]
fn a_tilt_about_y_of_parallel_axes_is_fitted() {
    for (convention, rows) in [
        (Convention::Standard, [0, 2, 4]),
        (Convention::Modified, [1, 3, 5]),
    ] {
        for row in rows {
            let mut nominal = tracked_arm(convention);
            nominal.links[row].alpha_rad = 0.0;
            let mut truth = nominal.clone();
            truth.links[row].beta_rad = 5e-3;
            let recording = seen(&truth, 40 + row as u64);
            let calibration = calibrate(&nominal, &recording, &unchecked()).unwrap();
            let report = &calibration.fit_channels[0];
            assert!(report.rms_before > 1e-4, "{convention:?} {row}");
            assert!(
                report.rms_after < 1e-8,
                "{convention:?} {row}: {:.1e} m is left",
                report.rms_after
            );
        }
    }
}

/// Of an arm that deviates from parallel by so much that its axes no longer count as parallel, the candidates are those
/// of its file, and what is not identified has the file's value in the device too.
#[test]
fn what_is_not_identified_keeps_its_value() {
    for (convention, twist_rad) in [
        (Convention::Standard, 1e-3),
        (Convention::Modified, 0.021),
        (Convention::Standard, 0.03),
    ] {
        let mut nominal = tracked_arm(convention);
        nominal.links[2].alpha_rad = 0.0;
        nominal.links[3].alpha_rad = 0.0;
        let mut truth = nominal.clone();
        truth.links[2].alpha_rad = twist_rad;
        truth.links[2].beta_rad = 0.015;
        truth.links[4].a_m += 2e-3;
        truth.links[1].d_m += 1e-3;
        let calibration = calibrate(&nominal, &seen(&truth, 50), &unchecked()).unwrap();
        let whole = calibration.fitted.whole.as_ref().unwrap();
        let beta = nominal.parameter("beta2").unwrap();
        assert!(whole.parameters.contains(&beta));
        let mut held = 0;
        for (parameter, estimate) in whole.parameters.iter().zip(&whole.estimates) {
            let now = parameter.value(&calibration.device);
            let then = parameter.value(&calibration.nominal);
            let said = estimate.value.unwrap_or(then);
            assert_eq!(now, said, "{}", estimate.name);
            held += usize::from(estimate.value.is_none());
        }
        assert!(held > 0, "no number is held");
        assert!(calibration.fit_channels[0].rms_after < 1e-8);
    }
}
