//! A delay that changes, by the likelihood of a regression of the position on its own past and the command's (an ARX model: Ljung,
//! System Identification, 4.2) whose command is later from an episode on.

use std::ops::RangeInclusive;

use haptical_linalg::NormalEquations;

use super::moments::{CONSTANT, late, moments, running, weighted_moments};
use super::series::Joint;
use super::verdict::probability;
use super::{EpisodeFinding, Fault};
use crate::thresholds::{
    EPISODE_DELAY_EVEN, EPISODE_DELAY_NATS, EPISODE_DELAY_Z, EPISODE_RIDGE, EPISODE_SHIFTS,
    HELD_DELAY_NATS, HELD_REPEATS, LEAST_DELAY, LEAST_SHIFT, NEIGHBOURS, PLACED_AGAIN, SIZE_TENTHS,
    SLOWEST_STEP_S, SMALL_DELAY_Z,
};

/// A change of the delay; episodes are places among those that show the joint. Why it was not looked for where it was not.
pub(super) fn fault(joint: &Joint) -> Result<Option<EpisodeFinding>, String> {
    if joint.step_s > SLOWEST_STEP_S {
        return Err(format!(
            "delay: rows are {:.0} ms apart, more than a joint takes to answer",
            1e3 * joint.step_s
        ));
    }
    if joint.other_rates > 0 {
        return Err(format!(
            "delay: {} episodes have another rate than the others",
            joint.other_rates
        ));
    }
    if joint.episodes.len() < 2 * NEIGHBOURS {
        return Err("delay: too few episodes in which the joint moves".to_owned());
    }
    let equal = moments(joint);
    let moments = weighted_moments(joint, &equal);
    let scan = Scan::new(&moments);
    let episodes = moments.len();
    if scan.rows() < 10.0 * scan.before[0].columns() as f64 {
        return Err("delay: too few rows whose last half second of commands is known".to_owned());
    }
    let places = NEIGHBOURS..=episodes - NEIGHBOURS;
    let best = EPISODE_SHIFTS
        .iter()
        .map(|rows| scan.best(*rows, places.clone()));
    let Some(rough) = best.max_by(|a, b| a.nats.total_cmp(&b.nats)) else {
        return Ok(None);
    };
    let near = rough.at.saturating_sub(2).max(*places.start())..=(rough.at + 2).min(*places.end());
    let tried =
        (-3..=3).map(|tenths| scan.best(rough.rows + 0.1 * f64::from(tenths), near.clone()));
    let best = tried.fold(
        rough,
        |best, tried| if tried.nats > best.nats { tried } else { best },
    );
    let least = if joint.repeated() > HELD_REPEATS {
        HELD_DELAY_NATS
    } else {
        EPISODE_DELAY_NATS
    };
    let is_one = best.nats >= least
        && best.rows.abs() >= LEAST_SHIFT
        && scan.is_even(&moments, best.at, best.rows);
    // weights tell a change from single rows that stick and slip; they also favour a small one
    let equal = Scan::new(&equal);
    let sizes = (1..=SIZE_TENTHS).map(|tenths| 0.1 * f64::from(tenths) * best.rows.signum());
    let sized = sizes
        .map(|rows| equal.best(rows, best.at..=best.at))
        .max_by(|a, b| a.nats.total_cmp(&b.nats));
    let rows = sized.map_or(best.rows, |sized| sized.rows);
    let about = best.at.saturating_sub(PLACED_AGAIN).max(*places.start())
        ..=(best.at + PLACED_AGAIN).min(*places.end());
    let at = equal.best(rows, about).at;
    let is_one = is_one && rows.abs() >= LEAST_DELAY;
    Ok(is_one.then(|| EpisodeFinding {
        fault: Fault::Latency {
            delay_s: rows * joint.step_s,
            // what the straight lines between rows are worth, and of a sensor that holds its readings how long it does
            sd_s: match joint.repeated() {
                // the end of what was looked for: it may be any longer one
                _ if rows.abs() >= 0.1 * f64::from(SIZE_TENTHS) - 0.05 => rows.abs() * joint.step_s,
                held if held > HELD_REPEATS => 0.5 * joint.step_s / (1.0 - held).max(0.02),
                _ => 0.2 * joint.step_s,
            },
        },
        since: at,
        until: None,
        probability: probability(best.nats, episodes),
    }))
}

/// A delay of some rows from a place on, and what it gains.
#[derive(Debug, Clone, Copy)]
struct Tried {
    nats: f64,
    at: usize,
    rows: f64,
}

/// Sums before each place, and what no change leaves.
struct Scan {
    sums: Vec<NormalEquations>,
    before: Vec<NormalEquations>,
    base: f64,
}

impl Scan {
    fn new(moments: &[NormalEquations]) -> Self {
        let sums = running(moments);
        let all = &sums[moments.len()];
        let base = EPISODE_SHIFTS
            .iter()
            .chain(&[0.0])
            .map(|rows| left(&late(all, *rows)));
        Self {
            base: base.fold(f64::INFINITY, f64::min),
            before: sums.iter().map(|sums| late(sums, 0.0)).collect(),
            sums,
        }
    }

    /// The place at which a delay gains most.
    fn best(&self, rows: f64, places: RangeInclusive<usize>) -> Tried {
        let all = &self.sums[self.sums.len() - 1];
        let tried = places.map(|at| Tried {
            nats: self.nats(at, &late(&all.plus(&self.sums[at], -1.0), rows)),
            at,
            rows,
        });
        let none = Tried {
            nats: f64::NEG_INFINITY,
            at: 0,
            rows,
        };
        tried.fold(
            none,
            |best, tried| if tried.nats > best.nats { tried } else { best },
        )
    }

    fn rows(&self) -> f64 {
        self.sums[self.sums.len() - 1].product(CONSTANT, CONSTANT)
    }

    /// What a delay from a place on gains over none.
    fn nats(&self, at: usize, after: &NormalEquations) -> f64 {
        0.5 * self.rows() * (self.base / left(&self.before[at].plus(after, 1.0))).ln()
    }

    /// Whether the episodes agree, on either side: each one's squares with its delay and with the other side's.
    fn is_even(&self, moments: &[NormalEquations], at: usize, rows: f64) -> bool {
        let all = &self.sums[self.sums.len() - 1];
        let changed = self.before[at].plus(&late(&all.plus(&self.sums[at], -1.0), rows), 1.0);
        let columns: Vec<usize> = (0..changed.columns()).collect();
        let coefficients = solved(&changed);
        let gains = moments.iter().enumerate().map(|(place, sums)| {
            let of = |rows: f64| late(sums, rows).left(&columns, &coefficients);
            let (here, there) = if place < at { (0.0, rows) } else { (rows, 0.0) };
            of(there) - of(here)
        });
        let gains: Vec<f64> = gains.collect();
        let mean = gains.iter().sum::<f64>() / gains.len() as f64;
        let squares: f64 = gains.iter().map(|gain| (gain - mean).powi(2)).sum();
        let z = mean * gains.len() as f64 / squares.sqrt();
        let share = |part: &[f64]| {
            part.iter().filter(|gain| **gain > 0.0).count() as f64 / part.len() as f64
        };
        let (before, after) = gains.split_at(at);
        // few episodes of which some hardly move scatter by as much as they say
        let least = EPISODE_DELAY_Z.min(SMALL_DELAY_Z * (gains.len() as f64).sqrt());
        z >= least && share(before).min(share(after)) >= EPISODE_DELAY_EVEN
    }
}

fn solved(sums: &NormalEquations) -> Vec<f64> {
    let columns: Vec<usize> = (0..sums.columns()).collect();
    let fit = sums.solve(&columns, |column| {
        EPISODE_RIDGE * sums.product(column, column)
    });
    fit.coefficients().to_vec()
}

fn left(sums: &NormalEquations) -> f64 {
    let columns: Vec<usize> = (0..sums.columns()).collect();
    let fit = sums.solve(&columns, |column| {
        EPISODE_RIDGE * sums.product(column, column)
    });
    fit.rest_square().max(f64::MIN_POSITIVE)
}
