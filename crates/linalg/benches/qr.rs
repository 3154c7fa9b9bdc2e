//! Times of the QR on matrices of a calibration's size: `cargo bench -p haptical-linalg`.
#![allow(missing_docs, reason = "criterion writes functions without text")]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use haptical_linalg::{LinalgError, Matrix, RANK_TOLERANCE, Reduction};

/// The paper's number of parameters.
const COLUMNS: usize = 28;

/// An entry in [-1, 1); columns are independent (SplitMix64).
fn entry(row: usize, column: usize) -> f64 {
    let index = (row * (COLUMNS + 1) + column) as u64;
    let mut z = (index + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

fn dense(criterion: &mut Criterion) -> Result<(), LinalgError> {
    let mut group = criterion.benchmark_group("dense, 28 columns");
    for rows in [200, 4096] {
        let matrix = Matrix::from_fn(rows, COLUMNS, entry);
        let rhs: Vec<f64> = (0..rows).map(|row| entry(row, COLUMNS)).collect();
        group.throughput(Throughput::Elements(rows as u64));
        group.bench_function(BenchmarkId::new("reduction", rows), |bencher| {
            bencher.iter(|| Reduction::new(black_box(&matrix), &rhs));
        });
    }
    group.throughput(Throughput::Elements(1));
    let matrix = Matrix::from_fn(200, COLUMNS, entry);
    let rhs: Vec<f64> = (0..200).map(|row| entry(row, COLUMNS)).collect();
    let reduction = Reduction::new(&matrix, &rhs)?;
    let columns: Vec<usize> = (0..COLUMNS).collect();
    // what is timed must have an answer: a refusal would be fast
    reduction.covariance(&columns, RANK_TOLERANCE)?;
    group.bench_function("step from the triangle", |bencher| {
        bencher.iter(|| reduction.solve(black_box(&columns), 1e-3, RANK_TOLERANCE));
    });
    group.bench_function("rank in order of preference", |bencher| {
        bencher.iter(|| reduction.ordered_rank(black_box(&columns), RANK_TOLERANCE));
    });
    group.bench_function("singular values", |bencher| {
        bencher.iter(|| reduction.singular_values(black_box(&columns)));
    });
    group.bench_function("covariance", |bencher| {
        bencher.iter(|| reduction.covariance(black_box(&columns), RANK_TOLERANCE));
    });
    group.finish();
    Ok(())
}

fn qr(criterion: &mut Criterion) {
    let added = dense(criterion);
    assert!(added.is_ok(), "{added:?}");
}

criterion_group!(benches, qr);
criterion_main!(benches);
