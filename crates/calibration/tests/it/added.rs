//! What effects add to readings: residuals, derivatives, and the fit of an effect beside a transmission.

use haptical_calibration::{Channel, DeviceProblem, Weights};
use haptical_identification::{Matrix, Problem};
use haptical_model::{
    AddedBy, AddedReadings, Device, DeviceEffect, FitNumber, ParameterId, Recording,
};

const ROWS: usize = 9;

fn reading(row: usize) -> f64 {
    (0.7 * row as f64).sin()
}

/// A joint whose encoder shows 2 mrad times a square wave besides its reading, of which the device has `value`.
fn case(value: f64) -> (Device, Recording) {
    let text = "[[joint]]\nexternal_encoder_sd_rad = 1e-4\n";
    let mut device = Device::from_toml(text, "one.toml").unwrap().device;
    device.effects.push(DeviceEffect {
        name: "backlash".to_owned(),
        joint: Some(0),
        fit: true,
        fitted: vec![FitNumber {
            name: "backlash@1.half_width_rad".to_owned(),
            unit: "rad",
            value,
            plausible_size: 1e-2,
            is_drift: false,
        }],
        ..DeviceEffect::default()
    });
    let wave = |row: usize| if row.is_multiple_of(3) { 1.0 } else { -1.0 };
    let recording = Recording {
        line: (2..2 + ROWS as u64).collect(),
        joint: vec![(0..ROWS).map(reading).collect()],
        output: vec![Some(
            (0..ROWS)
                .map(|row| reading(row) + 2e-3 * wave(row))
                .collect(),
        )],
        torque_nm: vec![None],
        added: vec![AddedReadings {
            effect: 0,
            channel: "out1".to_owned(),
            axis: 0,
            by: AddedBy::default(),
            readings: (0..ROWS).map(|row| 1e-3 * wave(row)).collect(),
            at: vec![1e-3],
            slopes: vec![(0..ROWS).map(wave).collect()],
        }],
        ..Recording::default()
    };
    (device, recording)
}

const EFFECT: ParameterId = ParameterId::Effect {
    effect: 0,
    number: 0,
};

fn residuals(value: f64, of: &[usize]) -> (Vec<f64>, Matrix) {
    let (device, recording) = case(value);
    let recording = recording.select(of);
    let channels = [Channel::Output { joint: 0 }];
    let weights = Weights::stated(&device, &channels);
    let parameters = [EFFECT];
    let problem = DeviceProblem::new(&device, &recording, &channels, &parameters, &weights);
    let problem = problem.unwrap();
    let mut residuals = vec![0.0; problem.residual_count()];
    let mut matrix = Matrix::zeros(residuals.len(), 1);
    let start = problem.start();
    problem
        .evaluate(&start, &mut residuals, Some((&[0], &mut matrix)))
        .unwrap();
    (residuals, matrix)
}

#[test]
fn an_effect_of_the_right_size_leaves_nothing_and_one_of_none_all() {
    let all: Vec<usize> = (0..ROWS).collect();
    assert!(residuals(2e-3, &all).0.iter().all(|rest| rest.abs() < 1e-9));
    // model minus measurement, in standard deviations: the square wave turned round
    let (without, _) = residuals(0.0, &all);
    assert!((without[0] + 20.0).abs() < 1e-9 && (without[1] - 20.0).abs() < 1e-9);
    // half of it, whichever rows are looked at
    let (half, _) = residuals(1e-3, &[4, 3]);
    assert!((half[0] - 10.0).abs() < 1e-9 && (half[1] + 10.0).abs() < 1e-9);
}

#[test]
fn derivatives_are_those_of_the_residuals() {
    let all: Vec<usize> = (0..ROWS).collect();
    let (low, slope) = residuals(1.0e-3, &all);
    let (high, _) = residuals(1.5e-3, &all);
    for row in 0..ROWS {
        let difference = (high[row] - low[row]) / 0.5e-3;
        assert!((difference - slope[(row, 0)]).abs() < 1e-6, "{row}");
        assert!(difference.abs() > 1e3);
    }
}
