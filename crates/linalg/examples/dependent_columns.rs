//! Finds which column of a small design depends on which others, and solves without it.
#![allow(clippy::print_stdout, reason = "an example prints its answer")]

use haptical_linalg::{LinalgError, Matrix, RANK_TOLERANCE, Reduction};

fn main() -> Result<(), LinalgError> {
    let design = Matrix::from_fn(6, 4, |row, column| {
        let t = row as f64 / 5.0;
        [1.0, t, t * t, 2.0 - 3.0 * t][column]
    });
    let rhs = [1.0, 1.1, 1.4, 1.9, 2.6, 3.5];
    let reduction = Reduction::new(&design, &rhs)?;
    let rank = reduction.ordered_rank(&[0, 1, 2, 3], RANK_TOLERANCE)?;
    for dependence in &rank.dependent {
        println!(
            "column {} = {:?}",
            dependence.column, dependence.combination
        );
    }
    let solution = reduction.solve(&rank.independent, 0.0, RANK_TOLERANCE)?;
    println!("solution {:?}", solution.values);
    println!(
        "covariance {:?}",
        reduction.covariance(&rank.independent, RANK_TOLERANCE)?
    );
    Ok(())
}
