//! Compass search (Kolda, Lewis & Torczon, SIAM Review 45, 2003): a play has corners where derivatives lie.

use crate::thresholds::SEARCH_ROUNDS;

/// What may move, by how much at first and at last, and how far from zero.
#[derive(Debug)]
pub(crate) struct Limits {
    pub(crate) free: [bool; AXES],
    pub(crate) steps: [f64; AXES],
    pub(crate) least: [f64; AXES],
    pub(crate) most: [f64; AXES],
}

/// Numbers of a shape.
pub(crate) const AXES: usize = 4;

/// The lowest point that steps along each axis find, and its value.
pub(crate) fn compass(
    start: [f64; AXES],
    limits: &Limits,
    value: &mut impl FnMut([f64; AXES]) -> f64,
) -> ([f64; AXES], f64) {
    let mut at = start;
    for axis in 0..AXES {
        at[axis] = at[axis].clamp(0.0, limits.most[axis]);
    }
    let mut best = value(at);
    let mut steps = limits.steps;
    for _ in 0..SEARCH_ROUNDS {
        let before = at;
        let mut has_moved = [false; AXES];
        for axis in (0..AXES).filter(|&axis| limits.free[axis] && steps[axis] >= limits.least[axis])
        {
            for sign in [1.0, -1.0] {
                let mut next = at;
                next[axis] = (at[axis] + sign * steps[axis]).clamp(0.0, limits.most[axis]);
                if next[axis] == at[axis] {
                    continue;
                }
                let found = value(next);
                if found < best {
                    (at, best) = (next, found);
                    has_moved[axis] = true;
                    break;
                }
            }
        }
        if has_moved.iter().any(|moved| *moved) {
            // along the way that helped, where a delay gives to a lag what the other takes
            let mut next = at;
            for axis in 0..AXES {
                next[axis] = (2.0 * at[axis] - before[axis]).clamp(0.0, limits.most[axis]);
            }
            let found = value(next);
            if found < best {
                (at, best) = (next, found);
            }
        }
        for axis in 0..AXES {
            if !has_moved[axis] {
                steps[axis] *= 0.5;
            }
        }
        let is_done = |axis: usize| !limits.free[axis] || steps[axis] < limits.least[axis];
        if (0..AXES).all(is_done) {
            break;
        }
    }
    (at, best)
}
