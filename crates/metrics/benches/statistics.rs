//! Times of the bootstrap and of the other functions that see whole recordings: `cargo bench -p haptical-metrics`.
#![allow(missing_docs, reason = "criterion writes functions without text")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use haptical_metrics::{Bootstrap, best_rotation, percentile_interval, rms, spearman};

/// Rows of a log of 60 s at 100 Hz.
const ROWS: usize = 6000;

fn statistics(criterion: &mut Criterion) {
    let values: Vec<f64> = (0..ROWS).map(|row| (row as f64 * 0.7).sin()).collect();
    let others: Vec<f64> = (0..ROWS).map(|row| (row as f64 * 0.3).cos()).collect();
    let mut group = criterion.benchmark_group("statistics of 6000 rows");
    group.bench_function("root mean square", |bencher| {
        bencher.iter(|| rms(black_box(&values)));
    });
    group.bench_function("percentile interval", |bencher| {
        bencher.iter(|| percentile_interval(black_box(&values), 0.95));
    });
    group.bench_function("rank correlation", |bencher| {
        bencher.iter(|| spearman(black_box(&values), black_box(&others)));
    });
    let bootstrap = Bootstrap {
        replicates: 200,
        seed: 1,
        level: 0.95,
        block_length: 100,
    };
    group.sample_size(20);
    group.bench_function("interval of a mean, 200 resamples in blocks", |bencher| {
        bencher.iter(|| {
            bootstrap.interval(ROWS, |rows| {
                let sum: f64 = rows.iter().map(|&row| values[row]).sum();
                Some(sum / rows.len() as f64)
            })
        });
    });
    group.finish();
    let points: Vec<[f64; 3]> = (0..200)
        .map(|point| [0, 1, 2].map(|axis| ((3 * point + axis) as f64 * 0.9).sin()))
        .collect();
    let turned: Vec<[f64; 3]> = points.iter().map(|[x, y, z]| [-y, *x, *z]).collect();
    criterion.bench_function("rotation between 200 points", |bencher| {
        bencher.iter(|| best_rotation(black_box(&points), black_box(&turned)));
    });
}

criterion_group!(benches, statistics);
criterion_main!(benches);
