//! A noise of two parts, one white and one with a memory, from two spectra: that of a torque above the band of the motion, and that of
//! what a fit leaves within it.
//!
//! The noise is `white + m`, `m` an autoregression of the first order. Both spectra are those of the noise, as the local polynomial and the low pass
//! leave them; the sizes and the memory are those of the greatest likelihood (Whittle, Arkiv foer Matematik 2, 1953). What a law of the
//! motion leaves has another shape: it lies where the motion is and does not go on above it (docs/equations.md, A noise with a memory).

use std::f64::consts::{LN_2, PI, TAU};

use super::local_polynomial::LocalPolynomial;
use super::noise::{Noise, median};
use crate::thresholds::signal::{
    FIFTHS, INNER_GROUPS, LEAST_MEMORY_ORDINATES, LEAST_SHORT_SEGMENT, LONGEST_MEMORY_S, MEMORIES,
    NOISE_SEGMENT_S, OUTER_GROUPS, SEGMENT, SHAPE_OFF, SHAPE_SDS, SHORT_SEGMENT,
};

/// Ordinates of a spectrum next to each other.
#[derive(Debug, Clone, Copy)]
struct Group {
    /// Their mean, in the square of the reading's unit.
    mean: f64,
    count: f64,
    is_inner: bool,
    /// What a white noise of variance 1 would have there, and one of each memory.
    white: f64,
    memory: [f64; MEMORIES],
}

/// How rows within the band come from samples.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Within<'a> {
    /// Weights of the samples of a row.
    pub(crate) weights: &'a [f64],
    /// Samples from row to row.
    pub(crate) every: usize,
}

/// The noise of a column's samples, if what is left of its rows is such a noise: `rows` are runs without a gap.
pub(crate) fn two_parts<'c>(
    columns: impl Iterator<Item = &'c [f64]>,
    (local, step_s): (&LocalPolynomial, f64),
    rows: &[&[f64]],
    within: Within<'_>,
) -> Option<Noise> {
    let memories: [f64; MEMORIES] = std::array::from_fn(|index| {
        let share = index as f64 / (MEMORIES - 1) as f64;
        // from half a sample to the longest
        let memory_s = 0.5 * step_s * (2.0 * LONGEST_MEMORY_S / step_s).powf(share);
        (-step_s / memory_s).exp()
    });
    let mut groups = above(columns, local, &memories);
    let inner = inside(rows, within, &memories);
    let count = |groups: &[Group]| groups.iter().map(|group| group.count).sum::<f64>();
    if count(&groups).min(count(&inner)) < LEAST_MEMORY_ORDINATES {
        return None;
    }
    groups.extend(inner);
    let mut best: Option<(f64, Noise, Vec<f64>)> = None;
    for (index, correlation) in memories.iter().enumerate() {
        let ([white, memory], loss) = sizes(&groups, index);
        if best.as_ref().is_none_or(|best| loss < best.0) {
            let model = |group: &Group| white * group.white + memory * group.memory[index];
            let noise = Noise {
                sd: white.sqrt(),
                memory_sd: memory.sqrt(),
                correlation: *correlation,
            };
            best = Some((loss, noise, groups.iter().map(model).collect()));
        }
    }
    // at the longest it may as well be longer: that is a drift, or what a slow motion leaves
    let (_, noise, model) = best.filter(|best| best.1.correlation < memories[MEMORIES - 1])?;
    let mut pairs = groups.iter().zip(&model);
    let has_shape = pairs.all(|(group, model)| {
        let by_chance = SHAPE_SDS / group.count.sqrt();
        // what is above the band may be lines and counts as well: it is the rows that have to be noise
        let allowed = if group.is_inner {
            by_chance
        } else {
            SHAPE_OFF.max(by_chance)
        };
        let ratio = group.mean / model;
        // what the fit took off the rows is noise as well
        ratio < 1.0 + allowed && (group.is_inner || ratio > 1.0 / (1.0 + allowed))
    });
    has_shape.then_some(noise)
}

/// Whether rows are as large in each fifth of a quantity: what an arm does at a reversal or under a load is not.
pub(crate) fn is_even(rows: &[f64], quantity: &[f64]) -> bool {
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by(|a, b| quantity[*a].total_cmp(&quantity[*b]));
    let square = |rows_of: &[usize]| rows_of.iter().map(|row| rows[*row].powi(2)).sum::<f64>();
    let mean = square(&order) / rows.len() as f64;
    let mut parts = order.chunks(rows.len().div_ceil(FIFTHS).max(1));
    parts.all(|part| {
        let count = part.len() as f64;
        // neighbours share a part of what they show
        square(part) / count < mean * (1.0 + SHAPE_SDS * (4.0 / count).sqrt())
    })
}

/// Sizes of the two parts with one memory, and minus twice the logarithm of their likelihood: Newton's steps by the expected curvature.
fn sizes(groups: &[Group], index: usize) -> ([f64; 2], f64) {
    let terms = |group: &Group| [group.white, group.memory[index]];
    let model = |group: &Group, sizes: [f64; 2]| {
        let [white, memory] = terms(group);
        (sizes[0] * white + sizes[1] * memory).max(f64::MIN_POSITIVE)
    };
    let loss = |sizes: [f64; 2]| -> f64 {
        let term = |group: &Group| {
            let model = model(group, sizes);
            group.count * (model.ln() + group.mean / model)
        };
        groups.iter().map(term).sum()
    };
    let all: f64 = groups.iter().map(|group| group.count).sum();
    let mean = groups
        .iter()
        .map(|group| group.count * group.mean / group.white);
    let start = mean.sum::<f64>() / all;
    let mut sizes = [0.5 * start, 0.5 * start];
    for _ in 0..60 {
        let (mut square, mut product) = ([[0.0; 2]; 2], [0.0; 2]);
        for group in groups {
            let (terms, model) = (terms(group), model(group, sizes));
            let weight = group.count / (model * model);
            for a in 0..2 {
                product[a] += weight * terms[a] * group.mean;
                for b in 0..2 {
                    square[a][b] += weight * terms[a] * terms[b];
                }
            }
        }
        let determinant = square[0][0] * square[1][1] - square[0][1] * square[1][0];
        let mut next = [
            (square[1][1] * product[0] - square[0][1] * product[1]) / determinant,
            (square[0][0] * product[1] - square[1][0] * product[0]) / determinant,
        ];
        // one part alone where the other would be negative
        for (one, other) in [(0, 1), (1, 0)] {
            if next[one].is_nan() || next[one] <= 0.0 {
                next = [0.0; 2];
                next[other] = product[other] / square[other][other];
                break;
            }
        }
        let is_there = (0..2).all(|k| (next[k] - sizes[k]).abs() <= 1e-6 * (next[0] + next[1]));
        sizes = next;
        if is_there {
            break;
        }
    }
    (sizes, loss(sizes))
}

/// Spectrum of an autoregression of variance 1 at a turn from sample to sample \[rad\].
fn of_memory(correlation: f64, turn: f64) -> f64 {
    (1.0 - correlation * correlation)
        / (1.0 - 2.0 * correlation * turn.cos() + correlation * correlation)
}

/// The spectrum above the band.
fn above<'c>(
    columns: impl Iterator<Item = &'c [f64]>,
    local: &LocalPolynomial,
    memories: &[f64; MEMORIES],
) -> Vec<Group> {
    let rest = |column: &[f64]| -> Vec<f64> {
        let inner = local.half..column.len().saturating_sub(local.half);
        inner.map(|k| column[k] - local.at(0, column, k)).collect()
    };
    let rests: Vec<Vec<f64>> = columns.map(rest).collect();
    let rests: Vec<&[f64]> = rests.iter().map(Vec::as_slice).collect();
    // friction that changes sides is in few segments
    let segment = (NOISE_SEGMENT_S / local.step_s).round() as usize;
    let segment = segment.clamp(LEAST_SHORT_SEGMENT, SHORT_SEGMENT);
    let ordinates = periodogram(&rests, segment, true);
    let passed = |turn: f64| {
        let weights = local.weights[0].iter().enumerate();
        let smoothed: f64 = weights
            .map(|(at, weight)| weight * (turn * (at as f64 - local.half as f64)).cos())
            .sum();
        (1.0 - smoothed).powi(2)
    };
    let ordinates = ordinates.into_iter().filter_map(|(turn, mean, count)| {
        let passed = passed(turn);
        // where little passes, what leaks from the motion is as large
        (passed > 0.5).then(|| Group {
            mean,
            count,
            is_inner: false,
            white: passed,
            memory: memories.map(|correlation| passed * of_memory(correlation, turn)),
        })
    });
    grouped(&ordinates.collect::<Vec<_>>(), OUTER_GROUPS)
}

/// The spectrum of the rows.
fn inside(rows: &[&[f64]], within: Within<'_>, memories: &[f64; MEMORIES]) -> Vec<Group> {
    let every = within.every as f64;
    let passed = |turn: f64| {
        let weights = within.weights.iter().enumerate();
        let (re, im) = weights.fold((0.0, 0.0), |(re, im), (at, weight)| {
            let angle = turn * at as f64;
            (re + weight * angle.cos(), im + weight * angle.sin())
        });
        re * re + im * im
    };
    let ordinates = periodogram(rows, SEGMENT, false)
        .into_iter()
        .map(|(turn, mean, count)| {
            let folded = |memory: Option<f64>| -> f64 {
                let aliases = (0..within.every).map(|alias| {
                    let turn = (turn + TAU * alias as f64) / every;
                    passed(turn) * memory.map_or(1.0, |correlation| of_memory(correlation, turn))
                });
                aliases.sum::<f64>() / every
            };
            Group {
                mean,
                count,
                is_inner: true,
                white: folded(None),
                memory: memories.map(|correlation| folded(Some(correlation))),
            }
        });
    grouped(&ordinates.collect::<Vec<_>>(), INNER_GROUPS)
}

/// Ordinates of segments under a Hann window, their mean or by their median: turn from sample to sample \[rad\], size, number of independent
/// ones. A white noise of variance 1 has ordinates of 1.
fn periodogram(runs: &[&[f64]], longest: usize, is_median: bool) -> Vec<(f64, f64, f64)> {
    let most = runs.iter().map(|run| run.len()).max().unwrap_or(0);
    let length = most / most.div_ceil(longest).max(1);
    if length < 16 {
        return Vec::new();
    }
    let window: Vec<f64> = (0..length)
        .map(|at| (PI * (at as f64 + 0.5) / length as f64).sin().powi(2))
        .collect();
    let square: f64 = window.iter().map(|weight| weight * weight).sum();
    let table: Vec<[f64; 2]> = (0..length)
        .map(|at| (TAU * at as f64 / length as f64).sin_cos().into())
        .collect();
    let segments: Vec<&[f64]> = runs
        .iter()
        .flat_map(|run| run.chunks_exact(length))
        .collect();
    let ordinate = |segment: &&[f64], order: usize| {
        let mut parts = [0.0; 2];
        let mut turn = 0;
        for (value, weight) in segment.iter().zip(&window) {
            let [sin, cos] = table[turn];
            parts[0] += weight * value * cos;
            parts[1] += weight * value * sin;
            turn += order;
            if turn >= length {
                turn -= length;
            }
        }
        (parts[0] * parts[0] + parts[1] * parts[1]) / square
    };
    // neighbours under this window share what they show: about two of three ordinates are independent
    let independent = segments.len() as f64 / 1.5;
    let of_order = |order: usize| {
        let mut all: Vec<f64> = segments
            .iter()
            .map(|segment| ordinate(segment, order))
            .collect();
        let turn = TAU * order as f64 / length as f64;
        match is_median {
            // of an exponential distribution, with half the certainty of its mean
            true => (turn, median(&mut all) / LN_2, 0.5 * independent),
            false => (
                turn,
                all.iter().sum::<f64>() / all.len() as f64,
                independent,
            ),
        }
    };
    (1..length / 2).map(of_order).collect()
}

/// Groups of ordinates, even by the logarithm of the frequency.
fn grouped(ordinates: &[Group], groups: usize) -> Vec<Group> {
    let total = ordinates.len();
    let end = |group: usize| {
        let share = group as f64 / groups as f64;
        ((total as f64 + 1.0).powf(share) - 1.0).round() as usize
    };
    let ranges = (0..groups).map(|group| end(group)..end(group + 1));
    let of_range = |range: std::ops::Range<usize>| {
        let part = ordinates.get(range).filter(|part| !part.is_empty())?;
        let count: f64 = part.iter().map(|one| one.count).sum();
        let mean = |of: &dyn Fn(&Group) -> f64| {
            part.iter().map(|one| one.count * of(one)).sum::<f64>() / count
        };
        Some(Group {
            mean: mean(&|one| one.mean),
            count,
            is_inner: part[0].is_inner,
            white: mean(&|one| one.white),
            memory: std::array::from_fn(|index| mean(&|one| one.memory[index])),
        })
    };
    ranges.filter_map(of_range).collect()
}

#[cfg(test)]
mod tests {
    use haptical_linalg::dot;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::signal::low_pass::LowPass;

    const STEP_S: f64 = 0.004;
    const PASS: LowPass = LowPass { edge_hz: 12.0 };

    /// White noise of a standard deviation of 0.3, and one of 0.2 with a memory of 30 ms.
    fn noise(seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let correlation = (-STEP_S / 0.03_f64).exp();
        let mut slow = normal();
        let sample = |_| {
            slow = correlation * slow + (1.0 - correlation * correlation).sqrt() * normal();
            0.3 * normal() + 0.2 * slow
        };
        (0..7500).map(sample).collect()
    }

    /// What is found of a torque that a fit explains but for `rest`.
    fn found(rest: &[f64]) -> (Option<Noise>, f64) {
        let motion = |k: usize| {
            let time_s = STEP_S * k as f64;
            20.0 * (2.0 * time_s).sin() + 5.0 * (7.0 * time_s).sin()
        };
        let torque = rest.iter().enumerate().map(|(k, value)| motion(k) + value);
        let torque: Vec<f64> = torque.collect();
        let (_, weights) = PASS.weights(STEP_S, 0.0);
        let every = (PASS.row_s() / STEP_S) as usize;
        let windows = rest.windows(weights.len()).step_by(every);
        let rows: Vec<f64> = windows.map(|window| dot(window, &weights)).collect();
        let local = LocalPolynomial::new(STEP_S, 2.0 * PASS.edge_hz);
        let within = Within {
            weights: &weights,
            every,
        };
        let found = two_parts(
            [torque.as_slice()].into_iter(),
            (&local, STEP_S),
            &[&rows],
            within,
        );
        (found, (dot(&rows, &rows) / rows.len() as f64).sqrt())
    }

    #[test]
    fn the_two_parts_of_a_noise_are_found_next_to_a_motion() {
        for seed in 1..6 {
            let (found, rms) = found(&noise(seed));
            let found = found.unwrap();
            assert!((found.sd / 0.3 - 1.0).abs() < 0.1, "{found:?}");
            assert!((found.memory_sd / 0.2 - 1.0).abs() < 0.3, "{found:?}");
            let memory_s = -STEP_S / found.correlation.ln();
            assert!((0.015..0.06).contains(&memory_s), "{found:?}");
            let (_, weights) = PASS.weights(STEP_S, 0.0);
            assert!(
                (found.behind(&weights) / rms - 1.0).abs() < 0.1,
                "{found:?}, {rms}"
            );
        }
    }

    /// What follows the motion lies at its frequencies and does not go on above them as a noise does.
    #[test]
    fn what_a_law_of_the_motion_leaves_is_no_noise() {
        let laws: [fn(f64) -> f64; 2] = [
            |time_s| 0.3 * (2.0 * time_s).sin(),
            |time_s| 0.2 * (2.0 * time_s).cos().signum(),
        ];
        for (number, law) in laws.into_iter().enumerate() {
            let rest = noise(7).into_iter().enumerate();
            let rest: Vec<f64> = rest
                .map(|(k, value)| value + law(STEP_S * k as f64))
                .collect();
            let (found, _) = found(&rest);
            assert!(found.is_none(), "{number}: {found:?}");
        }
    }

    /// Knocks at reversals have the spectrum of a noise.
    #[test]
    fn what_comes_at_reversals_is_not_even() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let speed = |k: usize| (0.05 * k as f64).cos().abs();
        let speeds: Vec<f64> = (0..800).map(speed).collect();
        let sound: Vec<f64> = StandardNormal.sample_iter(&mut random).take(800).collect();
        assert!(is_even(&sound, &speeds));
        let knocks = sound.iter().zip(&speeds);
        let knocks: Vec<f64> = knocks
            .map(|(value, speed)| value + 3.0 * (-(speed / 0.1).powi(2)).exp())
            .collect();
        assert!(!is_even(&knocks, &speeds));
    }

    #[test]
    fn few_rows_show_no_noise() {
        assert!(found(&noise(1)[..600]).0.is_none());
    }
}
