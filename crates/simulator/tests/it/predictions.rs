//! Recordings without noise are what the model predicts, and what closed forms say.

use haptical_simulator::model::kinematics::distance_m;
use haptical_simulator::model::{Device, Evaluation};
use haptical_simulator::{Noise, Settings, simulate, simulate_transmission, true_poses};

use crate::device::{arm, planar};

const ROWS: usize = 200;

/// Closed forms use another order of operations on lengths below 1 m and angles below 2 rad.
const TOLERANCE: f64 = 5e-15;

fn quiet() -> Settings {
    Settings {
        output_noise: Noise::None,
        cable_noise: Noise::None,
        ..Settings::paper()
    }
}

#[test]
fn without_noise_a_recording_is_the_prediction_to_the_bit() {
    let truth = arm();
    let recording = simulate(&truth, &quiet(), ROWS, 51).expect("a recording");
    let poses = true_poses(&truth, &recording).expect("poses");
    let mut evaluation = Evaluation::new(&truth);
    assert_eq!(poses.len(), ROWS);
    for (row, pose) in poses.iter().enumerate() {
        let readings: Vec<f64> = recording.joint.iter().map(|column| column[row]).collect();
        evaluation.move_to(&readings).expect("a pose");
        assert_eq!(pose, evaluation.pose().expect("links"));
        for (joint, column) in recording.output.iter().enumerate() {
            if let Some(column) = column {
                assert_eq!(column[row], evaluation.output_rad(joint));
            }
        }
        for (cable, column) in recording.cable_m.iter().enumerate() {
            let anchor = truth.cables[cable].anchor_m.into();
            let want = distance_m(&pose.position_m, &anchor).expect("a distance");
            assert_eq!(column.as_ref().expect("links")[row], want);
        }
        assert_eq!(recording.line[row], row as u64 + 2);
    }
    assert_eq!((recording.time_s, recording.run), (None, None));
    assert_eq!(recording.torque_nm, vec![None; 4]);
}

/// Equation (1) of the paper in polar form, with the standard library's functions.
fn capstan_error(truth: &Device, joint: usize, theta: f64) -> f64 {
    let p = |name: &str| {
        let parameter = truth
            .parameter(&format!("{name}{}", joint + 1))
            .expect("a parameter");
        parameter.value(truth)
    };
    let g = |r: f64, denominator: f64, x: f64| (r * x.sin() / (denominator - r * x.cos())).atan();
    let drum = |x: f64, y: f64, denominator: f64, turn: f64| {
        let (r, beta) = (x.hypot(y), y.atan2(x));
        g(r, denominator, turn + beta) - g(r, denominator, beta)
    };
    let ratio_deviation = p("ratio_deviation");
    p("offset") - ratio_deviation / (ratio_deviation + 8.0) * theta
        + drum(p("output_drum_x"), p("output_drum_y"), 0.07, theta)
        + drum(p("input_drum_x"), p("input_drum_y"), 0.003, 8.0 * theta)
}

#[test]
fn a_planar_arm_is_where_its_closed_form_says() {
    let truth = planar();
    let recording = simulate(&truth, &quiet(), ROWS, 52).expect("a recording");
    for row in 0..ROWS {
        let out: Vec<f64> = (0..2)
            .map(|joint| {
                let theta = recording.joint[joint][row];
                theta + capstan_error(&truth, joint, theta)
            })
            .collect();
        for (joint, column) in recording.output.iter().enumerate() {
            let got = column.as_ref().expect("capstans")[row];
            assert!((got - out[joint]).abs() < TOLERANCE, "{got} {}", out[joint]);
        }
        // links of 0.1 (fixed), 0.3 and 0.2 m; home 0.3 rad for both; cable exit off the plane
        let (one, two) = (0.3 + out[0], 0.3 + out[0] + 0.3 + out[1]);
        let x = 0.1 + 0.3 * one.cos() + 0.2 * two.cos();
        let y = 0.3 * one.sin() + 0.2 * two.sin();
        let want = ((x - 0.05).powi(2) + (y + 0.1).powi(2) + 0.2f64.powi(2)).sqrt();
        let got = recording.cable_m[0].as_ref().expect("links")[row];
        assert!((got - want).abs() < TOLERANCE, "{got} {want}");
    }
}

#[test]
fn one_transmission_follows_its_closed_form() {
    let truth = planar();
    let recording = simulate_transmission(&truth, &quiet(), 1, ROWS, 53).expect("a recording");
    let outputs = recording.output[1].as_ref().expect("a capstan");
    for (theta, output) in recording.joint[1].iter().zip(outputs) {
        let want = theta + capstan_error(&truth, 1, *theta);
        assert!((output - want).abs() < TOLERANCE, "{output} {want}");
        // the deviations of this device are milliradians: a sign would be seen
        assert!((output - theta).abs() > 1e-6);
    }
}
