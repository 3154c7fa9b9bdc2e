//! Residuals and derivatives against the chain's own, and against differences.

use haptical_kinematics::{Chain, LinkDerivatives, Parameter, distance_derivative};
use proptest::prelude::*;

use crate::support::{Case, all_rows, case, cases, random_case};

/// Of numbers of size 1: eight turns and slides, each with a few roundings.
const ROUNDING: f64 = 1e-14;
const STEP: f64 = 1e-4;

/// Error of the five-point difference of a distance (Abramowitz & Stegun 25.3.6: the fourth power of the
/// step over 30 times the fifth derivative). A point that turns at `REACH_M` passes the anchor at
/// `distance_m`, and the fifth derivative of such a distance is at most 45 REACH_M^5 / distance_m^4. The
/// first term is rounding: a few 1e-15 over the step.
fn difference_error(distance_m: f64) -> f64 {
    const REACH_M: f64 = 4.0;
    3e-10 + 1.5 * STEP.powi(4) * REACH_M.powi(5) / distance_m.powi(4)
}

/// What the chain says: derivative of the distance of a pose, by row and parameter.
fn by_the_chain(case: &Case, pose: usize) -> Vec<[f64; 6]> {
    let chain = Chain::new(case.convention, &case.links, &case.motions).unwrap();
    let mut out = vec![LinkDerivatives::default(); case.links.len()];
    let end = chain.derivatives(&case.variables(pose), &mut out).unwrap();
    out.iter()
        .map(|row| {
            Parameter::ALL.map(|parameter| {
                distance_derivative(&end, &case.anchor_m.into(), &row.get(parameter)).unwrap()
            })
        })
        .collect()
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn residuals_and_derivatives_are_the_chain_s(case in case(1..300)) {
        let (model, poses) = (case.full_model(), case.batch());
        // every other parameter, backwards, so that columns and parameters do not agree by chance
        let free: Vec<usize> = (0..model.parameters().len()).rev().step_by(2).collect();
        let (residuals, jacobian) = all_rows(&poses, &model, &model.start(), &free);
        for pose in 0..case.poses() {
            let weight = case.weights[pose];
            let expected = case.distance(&case.links, pose) - case.distances_m[pose];
            prop_assert!((residuals[pose] / weight - expected).abs() < ROUNDING);
            let derivatives = by_the_chain(&case, pose);
            for (column, &index) in free.iter().enumerate() {
                let (row, parameter) = model.parameters()[index];
                let expected = derivatives[row][parameter as usize];
                let found = jacobian[(pose, column)] / weight;
                prop_assert!((found - expected).abs() < ROUNDING, "{row} {parameter}: {found} {expected}");
            }
        }
    }

    #[test]
    fn derivatives_are_differences(case in case(3..40)) {
        let (model, poses) = (case.full_model(), case.batch());
        let free: Vec<usize> = (0..model.parameters().len()).collect();
        let start = model.start();
        let (_, jacobian) = all_rows(&poses, &model, &start, &free);
        for &index in &free {
            let at = [-2.0, -1.0, 1.0, 2.0].map(|steps| {
                let mut there = start.clone();
                there[index] += steps * STEP;
                all_rows(&poses, &model, &there, &[]).0
            });
            for pose in 0..case.poses() {
                let [before_2, before, after, after_2] = at.each_ref().map(|side| side[pose]);
                let difference = (8.0 * (after - before) - (after_2 - before_2)) / (12.0 * STEP);
                let error = (difference - jacobian[(pose, index)]) / case.weights[pose];
                let allowed = difference_error(case.distance(&case.links, pose));
                prop_assert!(error.abs() < allowed, "{index}: {error:e}, {allowed:e} allowed");
            }
        }
    }
}

#[test]
fn angles_beyond_the_lanes_are_served_by_libm() {
    let motions = [haptical_kinematics::Motion::Revolute; 3];
    let mut case = random_case(haptical_kinematics::Convention::Standard, &motions, 20, 5);
    case.joints[1][7] = 3.0e7;
    case.distances_m[7] = case.distance(&case.links, 7);
    let (model, poses) = (case.model(), case.batch());
    let (residuals, _) = all_rows(&poses, &model, &model.start(), &[]);
    // the sum 3e7 + theta is rounded at 4e-9
    assert!(
        residuals[7].abs() / case.weights[7] < 1e-8,
        "{}",
        residuals[7]
    );
}
