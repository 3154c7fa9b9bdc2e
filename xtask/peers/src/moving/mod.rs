//! MuJoCo's system identification and `diagnose` on logs of a moving arm: `cargo xtask peers-moving`
//! (docs/performance.md, Moving arms).

mod answers;
mod table;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result};
use xtask_blind::Answer;
use xtask_output::{built_command, put_between, read_json, said};

use crate::bench_peers::tools::{Tools, source};
use answers::{Case, Fit, Truth};

const PAGE: &str = "docs/performance.md";
/// Lines between which the table is.
const BEGIN: &str = "<!-- table: cargo xtask peers-moving -->\n";
const END: &str = "<!-- end of table -->\n";

/// How often each is timed; the least counts.
const ROUNDS: usize = 3;

/// Arguments of `peers-moving`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask peers-moving --keep-page")]
pub struct Arguments {
    /// Folder for the logs and the answers.
    #[arg(long, default_value = "target/peers-moving")]
    out: PathBuf,
    /// Folder of the Python environment that `bench-peers` has too.
    #[arg(long, default_value = "target/peers")]
    scratch: PathBuf,
    /// Install no Python packages: take what is there.
    #[arg(long)]
    offline: bool,
    /// A Python with MuJoCo's `sysid`, in the place of those that the job looks for.
    #[arg(long)]
    python: Option<PathBuf>,
    /// Print the table alone and leave docs/performance.md as it is.
    #[arg(long)]
    keep_page: bool,
}

/// Runs the job.
pub fn run(arguments: &Arguments) -> Result<()> {
    let python = match &arguments.python {
        Some(python) => python.clone(),
        None => {
            let tools = Tools::new(&arguments.scratch, !arguments.offline)?;
            // `mujoco.sysid` alone imports without the packages that it needs
            match tools.python("mujoco.sysid._src.optimize", &["mujoco[sysid]"]) {
                Ok(python) => python,
                Err(why) => {
                    println!("not run: MuJoCo makes the logs and is not here: {why}");
                    return Ok(());
                }
            }
        }
    };
    let program = built_command(Path::new("."))?;
    let out = &arguments.out;
    peer(&python, ["record".as_ref(), out.as_os_str()])?;
    let truth: Truth = read_json(&out.join("truth.json"))?;
    let mut cases = Vec::new();
    for withheld in truth.cases.keys() {
        println!("{withheld}");
        let mut case = ask(&python, &program, out, withheld)?;
        // a machine that others use is slow at times, never fast
        for _ in 1..ROUNDS {
            let again = ask(&python, &program, out, withheld)?;
            case.fit.seconds = case.fit.seconds.min(again.fit.seconds);
            case.gap_s = case.gap_s.min(again.gap_s);
        }
        cases.push(case);
    }
    let table = table::table(&truth, &cases)?;
    print!("{table}");
    if !arguments.keep_page {
        put_between(Path::new(PAGE), [BEGIN, END], &table)?;
    }
    Ok(())
}

/// Both programs on one log.
fn ask(python: &Path, program: &Path, folder: &Path, withheld: &str) -> Result<Case> {
    let answer = peer(
        python,
        ["fit".as_ref(), folder.as_os_str(), withheld.as_ref()],
    )?;
    let fit: Fit = serde_json::from_str(&answer).context("the answer of mujoco_sysid.py")?;
    let (gap, gap_s) = diagnose(program, folder, withheld)?;
    Ok(Case {
        withheld: withheld.to_owned(),
        fit,
        gap,
        gap_s,
    })
}

/// Runs `mujoco_sysid.py`; returns what it prints.
fn peer<'a>(python: &Path, words: impl IntoIterator<Item = &'a OsStr>) -> Result<String> {
    let script = source("mujoco_sysid.py");
    said(Command::new(python).arg(script).args(words))
}

/// `gap.json` of one log and its second, with the seconds from the start of the process to its end.
fn diagnose(program: &Path, folder: &Path, withheld: &str) -> Result<(Answer, f64)> {
    let out = folder.join(format!("gap-{withheld}"));
    let started = Instant::now();
    let mut command = Command::new(program);
    command.args(["diagnose", "--force"]);
    for (flag, file) in [
        ("--device", folder.join("arm.xml")),
        ("--log", folder.join(format!("{withheld}.csv"))),
        ("--validate", folder.join(format!("{withheld}-second.csv"))),
        ("--out", out.clone()),
    ] {
        command.arg(flag).arg(file);
    }
    said(&mut command)?;
    let seconds = started.elapsed().as_secs_f64();
    Ok((read_json(&out.join("gap.json"))?, seconds))
}
