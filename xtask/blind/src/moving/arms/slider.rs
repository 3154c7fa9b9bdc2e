//! Four joints, 9 kg: two in the plane, a slide that carries the weight, a turn about it.

use std::f64::consts::PI;

use super::{Arm, Axis};

pub(crate) const SLIDER: Arm = Arm {
    name: "slider",
    axes: &[
        Axis {
            slides: false,
            origin_m: [0.0, 0.0, 0.31],
            origin_rpy: [0.0; 3],
            mass_kg: 4.15,
            centre_m: [0.142, 0.003, 0.021],
            inertia_kgm2: [0.0122, 0.0571, 0.0603],
            armature: 0.62,
            ratio: 80.0,
            counts: 10000.0,
            range: 62.0,
            reach: [-2.2, 2.2],
            speed: 3.4,
        },
        Axis {
            slides: false,
            origin_m: [0.31, 0.0, 0.06],
            origin_rpy: [0.0; 3],
            mass_kg: 3.08,
            centre_m: [0.131, -0.004, 0.042],
            inertia_kgm2: [0.0094, 0.0342, 0.0361],
            armature: 0.29,
            ratio: 50.0,
            counts: 10000.0,
            range: 34.0,
            reach: [-2.4, 2.4],
            speed: 4.0,
        },
        Axis {
            slides: true,
            origin_m: [0.26, 0.0, 0.02],
            origin_rpy: [PI, 0.0, 0.0],
            mass_kg: 1.35,
            centre_m: [0.002, 0.004, -0.07],
            inertia_kgm2: [0.0052, 0.0052, 0.0004],
            armature: 6.4,
            ratio: 800.0,
            counts: 10000.0,
            range: 110.0,
            reach: [-0.12, 0.12],
            speed: 0.7,
        },
        Axis {
            slides: false,
            origin_m: [0.0, 0.0, 0.16],
            origin_rpy: [0.0; 3],
            mass_kg: 0.52,
            centre_m: [0.011, 0.002, 0.024],
            inertia_kgm2: [0.0006, 0.0007, 0.0005],
            armature: 0.021,
            ratio: 30.0,
            counts: 10000.0,
            range: 4.2,
            reach: [-2.8, 2.8],
            speed: 6.0,
        },
    ],
    flange_m: [0.0, 0.0, 0.05],
};
