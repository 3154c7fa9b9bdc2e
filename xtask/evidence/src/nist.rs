//! The 27 certified nonlinear regressions of NIST, from both starts: digits, steps, claims.

#[path = "../../../crates/identification/tests/it/nist/set/mod.rs"]
mod set;

use std::path::Path;

use anyhow::{Result, anyhow};
use haptical_identification::Settings;
use haptical_report::Table;
use xtask_output::{Output, cells, or_none};

use set::digits::{CERTIFIED_DIGITS, Score};
use set::{Certified, read_all};

/// Digits of parameters and residual sum of squares that count as solved.
const SOLVED_DIGITS: f64 = 8.0;
/// Digits of standard deviations.
const DEVIATION_DIGITS: f64 = 6.0;
/// How many of the problems must be solved from start 1 and from start 2.
const BARS: [usize; 2] = [24, 25];
/// Enough for the long valley of MGH10.
const PATIENCE: usize = 20_000;

pub(super) fn section(output: &mut Output, folder: &Path) -> Result<()> {
    let problems = read_all(folder).map_err(|error| anyhow!(error))?;
    let defaults = Settings::default();
    output.section("Solver against certified problems");
    output.words(format!(
        "The nonlinear regressions of NIST's Statistical Reference Datasets (`fixtures/nist`), from start 1, which is \
         far, and start 2, which is near. A score is the log relative error, -log10 |value - certified| / |certified|, \
         of the worst parameter, of the worst standard deviation and of the residual sum of squares; certified values \
         have {CERTIFIED_DIGITS} digits. The settings are the defaults, none is chosen for a problem: a search stops once the \
         undamped step promises less than {:e} of the sum, or after {} steps.",
        defaults.cost_tolerance, defaults.max_iterations
    ));
    start_tables(output, &problems, &defaults)?;
    patience(output, &problems, &defaults)
}

fn start_tables(output: &mut Output, problems: &[Certified], settings: &Settings) -> Result<()> {
    for (start, bar) in BARS.into_iter().enumerate() {
        let scores = problems
            .iter()
            .map(|problem| Score::new(problem, start, settings))
            .collect::<Result<Vec<_>, _>>()?;
        let file = format!("nist-start-{}", start + 1);
        let title = format!("NIST, start {}", start + 1);
        output.table(&file, table(&title, problems, &scores)?)?;
        verdicts(output, &title, &scores, bar);
    }
    Ok(())
}

fn table(title: &str, problems: &[Certified], scores: &[Score]) -> Result<Table> {
    let columns = "problem | parameters | digits of parameters | of standard deviations | of the sum | steps | \
             evaluations | the solver says";
    let mut table = Table::with_heads(title, columns);
    for (problem, score) in problems.iter().zip(scores) {
        table.push(cells! {
            score.name, problem.parameters.len() => 0, score.parameters => 1,
            score.standard_deviations => 1, score.cost => 1, score.fit.iterations => 0,
            score.fit.evaluations => 0, score.fit.convergence.to_string(),
        })?;
    }
    Ok(table)
}

fn verdicts(output: &mut Output, title: &str, scores: &[Score], bar: usize) {
    let named = |of: &dyn Fn(&Score) -> bool| {
        let names = scores.iter().filter(|score| of(score));
        or_none(&names.map(|score| score.name).collect::<Vec<&str>>())
    };
    let is_solved = |score: &&Score| score.has_digits(SOLVED_DIGITS);
    let solved = scores.iter().filter(is_solved).count();
    let text = format!(
        "{title}: {SOLVED_DIGITS} digits of every parameter and of the sum on {solved} of {} (bar: {bar}); not on: {}",
        scores.len(),
        named(&|score| !score.has_digits(SOLVED_DIGITS)),
    );
    output.verdict(solved >= bar, text);
    let is_coarse = |score: &Score| score.standard_deviations < DEVIATION_DIGITS;
    let coarse = scores.iter().filter(|score| is_coarse(score));
    let text = format!(
        "{title}: {DEVIATION_DIGITS} digits of every standard deviation, but for: {}",
        named(&is_coarse)
    );
    output.verdict(scores.len() - coarse.count() >= bar, text);
    let text = format!(
        "{title}: false claims of convergence: {}",
        named(&Score::is_false_claim)
    );
    output.verdict(!scores.iter().any(Score::is_false_claim), text);
}

/// What resists from the far start, with more steps allowed.
fn patience(output: &mut Output, problems: &[Certified], settings: &Settings) -> Result<()> {
    let patient = Settings {
        max_iterations: PATIENCE,
        ..settings.clone()
    };
    for problem in problems {
        let hasty = Score::new(problem, 0, settings)?;
        if hasty.fit.convergence.was_successful() {
            continue;
        }
        let score = Score::new(problem, 0, &patient)?;
        output.words(format!(
            "{} from start 1 with {PATIENCE} steps allowed: {} after {} steps, {:.1} digits of the \
             parameters.",
            score.name, score.fit.convergence, score.fit.iterations, score.parameters
        ));
    }
    output.words(
        "Lanczos1's certified sum is 1.4e-25: its residuals are differences of 1e-13 between numbers near 2, which \
         doubles hold to 2e-16. Its parameters count; of its sum and its standard deviations no more than three digits \
         exist in this arithmetic.",
    );
    Ok(())
}
