//! An orthonormal basis of columns that fall apart.

use haptical_linalg::{Direction, Matrix, OrthonormalBasis, SparseColumns};

/// Entries that follow no pattern.
fn entry(row: usize, column: usize) -> f64 {
    let row = (row + 1) as f64;
    (3.7 * row * row + 1.9 * column as f64 * row).sin()
}

/// Three parts of a matrix, one of which has a dependent column, against the parts by themselves.
#[test]
fn columns_without_a_common_row_are_decomposed_apart() {
    let part_of = |column: usize| column % 3;
    let whole = Matrix::from_fn(60, 9, |row, column| {
        if row / 20 != part_of(column) {
            0.0
        } else if column == 7 {
            entry(row, 1) - 2.0 * entry(row, 4)
        } else {
            entry(row, column)
        }
    });
    let basis = OrthonormalBasis::new(&SparseColumns::from(&whole), 1e-9).unwrap();
    assert_eq!(basis.directions().count(), 8);
    assert!(
        basis
            .directions()
            .all(|direction| direction.values().len() == 20)
    );
    let rhs: Vec<f64> = (0..60).map(|row| entry(row, 20)).collect();
    let solution = basis.solve(&rhs).unwrap();
    for part in 0..3 {
        let own = Matrix::from_fn(20, 3, |row, column| {
            whole[(20 * part + row, 3 * column + part)]
        });
        let alone = OrthonormalBasis::new(&SparseColumns::from(&own), 1e-9).unwrap();
        let expected = alone.solve(&rhs[20 * part..][..20]).unwrap();
        for (column, value) in expected.iter().enumerate() {
            let found = solution[3 * column + part];
            assert!(
                (found - value).abs() < 1e-13,
                "{part}, {column}: {found} for {value}"
            );
        }
    }
    // products with one another: those of an orthonormal basis
    let all: Vec<&Direction> = basis.directions().collect();
    for (a, first) in all.iter().enumerate() {
        for (b, second) in all.iter().enumerate() {
            let product = first.dot_part(second.values(), second.first());
            assert!((product - f64::from(u8::from(a == b))).abs() < 1e-13);
        }
    }
}
