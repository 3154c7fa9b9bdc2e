//! The makes of arms: six joints of 17 kg, seven of 8 kg, four of 9 kg of which one slides; and others of as many joints.

use std::f64::consts::{FRAC_PI_2, PI};

use super::{Arm, Axis};

const ALIKE: [f64; 3] = [0.0; 3];
const DOWN: [f64; 3] = [-FRAC_PI_2, 0.0, 0.0];
const UP: [f64; 3] = [FRAC_PI_2, 0.0, 0.0];
const FORWARD: [f64; 3] = [0.0, FRAC_PI_2, 0.0];
const OVER: [f64; 3] = [PI, 0.0, 0.0];

const SIX_AXES: [Axis; 6] = rows! {
    Axis {
        slides origin_m origin_rpy mass_kg centre_m inertia_kgm2
        armature ratio counts range reach speed
    }
    false, [0.0, 0.0, 0.18], ALIKE, 4.62, [0.021, 0.004, 0.083], [0.0213, 0.0224, 0.0142],
        1.12, 121.0, 8192.0, 120.0, [-2.8, 2.8], 2.4;
    false, [0.06, 0.0, 0.15], DOWN, 5.25, [0.205, 0.006, -0.031], [0.0151, 0.1052, 0.1018],
        1.34, 161.0, 8192.0, 145.0, [-2.4, 0.6], 2.0;
    false, [0.45, 0.0, 0.0], ALIKE, 3.41, [0.052, -0.037, 0.011], [0.0118, 0.0163, 0.0171],
        0.83, 121.0, 8192.0, 85.0, [-1.0, 2.4], 2.4;
    false, [0.18, -0.05, 0.0], FORWARD, 1.72, [0.003, -0.002, 0.112], [0.0094, 0.0091, 0.0021],
        0.118, 81.0, 4096.0, 26.0, [-2.8, 2.8], 3.2;
    false, [0.0, 0.0, 0.21], DOWN, 1.24, [0.002, -0.021, 0.009], [0.0019, 0.0014, 0.0018],
        0.101, 81.0, 4096.0, 22.0, [-1.9, 1.9], 3.2;
    false, [0.0, -0.085, 0.0], UP, 0.47, [0.004, 0.001, 0.012], [0.00041, 0.0004, 0.00052],
        0.062, 51.0, 4096.0, 14.0, [-2.9, 2.9], 3.6;
};

/// Shoulder and forearm off the axes, a wrist whose axes meet.
pub(crate) const SIX: Arm = Arm {
    name: "six",
    axes: &SIX_AXES,
    flange_m: [0.0, 0.0, 0.041],
};

const SEVEN_AXES: [Axis; 7] = rows! {
    Axis {
        slides origin_m origin_rpy mass_kg centre_m inertia_kgm2
        armature ratio counts range reach speed
    }
    false, [0.0, 0.0, 0.12], ALIKE, 1.72, [0.001, -0.018, 0.061], [0.0051, 0.0046, 0.0029],
        0.36, 100.0, 4096.0, 58.0, [-2.7, 2.7], 2.6;
    false, [0.0, 0.0, 0.12], DOWN, 1.63, [0.002, -0.083, 0.014], [0.0063, 0.0028, 0.006],
        0.36, 100.0, 4096.0, 58.0, [-1.8, 1.8], 2.6;
    false, [0.0, -0.21, 0.0], UP, 1.38, [0.009, 0.012, 0.067], [0.0044, 0.0042, 0.0021],
        0.24, 100.0, 4096.0, 38.0, [-2.7, 2.7], 3.0;
    false, [0.028, 0.0, 0.19], UP, 1.27, [-0.012, 0.071, 0.006], [0.0043, 0.0019, 0.0042],
        0.21, 100.0, 4096.0, 36.0, [-2.0, 2.0], 3.0;
    false, [-0.028, 0.2, 0.0], DOWN, 0.96, [0.001, -0.009, 0.058], [0.0023, 0.0022, 0.0009],
        0.082, 80.0, 4096.0, 15.0, [-2.7, 2.7], 3.4;
    false, [0.0, 0.0, 0.17], UP, 0.79, [0.006, 0.017, 0.008], [0.001, 0.0008, 0.0009],
        0.061, 80.0, 4096.0, 12.0, [-1.9, 1.9], 3.4;
    false, [0.0, 0.062, 0.0], DOWN, 0.36, [0.003, 0.002, 0.031], [0.0003, 0.0003, 0.0002],
        0.038, 50.0, 4096.0, 8.0, [-2.9, 2.9], 3.8;
};

/// Shoulder, elbow and wrist turn about crossing axes, the elbow a little off.
pub(crate) const SEVEN: Arm = Arm {
    name: "seven",
    axes: &SEVEN_AXES,
    flange_m: [0.0, 0.0, 0.055],
};

/// Two joints in the plane, a slide that carries the weight, a turn about it.
pub(crate) const SLIDER: Arm = Arm {
    name: "slider",
    axes: &rows! {
        Axis {
            slides origin_m origin_rpy mass_kg centre_m inertia_kgm2
            armature ratio counts range reach speed
        }
        false, [0.0, 0.0, 0.31], ALIKE, 4.15, [0.142, 0.003, 0.021], [0.0122, 0.0571, 0.0603],
            0.62, 80.0, 10000.0, 62.0, [-2.2, 2.2], 3.4;
        false, [0.31, 0.0, 0.06], ALIKE, 3.08, [0.131, -0.004, 0.042], [0.0094, 0.0342, 0.0361],
            0.29, 50.0, 10000.0, 34.0, [-2.4, 2.4], 4.0;
        true, [0.26, 0.0, 0.02], OVER, 1.35, [0.002, 0.004, -0.07], [0.0052, 0.0052, 0.0004],
            6.4, 800.0, 10000.0, 110.0, [-0.12, 0.12], 0.7;
        false, [0.0, 0.0, 0.16], ALIKE, 0.52, [0.011, 0.002, 0.024], [0.0006, 0.0007, 0.0005],
            0.021, 30.0, 10000.0, 4.2, [-2.8, 2.8], 6.0;
    },
    flange_m: [0.0, 0.0, 0.05],
};

/// An arm with links of other lengths and masses: per link the factors of both, and one of its drives.
const fn other<const N: usize>(axes: [Axis; N], links: [[f64; 2]; N], drives: f64) -> [Axis; N] {
    let mut other = axes;
    let mut index = 0;
    // the origin of a joint is on the link before it
    let mut before = 1.0;
    while index < N {
        let [length, mass] = links[index];
        let axis = &mut other[index];
        axis.mass_kg *= mass;
        axis.armature *= drives;
        axis.range *= drives;
        let mut along = 0;
        while along < 3 {
            axis.origin_m[along] *= before;
            axis.centre_m[along] *= length;
            axis.inertia_kgm2[along] *= mass * length * length;
            along += 1;
        }
        before = length;
        index += 1;
    }
    other
}

const fn named(name: &'static str, axes: &'static [Axis], like: Arm) -> Arm {
    Arm {
        name,
        axes,
        flange_m: like.flange_m,
    }
}

const LONG_SIX: [Axis; 6] = other(
    SIX_AXES,
    [
        [1.1, 1.2],
        [1.35, 1.3],
        [0.8, 0.9],
        [1.4, 1.5],
        [1.0, 1.6],
        [1.0, 1.3],
    ],
    1.4,
);
const SMALL_SIX: [Axis; 6] = other(
    SIX_AXES,
    [
        [0.9, 0.6],
        [0.65, 0.55],
        [1.2, 0.7],
        [0.7, 0.5],
        [0.9, 0.7],
        [1.0, 0.6],
    ],
    0.8,
);
const STOUT_SIX: [Axis; 6] = other(
    SIX_AXES,
    [
        [1.0, 1.5],
        [0.8, 1.9],
        [1.3, 1.7],
        [0.7, 1.9],
        [1.2, 1.6],
        [1.0, 2.0],
    ],
    1.3,
);
const LONG_SEVEN: [Axis; 7] = other(
    SEVEN_AXES,
    [
        [1.1, 1.1],
        [1.3, 1.4],
        [1.3, 0.9],
        [1.4, 1.5],
        [1.2, 0.8],
        [1.0, 1.6],
        [1.0, 1.3],
    ],
    1.5,
);
const SMALL_SEVEN: [Axis; 7] = other(
    SEVEN_AXES,
    [
        [0.9, 0.7],
        [0.7, 0.5],
        [0.75, 0.8],
        [0.7, 0.6],
        [0.7, 0.6],
        [1.0, 0.5],
        [1.0, 0.7],
    ],
    0.8,
);
const STOUT_SEVEN: [Axis; 7] = other(
    SEVEN_AXES,
    [
        [1.0, 1.6],
        [0.8, 1.9],
        [1.3, 1.7],
        [0.75, 1.9],
        [1.3, 1.8],
        [0.9, 1.6],
        [1.0, 2.0],
    ],
    1.6,
);

/// Arms of six joints that are not [`SIX`].
pub(crate) static OTHER_SIX: [Arm; 3] = [
    named("long six", &LONG_SIX, SIX),
    named("small six", &SMALL_SIX, SIX),
    named("stout six", &STOUT_SIX, SIX),
];

/// Arms of seven joints that are not [`SEVEN`].
pub(crate) static OTHER_SEVEN: [Arm; 3] = [
    named("long seven", &LONG_SEVEN, SEVEN),
    named("small seven", &SMALL_SEVEN, SEVEN),
    named("stout seven", &STOUT_SEVEN, SEVEN),
];
