//! Time of the dynamics of an arm of 7 joints: `cargo bench -p haptical-dynamics`.
#![allow(missing_docs, reason = "criterion writes functions without text")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use haptical_dynamics::nalgebra::{Matrix3, Rotation3, Vector3};
use haptical_dynamics::{
    Body, DynamicsError, Inertia, Joint, Pose, Scratch, TorqueDerivatives, Tree,
};

const JOINTS: usize = 7;

/// An arm like the usual ones, axes a quarter turn apart.
fn arm() -> [Body; JOINTS] {
    core::array::from_fn(|joint| Body {
        parent: joint.checked_sub(1),
        placement: Pose {
            position_m: Vector3::new(0.0, 0.1 * (joint % 2) as f64, 0.2),
            rotation: *Rotation3::new(Vector3::x() * 1.57).matrix(),
        },
        joint: Joint::Revolute(Vector3::z_axis()),
        inertia: Inertia::about_centre(
            4.0 - 0.4 * joint as f64,
            &Vector3::new(0.01, -0.05, 0.08),
            &Matrix3::from_diagonal(&Vector3::new(0.02, 0.03, 0.015)),
        ),
        armature_kgm2: 0.1,
    })
}

fn dynamics(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("7 joints");
    let bodies = arm();
    let mut add = || -> Result<(), DynamicsError> {
        let tree = Tree::new(&bodies, Vector3::new(0.0, 0.0, -9.81))?;
        let mut scratch = [Scratch::default(); JOINTS];
        let q: [f64; JOINTS] = core::array::from_fn(|joint| 0.3 + 0.2 * joint as f64);
        let (dq, ddq) = (q.map(|q| 1.0 - q), q.map(|q| q * q - 0.5));
        let mut torques = [0.0; JOINTS];
        group.bench_function("inverse dynamics", |bencher| {
            bencher.iter(|| {
                let (q, dq, ddq) = (black_box(&q), black_box(&dq), black_box(&ddq));
                let done = tree.inverse_dynamics(q, dq, ddq, &[], &mut scratch, &mut torques);
                black_box(&torques);
                done
            });
        });
        group.bench_function("forward dynamics", |bencher| {
            bencher.iter(|| {
                let (q, dq, tau) = (black_box(&q), black_box(&dq), black_box(&ddq));
                let done = tree.forward_dynamics(q, dq, tau, &[], &mut scratch, &mut torques);
                black_box(&torques);
                done
            });
        });
        let mut mass = [0.0; JOINTS * JOINTS];
        group.bench_function("mass matrix", |bencher| {
            bencher.iter(|| {
                let done = tree.mass_matrix(black_box(&q), &mut scratch, &mut mass);
                black_box(&mass);
                done
            });
        });
        let mut regressor = [0.0; 10 * JOINTS * JOINTS];
        group.bench_function("regressor", |bencher| {
            bencher.iter(|| {
                let (q, dq, ddq) = (black_box(&q), black_box(&dq), black_box(&ddq));
                let done = tree.regressor(q, dq, ddq, &mut scratch, &mut regressor);
                black_box(&regressor);
                done
            });
        });
        let mut by_dq = mass;
        group.bench_function("derivatives of inverse dynamics", |bencher| {
            bencher.iter(|| {
                let (q, dq, ddq) = (black_box(&q), black_box(&dq), black_box(&ddq));
                let out = TorqueDerivatives {
                    by_q: &mut mass,
                    by_dq: &mut by_dq,
                };
                let done = tree.torque_derivatives(q, dq, ddq, &mut scratch, out);
                black_box((&mass, &by_dq));
                done
            });
        });
        Ok(())
    };
    let added = add();
    assert!(added.is_ok(), "{added:?}");
    group.finish();
}

criterion_group!(benches, dynamics);
criterion_main!(benches);
