//! The trials of a batch: suites, how many of each, from which index on.

use anyhow::{Context, Result, ensure};
use xtask_blind::Suite;

use super::Arguments;

/// Some trials of one suite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Part {
    pub(crate) suite: Suite,
    pub(crate) first: u64,
    pub(crate) count: u64,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Plan(pub(crate) Vec<Part>);

impl Plan {
    pub(crate) fn new(arguments: &Arguments) -> Result<Self> {
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
        let parts = Suite::ALL.into_iter().filter(wanted).map(|suite| {
            let [scored, quick] = suite.trials();
            let whole = if arguments.quick { quick } else { scored };
            Part {
                suite,
                first: arguments.first,
                count: arguments.count.unwrap_or_else(|| of_share(whole)),
            }
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

    pub(crate) fn is_whole(&self) -> bool {
        let suites = self.0.iter().map(|part| part.suite);
        let is_all = |part: &Part| part.first == 0 && part.count == part.suite.trials()[0];
        suites.eq(Suite::ALL) && self.0.iter().all(is_all)
    }

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
