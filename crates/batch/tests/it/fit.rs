//! The solution is that of the device's own problem, solved row by row.

use haptical_batch::{
    DistanceModel, DistanceProblem, PoseBatch, Sines, Threads, solve_distances,
    solve_distances_warm,
};
use haptical_calibration::{Channel, DeviceProblem, Weights};
use haptical_identification::{Fit, Settings, solve};
use haptical_kinematics::Parameter;
use haptical_model::{Device, Evaluation, ParameterId, Recording};

use crate::support::numbers;

/// Rounding, amplified by the condition number of a fit of 28 parameters.
const SAME: f64 = 1e-9;

/// The device of the fixtures; none, with a printed line, where a packaged crate lacks them.
fn haptic7() -> Option<Device> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../fixtures/devices/haptic7.toml"
    );
    match std::fs::read_to_string(path) {
        Ok(text) => Some(Device::from_toml(&text, "haptic7.toml").unwrap().device),
        Err(error) => {
            println!("skipped: {path}: {error}");
            None
        }
    }
}

/// The paper's 28: without theta0, alpha0, d0 and alpha7.
fn parameters(device: &Device) -> Vec<ParameterId> {
    let fixed = [
        (0, Parameter::Theta),
        (0, Parameter::Alpha),
        (0, Parameter::D),
        (7, Parameter::Alpha),
    ];
    let all = device.link_parameters(false).into_iter();
    all.filter(|id| match id {
        ParameterId::Link { row, parameter } => !fixed.contains(&(*row, *parameter)),
        _ => false,
    })
    .collect()
}

/// A device 5 mm and 5 mrad off at most, and what its cable measures.
fn recording(nominal: &Device, rows: usize) -> Recording {
    let mut number = numbers(11);
    let mut truth = nominal.clone();
    for parameter in parameters(nominal) {
        parameter.set(&mut truth, parameter.value(nominal) + 5e-3 * number());
    }
    let joint: Vec<Vec<f64>> = (0..7)
        .map(|_| (0..rows).map(|_| 1.2 * number()).collect())
        .collect();
    let mut evaluation = Evaluation::new(&truth);
    let cable = (0..rows)
        .map(|row| {
            let readings: Vec<f64> = joint.iter().map(|column| column[row]).collect();
            evaluation.move_to(&readings).unwrap();
            evaluation.pose().unwrap().position_m.norm() + 2e-5 * number()
        })
        .collect();
    Recording {
        line: (2..2 + rows as u64).collect(),
        output: vec![None; 7],
        torque_nm: vec![None; 7],
        cable_m: vec![Some(cable)],
        joint,
        ..Recording::default()
    }
}

struct Both {
    model: DistanceModel,
    poses: PoseBatch,
    by_rows: Fit,
    start: Vec<f64>,
    free: Vec<usize>,
}

fn both(rows: usize, sines: Sines) -> Option<Both> {
    let device = haptic7()?;
    let recording = recording(&device, rows);
    let channel = Channel::Cable { index: 0 };
    let weights = Weights::stated(&device, &[channel]);
    let parameters = parameters(&device);
    let problem =
        DeviceProblem::new(&device, &recording, &[channel], &parameters, &weights).unwrap();
    let free: Vec<usize> = (0..parameters.len()).collect();
    let start = problem.start();
    let by_rows = solve(&problem, &start, &free, &Settings::default()).unwrap();
    // joint variables from home, so that the chain's theta is the device's own
    let joints: Vec<Vec<f64>> = recording
        .joint
        .iter()
        .zip(&device.joints)
        .map(|(readings, joint)| readings.iter().map(|q| q + joint.home_rad).collect())
        .collect();
    let of_rows: Vec<(usize, Parameter)> = parameters
        .iter()
        .filter_map(|id| match id {
            ParameterId::Link { row, parameter } => Some((*row, *parameter)),
            _ => None,
        })
        .collect();
    let motions = device.motions();
    let anchor_m = device.cables[0].anchor_m;
    let model = DistanceModel::new(device.convention, &device.links, &motions, anchor_m)
        .unwrap()
        .with_parameters(&of_rows)
        .unwrap();
    let deviations = weights.residual_sd(&device, &recording, channel).unwrap();
    let weights: Vec<f64> = deviations.iter().map(|sd| 1.0 / sd).collect();
    let distances = recording.cable_m[0].as_ref().unwrap();
    let poses = PoseBatch::new(&motions, &joints, distances, &weights, sines).unwrap();
    Some(Both {
        model,
        poses,
        by_rows,
        start,
        free,
    })
}

fn same(fit: &Fit, other: &Fit) {
    assert!(fit.convergence.was_successful(), "{:?}", fit.convergence);
    assert!(
        other.convergence.was_successful(),
        "{:?}",
        other.convergence
    );
    for (a, b) in fit.parameters.iter().zip(&other.parameters) {
        assert!((a - b).abs() < SAME, "{a} {b}");
    }
    assert!(
        (fit.cost / other.cost - 1.0).abs() < SAME,
        "{} {}",
        fit.cost,
        other.cost
    );
}

#[test]
fn the_solution_is_that_of_the_device_s_problem() {
    for (rows, sines) in [
        (200, Sines::Cached),
        (200, Sines::EachPass),
        (9000, Sines::Cached),
    ] {
        let Some(both) = both(rows, sines) else {
            return;
        };
        let Both {
            model,
            poses,
            by_rows,
            start,
            free,
        } = &both;
        let settings = Settings::default();
        let fit = solve_distances(model, poses, start, free, &settings, Threads::One).unwrap();
        same(&fit, by_rows);
        // the way is the same too, in fewer evaluations
        assert!(fit.iterations.abs_diff(by_rows.iterations) <= 1);
        assert!(fit.evaluations <= fit.iterations + 3, "{}", fit.evaluations);
        // and so is the covariance
        let columns: Vec<usize> = (0..free.len()).collect();
        let ours = fit.reduction.covariance(&columns, 1e-13).unwrap();
        let theirs = by_rows.reduction.covariance(&columns, 1e-13).unwrap();
        for index in columns {
            let ratio = ours[(index, index)] / theirs[(index, index)];
            assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");
        }
        // row by row through the same sweeps
        let by_sweeps = DistanceProblem::new(model, poses).unwrap();
        same(&solve(&by_sweeps, start, free, &settings).unwrap(), by_rows);
    }
}

#[test]
fn a_warm_start_changes_the_way_not_the_end() {
    let Some(both) = both(20_000, Sines::Cached) else {
        return;
    };
    let Both {
        model,
        poses,
        by_rows,
        start,
        free,
    } = &both;
    let settings = Settings::default();
    let warm = solve_distances_warm(model, poses, start, free, &settings, Threads::One, 4).unwrap();
    same(&warm.fit, by_rows);
    let subset = warm.subset.unwrap();
    assert!(subset.cost < 0.5 * warm.fit.cost);
    assert!(warm.fit.iterations < by_rows.iterations);
    // a subset that is everything is no subset
    let warm = solve_distances_warm(model, poses, start, free, &settings, Threads::One, 1).unwrap();
    assert!(warm.subset.is_none());
    same(&warm.fit, by_rows);
}

#[test]
fn a_dependent_parameter_leaves_the_rank_to_the_pivots() {
    let Some(both) = both(300, Sines::Cached) else {
        return;
    };
    let Both { model, poses, .. } = both;
    // d0 moves the anchor along with a0, theta1 and d1 in the frame of the first joint: four for three
    let mut parameters = model.parameters().to_vec();
    parameters.push((0, Parameter::D));
    let model = model.with_parameters(&parameters).unwrap();
    let free: Vec<usize> = (0..parameters.len()).collect();
    let start = model.start();
    let settings = Settings::default();
    let fit = solve_distances(&model, &poses, &start, &free, &settings, Threads::One).unwrap();
    let by_rows = DistanceProblem::new(&model, &poses).unwrap();
    let by_rows = solve(&by_rows, &start, &free, &settings).unwrap();
    assert_eq!(
        fit.convergence,
        haptical_identification::Convergence::RankLost
    );
    assert_eq!(by_rows.convergence, fit.convergence);
    assert!((fit.cost / by_rows.cost - 1.0).abs() < SAME);
}
