//! Times the sweeps, the reduction and whole fits of the distances of a 7-joint device, 28 parameters.
#![allow(missing_docs, clippy::unwrap_used, reason = "a program that measures")]

#[path = "../examples/arm/mod.rs"]
mod arm;

use std::hint::black_box;

use arm::Arm;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use haptical_batch::{
    DistanceProblem, PoseBatch, ReducedDistance, Sines, Threads, TileRows, Triangle,
    solve_distances, solve_distances_warm,
};
use haptical_identification::Matrix;

/// Poses of the passes that are timed per pose.
const POSES: usize = 4096;

/// Sweeps, and whole passes, with sines cached and not.
fn passes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("pass per pose");
    group.throughput(Throughput::Elements(POSES as u64));
    for (name, sines) in [("cached", Sines::Cached), ("each pass", Sines::EachPass)] {
        let arm = Arm::new(POSES, sines).unwrap();
        let start = arm.model.start();
        let rows = DistanceProblem::new(&arm.model, &arm.poses).unwrap();
        group.bench_function(BenchmarkId::new("derivatives", name), |bencher| {
            bencher.iter(|| {
                let see = |tile: &TileRows<'_>| {
                    black_box(tile.residuals());
                };
                rows.visit(&start, &arm.free, see).unwrap();
            });
        });
        let reduced = ReducedDistance::new(&arm.model, &arm.poses, Threads::One).unwrap();
        group.bench_function(
            BenchmarkId::new("derivatives and reduction", name),
            |bencher| {
                bencher.iter(|| reduced.reduce(&start, &arm.free, Triangle::cost).unwrap());
            },
        );
        group.bench_function(
            BenchmarkId::new("residuals and their sum", name),
            |bencher| {
                bencher.iter(|| reduced.reduce(&start, &[], Triangle::cost).unwrap());
            },
        );
    }
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

fn fits(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("fit of 28 parameters");
    group.sample_size(20);
    for poses in [200, 100_000] {
        let arm = Arm::new(poses, Sines::Cached).unwrap();
        let start = arm.model.start();
        for (name, threads) in [("one thread", Threads::One), ("several", Threads::Several)] {
            group.bench_function(BenchmarkId::new(name, poses), |bencher| {
                bencher.iter(|| {
                    let (model, settings) = (&arm.model, &arm.settings);
                    solve_distances(model, &arm.poses, &start, &arm.free, settings, threads)
                });
            });
        }
        group.bench_function(
            BenchmarkId::new("one thread, warm start", poses),
            |bencher| {
                bencher.iter(|| {
                    let (model, settings) = (&arm.model, &arm.settings);
                    let threads = Threads::One;
                    solve_distances_warm(
                        model, &arm.poses, &start, &arm.free, settings, threads, 16,
                    )
                });
            },
        );
        group.bench_function(BenchmarkId::new("batch with its sines", poses), |bencher| {
            bencher.iter(|| {
                let (motions, weights) = (arm.model.motions(), &arm.weights);
                PoseBatch::new(
                    motions,
                    &arm.joints,
                    &arm.distances_m,
                    weights,
                    Sines::Cached,
                )
            });
        });
    }
    group.finish();
}

criterion_group!(benches, passes, reduction, fits);
criterion_main!(benches);
