//! Folds a tile of rows into a triangle by Householder reflections, four at a time.
//!
//! Column j of `[R; B]`, R the triangle and B the tile, has one entry of R (its diagonal) and all of
//! B below the diagonal, so a reflection is H = I - tau v v^T with v = (1; s x), 1 in row j of R, x the
//! tile's column (LAPACK's dlarfg, with x left unscaled: s = 1 / (alpha - beta), alpha = R_jj,
//! beta = -sign(alpha) |(alpha; x)|, tau = (beta - alpha) / beta). Four of them act on the columns to
//! the right as I - V T^T V^T (Schreiber & Van Loan 1989): each column is read and written once for
//! four reflections. Nothing but R and Q^T r is carried; 2 (rows) k^2 operations for k columns.

use pulp::{Simd, WithSimd};

use crate::panel::{PANEL, Reflections, columns, sum_lanes};

/// A triangle and a tile to be folded into it.
#[derive(Debug)]
pub(crate) struct Fold<'a> {
    /// Column-major, `columns` rows, `columns + 1` columns; the last one is Q^T r.
    pub(crate) triangle: &'a mut [f64],
    /// Columns without the residual.
    pub(crate) columns: usize,
    /// Column-major, `columns + 1` columns; destroyed.
    pub(crate) tile: &'a mut [f64],
    /// Numbers from one column of the tile to the next.
    pub(crate) stride: usize,
    /// Rows of the tile, a multiple of twice the lanes.
    pub(crate) rows: usize,
}

impl WithSimd for Fold<'_> {
    /// Sum of squares of what no column of R explains.
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) -> f64 {
        let mut first = 0;
        while first + PANEL <= self.columns {
            self.panel::<S, PANEL>(simd, first);
            first += PANEL;
        }
        while first < self.columns {
            self.panel::<S, 1>(simd, first);
            first += 1;
        }
        let last = &self.tile[self.columns * self.stride..][..self.rows];
        dot::<S>(simd, S::as_simd_f64s(last).0)
    }
}

impl Fold<'_> {
    /// Makes W reflections from columns `first` on and applies them to the columns to the right.
    #[inline(always)]
    fn panel<S: Simd, const W: usize>(&mut self, simd: S, first: usize) {
        let (height, stride, rows) = (self.columns, self.stride, self.rows);
        let (own, rest) = self.tile[first * stride..].split_at_mut(W * stride);
        let reflections = Reflections::<W>::new::<S>(
            simd,
            &mut self.triangle[first * height..(first + W) * height],
            (first, height),
            (own, stride, rows),
        );
        let own = columns::<S, W>(own, stride, rows);
        let mut right = Right {
            tops: self.triangle[(first + W) * height..].chunks_exact_mut(height),
            bottoms: rest.chunks_mut(stride),
            own_rows: first..first + W,
            rows,
        };
        // pairs, and three at the end of an odd number, as one alone takes as long as two
        let count = height + 1 - (first + W);
        let last = if count < 3 || count.is_multiple_of(2) {
            count % 2
        } else {
            3
        };
        // The processor works on the next pair's products while the last one's few numbers go through
        // the reflections, which takes long and occupies it little.
        let mut waiting: Option<Group<'_, S, W, 2>> = None;
        for _ in 0..(count - last) / 2 {
            let Some(mut group) = right.next::<S, W, 2>() else {
                return;
            };
            let sums = dots::<S, W, 2>(simd, own, &group.bottoms);
            if let Some(waiting) = waiting {
                subtract::<S, W, 2>(simd, own, waiting);
            }
            group.factors = act_on(&reflections, &mut group.tops, sums);
            waiting = Some(group);
        }
        if let Some(waiting) = waiting {
            subtract::<S, W, 2>(simd, own, waiting);
        }
        match last {
            3 => apply::<S, W, 3>(&reflections, simd, own, right.next()),
            1 => apply::<S, W, 1>(&reflections, simd, own, right.next()),
            _ => {}
        }
    }
}

/// The columns to the right of a panel.
struct Right<'a> {
    tops: std::slice::ChunksExactMut<'a, f64>,
    bottoms: std::slice::ChunksMut<'a, f64>,
    own_rows: std::ops::Range<usize>,
    rows: usize,
}

/// N columns that are worked on together.
struct Group<'a, S: Simd, const W: usize, const N: usize> {
    /// Their entries of R in the panel's rows.
    tops: [&'a mut [f64]; N],
    bottoms: [&'a mut [S::f64s]; N],
    /// What of each x is to be subtracted.
    factors: [[f64; W]; N],
}

impl<'a> Right<'a> {
    #[inline(always)]
    fn next<S: Simd, const W: usize, const N: usize>(&mut self) -> Option<Group<'a, S, W, N>> {
        let mut group = Group {
            tops: std::array::from_fn(|_| &mut [][..]),
            bottoms: std::array::from_fn(|_| &mut [][..]),
            factors: [[0.0; W]; N],
        };
        for n in 0..N {
            group.tops[n] = &mut self.tops.next()?[self.own_rows.clone()];
            group.bottoms[n] = S::as_mut_simd_f64s(&mut self.bottoms.next()?[..self.rows]).0;
        }
        Some(group)
    }
}

#[inline(always)]
fn dot<S: Simd>(simd: S, x: &[S::f64s]) -> f64 {
    let mut sums = [simd.splat_f64s(0.0); 2];
    for pair in x.chunks_exact(2) {
        sums[0] = simd.mul_add_e_f64s(pair[0], pair[0], sums[0]);
        sums[1] = simd.mul_add_e_f64s(pair[1], pair[1], sums[1]);
    }
    simd.reduce_sum_f64s(simd.add_f64s(sums[0], sums[1]))
}

/// Products of each of N columns with each x.
#[inline(always)]
fn dots<S: Simd, const W: usize, const N: usize>(
    simd: S,
    own: [&[S::f64s]; W],
    columns: &[&mut [S::f64s]; N],
) -> [[f64; W]; N] {
    let rows = own[0].len();
    let mut sums = [[simd.splat_f64s(0.0); W]; N];
    let same = own.iter().all(|x| x.len() == rows) && columns.iter().all(|c| c.len() == rows);
    assert!(same, "columns of one tile");
    for row in 0..rows {
        for n in 0..N {
            let entry = columns[n][row];
            for p in 0..W {
                sums[n][p] = simd.mul_add_e_f64s(own[p][row], entry, sums[n][p]);
            }
        }
    }
    let mut made = [[0.0; W]; N];
    for n in 0..N {
        made[n] = sum_lanes::<S, W>(simd, [sums[n], [simd.splat_f64s(0.0); W]]);
    }
    made
}

/// Subtracts from each of N columns `factors[n][p]` of each x.
#[inline(always)]
fn subtract<S: Simd, const W: usize, const N: usize>(
    simd: S,
    own: [&[S::f64s]; W],
    group: Group<'_, S, W, N>,
) {
    let Group {
        bottoms: columns,
        factors,
        ..
    } = group;
    let rows = own[0].len();
    let same = own.iter().all(|x| x.len() == rows) && columns.iter().all(|c| c.len() == rows);
    assert!(same, "columns of one tile");
    let mut minus = [[simd.splat_f64s(0.0); W]; N];
    for n in 0..N {
        for p in 0..W {
            minus[n][p] = simd.splat_f64s(-factors[n][p]);
        }
    }
    for row in 0..rows {
        for n in 0..N {
            let mut entry = columns[n][row];
            for p in 0..W {
                entry = simd.mul_add_e_f64s(minus[n][p], own[p][row], entry);
            }
            columns[n][row] = entry;
        }
    }
}

/// Acts on the last columns.
#[inline(always)]
fn apply<S: Simd, const W: usize, const N: usize>(
    reflections: &Reflections<W>,
    simd: S,
    own: [&[S::f64s]; W],
    group: Option<Group<'_, S, W, N>>,
) {
    if let Some(mut group) = group {
        let sums = dots::<S, W, N>(simd, own, &group.bottoms);
        group.factors = act_on(reflections, &mut group.tops, sums);
        subtract::<S, W, N>(simd, own, group);
    }
}

#[inline(always)]
fn act_on<const W: usize, const N: usize>(
    reflections: &Reflections<W>,
    tops: &mut [&mut [f64]; N],
    sums: [[f64; W]; N],
) -> [[f64; W]; N] {
    let mut factors = [[0.0; W]; N];
    for n in 0..N {
        factors[n] = reflections.act(tops[n], sums[n]);
    }
    factors
}
