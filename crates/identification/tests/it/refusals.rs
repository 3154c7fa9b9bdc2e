//! Questions without an answer.

use haptical_identification::{IdentificationError, Method, Settings, solve};

use crate::support::{Closure, decay};

#[test]
fn fewer_measurements_than_parameters() {
    let problem = decay(&[0.0, 1.0], &[1.0, 0.5], 1.0);
    let refused = solve(&problem, &[1.0; 3], &[0, 1, 2], &Settings::default());
    assert!(matches!(
        refused,
        Err(IdentificationError::TooFewRows {
            rows: 2,
            parameters: 3
        })
    ));
    assert!(solve(&problem, &[1.0, 0.5, 0.0], &[0, 1], &Settings::default()).is_ok());
}

#[test]
fn shapes_and_free_lists() {
    let problem = decay(&[0.0, 1.0, 2.0], &[1.0; 3], 1.0);
    let settings = Settings::default();
    assert!(matches!(
        solve(&problem, &[1.0; 2], &[0], &settings),
        Err(IdentificationError::Shape {
            expected: 3,
            found: 2,
            ..
        })
    ));
    assert!(matches!(
        solve(&problem, &[1.0; 3], &[], &settings),
        Err(IdentificationError::NothingFree)
    ));
    assert!(matches!(
        solve(&problem, &[1.0; 3], &[0, 3], &settings),
        Err(IdentificationError::Shape {
            expected: 3,
            found: 3,
            ..
        })
    ));
    // Twice the same parameter would be two equal columns.
    assert!(matches!(
        solve(&problem, &[1.0; 3], &[1, 1], &settings),
        Err(IdentificationError::Linalg(_))
    ));
    assert!(matches!(
        solve(&problem, &[1.0, f64::NAN, 1.0], &[0], &settings),
        Err(IdentificationError::NotFinite { column: 1, .. })
    ));
}

#[test]
fn settings_have_ranges() {
    let good = Settings::default();
    assert_eq!(good.check(), Ok(()));
    for (name, settings) in [
        (
            "cost_tolerance",
            Settings {
                cost_tolerance: -1.0,
                ..good.clone()
            },
        ),
        (
            "step_tolerance",
            Settings {
                step_tolerance: f64::NAN,
                ..good.clone()
            },
        ),
        (
            "rank_tolerance",
            Settings {
                rank_tolerance: 1.0,
                ..good.clone()
            },
        ),
        (
            "max_iterations",
            Settings {
                max_iterations: 0,
                ..good.clone()
            },
        ),
        (
            "initial_damping",
            Settings {
                initial_damping: 0.0,
                ..good.clone()
            },
        ),
        (
            "initial_damping",
            Settings {
                initial_damping: f64::INFINITY,
                ..good.clone()
            },
        ),
    ] {
        let problem = decay(&[0.0, 1.0, 2.0], &[1.0; 3], 1.0);
        let refused = solve(&problem, &[1.0; 3], &[0], &settings);
        let Err(IdentificationError::Setting { name: found, .. }) = refused else {
            panic!("{refused:?}");
        };
        assert_eq!(found, name);
    }
}

#[test]
fn a_model_without_a_value_at_the_start_is_an_error() {
    for method in [Method::GaussNewton, Method::LevenbergMarquardt] {
        let settings = Settings {
            method,
            ..Settings::default()
        };
        let fails = Closure {
            parameters: 1,
            rows: 1,
            evaluate: |_: &[f64]| {
                Err(IdentificationError::Evaluation {
                    reason: "out of reach".into(),
                })
            },
        };
        assert!(matches!(
            solve(&fails, &[1.0], &[0], &settings),
            Err(IdentificationError::Evaluation { .. })
        ));
        // Residual and derivative that are not finite, named by parameter although only 2 is free.
        for (value, slope, column) in [(f64::NAN, 1.0, 3), (1.0, f64::INFINITY, 2)] {
            let broken = Closure {
                parameters: 3,
                rows: 2,
                evaluate: move |_: &[f64]| {
                    Ok((vec![0.0, value], vec![vec![1.0; 3], vec![1.0, 1.0, slope]]))
                },
            };
            let refused = solve(&broken, &[1.0; 3], &[2], &settings);
            let Err(IdentificationError::NotFinite {
                row: 1,
                column: found,
                ..
            }) = refused
            else {
                panic!("{refused:?}");
            };
            assert_eq!(found, column);
        }
    }
}
