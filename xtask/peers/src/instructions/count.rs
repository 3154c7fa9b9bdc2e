//! One workload: counted from outside, run inside.

use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use super::environment::lanes;
use super::workloads::{Job, Workload};

/// Function whose instructions callgrind collects, with all that it calls.
const COLLECTED: &str = "--toggle-collect=*collected_by_callgrind*";

/// Runs the workload `name` of this program under callgrind, on one thread: its instructions, and the lanes that it was offered.
pub(crate) fn count(name: &str) -> Result<(u64, String)> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(COLLECTED)
        .arg(std::env::current_exe()?)
        .args(["instructions", "--run", name])
        .env("RAYON_NUM_THREADS", "1")
        .output()
        .context("valgrind cannot be started")?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(
        output.status.success(),
        "it ended with {} under valgrind, which said:\n{said}",
        output.status
    );
    let Some(instructions) = collected(&said) else {
        bail!("valgrind said no count:\n{said}");
    };
    ensure!(
        instructions > 0,
        "valgrind collected nothing: it does not see the function of {COLLECTED}; was the program stripped?"
    );
    let lanes = String::from_utf8_lossy(&output.stdout);
    Ok((instructions, lanes.trim().to_owned()))
}

/// N of callgrind's line `==PID== Collected : N`.
pub(crate) fn collected(said: &str) -> Option<u64> {
    let mut lines = said.lines();
    let line = lines.find_map(|line| line.split_once("Collected :"))?;
    line.1.trim().parse().ok()
}

/// The counted process: prepares, then works where callgrind collects. Gives the lanes that it was offered.
pub(crate) fn run(workload: &Workload) -> Result<String> {
    // this thread is the pool: callgrind collects thread by thread, and no other one waits in a loop
    rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build_global()?;
    let mut job = workload.prepare()?;
    collected_by_callgrind(&mut job)?;
    Ok(lanes())
}

/// Its name is what callgrind looks for.
#[inline(never)]
fn collected_by_callgrind(job: &mut Job) -> Result<()> {
    job()
}
