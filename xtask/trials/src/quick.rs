//! A quick check refuses gross errors alone, for a few trials say no more.

use anyhow::{Result, ensure};

use super::batch::Case;

/// Clean recordings with another verdict than `no-gap`, of 6, that a quick check lets pass.
const CLEAN_FAULTS: usize = 1;
/// Share of torques and forces of no catalogue that may be answered `no-gap`.
const FOREIGN_UNSEEN: f64 = 0.5;
/// Share of strong single effects that must be answered rightly.
const SINGLES_RIGHT: f64 = 0.6;

/// Refuses a batch in which something is broken. Seals were opened before.
pub(crate) fn assert_sound(cases: &[Case], repeats: bool) -> Result<()> {
    let failed: Vec<String> = cases
        .iter()
        .filter_map(|case| {
            let error = case.error.as_ref()?;
            Some(format!("{} {}: {error}", case.suite, case.index))
        })
        .collect();
    ensure!(failed.is_empty(), "no answer:\n{}", failed.join("\n"));
    ensure!(repeats, "the same trial had two answers");
    let of = |suite: &str| -> Vec<bool> {
        let wanted = cases.iter().filter(|case| case.suite == suite);
        let right = wanted.filter_map(|case| Some(case.score.as_ref()?.right));
        right.collect()
    };
    let alarms = of("s0").iter().filter(|right| !**right).count();
    ensure!(
        alarms <= CLEAN_FAULTS,
        "{alarms} clean recordings have another verdict than no-gap"
    );
    let foreign = cases.iter().filter(|case| case.suite == "sfu");
    let foreign: Vec<_> = foreign.filter_map(|case| case.score.as_ref()).collect();
    let unseen = foreign.iter().filter(|score| !score.detected).count();
    ensure!(
        unseen as f64 <= FOREIGN_UNSEEN * foreign.len() as f64,
        "{unseen} of {} foreign torques and forces are answered no-gap",
        foreign.len()
    );
    let mut loops = cases.iter().filter_map(|case| case.closing.as_ref());
    ensure!(
        loops.all(|own| own.effects.is_empty() || own.closed_percent.is_some_and(f64::is_finite)),
        "a corrected device predicts nothing of a fresh recording"
    );
    let singles = of("s1");
    let right = singles.iter().filter(|right| **right).count();
    ensure!(
        right as f64 >= SINGLES_RIGHT * singles.len() as f64,
        "{right} of {} strong single effects are answered rightly",
        singles.len()
    );
    Ok(())
}
