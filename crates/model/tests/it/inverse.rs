//! Readings by a pose: reached, least change, within limits.

use haptical_model::kinematics::nalgebra::{Matrix6, Vector6};
use haptical_model::{Device, Evaluation, InversePose, Wanted};

use haptical_testkit::haptic7;

fn near(case: usize) -> Vec<f64> {
    let share = |joint: usize| (0.618_034 * (7 * case + joint + 1) as f64).fract() - 0.5;
    (0..7).map(|joint| 0.8 * share(joint)).collect()
}

/// The pose at readings, moved a little.
fn moved(device: &Device, readings: &[f64]) -> Wanted {
    let mut evaluation = Evaluation::new(device);
    evaluation.move_to(readings).unwrap();
    let pose = evaluation.pose().unwrap();
    let turn = haptical_model::rigid::about_z(0.02);
    Wanted {
        position_m: pose.position_m.add_scalar(0.004),
        rotation: Some(turn * pose.rotation),
    }
}

/// Of the postures with a pose the found one is next to the given one: the way back to that is a combination of the pose's
/// derivatives, so that no motion which keeps the pose shortens it.
#[test]
fn of_all_postures_with_the_pose_the_nearest_is_found() {
    let device = haptic7();
    let mut solver = InversePose::new(&device);
    for case in 0..20 {
        let near = near(case);
        let found = solver.solve(&moved(&device, &near), &near, &near).unwrap();
        assert!(
            found.rest_m < 1e-10 && found.rest_rad < 1e-9,
            "{case}: {found:?}"
        );
        let mut evaluation = Evaluation::new(&device);
        evaluation.move_to(&found.readings).unwrap();
        let columns: Vec<Vector6<f64>> = (0..7)
            .map(|joint| {
                let twist = evaluation.reading_twist(joint);
                let [x, y, z]: [f64; 3] = twist.linear.into();
                let [u, v, w]: [f64; 3] = twist.angular.into();
                Vector6::new(x, y, z, u, v, w)
            })
            .collect();
        let way: Vec<f64> = near
            .iter()
            .zip(&found.readings)
            .map(|(a, b)| a - b)
            .collect();
        let gram: Matrix6<f64> = columns.iter().map(|own| own * own.transpose()).sum();
        let seen: Vector6<f64> = columns
            .iter()
            .zip(&way)
            .map(|(own, part)| own * *part)
            .sum();
        let along = gram.cholesky().unwrap().solve(&seen);
        let size = way.iter().map(|part| part * part).sum::<f64>().sqrt();
        for (column, part) in columns.iter().zip(&way) {
            let left = (part - column.dot(&along)).abs();
            assert!(left < 1e-6 * size, "{case}: {left:e} of {size:e}");
        }
    }
}

#[test]
fn readings_stay_within_the_limits() {
    let mut device = haptic7();
    let near = near(3);
    let wanted = moved(&device, &near);
    let free = InversePose::new(&device)
        .solve(&wanted, &near, &near)
        .unwrap();
    // a limit between the start and where the joint would go
    for joint in 0..7 {
        let limit = 0.5 * (near[joint] + free.readings[joint]);
        let own = &mut device.joints[joint];
        let before = (own.lower_rad, own.upper_rad);
        match free.readings[joint] > near[joint] {
            true => own.upper_rad = limit,
            false => own.lower_rad = limit,
        }
        let (lower, upper) = (own.lower_rad, own.upper_rad);
        let found = InversePose::new(&device)
            .solve(&wanted, &near, &near)
            .unwrap();
        // the elbow alone makes the distance between shoulder and wrist; every other joint has a substitute
        let is_reached = found.rest_m < 1e-9 && found.rest_rad < 1e-8;
        assert_eq!(is_reached, joint != 3, "joint {joint}: {found:?}");
        assert!((lower..=upper).contains(&found.readings[joint]));
        assert_ne!(found.readings, free.readings);
        let own = &mut device.joints[joint];
        (own.lower_rad, own.upper_rad) = before;
    }
}

#[test]
fn what_is_out_of_reach_leaves_its_rest() {
    let device = haptic7();
    let near = near(1);
    let mut wanted = moved(&device, &near);
    wanted.position_m.x += 10.0;
    wanted.rotation = None;
    let found = InversePose::new(&device)
        .solve(&wanted, &near, &near)
        .unwrap();
    let mut evaluation = Evaluation::new(&device);
    evaluation.move_to(&found.readings).unwrap();
    let rest = (wanted.position_m - evaluation.pose().unwrap().position_m).norm();
    assert!(
        (rest - found.rest_m).abs() < 1e-12 && rest > 9.0 && rest < 10.5,
        "{rest}"
    );
    assert_eq!(found.rest_rad, 0.0);
}
