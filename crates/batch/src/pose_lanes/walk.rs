//! The two passes over a tile of postures: sines and cosines, then the walk along the chain.
//!
//! On the walk a joint's axis and a point of it go to the places of its Jacobian column; when the end is
//! known, the point becomes the velocity there. No closures: the compiler leaves them calls, without the
//! lanes' instructions.

use haptical_kinematics::ChainConstants;
use haptical_kinematics::nalgebra::Vector3;
use pulp::Simd;

use crate::trigonometry::{LARGEST_RAD, sine_cosine};

/// Postures of a block: a cache line of each number.
pub(super) const BLOCK: usize = 8;
/// Postures whose sines are worked out before the walk: they and the results fit the first-level cache.
pub(super) const TILE: usize = 32;
/// Numbers of a pose: position, then the axes x, y, z.
pub(super) const POSE: usize = 12;
/// Numbers of a Jacobian column: linear, then angular.
pub(super) const COLUMN: usize = 6;

/// Sines and cosines of a tile's turns; whether all its variables are in the lanes' range.
#[inline(always)]
pub(super) fn turns<S: Simd, const JOINTS: usize>(
    simd: S,
    constants: &ChainConstants<JOINTS>,
    variables: &[f64],
    sines: &mut [f64],
    cosines: &mut [f64],
) -> bool {
    let (zero, one) = (simd.splat_f64s(0.0), simd.splat_f64s(1.0));
    let limit = simd.splat_f64s(LARGEST_RAD);
    let mut beyond = zero;
    for joint in 0..JOINTS {
        let constant = &constants.joints[joint];
        let variables = S::as_simd_f64s(&variables[joint * TILE..][..TILE]).0;
        let sines = S::as_mut_simd_f64s(&mut sines[joint * TILE..][..TILE]).0;
        let cosines = S::as_mut_simd_f64s(&mut cosines[joint * TILE..][..TILE]).0;
        let offset = simd.splat_f64s(constant.offset_rad);
        let share = if constant.is_prismatic { zero } else { one };
        for ((&variable, sine), cosine) in variables.iter().zip(sines).zip(cosines) {
            // counts what is not within the limit, so that a NaN is beyond it too
            let is_served = simd.less_than_or_equal_f64s(simd.abs_f64s(variable), limit);
            beyond = simd.add_f64s(beyond, simd.select_f64s(is_served, zero, one));
            let angle = simd.mul_add_e_f64s(variable, share, offset);
            (*sine, *cosine) = sine_cosine(simd, angle);
        }
    }
    simd.reduce_sum_f64s(beyond) == 0.0
}

/// The frame's axes and origin.
struct Frame<V> {
    x: [V; 3],
    y: [V; 3],
    z: [V; 3],
    origin: [V; 3],
}

/// Turns two axes in their plane, the first towards the second.
#[inline(always)]
fn turn<S: Simd>(
    simd: S,
    first: &mut [S::f64s; 3],
    second: &mut [S::f64s; 3],
    sine: S::f64s,
    cosine: S::f64s,
) {
    for row in 0..3 {
        let (f, s) = (first[row], second[row]);
        first[row] = simd.mul_add_e_f64s(f, cosine, simd.mul_f64s(s, sine));
        let back = simd.neg_f64s(simd.mul_f64s(f, sine));
        second[row] = simd.mul_add_e_f64s(s, cosine, back);
    }
}

/// Moves a point along an axis.
#[inline(always)]
fn slide<S: Simd>(simd: S, point: &mut [S::f64s; 3], axis: &[S::f64s; 3], length: S::f64s) {
    for row in 0..3 {
        point[row] = simd.mul_add_e_f64s(axis[row], length, point[row]);
    }
}

/// One number in all lanes, three times.
#[inline(always)]
fn splat<S: Simd>(simd: S, vector: Vector3<f64>) -> [S::f64s; 3] {
    [
        simd.splat_f64s(vector.x),
        simd.splat_f64s(vector.y),
        simd.splat_f64s(vector.z),
    ]
}

/// Three numbers that are `apart` entries from each other.
#[inline(always)]
fn load<V: Copy>(from: &[V], at: usize, apart: usize) -> [V; 3] {
    [from[at], from[at + apart], from[at + 2 * apart]]
}

#[inline(always)]
fn store<V: Copy>(into: &mut [V], at: usize, apart: usize, vector: [V; 3]) {
    [into[at], into[at + apart], into[at + 2 * apart]] = vector;
}

/// `axis` x (`end` - `point`)
#[inline(always)]
fn velocity<S: Simd>(
    simd: S,
    axis: [S::f64s; 3],
    end: [S::f64s; 3],
    point: [S::f64s; 3],
) -> [S::f64s; 3] {
    let (x, y, z) = (
        simd.sub_f64s(end[0], point[0]),
        simd.sub_f64s(end[1], point[1]),
        simd.sub_f64s(end[2], point[2]),
    );
    let [u, v, w] = axis;
    [
        simd.mul_add_e_f64s(v, z, simd.neg_f64s(simd.mul_f64s(w, y))),
        simd.mul_add_e_f64s(w, x, simd.neg_f64s(simd.mul_f64s(u, z))),
        simd.mul_add_e_f64s(u, y, simd.neg_f64s(simd.mul_f64s(v, x))),
    ]
}

/// Pose and Jacobian of a block of postures.
#[inline(always)]
pub(super) fn walk<S: Simd, const JOINTS: usize>(
    simd: S,
    constants: &ChainConstants<JOINTS>,
    [variables, sines, cosines]: [&[f64]; 3],
    block: usize,
    numbers: &mut [f64],
) {
    // entries from one number to the next
    let apart = BLOCK / S::F64_LANES;
    let numbers = S::as_mut_simd_f64s(numbers).0;
    let variables = S::as_simd_f64s(&variables[..JOINTS * TILE]).0;
    let sines = S::as_simd_f64s(&sines[..JOINTS * TILE]).0;
    let cosines = S::as_simd_f64s(&cosines[..JOINTS * TILE]).0;
    let rotation = &constants.start.rotation;
    for index in 0..apart {
        let mut frame = Frame {
            x: splat(simd, rotation.column(0).into_owned()),
            y: splat(simd, rotation.column(1).into_owned()),
            z: splat(simd, rotation.column(2).into_owned()),
            origin: splat(simd, constants.start.position_m),
        };
        for joint in 0..JOINTS {
            let constant = &constants.joints[joint];
            let of_joint = (joint * TILE + block) / S::F64_LANES + index;
            let at = (POSE + COLUMN * joint) * apart + index;
            store(numbers, at, apart, frame.origin);
            store(numbers, at + 3 * apart, apart, frame.z);
            if constant.is_prismatic {
                slide(simd, &mut frame.origin, &frame.z, variables[of_joint]);
            }
            let (sine, cosine) = (sines[of_joint], cosines[of_joint]);
            turn(simd, &mut frame.x, &mut frame.y, sine, cosine);
            let (x_m, y_m) = (simd.splat_f64s(constant.x_m), simd.splat_f64s(constant.y_m));
            slide(simd, &mut frame.origin, &frame.x, x_m);
            slide(simd, &mut frame.origin, &frame.y, y_m);
            let sine = simd.splat_f64s(constant.twist_sine);
            let cosine = simd.splat_f64s(constant.twist_cosine);
            turn(simd, &mut frame.y, &mut frame.z, sine, cosine);
        }
        let sine = simd.splat_f64s(constants.end_sine);
        let cosine = simd.splat_f64s(constants.end_cosine);
        turn(simd, &mut frame.x, &mut frame.y, sine, cosine);
        store(numbers, index, apart, frame.origin);
        store(numbers, 3 * apart + index, apart, frame.x);
        store(numbers, 6 * apart + index, apart, frame.y);
        store(numbers, 9 * apart + index, apart, frame.z);
        for joint in 0..JOINTS {
            let at = (POSE + COLUMN * joint) * apart + index;
            let axis = load(numbers, at + 3 * apart, apart);
            if constants.joints[joint].is_prismatic {
                store(numbers, at, apart, axis);
                let zero = [simd.splat_f64s(0.0); 3];
                store(numbers, at + 3 * apart, apart, zero);
            } else {
                let point = load(numbers, at, apart);
                let linear = velocity(simd, axis, frame.origin, point);
                store(numbers, at, apart, linear);
            }
        }
    }
}
