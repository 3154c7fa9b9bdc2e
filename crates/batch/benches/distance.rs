//! Times the sweeps of the distances of a 7-joint device, 28 parameters, and the reduction of rows.
#![allow(missing_docs, clippy::unwrap_used, reason = "a program that measures")]

#[path = "../examples/arm/mod.rs"]
mod arm;

use std::hint::black_box;

use arm::Arm;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use haptical_batch::{PoseBatch, TileRows};
use haptical_linalg::{Matrix, Triangle};

/// Poses of the passes that are timed per pose.
const POSES: usize = 4096;

/// Sweeps, with and without derivatives.
fn passes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("pass per pose");
    group.throughput(Throughput::Elements(POSES as u64));
    let arm = Arm::new(POSES).unwrap();
    let start = arm.model.start();
    for (name, free) in [("derivatives", arm.free.as_slice()), ("residuals", &[])] {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let see = |tile: &TileRows<'_>| {
                    black_box(tile.residuals());
                };
                arm.poses.visit(&arm.model, &start, free, see).unwrap();
            });
        });
    }
    group.bench_function("batch with its sines", |bencher| {
        bencher.iter(|| {
            let motions = arm.model.motions();
            PoseBatch::new(motions, &arm.joints, &arm.distances_m, &arm.weights).unwrap()
        });
    });
    group.finish();
}

/// The reduction alone, its copy into tiles included.
fn reduction(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("reduction per row");
    group.throughput(Throughput::Elements(POSES as u64));
    for columns in [7, 14, 28, 56] {
        let entry = |index: usize| (index as f64 * 0.7).sin();
        let matrix = Matrix::from_fn(POSES, columns, |row, column| entry(row * columns + column));
        let slices: Vec<&[f64]> = (0..columns).map(|column| matrix.column(column)).collect();
        let residuals: Vec<f64> = (0..POSES).map(entry).collect();
        group.bench_function(BenchmarkId::new("columns", columns), |bencher| {
            bencher.iter(|| {
                let mut triangle = Triangle::new(columns);
                triangle.fold_rows(&slices, &residuals).unwrap();
                triangle
            });
        });
    }
    group.finish();
}

criterion_group!(benches, passes, reduction);
criterion_main!(benches);
