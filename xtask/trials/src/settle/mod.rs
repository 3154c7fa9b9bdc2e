//! `settle-check`: whether the recording that is chosen settles an ambiguous diagnosis, and how often others of the same
//! length do. Writes docs/evidence/settle.md.

mod page;
mod trial;

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use haptical_report::write_atomically;
use xtask_blind::Suite;
use xtask_output::Progress;

use self::trial::{Outcome, Settled, settled};
use super::threads::in_parallel;

/// Suites whose trials are drawn in turn: weak effects, a ladder of sizes, structural twins.
const SUITES: [Suite; 3] = [Suite::NearSingles, Suite::Ladder, Suite::Twins];
/// Share that the chosen recording must settle.
const BAR: f64 = 0.8;
/// Trials that are diagnosed at once, before it is seen how many are ambiguous.
const AT_ONCE: usize = 32;

/// Arguments of `settle-check`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: cargo xtask settle-check --count 10")]
pub struct Arguments {
    /// Ambiguous trials.
    #[arg(long, default_value_t = 100)]
    count: usize,
    /// Rows of the further recording.
    #[arg(long, default_value_t = 3000)]
    rows: usize,
    /// Seed of the trials.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Trials at once (default: one per core).
    #[arg(long)]
    jobs: Option<usize>,
    /// The page to write.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Runs the job.
///
/// # Errors
/// A trial cannot be drawn, or the page not written. That the bar is missed is a result.
pub fn settle(arguments: &Arguments) -> Result<()> {
    ensure!(arguments.count > 0, "--count is 0: a check needs a trial");
    let jobs = match arguments.jobs {
        Some(jobs) => jobs,
        None => std::thread::available_parallelism().map_or(1, usize::from),
    };
    let (found, drawn) = ambiguous(arguments, jobs)?;
    let page = page::page(arguments, &found, drawn)?;
    print!("{page}");
    if let Some(out) = &arguments.out {
        write_atomically(out, page.as_bytes()).with_context(|| out.display().to_string())?;
    }
    Ok(())
}

/// The first ambiguous trials, each with what further recordings made of it, and how many trials were drawn for them.
fn ambiguous(arguments: &Arguments, jobs: usize) -> Result<(Vec<Settled>, usize)> {
    let (mut found, mut drawn) = (Vec::new(), 0);
    while found.len() < arguments.count {
        let progress = Progress::new("diagnosing", AT_ONCE);
        let batch = in_parallel(jobs, AT_ONCE, &progress, |number| {
            let number = drawn + number;
            let suite = SUITES[number % SUITES.len()];
            settled(
                suite,
                (number / SUITES.len()) as u64,
                arguments.seed,
                arguments.rows,
            )
        })?;
        for one in batch {
            if found.len() < arguments.count {
                drawn += 1;
                found.extend(one?);
            }
        }
        eprintln!("{} of {} trials are ambiguous", found.len(), drawn);
    }
    Ok((found, drawn))
}

/// Shares of outcomes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Counts {
    settled: usize,
    wrong: usize,
    open: usize,
}

impl Counts {
    fn of<'s>(outcomes: impl Iterator<Item = &'s Outcome>) -> Self {
        let mut counts = Self::default();
        for outcome in outcomes {
            match outcome {
                Outcome::Settled => counts.settled += 1,
                Outcome::Wrong(_) => counts.wrong += 1,
                Outcome::Open(_) => counts.open += 1,
            }
        }
        counts
    }

    fn all(self) -> usize {
        self.settled + self.wrong + self.open
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_ambiguous_trials_are_recorded_again() {
        let arguments = Arguments {
            count: 1,
            rows: 1200,
            seed: 1,
            jobs: Some(2),
            out: None,
        };
        let (found, drawn) = ambiguous(&arguments, 2).unwrap();
        assert!(found.len() == 1 && drawn > 0);
        let page = page::page(&arguments, &found, drawn).unwrap();
        assert!(page.contains("chosen by `plan --settle`"), "{page}");
        // every further recording has an outcome, and none of them failed
        for outcome in [&found[0].chosen, &found[0].at_random, &found[0].by_hand] {
            assert!(
                !matches!(outcome, Outcome::Open(why) if why.starts_with("error")),
                "{outcome:?}"
            );
        }
    }
}
