//! Times of reading a URDF, correcting it and writing new descriptions: `cargo bench -p haptical-urdf`.
#![allow(missing_docs, reason = "criterion writes functions without text")]

use std::error::Error;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use haptical_urdf::{BaseAndTip, corrected_urdf, device_from_urdf, new_mjcf, new_urdf};

const ARM: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/urdf/arm.urdf");

fn add(criterion: &mut Criterion) -> Result<(), Box<dyn Error>> {
    let text = std::fs::read_to_string(ARM)?;
    let mut device = device_from_urdf(&text, "arm.urdf", BaseAndTip::default())?.device;
    device.links[2].a_m += 1e-3;
    // what is timed must have an answer: a refusal would be fast
    corrected_urdf(&text, "arm.urdf", BaseAndTip::default(), &device)?;
    new_urdf(&device)?;
    new_mjcf(&device)?;
    let mut group = criterion.benchmark_group("urdf, 6 joints");
    group.bench_function("read", |bencher| {
        bencher.iter(|| device_from_urdf(black_box(&text), "arm.urdf", BaseAndTip::default()));
    });
    group.bench_function("corrected", |bencher| {
        bencher
            .iter(|| corrected_urdf(black_box(&text), "arm.urdf", BaseAndTip::default(), &device));
    });
    group.bench_function("written anew", |bencher| {
        bencher.iter(|| new_urdf(black_box(&device)));
    });
    group.bench_function("written as MJCF", |bencher| {
        bencher.iter(|| new_mjcf(black_box(&device)));
    });
    group.finish();
    Ok(())
}

fn descriptions(criterion: &mut Criterion) {
    let added = add(criterion);
    assert!(added.is_ok(), "{added:?}");
}

criterion_group!(benches, descriptions);
criterion_main!(benches);
