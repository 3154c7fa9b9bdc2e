//! A contender in a comparison, and the answer of one of its runs.

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;

/// What a run found and how long it took, one time for each repeat.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Answer {
    /// Sum of squared weighted residuals; none where nothing is minimised.
    pub(crate) cost: Option<f64>,
    /// Steps from the start to the solution.
    pub(crate) iterations: Option<u64>,
    /// Time before the search: the problem is put together \[s\]. Never part of a ratio.
    pub(crate) construction_s: Vec<f64>,
    /// Time from the start values to the solution, or of the calls \[s\].
    pub(crate) solve_s: Vec<f64>,
}

impl Answer {
    /// Reads a peer's line: `cost`, `iterations`, `construction_s` (each optional) and `solve_s`.
    pub(crate) fn from_json(line: &str) -> Result<Self> {
        let value: Value = serde_json::from_str(line)
            .with_context(|| format!("a peer answered `{}`", line.trim()))?;
        let times = |name: &str| -> Result<Vec<f64>> {
            let list = value[name].as_array().map_or(&[][..], Vec::as_slice);
            list.iter()
                .map(|time| match time.as_f64() {
                    Some(time) if time >= 0.0 => Ok(time),
                    _ => bail!("a peer answered the time `{time}`"),
                })
                .collect()
        };
        let answer = Self {
            cost: value["cost"].as_f64(),
            iterations: value["iterations"].as_u64(),
            construction_s: times("construction_s")?,
            solve_s: times("solve_s")?,
        };
        ensure!(!answer.solve_s.is_empty(), "a peer answered no times");
        Ok(answer)
    }
}

#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Label {
    /// Whose it is: `ours`, `ours, warm start`, `Ceres`, `SciPy` or `Pinocchio`.
    pub(crate) family: &'static str,
    /// What it is, for tables.
    pub(crate) name: String,
    pub(crate) threads: usize,
}

impl Label {
    pub(crate) fn new(family: &'static str, name: &str, threads: usize) -> Self {
        Self {
            family,
            name: name.to_owned(),
            threads,
        }
    }

    /// `Ceres: automatic, dense QR (2 threads)`.
    pub(crate) fn full(&self) -> String {
        let threads = match self.threads {
            1 => String::new(),
            threads => format!(" ({threads} threads)"),
        };
        format!("{}: {}{threads}", self.family, self.name)
    }
}

/// Ours or a peer's: something that can be run again and again.
pub(crate) trait Contender {
    fn label(&self) -> &Label;

    /// Process that does the work, where it is not this one.
    fn process(&self) -> Option<u32> {
        None
    }

    fn run(&mut self, repeats: usize) -> Result<Answer>;
}
