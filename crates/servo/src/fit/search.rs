//! Compass search (Kolda, Lewis & Torczon, SIAM Review 45, 2003): a play has corners where derivatives lie.

use haptical_linalg::NormalEquations;

use crate::thresholds::SEARCH_ROUNDS;

/// What may move, by how much at first, how far from zero, and the rows and least variance of the noise that a value is of.
#[derive(Debug)]
pub(crate) struct Limits {
    pub(crate) free: [bool; AXES],
    pub(crate) steps: [f64; AXES],
    pub(crate) most: [f64; AXES],
    pub(crate) rows: f64,
    pub(crate) least_variance: f64,
    /// Fall in variances of the noise below which a search ends.
    pub(crate) least_fall: f64,
}

/// Numbers of a shape.
pub(crate) const AXES: usize = 5;

/// The lowest point of a search.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lowest {
    pub(crate) at: [f64; AXES],
    pub(crate) value: f64,
    /// Whether the parabola through the points around it promises a fall of less than `LEAST_FALL` variances of the noise.
    pub(crate) has_converged: bool,
}

/// The lowest point that steps along each axis find, and steps to the lowest point of the parabola through its neighbours, which may lie along
/// a valley that no axis follows.
pub(crate) fn compass(
    start: [f64; AXES],
    limits: &Limits,
    value: &mut impl FnMut([f64; AXES]) -> f64,
) -> Lowest {
    let within = |at: [f64; AXES]| -> [f64; AXES] {
        std::array::from_fn(|axis| at[axis].clamp(0.0, limits.most[axis]))
    };
    let mut at = within(start);
    let mut best = value(at);
    let mut steps = limits.steps;
    for _ in 0..SEARCH_ROUNDS {
        let before = at;
        let mut has_moved = [false; AXES];
        // values on either side; none beyond a limit
        let mut sides = [[None; 2]; AXES];
        for axis in (0..AXES).filter(|&axis| limits.free[axis]) {
            for (side, sign) in [1.0, -1.0].into_iter().enumerate() {
                let mut next = at;
                next[axis] += sign * steps[axis];
                next = within(next);
                if next[axis] == at[axis] {
                    continue;
                }
                let found = value(next);
                if found < best {
                    (at, best) = (next, found);
                    has_moved[axis] = true;
                    break;
                }
                // a step that a limit shortens is none of the parabola
                let is_whole = (next[axis] - at[axis]).abs() > 0.999 * steps[axis];
                sides[axis][side] = Some(found).filter(|_| is_whole);
            }
        }
        let is_moved = has_moved.iter().any(|moved| *moved);
        let next = match is_moved {
            // along the way that helped, where a delay gives to a lag what the other takes
            true => std::array::from_fn(|axis| 2.0 * at[axis] - before[axis]),
            false => {
                let (by, fall) = parabola((at, best), &steps, &sides, value);
                let variance = (best / limits.rows).max(limits.least_variance);
                if fall < limits.least_fall * variance {
                    return Lowest {
                        at,
                        value: best,
                        has_converged: true,
                    };
                }
                std::array::from_fn(|axis| at[axis] + by[axis])
            }
        };
        let next = within(next);
        let found = value(next);
        let is_lower = found < best;
        if is_lower {
            (at, best) = (next, found);
        }
        for axis in (0..AXES).filter(|&axis| !has_moved[axis] && (is_moved || !is_lower)) {
            steps[axis] *= 0.5;
        }
    }
    Lowest {
        at,
        value: best,
        has_converged: false,
    }
}

/// The step to the lowest point of the parabola through the neighbours of a point along the axes that no limit holds, and how much lower it
/// is there.
fn parabola(
    (at, best): ([f64; AXES], f64),
    steps: &[f64; AXES],
    sides: &[[Option<f64>; 2]; AXES],
    value: &mut impl FnMut([f64; AXES]) -> f64,
) -> ([f64; AXES], f64) {
    let mut free: Vec<(usize, [f64; 2])> = Vec::new();
    for (axis, side) in sides.iter().enumerate() {
        if let [Some(above), Some(below)] = side {
            free.push((axis, [*above, *below]));
        }
    }
    let count = free.len();
    // in steps: curvatures, and slopes behind them
    let mut products = vec![vec![0.0; count + 1]; count + 1];
    for (a, (axis, [above, below])) in free.iter().enumerate() {
        products[a][a] = above + below - 2.0 * best;
        products[count][a] = 0.5 * (below - above);
        for (b, (other, [beside, _])) in free[..a].iter().enumerate() {
            let mut next = at;
            next[*axis] += steps[*axis];
            next[*other] += steps[*other];
            products[a][b] = value(next) - above - beside + best;
        }
    }
    let sums = NormalEquations::from_products(count, |a, b| products[a.max(b)][a.min(b)]);
    let all: Vec<usize> = (0..count).collect();
    let lowest = sums.solve(&all, |_| 0.0);
    let mut by = [0.0; AXES];
    for ((axis, _), own) in free.iter().zip(lowest.coefficients()) {
        by[*axis] = own * steps[*axis];
    }
    (by, 0.5 * lowest.explained())
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits {
        free: [true, true, false, false, false],
        steps: [0.03; AXES],
        most: [10.0; AXES],
        rows: 1000.0,
        least_variance: 0.0,
        least_fall: 0.01,
    };

    /// A valley along which one number gives what another takes: steps along the axes alone halve long before its lowest point.
    #[test]
    fn a_search_ends_at_the_lowest_point_of_a_valley() {
        let wanted = [0.2345, 0.1234];
        let mut value = |at: [f64; AXES]| {
            let [a, b] = [at[0] - wanted[0], at[1] - wanted[1]];
            1000.0 + 1e8 * (a + b).powi(2) + 1e4 * (a - b).powi(2)
        };
        let found = compass([0.0; AXES], &LIMITS, &mut value);
        assert!(found.has_converged);
        // a hundredth of a variance of the noise, which is 1 here
        assert!(found.value < 1000.01, "{found:?}");
    }

    #[test]
    fn a_search_that_still_falls_has_not_converged() {
        let mut calls = 0.0;
        let found = compass([0.0; AXES], &LIMITS, &mut |_| {
            calls += 1.0;
            -calls
        });
        assert!(!found.has_converged);
    }

    #[test]
    fn a_limit_holds_a_number() {
        let mut value =
            |at: [f64; AXES]| 1000.0 + 1e6 * (at[0] + 0.1).powi(2) + 1e6 * (at[1] - 0.1).powi(2);
        let found = compass([0.05; AXES], &LIMITS, &mut value);
        assert!(found.has_converged && found.at[0] == 0.0, "{found:?}");
        assert!((found.at[1] - 0.1).abs() < 1e-4, "{found:?}");
    }
}
