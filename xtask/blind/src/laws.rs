//! Laws of material and contact that the effects share: stops, bristles, hysteresis loops, ramps, delays.

/// One Maxwell-slip element: a stop operator of half width `width`, weighted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SlipElement {
    pub(crate) weight: f64,
    pub(crate) width: f64,
}

impl SlipElement {
    /// Three around a width of 1, their weights in these proportions.
    pub(crate) fn three(weights: [f64; 3], spread: f64) -> Vec<Self> {
        let sum: f64 = weights.iter().sum();
        let elements = weights.iter().zip([1.0 / spread, 1.0, spread]);
        let elements = elements.map(|(weight, width)| Self {
            weight: weight / sum,
            width,
        });
        elements.collect()
    }

    /// The same elements, so many times as wide.
    pub(crate) fn widened(elements: &[Self], factor: f64) -> Vec<Self> {
        let elements = elements.iter().map(|element| Self {
            width: element.width * factor,
            ..*element
        });
        elements.collect()
    }
}

/// Differences of successive entries; the first is 0.
fn steps(input: &[f64]) -> impl Iterator<Item = f64> {
    let before = input.iter().take(1).chain(input);
    input.iter().zip(before).map(|(now, before)| now - before)
}

/// Generalised Maxwell-slip: the weighted sum of stops, each from -weight to weight.
///
/// Source: Al-Bender, Lampaert & Swevers, "The generalized Maxwell-slip model", IEEE TAC 50, 2005,
/// without its viscous part. `input` in any unit, `width` in the same; result in units of the weights.
pub(crate) fn maxwell_slip(input: &[f64], elements: &[SlipElement]) -> Vec<f64> {
    let mut states = vec![0.0; elements.len()];
    steps(input)
        .map(|step| {
            let mut sum = 0.0;
            for (state, element) in states.iter_mut().zip(elements) {
                *state = (*state + step / element.width).clamp(-1.0, 1.0);
                sum += element.weight * *state;
            }
            sum
        })
        .collect()
}

/// Bristle of Dahl's law, from -1 to 1: `dz/dx = (1 - z sgn dx) / width`, integrated exactly.
///
/// Source: Dahl, "Solid friction damping of mechanical vibrations", 1976; the steady part of LuGre's.
pub(crate) fn dahl(input: &[f64], width: f64) -> Vec<f64> {
    let mut state = 0.0;
    steps(input)
        .map(|step| {
            let target = if step > 0.0 { 1.0 } else { -1.0 };
            state = target + (state - target) * libm::exp(-step.abs() / width);
            state
        })
        .collect()
}

/// Largest step of the Bouc-Wen integration, in widths.
const BOUC_WEN_STEP: f64 = 0.1;
/// Steps after which a sample of a long travel is saturated anyway.
const BOUC_WEN_STEPS: usize = 80;

/// Bouc-Wen loop, from -1 to 1: `dz/dx = [1 - |z|^n (1 - g + g sgn(z dx))] / width`.
///
/// Source: Ismail, Ikhouane & Rodellar, "The hysteresis Bouc-Wen model, a survey", 2009; `g` is the
/// share of the sign-dependent term.
pub(crate) fn bouc_wen(input: &[f64], width: f64, exponent: f64, share: f64) -> Vec<f64> {
    let mut state: f64 = 0.0;
    let slope = |state: f64, direction: f64| {
        let agreement = if state * direction >= 0.0 { 1.0 } else { -1.0 };
        direction * (1.0 - libm::pow(state.abs(), exponent) * (1.0 - share + share * agreement))
    };
    steps(input)
        .map(|step| {
            let travel = step / width;
            let count = ((travel.abs() / BOUC_WEN_STEP) as usize + 1).min(BOUC_WEN_STEPS);
            let step = travel.abs().min(BOUC_WEN_STEP * BOUC_WEN_STEPS as f64) / count as f64;
            let direction = if travel > 0.0 { 1.0 } else { -1.0 };
            if travel != 0.0 {
                for _ in 0..count {
                    let middle = state + 0.5 * step * slope(state, direction);
                    state = (state + step * slope(middle, direction)).clamp(-1.0, 1.0);
                }
            }
            state
        })
        .collect()
}

/// 0 before `start_s`, 1 after `start_s + rise_s`, a cubic ramp between.
pub(crate) fn ramp(time_s: f64, start_s: f64, rise_s: f64) -> f64 {
    if time_s < start_s {
        return 0.0;
    }
    let x = if rise_s > 0.0 {
        ((time_s - start_s) / rise_s).min(1.0)
    } else {
        1.0
    };
    x * x * (3.0 - 2.0 * x)
}

/// `values`, sampled every `step_s` within runs, as they were `delay_s` earlier (cubic Lagrange
/// interpolation; at the ends of a run the outer value is held).
pub(crate) fn delayed(values: &[f64], run: &[i64], step_s: f64, delay_s: f64) -> Vec<f64> {
    let shift = delay_s / step_s;
    (0..values.len())
        .map(|row| {
            let within = |place: isize| {
                let clamped = place.clamp(0, values.len() as isize - 1) as usize;
                if run[clamped] == run[row] {
                    values[clamped]
                } else {
                    values[row]
                }
            };
            let place = row as f64 - shift;
            let whole = libm::floor(place);
            let (x, first) = (place - whole, whole as isize);
            let [a, b, c, d] = [-1, 0, 1, 2].map(|offset| within(first + offset));
            a * (-x * (x - 1.0) * (x - 2.0) / 6.0)
                + b * ((x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0)
                + c * (-(x + 1.0) * x * (x - 2.0) / 2.0)
                + d * ((x + 1.0) * x * (x - 1.0) / 6.0)
        })
        .collect()
}

/// Slope of `y` regressed on `x`; zero where `x` does not vary.
pub(crate) fn slope_of(x: &[f64], y: &[f64]) -> f64 {
    let count = x.len().max(1) as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / count;
    let (x_mean, y_mean) = (mean(x), mean(y));
    let (mut xx, mut xy) = (0.0, 0.0);
    for (a, b) in x.iter().zip(y) {
        xx += (a - x_mean) * (a - x_mean);
        xy += (a - x_mean) * (b - y_mean);
    }
    if xx > 0.0 { xy / xx } else { 0.0 }
}

/// Factor of `x` in `y`, fitted with a constant and `others`: least squares on all of them together. Source:
/// Frisch & Waugh, "Partial time regressions as compared with individual trends", Econometrica 1, 1933, with
/// Gram-Schmidt done twice. Zero where nothing of `x` is left.
pub(crate) fn slope_beside(x: &[f64], y: &[f64], others: &[Vec<f64>]) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let beyond = |column: &[f64], basis: &[Vec<f64>]| -> Vec<f64> {
        let mut rest = column.to_vec();
        for direction in basis.iter().chain(basis) {
            let part = dot(&rest, direction);
            for (entry, unit) in rest.iter_mut().zip(direction) {
                *entry -= part * unit;
            }
        }
        rest
    };
    let constant = vec![1.0; x.len()];
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for column in std::iter::once(&constant).chain(others) {
        let rest = beyond(column, &basis);
        let (length, before) = (dot(&rest, &rest), dot(column, column));
        // what is left of a repeated column is rounding
        if length > 1e-20 * before {
            let scale = 1.0 / libm::sqrt(length);
            basis.push(rest.into_iter().map(|entry| entry * scale).collect());
        }
    }
    let rest = beyond(x, &basis);
    let length = dot(&rest, &rest);
    if length > 1e-20 * dot(x, x) {
        dot(&rest, y) / length
    } else {
        0.0
    }
}

/// Root of the mean square; 0 of nothing.
pub(crate) fn rms(values: &[f64]) -> f64 {
    haptical_metrics::rms(values).unwrap_or(0.0)
}

/// Factor of `y` on `x`, vector by vector, through the origin; zero where `x` is zero.
pub(crate) fn vector_gain(x: &[[f64; 3]], y: &[[f64; 3]]) -> f64 {
    let (mut xx, mut xy) = (0.0, 0.0);
    for (a, b) in x.iter().flatten().zip(y.iter().flatten()) {
        xx += a * a;
        xy += a * b;
    }
    if xx > 0.0 { xy / xx } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUNDING: f64 = 1e-12;

    /// y = 2 x + 3 t - 5 t^2 + 7 has factor 2 with t and t^2, and another one alone.
    #[test]
    fn a_factor_beside_others_is_that_of_the_sum() {
        let t: Vec<f64> = (0..50).map(|k| 0.1 * f64::from(k) - 2.0).collect();
        let x: Vec<f64> = t.iter().map(|t| libm::sin(1.3 * t) + 0.4 * t).collect();
        let square: Vec<f64> = t.iter().map(|t| t * t).collect();
        let y: Vec<f64> = (0..50)
            .map(|k| 2.0 * x[k] + 3.0 * t[k] - 5.0 * square[k] + 7.0)
            .collect();
        let others = [t.clone(), square, t.clone()];
        assert!((slope_beside(&x, &y, &others) - 2.0).abs() < 1e-9);
        let alone = slope_of(&x, &y);
        assert!((slope_beside(&x, &y, &[]) - alone).abs() < 1e-9);
        assert!((alone - 2.0).abs() > 0.1);
        assert_eq!(slope_beside(&t, &y, &others), 0.0, "nothing is left of t");
    }

    /// A stop follows its input up to its width, stays, and comes back at once on reversal.
    #[test]
    fn one_slip_element_is_a_stop() {
        let element = SlipElement {
            weight: 2.0,
            width: 0.5,
        };
        let input = [0.0, 0.25, 1.0, 3.0, 2.75, 2.0, 1.0];
        let expected = [0.0, 1.0, 2.0, 2.0, 1.0, -2.0, -2.0];
        for (got, want) in maxwell_slip(&input, &[element]).iter().zip(expected) {
            assert!((got - want).abs() < ROUNDING);
        }
    }

    /// From rest, Dahl's bristle and Bouc-Wen's loop at exponent 1 follow 1 - exp(-x / width); back from
    /// the top Dahl's goes as 2 exp(-x / width) - 1, Bouc-Wen's with equal shares straight down.
    #[test]
    fn loops_follow_their_closed_forms() {
        /// Second order steps of a tenth of a width.
        const STEPS: f64 = 2e-3;
        let (width, top) = (0.2, 4.0);
        let up: Vec<f64> = (0..=400).map(|k| k as f64 * top / 400.0).collect();
        let down = (1..=15).map(|k| top - k as f64 * 0.01);
        let input: Vec<f64> = up.iter().copied().chain(down).collect();
        let bristle = dahl(&input, width);
        let wen = bouc_wen(&input, width, 1.0, 0.5);
        for (k, x) in input.iter().enumerate() {
            if k < up.len() {
                let rise = 1.0 - libm::exp(-x / width);
                assert!((bristle[k] - rise).abs() < ROUNDING);
                assert!((wen[k] - rise).abs() < STEPS);
            } else {
                let back = (top - x) / width;
                assert!((bristle[k] - (2.0 * libm::exp(-back) - 1.0)).abs() < 1e-8);
                assert!((wen[k] - (1.0 - back)).abs() < STEPS);
            }
        }
    }

    /// Rate independence: a finer path gives the same loop.
    #[test]
    fn loops_do_not_depend_on_sampling() {
        let path = |count: usize| -> Vec<f64> {
            (0..=count)
                .map(|k| libm::sin(6.0 * k as f64 / count as f64))
                .collect()
        };
        let last = |values: Vec<f64>| values.last().copied().unwrap_or(f64::NAN);
        let coarse = last(bouc_wen(&path(500), 0.1, 1.5, 0.7));
        let fine = last(bouc_wen(&path(5000), 0.1, 1.5, 0.7));
        assert!((coarse - fine).abs() < 2e-3);
        assert!((last(dahl(&path(500), 0.1)) - last(dahl(&path(5000), 0.1))).abs() < 1e-3);
    }

    #[test]
    fn a_ramp_rises_once() {
        let at = |time_s: f64| ramp(time_s, 2.0, 0.5);
        assert_eq!(
            (at(1.9), at(2.0), at(2.25), at(2.5), at(9.0)),
            (0.0, 0.0, 0.5, 1.0, 1.0)
        );
    }

    /// Cubic interpolation is exact for cubics; runs do not mix.
    #[test]
    fn delays_are_exact_for_cubics() {
        let cubic = |x: f64| 1.0 + x * (0.3 - x * (0.2 - 0.01 * x));
        let values: Vec<f64> = (0..40).map(|k| cubic(k as f64)).collect();
        let late = delayed(&values, &[0; 40], 0.01, 0.004);
        for (k, value) in late.iter().enumerate().skip(3).take(34) {
            assert!((value - cubic(k as f64 - 0.4)).abs() < 1e-10);
        }
        let two_runs: Vec<i64> = (0..40).map(|k| i64::from(k >= 20)).collect();
        let steps: Vec<f64> = (0..40).map(|k| if k >= 20 { 5.0 } else { 1.0 }).collect();
        assert!(
            delayed(&steps, &two_runs, 0.01, 0.03)
                .iter()
                .zip(&steps)
                .all(|(a, b)| a == b)
        );
    }
}
