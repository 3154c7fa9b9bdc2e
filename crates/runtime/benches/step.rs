//! Time of one step with torques of the 7-DOF device: `cargo bench -p haptical-runtime`.
#![allow(
    missing_docs,
    unreachable_pub,
    dead_code,
    reason = "an exported module is public; criterion writes functions without text"
)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use haptical_model::{Device, Evaluation};

mod polynomial {
    include!("../tests/fixtures/identified.rs");
}
mod parallelogram {
    include!("../tests/fixtures/parallelogram.rs");
}

const READINGS: [f64; 7] = [0.3, -0.2, 0.4, -0.5, 0.6, -0.7, 0.8];
const FORCE_N: [f64; 3] = [1.0, -2.0, 3.0];

fn step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step with torques, 7 joints");
    for (name, model) in [
        ("joint 4 a polynomial", &polynomial::MODEL),
        ("joint 4 a parallelogram", &parallelogram::MODEL),
    ] {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let state = model.step(black_box(&READINGS))?;
                state.reading_torques_nm(black_box(FORCE_N), [0.0; 3])
            });
        });
    }
    // what the model crate takes for the same pose and Jacobian, with the derivatives it also works out
    let text = include_str!("../tests/fixtures/parallelogram.toml");
    let device = Device::from_toml(text, "parallelogram.toml").map(|loaded| loaded.device);
    if let Ok(device) = device {
        let mut evaluation = Evaluation::new(&device);
        group.bench_function("haptical_model::Evaluation::move_to", |bencher| {
            bencher.iter(|| evaluation.move_to(black_box(&READINGS)));
        });
    }
    group.finish();
}

criterion_group!(benches, step);
criterion_main!(benches);
