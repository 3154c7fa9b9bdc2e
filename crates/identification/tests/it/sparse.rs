//! Sparse fits against dense ones.

use haptical_identification::{
    IdentificationError, Matrix, Method, Problem, Settings, SparseProblem, Triplet, solve,
    solve_sparse,
};

const BLOCKS: usize = 6;
const TIMES: usize = 8;
/// Both stop at the same minimum to 1e-16 of the cost.
const AGREEMENT: f64 = 1e-9;

/// y = a_k exp(-b t) + c_k in every block k: parameters b, then a_k and c_k of each block.
struct Blocks {
    y: Vec<f64>,
    /// Adds a parameter that acts like b: then nothing can tell the two apart.
    twin: bool,
}

impl Blocks {
    fn new(noise: f64, twin: bool) -> Self {
        let y = (0..BLOCKS * TIMES)
            .map(|row| {
                let (k, t) = (row / TIMES, Self::time(row));
                let irregular = noise * (row as f64 * 12.9898).sin();
                (1.0 + k as f64 * 0.3) * (-0.7 * t).exp() + 0.1 * k as f64 + irregular
            })
            .collect();
        Self { y, twin }
    }

    fn time(row: usize) -> f64 {
        (row % TIMES) as f64 * 0.4
    }

    fn start(&self) -> Vec<f64> {
        let mut start = vec![0.5];
        start.extend((0..BLOCKS).flat_map(|_| [1.5, 0.2]));
        if self.twin {
            start.push(0.0);
        }
        start
    }

    /// Parameter and derivative of each non-zero entry of a row.
    fn row(&self, row: usize, p: &[f64]) -> (f64, Vec<(usize, f64)>) {
        let (k, t) = (row / TIMES, Self::time(row));
        let rate = p[0] + if self.twin { p[1 + 2 * BLOCKS] } else { 0.0 };
        let (a, c) = (p[1 + 2 * k], p[2 + 2 * k]);
        let fall = (-rate * t).exp();
        let mut slopes = vec![(0, -a * t * fall), (1 + 2 * k, fall), (2 + 2 * k, 1.0)];
        if self.twin {
            slopes.push((1 + 2 * BLOCKS, -a * t * fall));
        }
        (a * fall + c - self.y[row], slopes)
    }
}

impl Problem for Blocks {
    fn parameter_count(&self) -> usize {
        1 + 2 * BLOCKS + usize::from(self.twin)
    }

    fn residual_count(&self) -> usize {
        self.y.len()
    }

    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        mut jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        for (row, residual) in residuals.iter_mut().enumerate() {
            let (value, slopes) = self.row(row, parameters);
            *residual = value;
            if let Some((free, matrix)) = &mut jacobian {
                for (column, parameter) in free.iter().enumerate() {
                    let found = slopes.iter().find(|(index, _)| index == parameter);
                    matrix[(row, column)] = found.map_or(0.0, |(_, slope)| *slope);
                }
            }
        }
        Ok(())
    }
}

impl SparseProblem for Blocks {
    fn evaluate_sparse(
        &self,
        parameters: &[f64],
        free: &[usize],
        residuals: &mut [f64],
        entries: &mut Vec<Triplet>,
    ) -> Result<(), IdentificationError> {
        entries.clear();
        for (row, residual) in residuals.iter_mut().enumerate() {
            let (value, slopes) = self.row(row, parameters);
            *residual = value;
            for (parameter, value) in slopes {
                if let Some(column) = free.iter().position(|index| *index == parameter) {
                    entries.push(Triplet { row, column, value });
                }
            }
        }
        Ok(())
    }
}

fn compare(problem: &Blocks, free: &[usize]) {
    let start = problem.start();
    let settings = Settings {
        method: Method::GaussNewton,
        ..Settings::default()
    };
    let dense = solve(problem, &start, free, &settings).unwrap();
    let sparse = solve_sparse(problem, &start, free, &settings).unwrap();
    assert!(dense.convergence.was_successful() && sparse.convergence.was_successful());
    for (a, b) in dense.parameters.iter().zip(&sparse.parameters) {
        assert!((a - b).abs() < AGREEMENT, "{a} {b}");
    }
    assert!((dense.cost - sparse.cost).abs() < AGREEMENT * dense.cost.max(AGREEMENT));
}

#[test]
fn sparse_agrees_with_dense() {
    for noise in [0.0, 0.01, 0.1] {
        let problem = Blocks::new(noise, false);
        compare(&problem, &(0..13).collect::<Vec<usize>>());
        // Some parameters fixed, columns in another order.
        compare(&problem, &[6, 3, 0, 1, 2]);
    }
}

#[test]
fn dependent_parameters_are_refused() {
    let problem = Blocks::new(0.01, true);
    let free: Vec<usize> = (0..14).collect();
    let refused = solve_sparse(&problem, &problem.start(), &free, &Settings::default());
    assert!(matches!(
        refused,
        Err(IdentificationError::RankDeficient { parameters: 14, .. })
    ));
    compare(&problem, &free[..13]);
}

#[test]
fn bad_questions_are_refused() {
    let mut problem = Blocks::new(0.01, false);
    let settings = Settings::default();
    let start = problem.start();
    assert!(matches!(
        solve_sparse(&problem, &start, &[], &settings),
        Err(IdentificationError::NothingFree)
    ));
    assert!(matches!(
        solve_sparse(&problem, &start[..5], &[0], &settings),
        Err(IdentificationError::Shape { .. })
    ));
    problem.y.truncate(4);
    assert!(matches!(
        solve_sparse(&problem, &start, &[0, 1, 2, 3, 4], &settings),
        Err(IdentificationError::TooFewRows {
            rows: 4,
            parameters: 5
        })
    ));
    problem.y[3] = f64::NAN;
    // The residual is named by the number of parameters, not of free ones.
    assert!(matches!(
        solve_sparse(&problem, &start, &[0, 1], &settings),
        Err(IdentificationError::NotFinite {
            row: 3,
            column: 13,
            ..
        })
    ));
}
