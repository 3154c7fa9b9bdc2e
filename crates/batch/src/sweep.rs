//! Residuals and derivatives of a tile by one sweep along the chain and one back.
//!
//! From the end to the base: v, the vector from a frame's origin to the handle in that frame, goes
//! through one elementary motion after the other, v <- v + value e for a slide along e, v <- R v for a
//! turn; the coordinates that a turn changes are kept. At the base v is the handle's position,
//! delta = |v - anchor| (Baser & Konukseven eq. (5)) and the gradient of w delta with respect to v is
//! g = w (v - anchor) / delta. From the base to the end: the derivative with respect to a slide along e
//! is g . e, with respect to a turn about e it is g . (e x v) with v as it was after the turn; then
//! g <- R^T g. (Reverse mode; the transposes are those of docs/equations.md, "Distance derivative".)

use pulp::Simd;

use crate::poses::Columns;
use crate::program::{Action, Angle, Program, Source, plane};
use haptical_linalg::{Aligned, TILE_ROWS};

/// Rows of a sweep, always all of them, so that the compiler knows the lengths of its loops; what is
/// kept on the way fits the first-level cache next to the tile.
pub(crate) const SWEEP_ROWS: usize = 64;

/// Room of a sweep.
#[derive(Debug, Default)]
pub(crate) struct SweepRoom {
    slots: Aligned,
    angles: Aligned,
    gradient: Aligned,
}

/// A row of the tile without a usable distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct BadRow {
    pub(crate) row: usize,
    pub(crate) is_zero: bool,
}

/// What a sweep reads.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tile<'a> {
    pub(crate) program: &'a Program,
    pub(crate) columns: &'a Columns,
    pub(crate) data: &'a [f64],
    /// Rows with a pose.
    pub(crate) rows: usize,
}

impl SweepRoom {
    pub(crate) fn reserve(&mut self, program: &Program) {
        self.slots.reserve(program.slots * SWEEP_ROWS);
        self.angles.reserve(program.angle_slots * SWEEP_ROWS);
        self.gradient.reserve(3 * SWEEP_ROWS);
    }
}

/// Writes weighted residuals to `residuals` and, where `derivatives` has room, all columns of the
/// program, column k from `k * TILE_ROWS` on. Rows that fill up a sweep get zeros.
#[inline(always)]
pub(crate) fn sweep_tile<S: Simd>(
    simd: S,
    tile: &Tile<'_>,
    room: &mut SweepRoom,
    residuals: &mut [f64],
    mut derivatives: Option<&mut [f64]>,
) -> Result<(), BadRow> {
    let mut first = 0;
    while first < tile.rows {
        let part = Part { tile, first };
        towards_base(simd, &part, room);
        distance(simd, &part, room, &mut residuals[first..])?;
        if let Some(derivatives) = derivatives.as_deref_mut() {
            towards_end(simd, &part, room, derivatives);
        }
        first += SWEEP_ROWS;
    }
    Ok(())
}

/// Some rows of a tile, from `first` on.
struct Part<'a> {
    tile: &'a Tile<'a>,
    first: usize,
}

impl Part<'_> {
    /// A column of the batch.
    #[inline(always)]
    fn column<S: Simd>(&self, column: usize) -> &[S::f64s] {
        lanes::<S>(self.tile.data, column * TILE_ROWS + self.first)
    }
}

#[inline(always)]
fn lanes<S: Simd>(from: &[f64], first: usize) -> &[S::f64s] {
    S::as_simd_f64s(&from[first..][..SWEEP_ROWS]).0
}

#[inline(always)]
fn lanes_mut<S: Simd>(from: &mut [f64], first: usize) -> &mut [S::f64s] {
    S::as_mut_simd_f64s(&mut from[first..][..SWEEP_ROWS]).0
}

#[inline(always)]
fn towards_base<S: Simd>(simd: S, part: &Part<'_>, room: &mut SweepRoom) {
    let slots = room.slots.as_mut_slice();
    for step in part.tile.program.steps.iter().rev() {
        match step.action {
            Action::Constant => {}
            Action::Joint { joint, from, to } => {
                let variable = part.column::<S>(part.tile.columns.joints[joint]);
                let (before, at) = slots.split_at_mut(to * SWEEP_ROWS);
                let (source, offset) = source::<S>(simd, before, from);
                let to = lanes_mut::<S>(at, 0);
                for ((to, &from), &q) in to.iter_mut().zip(source).zip(variable) {
                    *to = simd.add_f64s(simd.add_f64s(from, offset), q);
                }
            }
            Action::Turn {
                first,
                second,
                angle,
                to,
            } => {
                let (before, at) = slots.split_at_mut(to * SWEEP_ROWS);
                let (first, first_offset) = source::<S>(simd, before, first);
                let (second, second_offset) = source::<S>(simd, before, second);
                let (to_first, to_second) = at.split_at_mut(SWEEP_ROWS);
                let to_first = lanes_mut::<S>(to_first, 0);
                let to_second = lanes_mut::<S>(to_second, 0);
                let from = first.iter().zip(second);
                let into = to_first.iter_mut().zip(to_second);
                match angle {
                    Angle::Constant { sine, cosine } => {
                        let (s, c) = (simd.splat_f64s(sine), simd.splat_f64s(cosine));
                        for ((&p, &q), (to_p, to_q)) in from.zip(into) {
                            let p = simd.add_f64s(p, first_offset);
                            let q = simd.add_f64s(q, second_offset);
                            (*to_p, *to_q) = turn(simd, s, c, p, q);
                        }
                    }
                    Angle::Joint { slot, .. } => {
                        angles(simd, part, angle, room.angles.as_mut_slice());
                        let at = room.angles.as_slice();
                        let sines = lanes::<S>(at, slot * SWEEP_ROWS);
                        let cosines = lanes::<S>(at, (slot + 1) * SWEEP_ROWS);
                        let turns = sines.iter().zip(cosines);
                        for (((&p, &q), (to_p, to_q)), (&s, &c)) in from.zip(into).zip(turns) {
                            let p = simd.add_f64s(p, first_offset);
                            let q = simd.add_f64s(q, second_offset);
                            (*to_p, *to_q) = turn(simd, s, c, p, q);
                        }
                    }
                }
            }
        }
    }
}

/// A coordinate of v without its constant slides, and these.
#[inline(always)]
fn source<S: Simd>(simd: S, slots: &[f64], from: Source) -> (&[S::f64s], S::f64s) {
    (
        lanes::<S>(slots, from.slot * SWEEP_ROWS),
        simd.splat_f64s(from.offset_m),
    )
}

/// (c p - s q, s p + c q)
#[inline(always)]
fn turn<S: Simd>(simd: S, s: S::f64s, c: S::f64s, p: S::f64s, q: S::f64s) -> (S::f64s, S::f64s) {
    (
        simd.mul_add_e_f64s(c, p, simd.neg_f64s(simd.mul_f64s(s, q))),
        simd.mul_add_e_f64s(c, q, simd.mul_f64s(s, p)),
    )
}

/// Sines and cosines of a joint's whole angle into their slots.
#[inline(always)]
fn angles<S: Simd>(simd: S, part: &Part<'_>, angle: Angle, into: &mut [f64]) {
    let Angle::Joint {
        joint,
        sine,
        cosine,
        slot,
    } = angle
    else {
        return;
    };
    let (sines, cosines) = into[slot * SWEEP_ROWS..].split_at_mut(SWEEP_ROWS);
    let cosines = &mut cosines[..SWEEP_ROWS];
    let column = part.tile.columns.joints[joint];
    let (s, c) = (simd.splat_f64s(sine), simd.splat_f64s(cosine));
    let own = part
        .column::<S>(column)
        .iter()
        .zip(part.column::<S>(column + 1));
    let sines = S::as_mut_simd_f64s(sines).0.iter_mut();
    let cosines = S::as_mut_simd_f64s(cosines).0.iter_mut();
    for ((&own_s, &own_c), (to_s, to_c)) in own.zip(sines.zip(cosines)) {
        (*to_c, *to_s) = turn(simd, s, c, own_c, own_s);
    }
}

/// Residuals, and the gradient at the base.
#[inline(always)]
fn distance<S: Simd>(
    simd: S,
    part: &Part<'_>,
    room: &mut SweepRoom,
    residuals: &mut [f64],
) -> Result<(), BadRow> {
    let slots = room.slots.as_slice();
    let [x, y, z] = part.tile.program.end;
    let (x, y, z) = (
        source::<S>(simd, slots, x),
        source::<S>(simd, slots, y),
        source::<S>(simd, slots, z),
    );
    let (gx, rest) = room.gradient.as_mut_slice().split_at_mut(SWEEP_ROWS);
    let (gy, gz) = rest.split_at_mut(SWEEP_ROWS);
    let (gx, gy) = (lanes_mut::<S>(gx, 0), lanes_mut::<S>(gy, 0));
    let gz = lanes_mut::<S>(gz, 0);
    let measured = part.column::<S>(part.tile.columns.distance);
    let weights = part.column::<S>(part.tile.columns.weight);
    let residuals = lanes_mut::<S>(residuals, 0);
    let mut least = simd.splat_f64s(f64::INFINITY);
    // 0 times what is not finite is NaN, and stays it
    let mut unsound = simd.splat_f64s(0.0);
    for index in 0..SWEEP_ROWS / S::F64_LANES {
        let px = simd.add_f64s(x.0[index], x.1);
        let py = simd.add_f64s(y.0[index], y.1);
        let pz = simd.add_f64s(z.0[index], z.1);
        let square =
            simd.mul_add_e_f64s(pz, pz, simd.mul_add_e_f64s(py, py, simd.mul_f64s(px, px)));
        least = simd.min_f64s(least, square);
        unsound = simd.mul_add_e_f64s(square, simd.splat_f64s(0.0), unsound);
        let delta = simd.sqrt_f64s(square);
        let factor = simd.div_f64s(weights[index], delta);
        gx[index] = simd.mul_f64s(factor, px);
        gy[index] = simd.mul_f64s(factor, py);
        gz[index] = simd.mul_f64s(factor, pz);
        residuals[index] = simd.mul_f64s(weights[index], simd.sub_f64s(delta, measured[index]));
    }
    let sound = simd.reduce_sum_f64s(unsound) == 0.0;
    if sound && simd.reduce_min_f64s(least) >= SHORTEST_SQUARE {
        return Ok(());
    }
    Err(bad_row(part, slots))
}

/// Square of a distance below which the gradient's factor 1/delta would lose digits or overflow.
const SHORTEST_SQUARE: f64 = f64::MIN_POSITIVE;

/// The first row whose distance cannot be used.
#[cold]
fn bad_row(part: &Part<'_>, slots: &[f64]) -> BadRow {
    let square = |row: usize| -> f64 {
        let end = part.tile.program.end;
        let part = end.map(|end| (slots[end.slot * SWEEP_ROWS + row] + end.offset_m).powi(2));
        part[0] + part[1] + part[2]
    };
    let bad =
        (0..SWEEP_ROWS).find(|&row| !(square(row) >= SHORTEST_SQUARE && square(row).is_finite()));
    let row = bad.unwrap_or(0);
    BadRow {
        // a row that fills up the tile repeats the last pose
        row: (part.first + row).min(part.tile.rows - 1),
        is_zero: square(row) < SHORTEST_SQUARE,
    }
}

#[inline(always)]
fn towards_end<S: Simd>(simd: S, part: &Part<'_>, room: &mut SweepRoom, derivatives: &mut [f64]) {
    let (gx, rest) = room.gradient.as_mut_slice().split_at_mut(SWEEP_ROWS);
    let (gy, gz) = rest.split_at_mut(SWEEP_ROWS);
    let mut gradient = [
        lanes_mut::<S>(gx, 0),
        lanes_mut::<S>(gy, 0),
        lanes_mut::<S>(gz, 0),
    ];
    let program = part.tile.program;
    let (slots, angles) = (room.slots.as_slice(), room.angles.as_slice());
    for step in &program.steps[..program.differentiated] {
        let column = step
            .column
            .map(|column| lanes_mut::<S>(derivatives, column * TILE_ROWS + part.first));
        let Action::Turn { angle, to, .. } = step.action else {
            if let Some(column) = column {
                // adding zero keeps this a loop: the compiler makes a plain copy a call
                let zero = simd.splat_f64s(0.0);
                for (column, &g) in column.iter_mut().zip(gradient[step.axis].iter()) {
                    *column = simd.add_f64s(g, zero);
                }
            }
            continue;
        };
        let (g_first, g_second) = two_of(&mut gradient, step.axis);
        if let Some(column) = column {
            let first = lanes::<S>(slots, to * SWEEP_ROWS);
            let second = lanes::<S>(slots, (to + 1) * SWEEP_ROWS);
            let gradient = g_first.iter().zip(g_second.iter());
            let vector = first.iter().zip(second);
            for ((column, (&gp, &gq)), (&p, &q)) in column.iter_mut().zip(gradient).zip(vector) {
                *column = simd.mul_add_e_f64s(gq, p, simd.neg_f64s(simd.mul_f64s(gp, q)));
            }
        }
        let gradient = g_first.iter_mut().zip(g_second.iter_mut());
        // the other way round: R^T
        match angle {
            Angle::Constant { sine, cosine } => {
                let (s, c) = (simd.splat_f64s(sine), simd.splat_f64s(cosine));
                for (gp, gq) in gradient {
                    (*gq, *gp) = turn(simd, s, c, *gq, *gp);
                }
            }
            Angle::Joint { slot, .. } => {
                let sines = lanes::<S>(angles, slot * SWEEP_ROWS);
                let cosines = lanes::<S>(angles, (slot + 1) * SWEEP_ROWS);
                for ((gp, gq), (&s, &c)) in gradient.zip(sines.iter().zip(cosines)) {
                    (*gq, *gp) = turn(simd, s, c, *gq, *gp);
                }
            }
        }
    }
}

/// The coordinates in the plane of a turn.
#[inline(always)]
fn two_of<'g, T>(gradient: &'g mut [&mut [T]; 3], axis: usize) -> (&'g mut [T], &'g mut [T]) {
    let [x, y, z] = gradient;
    match plane(axis) {
        (1, 2) => (y, z),
        (2, 0) => (z, x),
        _ => (x, y),
    }
}
