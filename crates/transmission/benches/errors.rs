//! Times of the transmissions' errors with derivatives, and of the inverse: `cargo bench -p haptical-transmission`.
#![allow(missing_docs, reason = "criterion writes functions without text")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use haptical_transmission::{
    Capstan, CapstanError, CapstanParallelogram, LawError, Parallelogram, chebyshev,
};

const ANGLE_RAD: f64 = 0.4;
/// Angles in which an inverse is sought \[rad\].
const BRACKET_RAD: [f64; 2] = [-1.6, 1.6];
/// A parallelogram's lengths \[m\] and their deviations \[m\].
const LENGTHS_M: [f64; 4] = [0.18, 0.076, 0.18, 0.076];
const DEVIATIONS_M: [f64; 4] = [-5e-4, -7e-4, 0.0, 0.0];
/// A polynomial of degree 10, as the paper's.
const COEFFICIENTS: [f64; 11] = [
    1e-3, -1e-2, 6e-3, 2e-3, -1e-3, 5e-4, -2e-4, 1e-4, -5e-5, 2e-5, -1e-5,
];

fn errors(criterion: &mut Criterion) -> Result<(), LawError> {
    let mut group = criterion.benchmark_group("error with derivatives");
    let capstan = Capstan::new(8.0, 0.0675, 0.0675)?;
    let error = CapstanError::from_polar(0.001, -0.02, 2e-4, -0.2, 2.5e-6, 2.4);
    group.bench_function("capstan", |bencher| {
        bencher.iter(|| capstan.evaluate(&error, black_box(ANGLE_RAD)));
    });
    let parallelogram = Parallelogram::new(LENGTHS_M)?;
    group.bench_function("parallelogram", |bencher| {
        bencher.iter(|| parallelogram.evaluate(&DEVIATIONS_M, black_box(ANGLE_RAD)));
    });
    let both = CapstanParallelogram {
        capstan,
        parallelogram,
    };
    group.bench_function("capstan and parallelogram", |bencher| {
        bencher.iter(|| both.evaluate(&error, &DEVIATIONS_M, black_box(ANGLE_RAD)));
    });
    group.bench_function("polynomial of degree 10, value and slope", |bencher| {
        bencher.iter(|| chebyshev::evaluate([-0.8, 0.8], &COEFFICIENTS, black_box(ANGLE_RAD)));
    });
    group.finish();
    let mut group = criterion.benchmark_group("encoder angle for an output");
    group.bench_function("capstan", |bencher| {
        bencher.iter(|| capstan.invert(&error, black_box(ANGLE_RAD), BRACKET_RAD));
    });
    group.finish();
    Ok(())
}

fn transmissions(criterion: &mut Criterion) {
    let added = errors(criterion);
    assert!(added.is_ok(), "{added:?}");
}

criterion_group!(benches, transmissions);
criterion_main!(benches);
