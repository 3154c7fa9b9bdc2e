//! Times of the dense and the sparse QR on matrices of a calibration's size: `cargo bench -p haptical-linalg`.
#![allow(missing_docs, reason = "criterion writes functions without text")]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use haptical_linalg::{
    LinalgError, Matrix, RANK_TOLERANCE, Reduction, SparseLeastSquares, Triplet,
};

/// The paper's number of parameters.
const COLUMNS: usize = 28;
/// Columns of one block of the sparse matrix.
const BLOCK: usize = 4;

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

/// Seven blocks of four columns, 1000 rows, a row in one block each.
fn sparse(criterion: &mut Criterion) -> Result<(), LinalgError> {
    let mut group = criterion.benchmark_group("sparse, 1000 rows in 7 blocks of 4 columns");
    let rows = 1000;
    let blocks = COLUMNS / BLOCK;
    let entries: Vec<Triplet> = (0..rows * BLOCK)
        .map(|index| {
            let (row, within) = (index / BLOCK, index % BLOCK);
            let column = BLOCK * (row % blocks) + within;
            let value = entry(row, column);
            Triplet { row, column, value }
        })
        .collect();
    let rhs: Vec<f64> = (0..rows).map(|row| entry(row, COLUMNS)).collect();
    let solver = SparseLeastSquares::new(rows, COLUMNS, &entries)?;
    group.bench_function("analysis of the pattern", |bencher| {
        bencher.iter(|| SparseLeastSquares::new(rows, COLUMNS, black_box(&entries)));
    });
    group.bench_function("solution", |bencher| {
        bencher.iter(|| solver.solve(black_box(&entries), &rhs));
    });
    group.finish();
    Ok(())
}

fn qr(criterion: &mut Criterion) {
    let added = dense(criterion).and_then(|()| sparse(criterion));
    assert!(added.is_ok(), "{added:?}");
}

criterion_group!(benches, qr);
criterion_main!(benches);
