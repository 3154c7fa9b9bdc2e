//! Search for the best selection: greedy and random starts, then exchanges one pose at a time.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use crate::select::criterion::Score;
use crate::select::state::State;
use crate::select::whitened::Whitened;

/// How hard to search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Search {
    /// Random starts besides the greedy one.
    pub random_starts: usize,
    /// Passes over the selection, at most, from each start.
    pub passes: usize,
    /// Seed of the random starts.
    pub seed: u64,
}

impl Default for Search {
    /// The greedy start and one random one, at most ten passes each.
    fn default() -> Self {
        Self {
            random_starts: 1,
            passes: 10,
            seed: 1,
        }
    }
}

/// What a search found.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    pub(crate) chosen: Vec<usize>,
    pub(crate) score: f64,
    /// Score at the start and after every exchange.
    pub(crate) history: Vec<f64>,
}

/// Ridge of the greedy start, as a share of the information that poses of average worth would give: it lets the
/// first poses, which do not fix every parameter, be compared.
const RIDGE_SHARE: f64 = 1e-4;
/// Least gain of an exchange, as a share of the score's scale: below it rounding decides.
const LEAST_GAIN: f64 = 1e-9;
/// A pass that improves the score by less than this share of its scale is the last one: further ones change no digit
/// of a standard deviation that anyone reads.
const LEAST_PASS_GAIN: f64 = 1e-4;

/// The best selection of `count` poses, after starts that fix every parameter; none where no start does.
///
/// Each pass takes the poses out one by one and puts the best candidate in its place (Fedorov 1972, section 3.3, in
/// the one-at-a-time form of Mitchell's DETMAX, 1974); a pass without an exchange ends it. After every pass the
/// covariance is worked out anew. Starts run on several threads; each is worked out as it would be alone.
pub(crate) fn search(
    rows: &Whitened,
    score: &Score,
    count: usize,
    search: &Search,
) -> Option<Found> {
    let found = haptical_parallel::map(0..=search.random_starts, |start| {
        let chosen = match start {
            0 => greedy(rows, score, count)?,
            _ => random(rows, count, search.seed, start as u64),
        };
        exchange(rows, score, chosen, search.passes)
    });
    // the first of equals, whichever thread came first
    let found = found.into_iter().flatten();
    found.reduce(|best, other| {
        if other.score > best.score {
            other
        } else {
            best
        }
    })
}

/// Pose by pose the best one.
fn greedy(rows: &Whitened, score: &Score, count: usize) -> Option<Vec<bool>> {
    let ridge = RIDGE_SHARE * count as f64 / rows.poses() as f64;
    let chosen = vec![false; rows.poses()];
    let mut state = State::new(rows, score.weight(), chosen, ridge)?;
    for _ in 0..count {
        let (best, _) = score.best(&mut state, None, f64::NEG_INFINITY)?;
        state.add(best);
    }
    Some(state.chosen)
}

fn random(rows: &Whitened, count: usize, seed: u64, stream: u64) -> Vec<bool> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(stream);
    let mut order: Vec<usize> = (0..rows.poses()).collect();
    order.shuffle(&mut random);
    let mut chosen = vec![false; rows.poses()];
    order[..count].iter().for_each(|&pose| chosen[pose] = true);
    chosen
}

fn exchange(rows: &Whitened, score: &Score, chosen: Vec<bool>, passes: usize) -> Option<Found> {
    let mut state = State::new(rows, score.weight(), chosen, 0.0)?;
    let mut history = vec![score.now(&state)];
    for _ in 0..passes {
        let before = state.clone();
        let (mut exchanged, mut is_spoilt) = (false, false);
        let slots: Vec<usize> = (0..rows.poses())
            .filter(|&pose| state.chosen[pose])
            .collect();
        for pose in slots {
            let kept = score.now(&state);
            let Some(gone) = state.change(pose, -1.0) else {
                continue;
            };
            let least = kept + LEAST_GAIN * score.scale(kept);
            let better = score.best(&mut state, Some(&gone), least);
            if let Some((into, _)) = better {
                state.make(pose, gone);
                if !state.add(into) {
                    is_spoilt = true;
                    break;
                }
                exchanged = true;
                history.push(score.now(&state));
            }
        }
        // a covariance that rounding spoilt is no step
        if is_spoilt || !state.refresh() || score.now(&state) < score.now(&before) {
            state = before;
            break;
        }
        let (was, is) = (score.now(&before), score.now(&state));
        if !exchanged || is - was < LEAST_PASS_GAIN * score.scale(was) {
            break;
        }
    }
    let chosen = (0..rows.poses()).filter(|&pose| state.chosen[pose]);
    Some(Found {
        chosen: chosen.collect(),
        score: score.now(&state),
        history,
    })
}
