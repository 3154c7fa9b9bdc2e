//! The course of a search: rejected trials, reasons for stopping, no false success.

use std::cell::Cell;

use haptical_identification::{
    Convergence, IdentificationError, Interrupt, Method, Settings, Status, solve,
};
use proptest::prelude::*;

use crate::support::{Closure, Evaluation, decay, judge};

const METHODS: [Method; 2] = [Method::GaussNewton, Method::LevenbergMarquardt];

fn settings(method: Method) -> Settings {
    Settings {
        method,
        ..Settings::default()
    }
}

/// A trial where the model has no value, or says NaN, is rejected and a shorter step taken.
#[test]
fn trials_without_a_value_are_rejected() {
    // sqrt(p) = 1 from p = 100: the full step leads to p = -80.
    let square_root = |refuse: bool| Closure {
        parameters: 1,
        rows: 2,
        evaluate: move |p: &[f64]| {
            if refuse && p[0] < 0.0 {
                let reason = "negative".into();
                return Err(IdentificationError::Evaluation { reason });
            }
            let root = p[0].sqrt();
            Ok((vec![root - 1.0; 2], vec![vec![0.5 / root]; 2]))
        },
    };
    for method in METHODS {
        for refuse in [false, true] {
            let fit = solve(&square_root(refuse), &[100.0], &[0], &settings(method)).unwrap();
            assert!(
                fit.convergence.was_successful(),
                "{method:?} {:?}",
                fit.convergence
            );
            assert!((fit.parameters[0] - 1.0).abs() < 1e-7);
            assert!(fit.evaluations > fit.iterations);
        }
    }
}

/// A value without a derivative is an error that names row and parameter, not a number.
#[test]
fn where_derivatives_are_lost_the_search_does_not_go() {
    let broken = Closure {
        parameters: 2,
        rows: 2,
        evaluate: |p: &[f64]| {
            let slope = if p[1] < 5.0 { 1.0 } else { f64::NAN };
            Ok((vec![p[1] - 8.0; 2], vec![vec![0.0, slope]; 2]))
        },
    };
    for method in METHODS {
        let fit = solve(&broken, &[0.0, 1.0], &[1], &settings(method)).unwrap();
        assert!(!fit.convergence.was_successful(), "{method:?}");
        assert!(fit.parameters[1] > 4.0 && fit.parameters[1] < 5.0);
        assert!(fit.cost.is_finite());
    }
}

/// f = p0 x + p1 (x + s z), s = max(0, 1 - p0): beyond p0 = 1 both act alike.
fn merging() -> Closure<impl Fn(&[f64]) -> Result<Evaluation, IdentificationError>> {
    Closure {
        parameters: 2,
        rows: 6,
        evaluate: |p: &[f64]| {
            let (s, fall) = if p[0] < 1.0 {
                (1.0 - p[0], 1.0)
            } else {
                (0.0, 0.0)
            };
            Ok((0..6)
                .map(|row| {
                    let (x, z) = (1.0 + f64::from(row), f64::from(row % 2) - 0.5);
                    let slopes = vec![x - fall * p[1] * z, x + s * z];
                    (p[0] * x + p[1] * (x + s * z) - 3.0 * x, slopes)
                })
                .unzip())
        },
    }
}

#[test]
fn rank_lost_on_the_way_is_reported() {
    for method in METHODS {
        let fit = solve(&merging(), &[0.0, 0.0], &[0, 1], &settings(method)).unwrap();
        assert_eq!(fit.convergence, Convergence::RankLost, "{method:?}");
        assert!(!fit.convergence.was_successful());
        assert!(fit.iterations > 0);
    }
}

#[test]
fn rank_short_from_the_start_is_reported() {
    // Only the sum of the parameters matters.
    let sum = Closure {
        parameters: 2,
        rows: 3,
        evaluate: |p: &[f64]| {
            let values = (0..3).map(|row| p[0] + p[1] - f64::from(row)).collect();
            Ok((values, vec![vec![1.0, 1.0]; 3]))
        },
    };
    for method in METHODS {
        let fit = solve(&sum, &[0.0, 0.5], &[0, 1], &settings(method)).unwrap();
        assert_eq!(fit.convergence, Convergence::RankLost, "{method:?}");
        let fit = solve(&sum, &[0.0, 0.5], &[1], &settings(method)).unwrap();
        assert!(fit.convergence.was_successful());
        assert_eq!(fit.parameters[0], 0.0);
        assert!((fit.parameters[1] - 1.0).abs() < 1e-12);
    }
}

/// The analysis of the reduction that a fit returns names the culprit.
#[test]
fn a_fit_can_be_judged_afterwards() {
    let t: Vec<f64> = (0..12).map(f64::from).collect();
    let y: Vec<f64> = t.iter().map(|t| 2.0 * (-0.3 * t).exp() + 1.0).collect();
    let fit = solve(
        &decay(&t, &y, 0.01),
        &[1.0, 0.2, 0.0],
        &[0, 1, 2],
        &settings(METHODS[1]),
    );
    let fit = fit.unwrap();
    let (matrix, _) = haptical_identification::evaluate_jacobian(
        &decay(&t, &y, 0.01),
        &fit.parameters,
        &[0, 1, 2],
    )
    .unwrap();
    let judged = judge(&matrix, &[1.0; 3], &[0, 1, 2]);
    assert!(judged.statuses.iter().all(Status::is_independent));
    assert_eq!(fit.reduction.columns(), 3);
}

#[test]
fn exact_data_are_fitted_exactly_from_near_and_far() {
    let t: Vec<f64> = (0..20).map(|k| 0.25 * f64::from(k)).collect();
    let truth = [2.0, 0.8, -0.5];
    let y: Vec<f64> = t
        .iter()
        .map(|t| truth[0] * (-truth[1] * t).exp() + truth[2])
        .collect();
    for method in METHODS {
        for start in [truth, [2.0 + 1e-9, 0.8, -0.5], [1.0, 0.3, 0.0]] {
            let fit = solve(&decay(&t, &y, 1e-3), &start, &[0, 1, 2], &settings(method)).unwrap();
            assert!(
                fit.convergence.was_successful(),
                "{method:?} {start:?} {:?}",
                fit.convergence
            );
            for (value, truth) in fit.parameters.iter().zip(truth) {
                assert!((value - truth).abs() < 1e-11, "{method:?} {start:?}");
            }
        }
    }
}

/// A cost of 1e60 at the start must not make a cost of 1 look like zero.
#[test]
fn a_wild_start_does_not_end_the_search_early() {
    let problem = Closure {
        parameters: 1,
        rows: 2,
        evaluate: |p: &[f64]| {
            let growth = p[0].exp();
            Ok((vec![growth - 1.0, growth - 3.0], vec![vec![growth]; 2]))
        },
    };
    for method in METHODS {
        let fit = solve(&problem, &[70.0], &[0], &settings(method)).unwrap();
        assert!(
            fit.convergence.was_successful(),
            "{method:?} {:?}",
            fit.convergence
        );
        assert!((fit.parameters[0] - 2.0_f64.ln()).abs() < 1e-9);
        assert!((fit.cost - 2.0).abs() < 1e-12);
    }
}

/// Heavy damping makes every step short; that must not pass for convergence.
#[test]
fn a_damped_step_is_no_convergence() {
    let t: Vec<f64> = (0..20).map(|k| 0.25 * f64::from(k)).collect();
    let y: Vec<f64> = t
        .iter()
        .map(|t| 2.0 * (-0.8 * t).exp() + 0.1 * (9.0 * t).sin())
        .collect();
    let reference = solve(
        &decay(&t, &y, 1.0),
        &[1.0, 0.5, 0.0],
        &[0, 1, 2],
        &Settings::default(),
    );
    let reference = reference.unwrap();
    let heavy = Settings {
        initial_damping: 1e8,
        ..Settings::default()
    };
    let fit = solve(&decay(&t, &y, 1.0), &[1.0, 0.5, 0.0], &[0, 1, 2], &heavy).unwrap();
    assert!(fit.convergence.was_successful());
    for (a, b) in fit.parameters.iter().zip(&reference.parameters) {
        assert!((a - b).abs() < 1e-7 * b.abs());
    }
}

#[test]
fn the_iteration_limit_is_reported() {
    let t: Vec<f64> = (0..20).map(|k| 0.25 * f64::from(k)).collect();
    let y: Vec<f64> = t.iter().map(|t| 2.0 * (-0.8 * t).exp()).collect();
    for method in METHODS {
        let short = Settings {
            max_iterations: 1,
            ..settings(method)
        };
        let fit = solve(&decay(&t, &y, 1.0), &[1.0, 0.1, 0.5], &[0, 1, 2], &short).unwrap();
        assert_eq!(fit.convergence, Convergence::IterationLimit);
        // a damped search goes on once more with another memory
        let searches = match method {
            Method::GaussNewton => 1,
            Method::LevenbergMarquardt => 2,
        };
        assert_eq!(fit.iterations, searches);
        assert!(!fit.convergence.was_successful());
    }
}

/// The model asks for the stop while it is evaluated at its second place: the search goes no further.
#[test]
fn a_request_to_stop_ends_the_search_at_its_next_step() {
    let interrupt = Interrupt::default();
    let places = Cell::new(0);
    let cubic = Closure {
        parameters: 1,
        rows: 2,
        evaluate: |p: &[f64]| {
            places.set(places.get() + 1);
            if places.get() == 3 {
                interrupt.request();
            }
            Ok((
                vec![p[0].powi(3) - 1.0; 2],
                vec![vec![3.0 * p[0] * p[0]]; 2],
            ))
        },
    };
    for method in METHODS {
        let heard = Settings {
            interrupt: interrupt.clone(),
            ..settings(method)
        };
        let ended = solve(&cubic, &[9.0], &[0], &heard).map(|_| ());
        assert_eq!(ended, Err(IdentificationError::Interrupted));
        // a step evaluates residuals, then derivatives: the second method begins with the request
        assert!(places.get() <= 5, "{}", places.get());
    }
}

/// A jump in the model: the derivative promises a fall that no step delivers.
#[test]
fn no_descent_is_reported() {
    let wrong_sign = Closure {
        parameters: 1,
        rows: 2,
        evaluate: |p: &[f64]| Ok((vec![p[0] - 1.0; 2], vec![vec![-1.0]; 2])),
    };
    for method in METHODS {
        let fit = solve(&wrong_sign, &[3.0], &[0], &settings(method)).unwrap();
        assert_eq!(fit.convergence, Convergence::NoFurtherDescent);
        assert_eq!(fit.parameters, [3.0]);
    }
}

proptest! {
    #![proptest_config(crate::support::cases(64))]

    /// At a reported minimum the residual is orthogonal to the derivatives, for both methods alike.
    #[test]
    fn both_methods_reach_the_same_minimum(
        noise in prop::collection::vec(-0.05..0.05_f64, 25),
        a in 1.0..3.0_f64, b in 0.4..1.5_f64, c in -1.0..1.0_f64,
    ) {
        let t: Vec<f64> = (0..25).map(|k| 0.2 * f64::from(k)).collect();
        let y: Vec<f64> = t.iter().zip(&noise).map(|(t, n)| a * (-b * t).exp() + c + n).collect();
        let problem = decay(&t, &y, 0.03);
        let fits: Vec<_> = METHODS.iter()
            .map(|&method| solve(&problem, &[2.0, 0.8, 0.0], &[0, 1, 2], &settings(method)).unwrap())
            .collect();
        for fit in &fits {
            prop_assert!(fit.convergence.was_successful());
            let newton = fit.reduction.solve(&[0, 1, 2], 0.0, 1e-12).unwrap();
            prop_assert!(newton.explained_square <= 1e-15 * fit.cost);
            let cost: f64 = fit.residuals.iter().map(|r| r * r).sum();
            prop_assert!((cost - fit.cost).abs() < 1e-12 * cost);
        }
        for (one, other) in fits[0].parameters.iter().zip(&fits[1].parameters) {
            prop_assert!((one - other).abs() < 1e-6);
        }
    }
}

/// `e^(x t)` to readings that no x explains (after Dennis & Schnabel 1983, *Numerical Methods for Unconstrained Optimization*, example
/// 10.2.4): with J'J alone the search contracts by a constant factor a step.
fn unexplained(last: f64) -> Closure<impl Fn(&[f64]) -> Result<Evaluation, IdentificationError>> {
    let readings = [2.0, 4.0, last];
    Closure {
        parameters: 1,
        rows: 3,
        evaluate: move |p: &[f64]| {
            let values = [1.0, 2.0, 3.0].map(|t: f64| (p[0] * t).exp());
            let residuals = values
                .iter()
                .zip(readings)
                .map(|(value, read)| value - read);
            let slopes = values
                .iter()
                .zip([1.0, 2.0, 3.0])
                .map(|(value, t)| value * t);
            Ok((
                residuals.collect(),
                slopes.map(|slope| vec![slope]).collect(),
            ))
        },
    }
}

#[test]
fn large_residuals_take_tens_of_steps() {
    for last in [-2.0, -3.0, -4.0, -6.0] {
        let problem = unexplained(last);
        let fit = solve(&problem, &[1.0], &[0], &Settings::default()).unwrap();
        let x = fit.parameters[0];
        let slope: f64 = [(1.0, 2.0), (2.0, 4.0), (3.0, last)]
            .map(|(t, read): (f64, f64)| t * (x * t).exp() * ((x * t).exp() - read))
            .iter()
            .sum();
        assert!(slope.abs() < 1e-8, "{last}: {slope}");
        assert!(fit.iterations < 30, "{last}: {}", fit.iterations);
        let compared = solve(&problem, &[1.0], &[0], &Settings::default().to_compare()).unwrap();
        assert!(compared.is_coarse && !fit.is_coarse);
        assert!(compared.iterations < fit.iterations, "{last}");
        assert!(compared.cost < 1.01 * fit.cost, "{last}: {}", compared.cost);
    }
}

/// Two columns that are nearly one, and a start close to the minimum: the damping of a far start would hold the weak direction back.
#[test]
fn a_search_that_begins_close_ends_in_two_steps() {
    let turned = |row: usize| (row as f64 * 0.7).sin();
    let readings: Vec<f64> = (0..40).map(|row| (row as f64 * 1.9).cos()).collect();
    let problem = Closure {
        parameters: 2,
        rows: 40,
        evaluate: |p: &[f64]| {
            let slopes = |row: usize| vec![1.0, 1.0 + 1e-3 * turned(row)];
            let made = |row: usize| p[0] * slopes(row)[0] + p[1] * slopes(row)[1];
            let residuals = (0..40).map(|row| made(row) - readings[row]).collect();
            Ok((residuals, (0..40).map(slopes).collect()))
        },
    };
    let there = solve(&problem, &[0.0, 0.0], &[0, 1], &Settings::default()).unwrap();
    // along the weak direction
    let start = [there.parameters[0] + 10.0, there.parameters[1] - 10.0];
    let close = solve(&problem, &start, &[0, 1], &Settings::default()).unwrap();
    assert!(close.iterations <= 2, "{}", close.iterations);
    assert!((close.parameters[0] - there.parameters[0]).abs() < 1e-6);
}
