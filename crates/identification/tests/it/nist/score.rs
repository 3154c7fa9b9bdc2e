//! Scores the solver in certified digits, with its default settings.

use std::path::PathBuf;

use haptical_identification::{
    Convergence, DerivativeMismatch, Method, Settings, solve, worst_derivative,
};

use super::relative::Relative;
use super::set::digits::{Score, worst};
use super::set::{Certified, read_all};

/// From the near start (2) every parameter must agree to this many digits.
const DIGITS_NEAR: f64 = 7.5;
/// Standard deviations lose up to one digit against the parameters.
const DEVIATION_DIGITS_NEAR: f64 = 6.0;
/// The residual sum of squares is flat at the minimum, so its digits exceed the parameters'.
const COST_DIGITS_NEAR: f64 = 9.5;
/// From the far start (1).
const DIGITS_FAR: f64 = 4.0;
const SOLVED_FAR: usize = 24;

/// Lanczos1 is an exact fit but for the 14th digit of its data: residuals of 1e-13 are differences of
/// numbers near 2, which doubles hold to 2e-16. Three digits of each residual remain, and so of the
/// sum of their squares (certified 1.43e-25) and of the standard deviations that come from it.
const LANCZOS1_DIGITS: f64 = 2.0;

/// Problems that resist from the far start with default settings, with their digits then. MGH10:
/// b1 exp(b2/(x + b3)) starts with b3 72 times too large, where the three parameters act almost alike;
/// the search follows a curved valley along which b1 falls to 1e-47 before it turns. The limit of 1000
/// iterations stops it there, reported as not converged; `PATIENCE` iterations reach the minimum (it
/// takes about 5700).
const RESIST_FAR: [(&str, f64); 1] = [("MGH10", 0.0)];
const PATIENCE: usize = 20_000;

/// All problems, or none (with a line on standard error) where the fixtures were not shipped.
fn all() -> Option<Vec<Certified>> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/nist");
    if !folder.is_dir() {
        eprintln!("skip: fixtures/nist is absent");
        return None;
    }
    Some(read_all(&folder).unwrap())
}

fn run_all(problems: &[Certified], start: usize, method: Method) -> Vec<Score> {
    let settings = Settings {
        method,
        ..Settings::default()
    };
    println!(
        "{method:?}, start {}: certified digits of parameters, standard deviations, residual sum \
         of squares; iterations; evaluations",
        start + 1
    );
    let scores: Vec<Score> = problems
        .iter()
        .map(|problem| Score::new(problem, start, &settings).unwrap())
        .collect();
    for score in &scores {
        println!(
            "{:10} {:5.1} {:5.1} {:5.1} {:5} {:5}  {}",
            score.name,
            score.parameters,
            score.standard_deviations,
            score.cost,
            score.fit.iterations,
            score.fit.evaluations,
            score.fit.convergence
        );
    }
    scores
}

#[test]
fn near_start_reaches_the_certified_values() {
    let Some(problems) = all() else { return };
    for score in run_all(&problems, 1, Method::LevenbergMarquardt) {
        let (deviation_digits, cost_digits) = match score.name {
            "Lanczos1" => (LANCZOS1_DIGITS, LANCZOS1_DIGITS),
            _ => (DEVIATION_DIGITS_NEAR, COST_DIGITS_NEAR),
        };
        let name = score.name;
        assert!(score.fit.convergence.was_successful(), "{name}");
        assert!(score.parameters >= DIGITS_NEAR, "{name}");
        assert!(score.standard_deviations >= deviation_digits, "{name}");
        assert!(score.cost >= cost_digits, "{name}");
    }
}

#[test]
fn far_start_reaches_the_certified_values_but_for_the_stated_exceptions() {
    let Some(problems) = all() else { return };
    let scores = run_all(&problems, 0, Method::LevenbergMarquardt);
    let solved = scores
        .iter()
        .filter(|score| score.parameters >= DIGITS_FAR)
        .count();
    println!("solved {solved} of {}", scores.len());
    assert!(solved >= SOLVED_FAR);
    for score in &scores {
        let resists = RESIST_FAR.iter().find(|(name, _)| *name == score.name);
        match resists {
            // The table above is a claim too: it must be corrected once the solver does better.
            Some((name, digits)) => {
                assert!((score.parameters - digits).abs() < 0.5, "{name}");
                assert_eq!(score.fit.convergence, Convergence::IterationLimit, "{name}");
            }
            None => {
                assert!(score.parameters >= DIGITS_FAR, "{}", score.name);
                assert!(score.fit.convergence.was_successful(), "{}", score.name);
            }
        }
    }
}

#[test]
fn those_that_resist_are_solved_with_more_iterations() {
    let Some(problems) = all() else { return };
    for problem in &problems {
        if RESIST_FAR.iter().any(|(name, _)| *name == problem.name) {
            let free: Vec<usize> = (0..problem.parameters.len()).collect();
            let patient = Settings {
                max_iterations: PATIENCE,
                ..Settings::default()
            };
            let fit = solve(problem, &problem.starts[0], &free, &patient).unwrap();
            println!("{}: {} iterations", problem.name, fit.iterations);
            assert!(fit.convergence.was_successful(), "{}", problem.name);
            assert!(worst(&fit.parameters, &problem.parameters) >= DIGITS_NEAR);
        }
    }
}

/// The bars that the project states of itself (docs/evidence.md).
#[test]
fn eight_digits_are_reached() {
    const DIGITS: f64 = 8.0;
    const DEVIATION_DIGITS: f64 = 6.0;
    let Some(problems) = all() else { return };
    for (start, at_least) in [(0, 24), (1, 25)] {
        let scores = run_all(&problems, start, Method::LevenbergMarquardt);
        let reached = scores.iter().filter(|score| score.has_digits(DIGITS));
        assert!(reached.count() >= at_least, "start {}", start + 1);
        for score in &scores {
            assert!(!score.is_false_claim(), "{}", score.name);
            let exempt = score.name == "Lanczos1" || !score.fit.convergence.was_successful();
            let digits = score.standard_deviations;
            assert!(exempt || digits >= DEVIATION_DIGITS, "{}", score.name);
        }
    }
}

#[test]
fn gauss_newton_is_right_wherever_it_says_converged() {
    let Some(problems) = all() else { return };
    for (start, at_least) in [(0, 20), (1, 27)] {
        let scores = run_all(&problems, start, Method::GaussNewton);
        let converged: Vec<&Score> = scores
            .iter()
            .filter(|score| score.fit.convergence.was_successful())
            .collect();
        assert!(converged.len() >= at_least, "start {}", start + 1);
        for score in converged {
            assert!(score.parameters >= DIGITS_NEAR, "{}", score.name);
        }
    }
}

#[test]
fn derivatives_of_the_models_agree_with_central_differences() {
    /// Truncation is step^2 times the curvature in relative parameters (up to 1e3 for the cycles of
    /// ENSO and the exponent of MGH10), rounding 1e-16 / step times |model| / |slope|.
    const STEP: f64 = 1e-6;
    const DERIVATIVE_TOLERANCE: f64 = 1e-6;
    let Some(problems) = all() else { return };
    for problem in &problems {
        for point in [&problem.starts[1], &problem.parameters] {
            let relative = Relative::new(problem, point);
            let ones = vec![1.0; point.len()];
            let worst: DerivativeMismatch = worst_derivative(&relative, &ones, STEP).unwrap();
            println!("{:10} {:.1e}", problem.name, worst.relative);
            assert!(
                worst.relative < DERIVATIVE_TOLERANCE,
                "{}: {worst:?}",
                problem.name
            );
        }
    }
}
