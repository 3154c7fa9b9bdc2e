//! Whole commands over the rows of their logs: `cargo xtask bench-whole` (docs/performance.md, Whole commands).

mod process;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use xtask_output::{built_command, put_between};

use process::{Cost, cost};

const PAGE: &str = "docs/performance.md";
/// Lines between which the table is.
const BEGIN: &str = "<!-- table: cargo xtask bench-whole -->\n";
const END: &str = "<!-- end of the table of whole commands -->\n";

const DEVICE: &str = "fixtures/devices/haptic7.toml";
/// What the device file of half of the logs lacks.
const EFFECT: &str =
    "[[effect]]\nname = \"capstan-compliance\"\njoint = 2\nstiffness_nm_per_rad = 260.0\n";
/// Seconds and rows a second of the motions.
const MOTIONS: [(u32, u32); 4] = [(20, 50), (20, 300), (20, 1000), (100, 1000)];
/// Rows from which on nothing is diagnosed here: at 100 000 the log decides, and not the rows.
const MOST_DIAGNOSED: u32 = 20_000;

/// Arguments of `bench-whole`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask bench-whole --keep-page")]
pub struct Arguments {
    /// Folder for the logs and the answers.
    #[arg(long, default_value = "target/bench-whole")]
    out: PathBuf,
    /// A built command, in the place of the one that the job builds.
    #[arg(long)]
    binary: Option<PathBuf>,
    /// How often each is run: the median counts.
    #[arg(long, default_value_t = 3)]
    rounds: usize,
    /// Print the table alone and leave docs/performance.md as it is.
    #[arg(long)]
    keep_page: bool,
}

/// A command on a log of so many rows.
struct Work {
    name: String,
    rows: u32,
    words: Vec<String>,
    /// The command that does nothing but read the log and say what is in it.
    reading: Option<Vec<String>>,
}

/// Runs the job.
pub fn run(arguments: &Arguments) -> Result<()> {
    if !cfg!(target_os = "linux") {
        println!("not run: processor time and memory of a process are read from /proc");
        return Ok(());
    }
    let program = match &arguments.binary {
        Some(binary) => binary.clone(),
        None => built_command(Path::new("."))?,
    };
    fs::create_dir_all(&arguments.out)?;
    let mut table = String::from(
        "| command | rows | processor time [s] | over reading | memory [MB] |\n| --- | --- | --- | --- | --- |\n",
    );
    for work in works(&program, &arguments.out)? {
        let median = |words: &[String]| -> Result<Cost> {
            let rounds = 0..arguments.rounds.max(1);
            let mut all: Vec<Cost> = rounds
                .map(|_| cost(&program, words))
                .collect::<Result<_>>()?;
            all.sort_by(|a, b| a.processor_s.total_cmp(&b.processor_s));
            Ok(all[all.len() / 2])
        };
        let own = median(&work.words)?;
        let reading = work.reading.as_deref().map(median).transpose()?;
        let over = reading.map_or("–".to_owned(), |reading| {
            format!("{:.1}", own.processor_s / reading.processor_s.max(0.01))
        });
        let row = format!(
            "| {} | {} | {:.2} | {over} | {:.0} |\n",
            work.name, work.rows, own.processor_s, own.memory_mb
        );
        print!("{row}");
        table += &row;
    }
    if !arguments.keep_page {
        put_between(Path::new(PAGE), [BEGIN, END], &table)?;
    }
    Ok(())
}

/// All that is timed; their logs are made.
fn works(program: &Path, folder: &Path) -> Result<Vec<Work>> {
    let effects = folder.join("effects.toml");
    fs::write(&effects, EFFECT).with_context(|| effects.display().to_string())?;
    let out = folder.join("answer").display().to_string();
    let words = |text: &str| -> Vec<String> { text.split(' ').map(str::to_owned).collect() };
    let mut works = Vec::new();
    for (seconds, rate_hz) in MOTIONS {
        let rows = seconds * rate_hz;
        for (kind, with) in [("", None), (", an effect missing", Some(&effects))] {
            let log = folder.join(format!("{rows}{}.csv", with.map_or("", |_| "-effect")));
            let log = log.display();
            let mut simulate = words(&format!(
                "simulate --device {DEVICE} --deviate 0.3 --seconds {seconds} --rate-hz {rate_hz} --seed 1 --out {log} --force"
            ));
            if let Some(effects) = with {
                simulate.extend(["--effects".to_owned(), effects.display().to_string()]);
            }
            cost(program, &simulate)?;
            let reading = words(&format!("check {DEVICE} {log}"));
            let mut add = |command: &str| {
                works.push(Work {
                    name: format!("`{command}`{kind}"),
                    rows,
                    words: words(&format!(
                        "{command} --device {DEVICE} --log {log} --out {out} --force"
                    )),
                    reading: Some(reading.clone()),
                });
            };
            add("identify");
            if rows <= MOST_DIAGNOSED {
                add("diagnose");
            }
        }
    }
    works.push(Work {
        name: "`plan` of 60 poses".to_owned(),
        rows: 60,
        words: words(&format!(
            "plan --device {DEVICE} --poses 60 --out {out} --force"
        )),
        reading: None,
    });
    Ok(works)
}
