//! Time of pose and Jacobian of a 7-joint chain: `cargo bench -p haptical-kinematics`.
#![allow(missing_docs, reason = "criterion writes functions without text")]

#[path = "../examples/arm/mod.rs"]
mod arm;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use haptical_kinematics::{Chain, Convention, KinematicsError, PreparedChain, Twist};

fn pose_and_jacobian(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("pose and Jacobian, 7 joints");
    let links = arm::links();
    let mut add = || -> Result<(), KinematicsError> {
        let chain = Chain::new(Convention::Standard, &links, &arm::MOTIONS)?;
        let mut jacobian = [Twist::default(); arm::JOINTS];
        group.bench_function("Chain", |bencher| {
            bencher.iter(|| {
                let pose = chain.geometric_jacobian(black_box(&arm::POSTURE_RAD), &mut jacobian);
                black_box(&jacobian);
                pose
            });
        });
        let prepared = PreparedChain::new(&chain)?;
        group.bench_function("PreparedChain", |bencher| {
            bencher.iter(|| {
                let pose = prepared.pose_and_jacobian(black_box(&arm::POSTURE_RAD), &mut jacobian);
                black_box(&jacobian);
                pose
            });
        });
        group.bench_function("seven sines and cosines by libm", |bencher| {
            bencher.iter(|| black_box(arm::POSTURE_RAD).map(libm::sincos));
        });
        group.bench_function("preparation", |bencher| {
            bencher.iter(|| PreparedChain::<{ arm::JOINTS }>::new(black_box(&chain)));
        });
        Ok(())
    };
    let added = add();
    assert!(added.is_ok(), "{added:?}");
    group.finish();
}

criterion_group!(benches, pose_and_jacobian);
criterion_main!(benches);
