//! The same bits whatever the number of threads.

use haptical_batch::{ReducedDistance, Sines, Threads, solve_distances};
use haptical_identification::Settings;
use haptical_kinematics::{Convention, Motion};

use crate::support::{Case, random_case};

fn seven_joints(poses: usize) -> Case {
    let mut motions = vec![Motion::Revolute; 8];
    motions[0] = Motion::Fixed;
    random_case(Convention::Standard, &motions, poses, 3)
}

fn bits(values: impl IntoIterator<Item = f64>) -> Vec<u64> {
    values.into_iter().map(f64::to_bits).collect()
}

#[test]
fn triangles_are_byte_identical_on_one_two_and_three_threads() {
    // six blocks, the last one short
    let case = seven_joints(5 * 4096 + 777);
    let (model, poses) = (case.model(), case.batch(Sines::Cached));
    let free: Vec<usize> = (1..31).collect();
    let at = |threads: usize, how: Threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let problem = ReducedDistance::new(&model, &poses, how).unwrap();
            problem
                .reduce(&model.start(), &free, |triangle| {
                    let all = (0..30).flat_map(|c| (0..30).map(move |r| (r, c)));
                    let entries = all.map(|(r, c)| triangle.entry(r, c));
                    let rest = triangle.projected().iter().copied();
                    bits(entries.chain(rest).chain([triangle.rest_square()]))
                })
                .unwrap()
        })
    };
    let alone = at(1, Threads::One);
    for threads in 1..=3 {
        assert_eq!(at(threads, Threads::Several), alone, "{threads} threads");
    }
}

#[test]
fn fits_are_byte_identical_on_one_two_and_three_threads() {
    let mut case = seven_joints(9000);
    let (model, start) = (case.model(), case.model().start());
    for link in &mut case.links {
        link.a_m += 2e-3;
        link.alpha_rad -= 1e-3;
    }
    for pose in 0..case.poses() {
        case.distances_m[pose] = case.distance(&case.links, pose);
    }
    let poses = case.batch(Sines::Cached);
    // a and alpha of every row but the last twist, which has no effect
    let free: Vec<usize> = (0..28).filter(|index| index % 4 < 2).collect();
    let at = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let settings = Settings::default();
        let solved = || solve_distances(&model, &poses, &start, &free, &settings, Threads::Several);
        let fit = pool.install(solved).unwrap();
        assert!(fit.convergence.was_successful());
        bits(fit.parameters.into_iter().chain([fit.cost]))
    };
    let alone = at(1);
    assert_eq!(at(2), alone);
    assert_eq!(at(3), alone);
}

#[test]
fn the_first_bad_pose_is_named_whatever_the_threads() {
    let mut case = seven_joints(3 * 4096);
    case.anchor_m = [0.0; 3];
    // a chain without lengths: the handle is at the anchor where the one slide is 0
    let slide = Motion::Prismatic;
    case.motions = vec![slide];
    case.links = vec![haptical_kinematics::Link::default()];
    case.joints = vec![vec![0.3; case.poses()]];
    case.joints[0][9000] = 0.0;
    case.joints[0][5000] = 0.0;
    let (model, poses) = (case.model(), case.batch(Sines::Cached));
    for threads in [1, 2, 3] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let error = pool.install(|| {
            let problem = ReducedDistance::new(&model, &poses, Threads::Several).unwrap();
            problem.reduce(&model.start(), &[0], |_| ()).unwrap_err()
        });
        assert_eq!(
            error,
            haptical_batch::BatchError::ZeroDistance { pose: 5000 }
        );
    }
}
