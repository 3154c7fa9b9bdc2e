//! A stream gives the bits of a batch that works its sines out in every pass, and holds nothing.

use haptical_batch::{BatchError, PoseRow, ReducedDistance, Sines, StreamedDistance, Threads};
use haptical_identification::{IdentificationError, Matrix, Problem, Settings, solve};
use haptical_kinematics::Motion;
use proptest::prelude::*;

use crate::support::{Case, case, cases, random_case};

type Each<'e> = &'e mut dyn FnMut(PoseRow<'_>) -> Result<(), BatchError>;

fn source(case: &Case) -> impl Fn(Each<'_>) -> Result<(), BatchError> {
    move |each| {
        for pose in 0..case.poses() {
            each(PoseRow {
                joints: &case.variables(pose),
                distance_m: case.distances_m[pose],
                weight: case.weights[pose],
            })?;
        }
        Ok(())
    }
}

fn evaluated(problem: &impl Problem, at: &[f64], free: &[usize]) -> (Vec<f64>, Matrix) {
    let mut residuals = vec![0.0; problem.residual_count()];
    let mut jacobian = Matrix::zeros(problem.residual_count(), free.len());
    problem
        .evaluate(at, &mut residuals, Some((free, &mut jacobian)))
        .unwrap();
    (residuals, jacobian)
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn the_bits_are_those_of_a_batch(case in case(1..9000)) {
        let (model, poses) = (case.model(), case.batch(Sines::EachPass));
        let free: Vec<usize> = (0..model.start().len()).collect();
        let batch = ReducedDistance::new(&model, &poses, Threads::One).unwrap();
        let stream = StreamedDistance::new(&model, source(&case));
        prop_assert!(evaluated(&batch, &model.start(), &free) == evaluated(&stream, &model.start(), &free));
    }
}

#[test]
fn a_stream_is_solved() {
    let motions = [Motion::Fixed, Motion::Revolute, Motion::Revolute];
    let case = random_case(haptical_kinematics::Convention::Modified, &motions, 500, 8);
    let (model, poses) = (case.model(), case.batch(Sines::EachPass));
    let free = [4, 5, 8];
    let settings = Settings::default();
    let batch = ReducedDistance::new(&model, &poses, Threads::One).unwrap();
    let stream = StreamedDistance::new(&model, source(&case));
    let of_batch = solve(&batch, &model.start(), &free, &settings).unwrap();
    let of_stream = solve(&stream, &model.start(), &free, &settings).unwrap();
    assert_eq!(of_batch.parameters, of_stream.parameters);
    assert!(of_batch.convergence.was_successful());
}

#[test]
fn what_a_stream_refuses() {
    let motions = [Motion::Revolute; 2];
    let case = random_case(haptical_kinematics::Convention::Standard, &motions, 1, 8);
    let model = case.model();
    let said = |row: PoseRow<'_>| {
        let stream = StreamedDistance::new(&model, |each: Each<'_>| {
            let good = PoseRow {
                joints: &[0.1, 0.2],
                distance_m: 1.0,
                weight: 1.0,
            };
            (0..200).try_for_each(|_| each(good))?;
            each(row)
        });
        let mut residuals = vec![0.0; 9];
        match stream
            .evaluate(&model.start(), &mut residuals, None)
            .unwrap_err()
        {
            IdentificationError::Evaluation { reason } => reason,
            other => panic!("{other}"),
        }
    };
    let row = |joints, distance_m, weight| PoseRow {
        joints,
        distance_m,
        weight,
    };
    assert!(said(row(&[0.1], 1.0, 1.0)).contains("1 entries; 2 are needed"));
    assert!(said(row(&[0.1, f64::NAN], 1.0, 1.0)).contains("joint variable of pose 200 is NaN"));
    assert!(said(row(&[0.1, 0.2], f64::INFINITY, 1.0)).contains("distance of pose 200 is inf"));
    assert!(said(row(&[0.1, 0.2], 1.0, -1.0)).contains("weight of pose 200 is -1"));
    let empty = StreamedDistance::new(&model, |_: Each<'_>| Ok(()));
    let refused = empty
        .evaluate(&model.start(), &mut [0.0; 9], None)
        .unwrap_err();
    assert!(refused.to_string().contains("no pose"), "{refused}");
}
