//! Time of one diagnosis over the number of rows: `cargo bench -p haptical-diagnosis`.
#![allow(
    missing_docs,
    dead_code,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a program that measures, on the arm of the tests"
)]

#[path = "../tests/it/arm.rs"]
mod arm;
#[path = "../tests/it/normal.rs"]
mod normal;

use std::hint::black_box;

use arm::{Session, device, record_yielding};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use haptical_diagnosis::{Options, Verdict, diagnose};

fn diagnosis(criterion: &mut Criterion) {
    let device = device();
    let mut group = criterion.benchmark_group("diagnosis of a yielding cable, 3 joints");
    group.sample_size(10);
    for rows in [600, 2400] {
        let recording = record_yielding(&Session {
            rows_of_a_run: rows / 2,
            ..Session::default()
        });
        // what is timed must find something
        let found = diagnose(&device, &recording, &Options::default()).unwrap();
        assert_eq!(found.verdict, Verdict::Named);
        group.bench_function(BenchmarkId::new("rows", rows), |bencher| {
            bencher.iter(|| diagnose(&device, black_box(&recording), &Options::default()).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, diagnosis);
criterion_main!(benches);
