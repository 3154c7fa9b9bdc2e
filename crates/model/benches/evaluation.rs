//! Times of a device's predictions with derivatives, and of its file: `cargo bench -p haptical-model`.
#![allow(missing_docs, reason = "criterion writes functions without text")]

use std::error::Error;
use std::fmt::Write;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use haptical_model::{Device, Evaluation};

const JOINTS: usize = 7;

/// A 7-joint arm, every joint a capstan with errors.
fn text() -> String {
    let mut text = String::from("[device]\nname = \"arm\"\n");
    for row in 0..=JOINTS {
        let sign = if row % 2 == 0 { -1.0 } else { 1.0 };
        let (a_m, alpha_rad, d_m) = (0.02 * row as f64, 1.57 * sign, 0.1 + 0.01 * row as f64);
        let _ = writeln!(
            text,
            "[[link]]\na_m = {a_m}\nalpha_rad = {alpha_rad}\nd_m = {d_m}"
        );
    }
    for _ in 0..JOINTS {
        text += "[[joint]]\nlower_rad = -1.5\nupper_rad = 1.5\ntransmission = \"capstan\"\n\
                 transmission_ratio = 8.0\ndrum_distance_m = 0.0675\n[joint.transmission_error]\n\
                 ratio_deviation = -0.02\noutput_drum_xy_m = [1.5e-4, -8e-5]\ninput_drum_xy_m = [2e-6, 4e-6]\n";
    }
    text
}

fn add(criterion: &mut Criterion) -> Result<(), Box<dyn Error>> {
    let text = text();
    let device = Device::from_toml(&text, "arm.toml")?.device;
    let readings = [0.3, -0.2, 0.4, -0.5, 0.6, -0.7, 0.8];
    let mut group = criterion.benchmark_group("model, 7 joints");
    let mut evaluation = Evaluation::new(&device);
    // what is timed must have an answer: a refusal would be fast
    evaluation.move_to(&readings)?;
    device.to_toml(&text, "arm.toml")?;
    group.bench_function("pose with all derivatives", |bencher| {
        bencher.iter(|| evaluation.move_to(black_box(&readings)));
    });
    group.bench_function("pose with those of the readings", |bencher| {
        bencher.iter(|| evaluation.move_pose_to(black_box(&readings)));
    });
    group.bench_function("one joint", |bencher| {
        bencher.iter(|| evaluation.move_joint(2, black_box(0.4)));
    });
    group.bench_function("device file read", |bencher| {
        bencher.iter(|| Device::from_toml(black_box(&text), "arm.toml"));
    });
    group.bench_function("device file written", |bencher| {
        bencher.iter(|| black_box(&device).to_toml(&text, "arm.toml"));
    });
    group.finish();
    Ok(())
}

fn model(criterion: &mut Criterion) {
    let added = add(criterion);
    assert!(added.is_ok(), "{added:?}");
}

criterion_group!(benches, model);
criterion_main!(benches);
