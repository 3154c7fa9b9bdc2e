//! Times of a search and of the judgement what can be fixed: `cargo bench -p haptical-identification`.
#![allow(missing_docs, reason = "criterion writes functions without text")]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use haptical_identification::{
    IdentifiabilityRules, IdentificationError, Matrix, Method, ParameterInfo, Problem, Reduction,
    Settings, analyse, solve,
};

/// Rows and parameters of the paper's distance identification.
const ROWS: usize = 200;
const COLUMNS: usize = 28;

/// An entry in [-1, 1); columns are independent (SplitMix64).
fn entry(row: usize, column: usize) -> f64 {
    let index = (row * (COLUMNS + 1) + column) as u64;
    let mut z = (index + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Residuals sin(x_k . p) - y_k.
struct Waves {
    measured: Vec<f64>,
}

impl Waves {
    /// Measured at parameters of 0.02 each, with errors.
    fn new() -> Self {
        let phase = |row| -> f64 { (0..COLUMNS).map(|column| 0.02 * entry(row, column)).sum() };
        Self {
            measured: (0..ROWS)
                .map(|row| phase(row).sin() + 1e-3 * entry(row, COLUMNS))
                .collect(),
        }
    }
}

impl Problem for Waves {
    fn parameter_count(&self) -> usize {
        COLUMNS
    }

    fn residual_count(&self) -> usize {
        ROWS
    }

    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let mut slopes = vec![0.0; ROWS];
        for (row, measured) in self.measured.iter().enumerate() {
            let pairs = parameters.iter().enumerate();
            let phase: f64 = pairs.map(|(column, p)| entry(row, column) * p).sum();
            residuals[row] = phase.sin() - measured;
            slopes[row] = phase.cos();
        }
        if let Some((free, matrix)) = jacobian {
            for (position, &column) in free.iter().enumerate() {
                for (row, value) in matrix.column_mut(position).iter_mut().enumerate() {
                    *value = slopes[row] * entry(row, column);
                }
            }
        }
        Ok(())
    }
}

fn searches(criterion: &mut Criterion) -> Result<(), IdentificationError> {
    let mut group = criterion.benchmark_group("search, 200 rows, 28 parameters");
    let (problem, start) = (Waves::new(), vec![0.0; COLUMNS]);
    let free: Vec<usize> = (0..COLUMNS).collect();
    for (name, method) in [
        ("Gauss-Newton", Method::GaussNewton),
        ("Levenberg-Marquardt", Method::LevenbergMarquardt),
    ] {
        let settings = Settings {
            method,
            ..Settings::default()
        };
        // what is timed must end at a minimum
        let fit = solve(&problem, &start, &free, &settings)?;
        assert!(fit.convergence.was_successful(), "{:?}", fit.convergence);
        group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
            bencher.iter(|| solve(black_box(&problem), &start, &free, &settings));
        });
    }
    group.finish();
    Ok(())
}

fn judgement(criterion: &mut Criterion) -> Result<(), IdentificationError> {
    let mut group = criterion.benchmark_group("what can be fixed, 28 parameters");
    let matrix = Matrix::from_fn(ROWS, COLUMNS, entry);
    let reduction = Reduction::new(&matrix, &vec![0.0; ROWS])?;
    let name = |column| ParameterInfo::new(format!("p{column}"), "1", 1.0);
    let parameters: Vec<ParameterInfo> = (0..COLUMNS).map(name).collect();
    let order: Vec<usize> = (0..COLUMNS).collect();
    for (name, singular_values) in [("with singular values", true), ("by bounds", false)] {
        let rules = IdentifiabilityRules {
            singular_values,
            ..IdentifiabilityRules::default()
        };
        group.bench_function(name, |bencher| {
            bencher.iter(|| analyse(black_box(&reduction), &parameters, &order, &rules));
        });
    }
    group.finish();
    Ok(())
}

fn identification(criterion: &mut Criterion) {
    let added = searches(criterion).and_then(|()| judgement(criterion));
    assert!(added.is_ok(), "{added:?}");
}

criterion_group!(benches, identification);
criterion_main!(benches);
