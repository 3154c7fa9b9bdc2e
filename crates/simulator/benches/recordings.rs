//! Times of simulated recordings, random poses and a hand-guided motion: `cargo bench -p haptical-simulator`.
#![allow(missing_docs, reason = "criterion writes functions without text")]

use std::error::Error;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use haptical_simulator::model::Device;
use haptical_simulator::{
    Effect, Effects, HandMotion, MotionSettings, Settings, record_motion, simulate,
};

/// Three joints in front of a cable.
const ARM: &str = r#"
[[link]]
a_m = 0.25
alpha_rad = -1.5
d_m = 0.05
[[link]]
a_m = 0.1
alpha_rad = 1.4
d_m = 0.35
[[link]]
a_m = 0.2
alpha_rad = 0.4
d_m = 0.1
[[link]]
a_m = 0.22
alpha_rad = 0.3
d_m = 0.03
[[joint]]
home_rad = 0.3
lower_rad = -1.2
upper_rad = 1.2
sampling_sd_rad = 0.4
transmission = "capstan"
transmission_ratio = 8.0
drum_distance_m = 0.0675
encoder_counts_per_rev = 20000
external_encoder_sd_rad = 1e-4
[[joint]]
home_rad = -0.6
lower_rad = -1.2
upper_rad = 1.2
sampling_sd_rad = 0.4
encoder_counts_per_rev = 20000
external_encoder_sd_rad = 1e-4
[[joint]]
home_rad = 0.9
lower_rad = -1.2
upper_rad = 1.2
sampling_sd_rad = 0.4
encoder_counts_per_rev = 20000
external_encoder_sd_rad = 1e-4
[cable_encoder]
drum_radius_m = 0.015
counts_per_rev = 20000
distance_sd_m = 1e-5
"#;

fn add(criterion: &mut Criterion) -> Result<(), Box<dyn Error>> {
    let truth = Device::from_toml(ARM, "arm.toml")?.device;
    let mut group = criterion.benchmark_group("simulation, 3 joints");
    group.sample_size(20);
    let settings = Settings::paper();
    simulate(&truth, &settings, 1000, 1)?;
    group.throughput(Throughput::Elements(1000));
    group.bench_function("1000 random poses", |bencher| {
        bencher.iter(|| simulate(&truth, &settings, 1000, 1));
    });
    let settings = MotionSettings {
        motion: HandMotion {
            seconds: 20.0,
            rate_hz: 100.0,
            ..HandMotion::default()
        },
        ..MotionSettings::default()
    };
    let play = Effect::Backlash {
        joint: 2,
        width_rad: 2e-3,
        driven_by: haptical_simulator::Driver::Hand,
    };
    group.throughput(Throughput::Elements(settings.rows()?));
    for (name, effects) in [("no effect", vec![]), ("play at joint 2", vec![play])] {
        let effects = Effects::new(effects)?;
        record_motion(&truth, &effects, &settings, 1)?;
        group.bench_function(format!("20 s by hand at 100 Hz, {name}"), |bencher| {
            bencher.iter(|| record_motion(&truth, &effects, &settings, 1));
        });
    }
    group.finish();
    Ok(())
}

fn recordings(criterion: &mut Criterion) {
    let added = add(criterion);
    assert!(added.is_ok(), "{added:?}");
}

criterion_group!(benches, recordings);
criterion_main!(benches);
