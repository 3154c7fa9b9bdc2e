//! Eq. (2), corrected, without its elementary functions: what every form of the parallelogram's error uses.

/// A triangle inequality of the loop must hold by this part of the triangle's perimeter: nearer to a
/// line the derivatives, which grow with the inverse of the area, hold fewer than half the digits.
pub(crate) const SINGULAR_MARGIN: f64 = 1e-9;

/// A four-bar loop A-B-C-E, its lengths over the longest: squares of very small or large lengths would lose
/// digits or overflow. The module of [`Parallelogram`](crate::Parallelogram) derives the formulas. Usable in
/// constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FourBar {
    lengths: [f64; 4],
}

impl FourBar {
    /// Part of the perimeter by which every triangle inequality must hold.
    pub const SINGULAR_MARGIN: f64 = SINGULAR_MARGIN;

    /// A loop of positive lengths AB, BC, CE, EA, and the longest of them in m.
    #[must_use]
    pub const fn new(lengths_m: [f64; 4]) -> (Self, f64) {
        let mut longest_m = 0.0;
        let mut bar = 0;
        while bar < 4 {
            if lengths_m[bar] > longest_m {
                longest_m = lengths_m[bar];
            }
            bar += 1;
        }
        let [l1, l2, l3, l4] = lengths_m;
        let lengths = [
            l1 / longest_m,
            l2 / longest_m,
            l3 / longest_m,
            l4 / longest_m,
        ];
        (Self { lengths }, longest_m)
    }

    /// Lengths AB, BC, CE, EA over the longest.
    #[must_use]
    pub const fn lengths(&self) -> [f64; 4] {
        self.lengths
    }

    /// Triangle ABC, of which two sides and the angle between them are given: `[u, v]` with the diagonal
    /// `s^2 = u^2 + v^2` and `alpha = atan2(v, u)`, from the input angle's sine and cosine.
    #[inline]
    #[must_use]
    pub const fn corner(&self, (sine, cosine): (f64, f64)) -> [f64; 2] {
        let [l1, l2, _, _] = self.lengths;
        [l1 - l2 * sine, l2 * cosine]
    }

    /// Triangle CAE, of which three sides are given: its perimeter and its three triangle inequalities, the
    /// factors of Heron's product `k^2`.
    #[inline]
    #[must_use]
    pub const fn heron(&self, s: f64) -> [f64; 4] {
        let [_, _, l3, l4] = self.lengths;
        [l3 + l4 + s, l3 + l4 - s, l3 + (s - l4), l4 + (s - l3)]
    }

    /// `2 L4 s cos gamma`: with `k` it gives `gamma = atan2(k, ..)`.
    #[inline]
    #[must_use]
    pub const fn gamma_side(&self, s: f64) -> f64 {
        let [_, _, l3, l4] = self.lengths;
        s * s + (l4 - l3) * (l4 + l3)
    }

    /// How `alpha + gamma` changes with whatever changes `u` and `v` at the given rates: through the corner
    /// and the diagonal, from `L3^2 = L4^2 + s^2 - 2 L4 s cos gamma`.
    #[inline]
    #[must_use]
    pub const fn rate(
        &self,
        [u, v]: [f64; 2],
        [u_rate, v_rate]: [f64; 2],
        [s, k]: [f64; 2],
    ) -> f64 {
        let [_, _, l3, l4] = self.lengths;
        let gamma_s = ((l4 - l3) * (l4 + l3) - s * s) / (s * k);
        let alpha_rate = (u * v_rate - v * u_rate) / (s * s);
        let s_rate = (u * u_rate + v * v_rate) / s;
        alpha_rate + gamma_s * s_rate
    }
}
