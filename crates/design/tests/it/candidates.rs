//! Candidate poses keep every limit, and the same seed gives the same ones.

use haptical_calibration::frame_origins_m;
use haptical_design::{DesignError, Limits, Spread, candidates};
use haptical_model::{Device, DeviceChain, Recording};
use haptical_testkit::haptic7;
use proptest::prelude::*;

use crate::support::arm;

fn handle_m(device: &Device, pose: &[f64]) -> [f64; 3] {
    DeviceChain::new(device)
        .pose(pose)
        .unwrap()
        .position_m
        .into()
}

/// Least distance between points of links that are no neighbours, nor joined by less than two radii, on a grid: above
/// the true one.
fn grid_clearance_m(device: &Device, pose: &[f64], radius_m: f64) -> f64 {
    let recording = Recording {
        line: vec![1],
        joint: pose.iter().map(|reading| vec![*reading]).collect(),
        output: vec![None; pose.len()],
        ..Recording::default()
    };
    let origins = frame_origins_m(device, &recording).unwrap().remove(0);
    let far =
        |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let mut corners: Vec<[f64; 3]> = Vec::new();
    for origin in &origins[1..] {
        if corners.last().is_none_or(|last| far(last, origin) > 1e-6) {
            corners.push(*origin);
        }
    }
    let mut least = f64::INFINITY;
    for i in 0..corners.len() - 1 {
        for j in i + 2..corners.len() - 1 {
            let between = corners[i + 1..=j].windows(2);
            if between.map(|pair| far(&pair[0], &pair[1])).sum::<f64>() < 2.0 * radius_m {
                continue;
            }
            for s in 0..=40 {
                for t in 0..=40 {
                    let at = |from: [f64; 3], to: [f64; 3], share: i32| {
                        let share = f64::from(share) / 40.0;
                        [0, 1, 2].map(|k| from[k] + share * (to[k] - from[k]))
                    };
                    let a = at(corners[i], corners[i + 1], s);
                    least = least.min(far(&a, &at(corners[j], corners[j + 1], t)));
                }
            }
        }
    }
    least
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn poses_respect_every_limit(
        seed in 0..1000_u64,
        normal in any::<bool>(),
        side in 0.25..0.8_f64,
        shortest in 0.05..0.3_f64,
        span in 0.15..0.6_f64,
        radius in 0.0..0.02_f64,
    ) {
        let device = haptic7();
        let limits = Limits {
            spread: if normal { Spread::Normal } else { Spread::Uniform },
            workspace_m: Some([[-side; 3], [side; 3]]),
            cable_m: [shortest, shortest + span],
            link_radius_m: Some(radius),
        };
        let poses = match candidates(&device, &limits, 20, seed) {
            Ok(poses) => poses,
            Err(DesignError::NoCandidates { .. }) => return Ok(()),
            Err(error) => return Err(TestCaseError::fail(error.to_string())),
        };
        prop_assert_eq!(poses.len(), 20);
        for pose in &poses {
            for (reading, joint) in pose.iter().zip(&device.joints) {
                prop_assert!((joint.lower_rad..=joint.upper_rad).contains(reading));
                let sd = joint.sampling_sd_rad.unwrap();
                prop_assert!(!normal || reading.abs() <= 3.0 * sd * (1.0 + 1e-12));
            }
            let handle = handle_m(&device, pose);
            prop_assert!(handle.iter().all(|value| value.abs() <= side));
            let length = handle.iter().map(|value| value * value).sum::<f64>().sqrt();
            prop_assert!(length >= shortest && length <= shortest + span);
            prop_assert!(grid_clearance_m(&device, pose, radius) >= 2.0 * radius);
        }
        prop_assert_eq!(poses, candidates(&device, &limits, 20, seed).unwrap());
    }
}

#[test]
fn normal_poses_have_the_spread_of_the_device_file_and_uniform_ones_that_of_the_limits() {
    let device = haptic7();
    for (spread, factor) in [
        (Spread::Normal, 3.0 / 0.9867),
        (Spread::Uniform, 3.0_f64.sqrt()),
    ] {
        let limits = Limits {
            spread,
            ..Limits::default()
        };
        let poses = candidates(&device, &limits, 4000, 5).unwrap();
        for (joint, described) in device.joints.iter().enumerate() {
            let square = poses.iter().map(|pose| pose[joint].powi(2)).sum::<f64>() / 4000.0;
            let wanted = described.upper_rad / factor;
            // five standard deviations of the variance of 4000 numbers; the cable's length shifts it a little
            assert!(
                (square.sqrt() / wanted - 1.0).abs() < 0.06,
                "{spread:?} {joint}"
            );
        }
    }
}

#[test]
fn a_longer_list_begins_with_the_shorter_one() {
    let device = arm();
    let long = candidates(&device, &Limits::default(), 50, 9).unwrap();
    assert_eq!(
        long[..20],
        candidates(&device, &Limits::default(), 20, 9).unwrap()
    );
    assert_ne!(
        long,
        candidates(&device, &Limits::default(), 50, 10).unwrap()
    );
}
