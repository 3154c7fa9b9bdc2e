//! The least-squares problems of Moré, Garbow & Hillstrom from three starts: sums, steps, claims.

#[path = "../../../crates/identification/tests/it/mgh/set/mod.rs"]
mod set;

use std::path::Path;

use anyhow::{Result, anyhow};
use haptical_identification::{Convergence, Problem, Settings};
use haptical_report::{Cell, Table};
use xtask_output::{Output, cells, or_none};

use set::judge::{Outcome, run};
use set::{Instance, START_FACTORS, Tables};

/// Why a run reaches no known sum: problem, factors of the start, cause. Shown only where one does not.
const CAUSES: [(&str, &[f64], &str); 5] = [
    (
        "meyer",
        &[100.0],
        "a curved valley as that of NIST's MGH10, which is the same function: still descending at the limit of steps",
    ),
    (
        "box-3d",
        &[100.0],
        "at the start exp(-1000 t) leaves the second column a length of 4e-45; steps scaled by it send x2 to where the \
         column is zero, which is refused, and damping strong enough to stop that stops the other parameters too",
    ),
    (
        "jennrich-sampson",
        &[100.0],
        "the square of exp(400) is beyond the largest number: refused at the start",
    ),
    (
        "chebyquad",
        &[10.0, 100.0],
        "polynomials of degree 8 to 10 far outside \\[0, 1\\], where residuals are 1e10 and more; not looked into \
         further",
    ),
    (
        "osborne-2",
        &[10.0, 100.0],
        "at the start every bell lies beyond the data: nine of the eleven derivatives are exactly zero and stay so, which \
         is what the solver says",
    ),
];

pub(super) fn section(output: &mut Output, folder: &Path) -> Result<()> {
    let (instances, tables) = set::read(folder).map_err(|error| anyhow!(error))?;
    let mut runs = Vec::new();
    for instance in &instances {
        for factor in START_FACTORS {
            let outcome = run(instance, &tables, factor, &Settings::default());
            runs.push(Run {
                instance,
                factor,
                outcome,
            });
        }
    }
    output.section("Moré, Garbow & Hillstrom's problems");
    output.words(
        "The eighteen least-squares problems of Moré, Garbow & Hillstrom (1981) in the sizes of MINPACK's tests, from \
         the standard start, ten times and a hundred times it, with the default settings (`fixtures/mgh`). A known \
         sum is the paper's, to its six digits; zero means below 1e-20. A sum marked `at infinity` has no finite \
         parameters. The offset is the cosine between the residuals and what the derivatives span (Bates & Watts \
         1981), by Gram-Schmidt and not by the solver: 0 at a stationary point of full rank. Of a sum that is \
         zero to rounding it says nothing. A claim is false where the offset is above 1e-6 or the sum is none of \
         the known ones. MINPACK's sums are those of its test program, which tries fewer starts.",
    );
    output.table("mgh", table(&runs, &tables)?)?;
    verdicts(output, &runs);
    causes(output, &runs);
    Ok(())
}

struct Run<'a> {
    instance: &'a Instance,
    factor: f64,
    outcome: Outcome,
}

impl Run<'_> {
    fn name(&self) -> String {
        let (instance, factor) = (self.instance, self.factor);
        let (parameters, residuals) = (instance.start.len(), instance.residual_count());
        format!(
            "{} ({parameters} of {residuals}) from {factor} x0",
            instance.name
        )
    }

    fn judgement(&self) -> String {
        let outcome = &self.outcome;
        let kind = outcome.reached.as_ref().map(|known| known.kind.as_str());
        match (outcome.false_claim(), outcome.claims(), kind) {
            (Some(why), _, _) => format!("FALSE CLAIM: {why}"),
            (None, true, Some("least")) => "found".to_owned(),
            (None, true, Some(kind)) => format!("found, {kind}"),
            (None, false, Some("least")) => "found, no claim".to_owned(),
            (None, false, Some(kind)) => format!("found, {kind}, no claim"),
            (None, _, None) => "not found, no claim".to_owned(),
        }
    }
}

fn table(runs: &[Run<'_>], tables: &Tables) -> Result<Table> {
    let columns = "problem | parameters | residuals | start | sum of squares | known sum | MINPACK's | offset | steps | \
             evaluations | the solver says | judged";
    let mut table = Table::with_heads("Moré, Garbow & Hillstrom, default settings", columns);
    for run in runs {
        let (instance, outcome) = (run.instance, &run.outcome);
        let (parameters, residuals) = (instance.start.len(), instance.residual_count());
        let fit = outcome.fit.as_ref().ok();
        let sum = |value: Option<f64>| value.map_or(Cell::Missing, |v| Cell::scientific(v, 6));
        let minpack = tables.minpack(instance.name, parameters, residuals, run.factor);
        let known = outcome.reached.as_ref().map(|known| known.sum_of_squares);
        let offset = outcome.offset.filter(|_| !outcome.is_zero());
        table.push(cells! {
            instance.name, parameters => 0, residuals => 0, format!("{} x0", run.factor),
            sum(fit.map(|fit| fit.cost)), sum(known), sum(minpack),
            offset.map_or(Cell::Missing, |v| Cell::scientific(v, 1)),
            fit.map(|fit| fit.iterations) => 0, fit.map(|fit| fit.evaluations) => 0,
            claim(outcome), run.judgement(),
        })?;
    }
    Ok(table)
}

fn verdicts(output: &mut Output, runs: &[Run<'_>]) {
    let names = |of: &dyn Fn(&&Run<'_>) -> bool| {
        let names: Vec<String> = runs.iter().filter(of).map(Run::name).collect();
        or_none(&names)
    };
    let claims = runs.iter().filter(|run| run.outcome.claims()).count();
    let is_false = |run: &&Run<'_>| run.outcome.false_claim().is_some();
    let text = format!(
        "false claims among {claims} claims of {} runs: {}",
        runs.len(),
        names(&is_false)
    );
    output.verdict(!runs.iter().any(|run| is_false(&run)), text);
    for factor in START_FACTORS {
        let from: Vec<&Run<'_>> = runs.iter().filter(|run| run.factor == factor).collect();
        let is_missed = |run: &&Run<'_>| run.factor == factor && !run.outcome.is_solved();
        let solved = from.iter().filter(|run| run.outcome.is_solved()).count();
        let text = format!(
            "a known sum is reached from {factor} x0 on {solved} of {}; not on: {}",
            from.len(),
            names(&is_missed)
        );
        output.verdict(solved == from.len(), text);
    }
    let is_silent = |run: &&Run<'_>| run.outcome.is_solved() && !run.outcome.claims();
    let is_maximum = |run: &&Run<'_>| {
        let kind = run.outcome.reached.as_ref().map(|known| &known.kind);
        run.outcome.claims() && kind.is_some_and(|kind| kind == "maximum")
    };
    output.words(format!(
        "Claimed at a maximum: {}. The gradient there is zero to the last bit, and first derivatives cannot tell a \
         maximum from a minimum; MINPACK stops at the same place.",
        names(&is_maximum)
    ));
    output.words(format!(
        "Reached without a claim: {}. There the derivatives are dependent: by construction (rank 1), because columns \
         coincide or vanish at the minimum (Powell, Jennrich & Sampson, Chebyquad, Freudenstein & Roth), or because the \
         parameters run off to infinity (Bard, Kowalik & Osborne). The sum is least, but it does not fix the \
         parameters to first order, so there is no covariance and no claim. Brown & Dennis from 10 x0 has \
         the sum and stops at the limit of steps.",
        names(&is_silent)
    ));
}

fn causes(output: &mut Output, runs: &[Run<'_>]) {
    for run in runs.iter().filter(|run| !run.outcome.is_solved()) {
        let cause = CAUSES
            .iter()
            .find(|(name, factors, _)| *name == run.instance.name && factors.contains(&run.factor));
        let cause = cause.map_or("not looked into", |(_, _, cause)| cause);
        output.words(format!("- {}: {cause}.", run.name()));
    }
}

/// What the solver says, in a word or two.
fn claim(outcome: &Outcome) -> &'static str {
    match outcome.fit.as_ref().map(|fit| fit.convergence) {
        Ok(Convergence::SmallCostChange) => "converged: cost",
        Ok(Convergence::SmallStep) => "converged: step",
        Ok(Convergence::ExactFit) => "converged: exact",
        Ok(Convergence::NoFurtherDescent) => "no descent",
        Ok(Convergence::IterationLimit) => "iteration limit",
        Ok(Convergence::RankLost) => "dependent",
        Err(_) => "refused",
    }
}
