//! Plants the faults of `fixtures/mutants` one after the other in a copy of the sources, and expects that named tests notice.

mod check;
mod fault;
mod tree;

use std::time::Instant;

use anyhow::{Result, bail, ensure};
use xtask_output::root;

use check::Bench;
use fault::{Fault, diff_of};
use tree::Tree;

/// Arguments of `mutants`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask mutants --only dynamics")]
pub(crate) struct Arguments {
    /// Only faults whose name starts with this.
    #[arg(long, default_value = "")]
    only: String,
    /// Lists the faults and plants none.
    #[arg(long)]
    list: bool,
}

/// Runs the job.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let mut faults = fault::read(&root())?;
    faults.retain(|fault| fault.name.starts_with(&arguments.only));
    ensure!(!faults.is_empty(), "no fault of that name");
    if arguments.list {
        for fault in &faults {
            println!("{:32} {}", fault.name, fault.meaning);
        }
        return Ok(());
    }
    let folder = root().join("target/mutants");
    let tree = Tree::copied(&root(), &folder)?;
    let bench = Bench::new(tree.path(), &folder);
    pass_without_a_fault(&bench, &faults)?;
    let mut missed = Vec::new();
    for fault in &faults {
        let began = Instant::now();
        let line = match caught(&tree, &bench, fault) {
            Ok(by) => format!("caught by {by}"),
            Err(error) => {
                missed.push(fault.name.as_str());
                format!("{error:#}")
            }
        };
        let seconds = began.elapsed().as_secs_f64();
        println!("{:32} {seconds:5.0} s  {line}", fault.name);
    }
    let (caught, all) = (faults.len() - missed.len(), faults.len());
    println!("{caught} of {all} faults are caught");
    ensure!(missed.is_empty(), "not caught: {}", missed.join(", "));
    Ok(())
}

/// Without a fault each check passes, so that its failure is the fault's doing.
fn pass_without_a_fault(bench: &Bench, faults: &[Fault]) -> Result<()> {
    let mut checks: Vec<_> = faults.iter().flat_map(|fault| &fault.caught_by).collect();
    checks.sort();
    checks.dedup();
    for check in checks {
        let began = Instant::now();
        if let Some(by) = bench.run(check)? {
            bail!("{check} fails without a fault: {by}");
        }
        let seconds = began.elapsed().as_secs_f64();
        println!(
            "{:32} {seconds:5.0} s  passes without a fault",
            check.to_string()
        );
    }
    Ok(())
}

/// Plants a fault, runs its checks and takes it out again; what caught it.
fn caught(tree: &Tree, bench: &Bench, fault: &Fault) -> Result<String> {
    let planted = tree.plant(&diff_of(&root(), &fault.name))?;
    let found = fault.caught_by.iter().map(|check| bench.run(check));
    let found: Result<Vec<_>> = found.collect();
    tree.restore(&planted)?;
    let mut named = Vec::new();
    for (check, by) in fault.caught_by.iter().zip(found?) {
        match by {
            Some(by) => named.push(format!("{check}: {by}")),
            None => bail!("SURVIVED {check}"),
        }
    }
    Ok(named.join("; "))
}

#[cfg(test)]
mod tests {
    use super::fault::{diff_of, read};
    use super::root;
    use super::tree::apply;

    #[test]
    fn every_fault_has_a_diff_that_applies_and_every_diff_a_fault() {
        let faults = read(&root()).unwrap();
        for fault in &faults {
            apply(&root(), &diff_of(&root(), &fault.name), &["--check"]).unwrap();
            assert!(!fault.caught_by.is_empty(), "{}", fault.name);
        }
        let mut named: Vec<_> = faults
            .iter()
            .map(|fault| diff_of(&root(), &fault.name))
            .collect();
        let mut there: Vec<_> = std::fs::read_dir(root().join("fixtures/mutants"))
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|path| path.extension().is_some_and(|end| end == "diff"))
            .collect();
        named.sort();
        there.sort();
        assert_eq!(named, there);
    }
}
