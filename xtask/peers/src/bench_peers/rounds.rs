//! Two contenders in turns: ours, the other, ours, the other; a ratio for each undisturbed round.

use std::time::Duration;

use anyhow::{Context, Result};
use haptical_metrics::median;

use super::agreement::check_costs;
use super::contender::{Answer, Contender, Label};
use super::load::{DISTURBED, Ticks};
use super::ratio::MedianRatio;

/// Time that each side of a round should last \[s\]: ten ticks of the system's processor times.
const SIDE_S: f64 = 0.1;
/// Most repeats of a side, for the shortest works.
const MOST_REPEATS: usize = 20_000;
/// Rounds that are tried for each one that is wanted.
const ATTEMPTS: usize = 3;

/// Wait after a disturbed round: others may be done then.
const PAUSE: Duration = Duration::from_millis(500);

/// How many rounds, and whether disturbed ones count.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plan {
    pub(crate) rounds: usize,
    pub(crate) keep_disturbed: bool,
    /// Share of a cost within which final costs agree.
    pub(crate) agreement: f64,
}

/// Two contenders' times in the rounds that count.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Comparison {
    pub(crate) work: String,
    /// Ours: family, name and threads.
    pub(crate) ours: Label,
    pub(crate) other: Label,
    /// Median time of each round \[s\].
    pub(crate) ours_s: Vec<f64>,
    pub(crate) other_s: Vec<f64>,
    /// The other's time over ours, round by round.
    pub(crate) ratios: Vec<f64>,
    /// Rounds that were disturbed and left out.
    pub(crate) discarded: usize,
}

impl Comparison {
    /// Median of the ratios with its interval; none where every round was disturbed.
    pub(crate) fn ratio(&self) -> Option<MedianRatio> {
        MedianRatio::new(&self.ratios).ok()
    }
}

/// Repeats that fill a side of a round, after a run that took `once_s`.
pub(crate) fn repeats(once_s: f64) -> usize {
    // a time of zero asks for the most
    ((SIDE_S / once_s).ceil() as usize).clamp(1, MOST_REPEATS)
}

/// Median time of an answer \[s\].
pub(crate) fn time_s(answer: &Answer) -> Result<f64> {
    median(&answer.solve_s).context("an answer without times")
}

/// Runs both in turns until enough rounds count or too many did not.
pub(crate) fn compare(
    work: &str,
    ours: (&mut dyn Contender, usize),
    other: (&mut dyn Contender, usize),
    plan: Plan,
) -> Result<Comparison> {
    let ((ours, ours_repeats), (other, other_repeats)) = (ours, other);
    let mut comparison = Comparison {
        work: work.to_owned(),
        ours: ours.label().clone(),
        other: other.label().clone(),
        ..Comparison::default()
    };
    let processes = [ours.process(), other.process()].into_iter().flatten();
    let processes: Vec<u32> = processes.collect();
    for _ in 0..ATTEMPTS * plan.rounds {
        if comparison.ratios.len() == plan.rounds {
            break;
        }
        let before = Ticks::now(&processes);
        let answers = [ours.run(ours_repeats)?, other.run(other_repeats)?];
        let share = Ticks::now(&processes)
            .zip(before)
            .and_then(|(now, before)| now.foreign_share(&before));
        let labels = [&comparison.ours, &comparison.other];
        let costs = labels.into_iter().zip(&answers);
        let costs = costs.filter_map(|(label, answer)| Some((label.full(), answer.cost?)));
        let costs: Vec<(String, f64)> = costs.collect();
        check_costs(work, plan.agreement, &costs)?;
        if share.is_some_and(|share| share > DISTURBED) && !plan.keep_disturbed {
            comparison.discarded += 1;
            std::thread::sleep(PAUSE);
            continue;
        }
        let (ours_s, other_s) = (time_s(&answers[0])?, time_s(&answers[1])?);
        comparison.ours_s.push(ours_s);
        comparison.other_s.push(other_s);
        comparison.ratios.push(other_s / ours_s);
    }
    Ok(comparison)
}
