//! Instruction counts of fixed workloads under callgrind, compared with committed ones.

mod committed;
mod compare;
mod count;
mod environment;
mod growth;
mod output;
#[cfg(test)]
mod tests;
mod workloads;

use std::path::PathBuf;

use anyhow::{Context, Result, anyhow, bail, ensure};
use rayon::prelude::*;
use xtask_output::{Progress, root};

use compare::Comparison;
use environment::Environment;
use output::Results;
use workloads::{Workload, all};

/// Arguments of `instructions`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples: cargo xtask instructions --quick\n          \
                         cargo xtask instructions --only csv-rows,fit-200-poses --json\n          \
                         cargo xtask instructions --record     after a change that moves counts\n          \
                         cargo xtask instructions --growth     over logs of 1000 to 8000 rows")]
pub struct Arguments {
    /// Commit these counts instead of comparing them: writes `fixtures/instructions/VERSION.toml`.
    #[arg(long)]
    record: bool,
    /// Only these workloads.
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "NAME",
        conflicts_with = "quick"
    )]
    only: Vec<String>,
    /// Leave out the workloads that take valgrind more than ten seconds.
    #[arg(long)]
    quick: bool,
    /// How the instructions of commands grow with the rows of their logs, in the place of the workloads: some minutes
    #[arg(long, conflicts_with_all = ["record", "only", "quick", "json"])]
    growth: bool,
    /// Print JSON alone.
    #[arg(long)]
    json: bool,
    /// Run one workload, as the counted process does.
    #[arg(long, hide = true, value_name = "NAME")]
    run: Option<String>,
}

/// Where the committed counts are, one file for each version of the compiler.
fn folder() -> PathBuf {
    root().join("fixtures/instructions")
}

/// Runs the job.
pub fn instructions(arguments: &Arguments) -> Result<()> {
    if let Some(name) = &arguments.run {
        let of_growth = growth::WORKLOADS
            .into_iter()
            .find(|known| known.name == *name);
        let workload = match of_growth {
            Some(workload) => workload,
            None => chosen(std::slice::from_ref(name))?[0],
        };
        let lanes = count::run(&workload)?;
        println!("{lanes}");
        return Ok(());
    }
    if arguments.growth {
        let environment =
            Environment::here().map_err(|why| anyhow!("nothing can be counted: {why}"))?;
        let (_, counts) = counted(environment, &growth::WORKLOADS)?;
        return growth::judge(&counts);
    }
    let mut workloads = chosen(&arguments.only)?;
    workloads.retain(|workload| !(arguments.quick && workload.is_long));
    let environment = match Environment::here() {
        Ok(environment) => environment,
        Err(why) if arguments.record => bail!("nothing can be recorded: {why}"),
        Err(why) => return output::nothing_counted(&why, arguments.json),
    };
    let (environment, counts) = counted(environment, &workloads)?;
    let folder = folder();
    let known: Vec<&str> = all().map(|workload| workload.name).collect();
    if arguments.record {
        let is_part = workloads.len() < known.len();
        let path = committed::record(&folder, &environment, &counts, &known, is_part)?;
        let path = path.canonicalize().unwrap_or(path);
        eprintln!("recorded: {}", path.display());
    }
    let found = committed::find(&folder, &environment)?;
    let comparison = found.map(|found| Comparison::new(&counts, &found.instructions, &known));
    let results = Results {
        environment: &environment,
        workloads: &workloads,
        counts: &counts,
        comparison: comparison.as_ref(),
    };
    results.print(arguments.json)?;
    let failures = comparison.map_or_else(|_| Vec::new(), |comparison| comparison.failures());
    ensure!(
        failures.is_empty(),
        "{}\nwhere the change is meant, commit it: cargo xtask instructions --record",
        failures.join("\n")
    );
    Ok(())
}

/// The workloads of these names; all if there are none.
fn chosen(names: &[String]) -> Result<Vec<Workload>> {
    let known: Vec<&str> = all().map(|workload| workload.name).collect();
    if let Some(name) = names.iter().find(|name| !known.contains(&name.as_str())) {
        bail!(
            "there is no workload `{name}`; known are {}",
            known.join(", ")
        );
    }
    let wanted = |workload: &Workload| names.is_empty() || names.iter().any(|n| n == workload.name);
    Ok(all().filter(wanted).collect())
}

/// Counts every workload in a process of its own, several at a time: counts do not depend on the load.
fn counted(
    environment: Environment,
    workloads: &[Workload],
) -> Result<(Environment, Vec<(&'static str, u64)>)> {
    let progress = Progress::new("counting instructions", workloads.len());
    let count = |workload: &Workload| {
        let count = count::count(workload.name).context(workload.name);
        progress.step();
        let (instructions, lanes) = count?;
        Ok(((workload.name, instructions), lanes))
    };
    let counted = workloads.par_iter().with_max_len(1).map(count);
    let counted = counted.collect::<Result<Vec<_>>>()?.into_iter();
    let (counts, lanes): (Vec<_>, Vec<String>) = counted.unzip();
    let environment = Environment {
        lanes: lanes.into_iter().next().unwrap_or_default(),
        ..environment
    };
    Ok((environment, counts))
}
