//! The log of scored runs in docs/blind-checks.md.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use haptical_report::write_atomically;
use serde::Serialize;

use crate::measure::Measure;

/// The log, from the root of the repository.
pub(crate) const LOG: &str = "docs/blind-checks.md";
/// Rows come before this line.
const END: &str = "<!-- end of scored runs -->";

/// What a row says besides its figures.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Run {
    /// YYYY-MM-DD.
    pub(crate) date: String,
    /// Commit that was tried.
    pub(crate) commit: String,
    /// Commit that froze the thresholds.
    pub(crate) frozen_by: String,
    pub(crate) seed: u64,
    /// Commits that changed the diagnosis after the freeze.
    pub(crate) changes_since: usize,
    pub(crate) counts: String,
}

/// Headline figures, a line each: group and name as in the table of bars, and what a row calls them.
const HEADLINES: &str = "\
clean sets | named, all | clean: named
clean sets | any verdict but no-gap, all | clean: any verdict but no-gap
strong singles | answered `named` | strong singles: named
strong singles | top name alone right | strong singles: top name right
detected singles | family right up to the declared class | detected singles: right
precision of `named` | all suites together | precision of named
withheld and never in the catalogue | unknown or a twin class, together | withheld or in no catalogue: unknown
withheld and never in the catalogue | confidently wrong, together | the same: confidently wrong
two effects | both found | two effects: both found
two effects | false extra causes per set | two effects: false causes
held-out gap where the name is right | truly closed, median, strong singles | gap closed
held-out gap where the name is right | interval holds the true shrink, strong singles | shrink intervals that hold
expected calibration error, unknown included | all suites together | calibration error
95 % intervals of effect parameters hold the truth | all suites with names | parameter intervals that hold
near-threshold effects | detected | near threshold: detected
near-threshold effects | right, of detected | near threshold: right of detected
the loop: a corrected device on a fresh recording | gap closed, median, all | corrected device on a fresh recording: gap closed
the loop: a corrected device on a fresh recording | gap closed, worst tenth, all | in the worst tenth
the loop: a corrected device on a fresh recording | then no gap against it, all | then no gap
an effect that is not there | fitted, and said not to be shown | absent effects not shown
moving arms | clean: any verdict but no-gap | moving arms, clean: any verdict but no-gap
moving arms | strong: right, of detected | moving arms, strong: right of detected
moving arms | no name is right: confidently wrong, of detected | moving arms, no name is right: confidently wrong";

/// The columns of the headline figures.
pub(crate) fn headlines() -> impl Iterator<Item = [&'static str; 3]> {
    HEADLINES.lines().map(|line| {
        let mut cells = line.split(" | ");
        [(); 3].map(|()| cells.next().unwrap_or_default())
    })
}

/// Adds a row to the log below `root`.
pub(crate) fn append(root: &Path, run: &Run, measures: &[Measure]) -> Result<()> {
    let path = root.join(LOG);
    let text = std::fs::read_to_string(&path).with_context(|| LOG.to_owned())?;
    let text = with_row(&text, &row(&text, run, measures)?)?;
    write_atomically(&path, text.as_bytes())?;
    Ok(())
}

/// The log with one row more.
pub(crate) fn with_row(text: &str, row: &str) -> Result<String> {
    let found: Vec<_> = text.match_indices(END).collect();
    ensure!(
        found.len() == 1,
        "{LOG} has {} lines `{END}`, one is needed",
        found.len()
    );
    let (before, after) = text.split_at(found[0].0);
    Ok(format!("{before}{row}\n{after}"))
}

/// The row of a run; `text` is the log so far, which knows whether the seed was used before.
pub(crate) fn row(text: &str, run: &Run, measures: &[Measure]) -> Result<String> {
    let judged = measures.iter().filter(|one| one.bar.is_some());
    let met = judged.clone().filter(|one| one.met == Some(true)).count();
    let seed = format!("| {} |", run.seed);
    let mut remarks = Vec::new();
    remarks.push(if text.contains(&seed) {
        "seed used before".to_owned()
    } else {
        "first with this seed".to_owned()
    });
    if run.changes_since > 0 {
        remarks.push(format!(
            "{} commits changed the diagnosis after the freeze",
            run.changes_since
        ));
    }
    let mut figures = Vec::new();
    for [group, name, short] in headlines() {
        let found = measures
            .iter()
            .find(|one| one.group == group && one.name == name);
        let found = found.with_context(|| format!("no figure `{group}: {name}`"))?;
        figures.push(format!("{short} {}", found.value.words()));
    }
    let cells = [
        run.date.clone(),
        run.commit.clone(),
        run.frozen_by.clone(),
        run.seed.to_string(),
        run.counts.clone(),
        format!("{met} of {}", judged.count()),
        figures.join("; "),
        remarks.join(", "),
    ];
    Ok(format!("| {} |", cells.join(" | ")))
}
