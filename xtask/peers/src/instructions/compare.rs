//! Counted against committed: what lies within the tolerance, and what is named if it does not.

use std::collections::BTreeMap;

/// Largest distance from a committed count, to either side, in percent of it.
pub(crate) const TOLERANCE_PERCENT: u64 = 5;

/// What is said of a count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Verdict {
    /// Within the tolerance.
    Same,
    /// Above it.
    More,
    /// Below it: a gain is committed too, or it could be lost again unseen.
    Fewer,
    /// Nothing was committed.
    NotCommitted,
}

impl Verdict {
    /// Its tolerance is taken in whole numbers.
    pub(crate) fn from_counts(counted: u64, committed: Option<u64>) -> Self {
        let Some(committed) = committed else {
            return Self::NotCommitted;
        };
        let away = u128::from(counted.abs_diff(committed));
        if 100 * away <= u128::from(TOLERANCE_PERCENT) * u128::from(committed) {
            Self::Same
        } else if counted > committed {
            Self::More
        } else {
            Self::Fewer
        }
    }

    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Same => "same",
            Self::More => "MORE",
            Self::Fewer => "FEWER",
            Self::NotCommitted => "NOT COMMITTED",
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    pub(crate) name: String,
    pub(crate) counted: u64,
    pub(crate) committed: Option<u64>,
    pub(crate) verdict: Verdict,
}

/// All that were counted, and what was committed in vain.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Comparison {
    pub(crate) rows: Vec<Row>,
    /// Committed names of no workload.
    pub(crate) left_over: Vec<String>,
}

impl Comparison {
    /// Counts next to committed ones; `known` are the names of all workloads, counted or not.
    pub(crate) fn new(
        counts: &[(&str, u64)],
        committed: &BTreeMap<String, u64>,
        known: &[&str],
    ) -> Self {
        let row = |&(name, counted): &(&str, u64)| {
            let committed = committed.get(name).copied();
            Row {
                name: name.to_owned(),
                counted,
                committed,
                verdict: Verdict::from_counts(counted, committed),
            }
        };
        let is_left_over = |name: &&String| !known.contains(&name.as_str());
        Self {
            rows: counts.iter().map(row).collect(),
            left_over: committed.keys().filter(is_left_over).cloned().collect(),
        }
    }

    /// A sentence for everything that is not as committed.
    pub(crate) fn failures(&self) -> Vec<String> {
        let of_rows = self.rows.iter().filter_map(|row| {
            let (name, counted) = (&row.name, row.counted);
            match (row.verdict, row.committed) {
                (Verdict::Same, _) => None,
                (_, None) => Some(format!("{name}: {counted} instructions, none committed")),
                (_, Some(committed)) => {
                    let percent = 100.0 * (counted as f64 / committed as f64 - 1.0);
                    Some(format!(
                        "{name}: {counted} instructions, {percent:+.1} % of the committed {committed} (allowed: \
                         {TOLERANCE_PERCENT} % either way)"
                    ))
                }
            }
        });
        let left_over = self.left_over.iter();
        let left_over =
            left_over.map(|name| format!("{name}: committed, but there is no such workload"));
        of_rows.chain(left_over).collect()
    }
}
