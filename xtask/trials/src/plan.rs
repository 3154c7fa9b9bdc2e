//! The trials of a batch: suites, how many of each, from which index on.

use anyhow::{Context, Result, ensure};
use xtask_blind::Suite;

use super::Arguments;

/// Trials of a scored batch.
const SCORED: [(Suite, u64); 27] = [
    (Suite::Clean, 300),
    (Suite::Singles, 300),
    (Suite::NearSingles, 150),
    (Suite::Withheld, 150),
    (Suite::Unknown, 100),
    (Suite::Pairs, 100),
    (Suite::Ladder, 70),
    (Suite::Twins, 40),
    (Suite::Noise, 60),
    (Suite::Ablation, 20),
    (Suite::Wrong, 30),
    (Suite::Force, 40),
    (Suite::ForceWithheld, 45),
    (Suite::ForceUnknown, 36),
    (Suite::Payload, 120),
    (Suite::PayloadWithheld, 40),
    (Suite::PayloadSame, 100),
    (Suite::Elastic, 100),
    (Suite::Repeats, 80),
    (Suite::Moved, 80),
    (Suite::Coloured, 80),
    (Suite::Wrist, 100),
    (Suite::Loop, 96),
    (Suite::LoopPairs, 50),
    (Suite::Absent, 100),
    (Suite::Moving, 400),
    (Suite::MovingMemory, 40),
];
/// Trials of a quick check: each kind of clean recording once, a third of the strong effects, one or two of all other suites.
const QUICK: [(Suite, u64); 27] = [
    (Suite::Clean, 6),
    (Suite::Singles, 11),
    (Suite::NearSingles, 1),
    (Suite::Withheld, 2),
    (Suite::Unknown, 2),
    (Suite::Pairs, 1),
    (Suite::Ladder, 1),
    (Suite::Twins, 1),
    (Suite::Noise, 1),
    (Suite::Ablation, 1),
    (Suite::Wrong, 1),
    (Suite::Force, 1),
    (Suite::ForceWithheld, 1),
    (Suite::ForceUnknown, 2),
    (Suite::Payload, 1),
    (Suite::PayloadWithheld, 1),
    (Suite::PayloadSame, 1),
    (Suite::Elastic, 1),
    (Suite::Repeats, 1),
    (Suite::Moved, 1),
    (Suite::Coloured, 1),
    (Suite::Wrist, 1),
    (Suite::Loop, 1),
    (Suite::LoopPairs, 1),
    (Suite::Absent, 1),
    (Suite::Moving, 1),
    (Suite::MovingMemory, 1),
];

/// Some trials of one suite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Part {
    pub(crate) suite: Suite,
    pub(crate) first: u64,
    pub(crate) count: u64,
}

/// The trials of a batch.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Plan(pub(crate) Vec<Part>);

impl Plan {
    /// What the arguments ask for.
    pub(crate) fn new(arguments: &Arguments) -> Result<Self> {
        let counts = if arguments.quick { QUICK } else { SCORED };
        ensure!(
            arguments.share > 0.0 && arguments.share <= 1.0,
            "--share is {}: it must be above 0 and at most 1",
            arguments.share
        );
        let mut suites = Vec::new();
        for name in &arguments.suite {
            let suite = Suite::named(name).context("--suite")?;
            ensure!(!suites.contains(&suite), "--suite names {name} twice");
            suites.push(suite);
        }
        let wanted = |suite: &Suite| suites.is_empty() || suites.contains(suite);
        let of_share = |count: u64| (count as f64 * arguments.share).round().max(1.0) as u64;
        let parts = counts.into_iter().filter(|(suite, _)| wanted(suite));
        let parts = parts.map(|(suite, count)| Part {
            suite,
            first: arguments.first,
            count: arguments.count.unwrap_or_else(|| of_share(count)),
        });
        let plan = Self(parts.collect());
        ensure!(
            plan.0.iter().all(|part| part.count > 0),
            "--count is 0: there is nothing to try"
        );
        let end = arguments.first.checked_add(arguments.count.unwrap_or(0));
        ensure!(
            end.is_some_and(|end| end < 1 << 32),
            "--first and --count reach beyond the trials of a suite, 2^32"
        );
        Ok(plan)
    }

    /// The trials of a scored batch, all of them.
    pub(crate) fn is_whole(&self) -> bool {
        let whole = SCORED.into_iter();
        self.0.iter().map(|part| (part.suite, part.count)).eq(whole)
            && self.0.iter().all(|part| part.first == 0)
    }

    /// Suite and index of every trial.
    pub(crate) fn trials(&self) -> Vec<(Suite, u64)> {
        let of_part = |part: &Part| {
            let suite = part.suite;
            (part.first..part.first + part.count).map(move |index| (suite, index))
        };
        self.0.iter().flat_map(of_part).collect()
    }

    /// `s0 300, s1 300, ...`.
    pub(crate) fn words(&self) -> String {
        let parts: Vec<String> = self
            .0
            .iter()
            .map(|part| format!("{} {}", part.suite.name(), part.count))
            .collect();
        parts.join(", ")
    }
}
