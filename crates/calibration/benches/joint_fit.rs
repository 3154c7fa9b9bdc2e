//! Times one joint fit, dense and by reduced channels, over the number of rows.
#![allow(
    missing_docs,
    dead_code,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a program that measures, on the devices of the tests"
)]

#[path = "../tests/it/haptic.rs"]
mod haptic;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use haptical_calibration::{DeviceProblem, ReducedProblem};
use haptical_identification::{Settings, solve};
use haptical_simulator::Noise;

const ROWS: [usize; 6] = [50, 200, 1000, 3000, 6000, 20_000];

fn joint_fit(criterion: &mut Criterion) {
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let mut group = criterion.benchmark_group("joint fit");
    group.sample_size(10);
    for rows in ROWS {
        let truth = haptic::truth_of(&nominal, 1.0);
        let recording = haptic::record(&truth, rows, 7, Noise::Gaussian);
        let joint = haptic::joint_problem(&nominal, &recording);
        let (channels, parameters) = (&joint.channels, &joint.parameters);
        let problem = DeviceProblem::new(
            &joint.device,
            &recording,
            channels,
            parameters,
            &joint.weights,
        )
        .unwrap();
        let reduced = ReducedProblem::new(&problem);
        let start = problem.start();
        let settings = Settings::default();
        let fit = solve(&problem, &start, &joint.free, &settings).unwrap();
        let other = solve(&reduced, &start, &joint.free, &settings).unwrap();
        println!(
            "{rows} rows, {} free: steps {} dense, {} reduced",
            joint.free.len(),
            fit.iterations,
            other.iterations
        );
        group.bench_function(BenchmarkId::new("dense", rows), |bencher| {
            bencher.iter(|| solve(&problem, &start, &joint.free, &settings).unwrap());
        });
        group.bench_function(BenchmarkId::new("reduced", rows), |bencher| {
            bencher.iter(|| solve(&reduced, &start, &joint.free, &settings).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, joint_fit);
criterion_main!(benches);
