//! Runs fixed commands and compares every number of their results with the recorded ones.

mod compare;
mod runs;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use compare::{Difference, compare};
pub(crate) use runs::command;
use runs::{Run, Runs};

/// Where the recorded results are, from the root of the project.
const RECORDED: &str = "fixtures/results/recorded";

/// Arguments of `compare-results`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask compare-results --only gap-set")]
pub(crate) struct Arguments {
    /// Only runs whose name contains this.
    #[arg(long)]
    only: Option<String>,
    /// Records the results instead of comparing them.
    #[arg(long)]
    record: bool,
    /// Folder of data outside this repository; runs that need it are skipped where it is absent.
    #[arg(long, default_value = "../shared")]
    shared: PathBuf,
    /// Folder for the results.
    #[arg(long, default_value = "target/compare-results")]
    out: PathBuf,
    /// Differences that are listed for each file.
    #[arg(long, default_value_t = 8)]
    list: usize,
}

/// Runs the job: an error where a number, a status or a verdict moved.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let runs = Runs::load(Path::new("fixtures/results/runs.toml"))?;
    let program = command()?;
    let (mut moved, mut reworded, mut files, mut skipped) = (0, 0, 0, 0);
    for run in runs.named(arguments.only.as_deref()) {
        if run.shared && !arguments.shared.is_dir() {
            println!("{:32} skipped: no {}", run.name, arguments.shared.display());
            skipped += 1;
            continue;
        }
        let folder = arguments.out.join(&run.name);
        run.execute(&program, &folder, &arguments.shared)?;
        for file in &run.results {
            files += 1;
            let found = runs::read(&folder.join(file))?;
            let recorded = recorded(run, file);
            if arguments.record {
                runs::write(&recorded, &found)?;
                continue;
            }
            let expected = runs::read(&recorded)
                .with_context(|| "no record of this run: --record makes one".to_owned())?;
            let differences = compare(&expected, &found);
            let (words, numbers): (Vec<_>, Vec<_>) = differences
                .iter()
                .partition(|difference| difference.is_of_words());
            moved += numbers.len();
            reworded += words.len();
            print(
                &format!("{}/{file}", run.name),
                &numbers,
                &words,
                arguments.list,
            );
        }
    }
    if files == 0 && skipped == 0 {
        bail!("no run has a name that contains {:?}", arguments.only);
    }
    println!(
        "{files} files: {moved} values moved, {reworded} texts reworded; {skipped} runs skipped"
    );
    if moved > 0 {
        bail!("{moved} values moved");
    }
    Ok(())
}

fn recorded(run: &Run, file: &str) -> PathBuf {
    Path::new(RECORDED).join(format!("{}-{}.gz", run.name, file.replace('/', "-")))
}

fn print(name: &str, numbers: &[&Difference], words: &[&Difference], most: usize) {
    println!(
        "{name:56} {} moved, {} reworded",
        numbers.len(),
        words.len()
    );
    for difference in numbers.iter().take(most) {
        println!("    {difference}");
    }
    if numbers.len() > most {
        println!("    and {} more", numbers.len() - most);
    }
}
