//! Times of reading and writing a log of 60 s: `cargo bench -p haptical-data`.
#![allow(missing_docs, reason = "criterion writes functions without text")]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use haptical_data::{DataError, JointShape, LogShape, read_log_from, write_log_to};
use haptical_model::Recording;

const ROWS: usize = 6000;
const JOINTS: usize = 7;

/// Time, 7 motor-side and 4 external encoders, a cable, 7 torques: 20 columns.
fn recording() -> Recording {
    let column = |number: usize| -> Vec<f64> {
        let value = |row: usize| (row as f64 * 1e-3 * (1 + number) as f64).sin();
        (0..ROWS).map(value).collect()
    };
    let joint: Vec<Vec<f64>> = (0..JOINTS).map(column).collect();
    Recording {
        line: (2..).take(ROWS).collect(),
        time_s: Some((0..ROWS).map(|row| 0.01 * row as f64).collect()),
        output: (0..JOINTS)
            .map(|index| (index < 4).then(|| column(index)))
            .collect(),
        cable_m: vec![Some(column(7).iter().map(|m| 0.3 + 0.1 * m).collect())],
        torque_nm: (0..JOINTS).map(|index| Some(column(8 + index))).collect(),
        joint,
        ..Recording::default()
    }
}

fn add(criterion: &mut Criterion) -> Result<(), DataError> {
    let joint = |index: usize| JointShape {
        name: (index + 1).to_string(),
        prismatic: false,
        lower: -1.5,
        upper: 1.5,
    };
    let shape = LogShape {
        joints: (0..JOINTS).map(joint).collect(),
        cable_count: 1,
        hands: Vec::new(),
    };
    let recording = recording();
    let mut text = Vec::new();
    write_log_to(&mut text, &recording, &shape)?;
    // what is timed must be a log: a refusal would be fast
    read_log_from(text.as_slice(), "log.csv", &shape)?;
    let mut group = criterion.benchmark_group("log of 6000 rows, 20 columns");
    group.throughput(Throughput::Elements(ROWS as u64));
    group.sample_size(20);
    group.bench_function("read", |bencher| {
        bencher.iter(|| read_log_from(black_box(text.as_slice()), "log.csv", &shape));
    });
    group.bench_function("written", |bencher| {
        bencher.iter(|| {
            let mut copy = Vec::with_capacity(text.len());
            write_log_to(&mut copy, black_box(&recording), &shape).map(|()| copy)
        });
    });
    group.finish();
    Ok(())
}

fn log(criterion: &mut Criterion) {
    let added = add(criterion);
    assert!(added.is_ok(), "{added:?}");
}

criterion_group!(benches, log);
criterion_main!(benches);
