//! Statuses of planted columns.

use haptical_identification::{IdentifiabilityRules, IdentificationError, Matrix, Status, analyse};

use crate::support::{judge, named, reduce};

/// Rounding of a well-conditioned reduction.
const ROUNDING: f64 = 1e-12;

fn wave(row: usize, k: usize) -> f64 {
    ((row + 1) as f64 * 0.61 * (k + 1) as f64).sin()
}

/// Columns: 0 and 1 good, 2 zero, 3 noise of 1e-17, 4 = 2 column 0 - 0.5 column 1, 5 weak.
fn planted() -> Matrix {
    Matrix::from_fn(40, 6, |row, column| match column {
        0 | 1 => wave(row, column),
        2 => 0.0,
        3 => 1e-17 * wave(row, 9),
        4 => 2.0 * wave(row, 0) - 0.5 * wave(row, 1),
        _ => 1e-3 * wave(row, 5),
    })
}

#[test]
fn every_planted_status_is_found() {
    let matrix = planted();
    let answer = judge(&matrix, &[10.0; 6], &[0, 1, 2, 3, 4, 5]);
    assert_eq!(answer.independent, [0, 1, 5]);
    assert_eq!((answer.rank, answer.singular_rank), (3, 3));
    assert!(answer.is_clear());
    assert_eq!(answer.statuses[2], Status::Invisible);
    assert_eq!(answer.statuses[3], Status::Invisible);
    assert!(matches!(answer.statuses[0], Status::Identifiable { .. }));
    assert!(matches!(answer.statuses[1], Status::Identifiable { .. }));
    let Status::Dependent { combination } = &answer.statuses[4] else {
        panic!("{:?}", answer.statuses[4]);
    };
    let terms: Vec<(usize, &str)> = combination
        .iter()
        .map(|term| (term.parameter, term.name.as_str()))
        .collect();
    assert_eq!(terms, [(0, "p0"), (1, "p1")]);
    assert!((combination[0].coefficient - 2.0).abs() < ROUNDING);
    assert!((combination[1].coefficient + 0.5).abs() < ROUNDING);

    // Column 5 alone would have the standard deviation 1 / norm; the others can only enlarge it.
    let Status::Weak { standard_deviation } = answer.statuses[5] else {
        panic!("{:?}", answer.statuses[5]);
    };
    let norm: f64 = matrix.column(5).iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!(standard_deviation >= 1.0 / norm && standard_deviation < 1.1 / norm);
    assert!(answer.gap[0] > 0.1 && answer.gap[1] < ROUNDING);
    assert!(answer.condition_unit_norm < 10.0);
    assert!(answer.observability.is_some());
}

#[test]
fn weak_is_judged_by_the_plausible_size() {
    // One column of norm 2: standard deviation 0.5, weak where that exceeds half the size.
    let matrix = Matrix::from_fn(4, 1, |_, _| 1.0);
    for (size, weak) in [(0.9, true), (1.1, false)] {
        let answer = judge(&matrix, &[size], &[0]);
        let deviation = match answer.statuses[0] {
            Status::Weak { standard_deviation } if weak => standard_deviation,
            Status::Identifiable { standard_deviation } if !weak => standard_deviation,
            ref other => panic!("{size}: {other:?}"),
        };
        assert!((deviation - 0.5).abs() < ROUNDING);
    }
}

#[test]
fn the_order_of_preference_is_respected() {
    let matrix = planted();
    for (order, dropped) in [
        ([0, 1, 4, 2, 3, 5], 4),
        ([4, 1, 0, 2, 3, 5], 0),
        ([5, 4, 0, 1, 2, 3], 1),
    ] {
        let answer = judge(&matrix, &[10.0; 6], &order);
        let dependent: Vec<usize> = (0..6)
            .filter(|&k| matches!(answer.statuses[k], Status::Dependent { .. }))
            .collect();
        assert_eq!(dependent, [dropped]);
        assert_eq!(answer.rank, 3);
    }
    // column 0 = 0.5 column 4 + 0.25 column 1
    let answer = judge(&matrix, &[10.0; 6], &[4, 1, 0, 2, 3, 5]);
    let reason = answer.reason(0).unwrap();
    assert_eq!(reason, "p0 acts like +0.500000 p4 +0.250000 p1");
    assert_eq!(
        answer.reason(2).unwrap(),
        "p2 has no effect on any measurement"
    );
    assert_eq!(answer.reason(4), None);
    assert_eq!(answer.reason(99), None);
}

#[test]
fn nothing_visible() {
    let answer = judge(&Matrix::zeros(5, 2), &[1.0; 2], &[1, 0]);
    assert_eq!(answer.statuses, [Status::Invisible, Status::Invisible]);
    assert!(answer.independent.is_empty() && answer.observability.is_none());
    assert_eq!(answer.rank, 0);
}

#[test]
fn a_rank_on_the_edge_is_said_not_to_be_clear() {
    // Remainder 2e-9 of a unit column is kept, but the smallest singular value is 1/sqrt(2) of it
    // and the largest sqrt(2), a ratio of 1e-9 that the singular values call a loss.
    let gap = 1.9e-9;
    let matrix = Matrix::from_fn(2, 2, |row, column| match (row, column) {
        (0, _) => 1.0,
        (1, 1) => gap,
        _ => 0.0,
    });
    let answer = judge(&matrix, &[1.0; 2], &[0, 1]);
    assert_eq!((answer.rank, answer.singular_rank), (2, 1));
    assert!(!answer.is_clear());
}

#[test]
fn bad_questions_are_refused() {
    let reduction = reduce(&planted());
    let rules = IdentifiabilityRules::default();
    let good = named(&[1.0; 6]);
    let order = [0, 1, 2, 3, 4, 5];
    assert!(matches!(
        analyse(&reduction, &good[..5], &order, &rules),
        Err(IdentificationError::Shape {
            expected: 6,
            found: 5,
            ..
        })
    ));
    assert!(matches!(
        analyse(&reduction, &good, &order[..4], &rules),
        Err(IdentificationError::Shape {
            expected: 6,
            found: 4,
            ..
        })
    ));
    for order in [[0, 1, 2, 3, 4, 6], [0, 1, 2, 2, 4, 5]] {
        // Index 2 is invisible: its repetition must not hide index 3.
        let refused = analyse(&reduction, &good, &order, &rules);
        assert!(matches!(refused, Err(IdentificationError::Linalg(_))));
    }
    for size in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let mut sizes = [1.0; 6];
        sizes[3] = size;
        let refused = analyse(&reduction, &named(&sizes), &order, &rules);
        assert!(matches!(
            refused,
            Err(IdentificationError::Setting {
                name: "plausible_size",
                ..
            })
        ));
    }
    for (name, rules) in [
        (
            "zero_tolerance",
            IdentifiabilityRules {
                zero_tolerance: f64::NAN,
                ..rules
            },
        ),
        (
            "rank_tolerance",
            IdentifiabilityRules {
                rank_tolerance: 1.0,
                ..rules
            },
        ),
        (
            "weak_share",
            IdentifiabilityRules {
                weak_share: 0.0,
                ..rules
            },
        ),
    ] {
        let refused = analyse(&reduction, &good, &order, &rules);
        let Err(IdentificationError::Setting { name: found, .. }) = refused else {
            panic!("{refused:?}");
        };
        assert_eq!(found, name);
    }
}
