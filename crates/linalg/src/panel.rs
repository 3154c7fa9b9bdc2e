//! Makes the reflections of a panel of columns, and acts with them on the few entries of R.
//!
//! The notation is that of the `fold` module.

use pulp::Simd;

/// Reflections that act together.
pub(crate) const PANEL: usize = 4;

/// W reflections as I - V T^T V^T.
pub(crate) struct Reflections<const W: usize> {
    /// The factor of x in each v; 0 for a column that is zero already.
    s: [f64; W],
    /// Upper triangle of T, by columns.
    t: [[f64; W]; W],
}

impl<const W: usize> Reflections<W> {
    /// Makes them from the panel's own columns, which are left as the x of the reflections.
    #[inline(always)]
    pub(crate) fn new<S: Simd>(
        simd: S,
        top: &mut [f64],
        (first, height): (usize, usize),
        (own, stride, rows): (&mut [f64], usize, usize),
    ) -> Self {
        let mut panel = Panel::<S, W> {
            simd,
            top,
            first,
            height,
            own,
            stride,
            rows,
            made: Self {
                s: [0.0; W],
                t: [[0.0; W]; W],
            },
            products: [0.0; W],
        };
        panel.first_products();
        panel.round::<0>();
        // the others do nothing in a panel of one
        if W == PANEL {
            panel.round::<1>();
            panel.round::<2>();
            panel.round::<3>();
        }
        panel.made
    }

    /// Acts on the entries of R of one column; `sums` are the products of its part of the tile with
    /// each x. Returns what of each x is to be subtracted there.
    #[inline(always)]
    pub(crate) fn act(&self, top: &mut [f64], sums: [f64; W]) -> [f64; W] {
        let mut w = [0.0; W];
        for p in 0..W {
            w[p] = top[p] + self.s[p] * sums[p];
        }
        let mut factors = [0.0; W];
        for p in 0..W {
            let mut z = 0.0;
            for i in 0..=p {
                z += self.t[p][i] * w[i];
            }
            top[p] -= z;
            factors[p] = self.s[p] * z;
        }
        factors
    }
}

/// Sum of squares of a column of the tile that counts as zero. Where rows depend on each other, rounding leaves
/// columns of 1e-17, then 1e-34 and so on of the rows' size; products of their scales would overflow.
const NEGLIGIBLE_SQUARE: f64 = 1e-280;

/// A panel on its way to reflections.
struct Panel<'a, S: Simd, const W: usize> {
    simd: S,
    /// The panel's columns of R.
    top: &'a mut [f64],
    first: usize,
    height: usize,
    own: &'a mut [f64],
    stride: usize,
    rows: usize,
    made: Reflections<W>,
    /// Products of the current column with every column of the panel.
    products: [f64; W],
}

impl<S: Simd, const W: usize> Panel<'_, S, W> {
    /// Makes the reflection of column P, applies it to the panel's later columns, and multiplies the
    /// next one with all.
    #[inline(always)]
    fn round<const P: usize>(&mut self) {
        let (first, height) = (self.first, self.height);
        let (made, products) = (&mut self.made, &self.products);
        let alpha = self.top[P * height + first + P];
        let square = products[P];
        let mut factors = [0.0; W];
        // a NaN goes on, to be found in R
        let is_negligible = square < NEGLIGIBLE_SQUARE;
        if !is_negligible {
            let norm = (alpha * alpha + square).sqrt();
            let beta = if alpha >= 0.0 { -norm } else { norm };
            let s = 1.0 / (alpha - beta);
            let tau = (beta - alpha) / beta;
            made.s[P] = s;
            made.t[P][P] = tau;
            self.top[P * height + first + P] = beta;
            for q in P + 1..W {
                let entry = &mut self.top[q * height + first + P];
                let change = tau * (*entry + s * products[q]);
                *entry -= change;
                factors[q] = s * change;
            }
            for i in 0..P {
                let mut sum = 0.0;
                for l in i..P {
                    sum += made.t[l][i] * (made.s[l] * s * products[l]);
                }
                made.t[P][i] = -tau * sum;
            }
        }
        if P + 1 < W {
            self.update_and_multiply::<P>(factors);
        }
    }

    /// Products of the first column with all.
    #[inline(always)]
    fn first_products(&mut self) {
        let simd = self.simd;
        let own = columns::<S, W>(self.own, self.stride, self.rows);
        let mut sums = [[simd.splat_f64s(0.0); W]; 2];
        let mut row = 0;
        while row + 1 < own[0].len() {
            for half in 0..2 {
                let x = own[0][row + half];
                for q in 0..W {
                    sums[half][q] = simd.mul_add_e_f64s(x, own[q][row + half], sums[half][q]);
                }
            }
            row += 2;
        }
        self.products = sum_lanes::<S, W>(simd, sums);
    }

    /// Subtracts `factors[q]` of column P from the columns q after it; products of column P + 1, as it
    /// is then, with every column.
    #[inline(always)]
    fn update_and_multiply<const P: usize>(&mut self, factors: [f64; W]) {
        let simd = self.simd;
        let mut minus = [simd.splat_f64s(0.0); W];
        for q in 0..W {
            minus[q] = simd.splat_f64s(-factors[q]);
        }
        let own = columns_mut::<S, W>(self.own, self.stride, self.rows);
        let mut sums = [[simd.splat_f64s(0.0); W]; 2];
        let mut row = 0;
        while row + 1 < own[0].len() {
            for half in 0..2 {
                let at = row + half;
                let x = own[P][at];
                let mut now = [x; W];
                for q in 0..W {
                    now[q] = own[q][at];
                    if q > P {
                        now[q] = simd.mul_add_e_f64s(minus[q], x, now[q]);
                        own[q][at] = now[q];
                    }
                }
                for q in 0..W {
                    sums[half][q] = simd.mul_add_e_f64s(now[P + 1], now[q], sums[half][q]);
                }
            }
            row += 2;
        }
        self.products = sum_lanes::<S, W>(simd, sums);
    }
}

/// The first `rows` rows of W columns.
#[inline(always)]
pub(crate) fn columns<S: Simd, const W: usize>(
    from: &[f64],
    stride: usize,
    rows: usize,
) -> [&[S::f64s]; W] {
    let mut made = [&[][..]; W];
    for (made, column) in made.iter_mut().zip(from.chunks(stride)) {
        *made = S::as_simd_f64s(&column[..rows]).0;
    }
    let length = made[0].len();
    for made in &mut made {
        *made = &made[..length];
    }
    made
}

/// As [`columns`], to be written.
#[inline(always)]
fn columns_mut<S: Simd, const W: usize>(
    from: &mut [f64],
    stride: usize,
    rows: usize,
) -> [&mut [S::f64s]; W] {
    let mut made: [&mut [S::f64s]; W] = std::array::from_fn(|_| &mut [][..]);
    for (made, column) in made.iter_mut().zip(from.chunks_mut(stride)) {
        *made = S::as_mut_simd_f64s(&mut column[..rows]).0;
    }
    let length = made[0].len();
    for made in &mut made {
        *made = &mut std::mem::take(made)[..length];
    }
    made
}

/// The sums of the lanes of the two halves' registers.
#[inline(always)]
pub(crate) fn sum_lanes<S: Simd, const W: usize>(simd: S, halves: [[S::f64s; W]; 2]) -> [f64; W] {
    let mut sums = [0.0; W];
    for p in 0..W {
        sums[p] = simd.reduce_sum_f64s(simd.add_f64s(halves[0][p], halves[1][p]));
    }
    sums
}
