//! The distribution of joint readings.

use std::f64::consts::FRAC_PI_2;

use haptical_simulator::{Noise, Sampling, Settings, simulate, simulate_transmission, true_poses};

use crate::device::arm;
use crate::statistics::{assert_centred, assert_uncorrelated, assert_uniform, normal_cdf};

const ROWS: usize = 20_000;

/// Standard deviation of the standard normal distribution cut at 3:
/// sqrt(1 - 6 phi(3) / (2 Phi(3) - 1)).
const CUT_SD: f64 = 0.986_578;

fn poses(sampling: Sampling) -> Settings {
    Settings {
        sampling,
        minimum_distance_m: 0.0,
        ..Settings::paper()
    }
}

#[test]
fn normal_readings_are_normal_and_cut_at_three_standard_deviations() {
    let truth = arm();
    let recording = simulate(&truth, &poses(Sampling::Normal), ROWS, 11).expect("a recording");
    // the turret's limits are at 3 sd, the slide's at 2.5 sd
    for (joint, cut) in [(0, 3.0), (1, 3.0), (2, 2.5)] {
        let sd = truth.joints[joint].sampling_sd_rad.expect("given");
        let scaled: Vec<f64> = recording.joint[joint].iter().map(|x| x / sd).collect();
        let largest = scaled.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
        // the last 3 % before the cut are hit with probability 7e-4 or more a draw
        assert!(largest <= cut && largest > 0.97 * cut, "{joint}: {largest}");
        let inside = 1.0 - 2.0 * normal_cdf(-cut);
        let shares: Vec<f64> = scaled
            .iter()
            .map(|z| (normal_cdf(*z) - normal_cdf(-cut)) / inside)
            .collect();
        assert_uniform(&shares, "normal readings");
        if cut == 3.0 {
            assert_centred(&scaled, CUT_SD, "normal readings");
        }
    }
}

#[test]
fn normal_readings_respect_a_limit_on_one_side() {
    let truth = arm();
    let recording = simulate(&truth, &poses(Sampling::Normal), ROWS, 12).expect("a recording");
    // the wrist's limits are -1 sd and 4 sd, so the cuts are -1 sd and 3 sd
    let (low, high) = (normal_cdf(-1.0), normal_cdf(3.0));
    let shares: Vec<f64> = recording.joint[3]
        .iter()
        .map(|x| (normal_cdf(x / 0.3) - low) / (high - low))
        .collect();
    assert_uniform(&shares, "one limit");
}

#[test]
fn uniform_readings_fill_the_share_of_the_limits() {
    let truth = arm();
    for share in [2.0 / 3.0, 1.0, 0.25] {
        let settings = Settings {
            uniform_share: share,
            ..poses(Sampling::Uniform)
        };
        let recording = simulate(&truth, &settings, ROWS, 13).expect("a recording");
        for (joint, (lower, upper)) in [(0, (-FRAC_PI_2, FRAC_PI_2)), (3, (-0.3, 1.2))] {
            let shares: Vec<f64> = recording.joint[joint]
                .iter()
                .map(|x| (x - share * lower) / (share * (upper - lower)))
                .collect();
            assert_uniform(&shares, "uniform readings");
        }
    }
}

#[test]
fn the_default_share_is_two_thirds() {
    assert_eq!(Settings::default(), Settings::paper());
    assert_eq!(Settings::paper().uniform_share, 2.0 / 3.0);
    assert_eq!(Settings::paper().minimum_distance_m, 0.03);
}

#[test]
fn joints_are_drawn_independently() {
    let recording = simulate(&arm(), &poses(Sampling::Normal), ROWS, 14).expect("a recording");
    for a in 0..4 {
        for b in 0..a {
            assert_uncorrelated(&recording.joint[a], &recording.joint[b], "two joints");
        }
    }
    // nor does a row repeat the one before
    let column = &recording.joint[0];
    assert_uncorrelated(&column[1..], &column[..ROWS - 1], "two rows");
}

/// Spheres about the exits of the cables that some poses of the arm enter, but not most.
const MINIMUM_DISTANCE_M: f64 = 0.5;

#[test]
fn poses_near_a_cable_exit_are_drawn_again_and_no_others() {
    let truth = arm();
    let quiet = Settings {
        output_noise: Noise::None,
        cable_noise: Noise::None,
        minimum_distance_m: 0.0,
        ..Settings::paper()
    };
    let all = simulate(&truth, &quiet, 2000, 15).expect("a recording");
    let clear = Settings {
        minimum_distance_m: MINIMUM_DISTANCE_M,
        ..quiet
    };
    let clear = simulate(&truth, &clear, 2000, 15).expect("a recording");
    let poses = true_poses(&truth, &all).expect("poses");
    let anchors = [[0.0; 3], truth.cables[1].anchor_m];
    let mut drawn_again = 0;
    for (row, pose) in poses.iter().enumerate() {
        let near = anchors.iter().any(|anchor| {
            let squares = (0..3).map(|k| (pose.position_m[k] - anchor[k]).powi(2));
            squares.sum::<f64>().sqrt() < MINIMUM_DISTANCE_M
        });
        drawn_again += usize::from(near);
        let same = (0..4).all(|joint| all.joint[joint][row] == clear.joint[joint][row]);
        assert_eq!(same, !near, "row {row}");
        for cable in clear.cable_m.iter().flatten() {
            assert!(
                cable[row] >= MINIMUM_DISTANCE_M,
                "row {row}: {}",
                cable[row]
            );
        }
    }
    assert!((20..1000).contains(&drawn_again), "{drawn_again} rows");
}

#[test]
fn one_transmission_moves_alone() {
    let truth = arm();
    let settings = poses(Sampling::Normal);
    let recording = simulate_transmission(&truth, &settings, 1, ROWS, 16).expect("a recording");
    let scaled: Vec<f64> = recording.joint[1]
        .iter()
        .map(|x| x / 0.261_799_387_799_149_4)
        .collect();
    assert_centred(&scaled, CUT_SD, "one transmission");
    assert!(
        [0, 2, 3]
            .into_iter()
            .all(|joint| recording.joint[joint] == vec![0.0; ROWS])
    );
    let present: Vec<bool> = recording.output.iter().map(Option::is_some).collect();
    assert_eq!(present, [false, true, false, false]);
    assert_eq!(recording.cable_m, [None, None]);
    assert_eq!(recording.output[1].as_ref().map(Vec::len), Some(ROWS));
    assert_eq!(recording.line.len(), ROWS);
}
