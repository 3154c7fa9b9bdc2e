//! Columns that are taken away from an order of preference.

use haptical_linalg::{Matrix, OrderedColumns, Reduction};

/// Numbers that repeat themselves at no entry.
fn entry(row: usize, column: usize) -> f64 {
    (1.0 + 7.3 * row as f64 + 1.7 * (column * column) as f64 + (row * column) as f64).sin()
}

/// The columns left are judged as if the one taken away had never been there: also where another one takes its place,
/// and where one depends on columns around it.
#[test]
fn what_is_taken_away_was_never_offered() {
    const COLUMNS: usize = 12;
    let matrix = Matrix::from_fn(30, COLUMNS, |row, column| match column {
        4 => entry(row, 1) - 2.0 * entry(row, 3),
        7 => entry(row, 5) + entry(row, 6),
        9 => entry(row, 2) + entry(row, 8) - entry(row, 6),
        10 => 0.0,
        _ => entry(row, column),
    });
    let reduction = Reduction::new(&matrix, &[1.0; 30]).unwrap();
    let all: Vec<usize> = (0..COLUMNS).collect();
    for taken in [
        vec![0, 5],
        vec![1, 2],
        vec![10, 4, 6],
        vec![3, 8, 11],
        vec![2, 7],
    ] {
        let mut ordered = OrderedColumns::new(&reduction, &all, 1e-9).unwrap();
        ordered.inverse_row_squares();
        taken.iter().for_each(|&column| ordered.take_away(column));
        let left: Vec<usize> = all
            .iter()
            .copied()
            .filter(|own| !taken.contains(own))
            .collect();
        let mut fresh = OrderedColumns::new(&reduction, &left, 1e-9).unwrap();
        let (a, b) = (ordered.rank().unwrap(), fresh.rank().unwrap());
        assert_eq!(
            (&a.independent, &a.zero),
            (&b.independent, &b.zero),
            "{taken:?}"
        );
        assert!((a.smallest_kept - b.smallest_kept).abs() < 1e-12);
        assert_eq!(a.dependent.len(), b.dependent.len());
        for (a, b) in a.dependent.iter().zip(&b.dependent) {
            assert_eq!(a.column, b.column);
            for (a, b) in a.combination.iter().zip(&b.combination) {
                assert!(a.0 == b.0 && (a.1 - b.1).abs() < 1e-9, "{a:?} for {b:?}");
            }
        }
        let squares = ordered.inverse_row_squares().into_iter();
        for (a, b) in squares.zip(fresh.inverse_row_squares()) {
            assert!((a - b).abs() < 1e-9 * b, "{a} for {b}");
        }
    }
}
