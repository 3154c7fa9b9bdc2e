//! What a process costs, as Linux counts it.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use anyhow::{Context, Result, ensure};

/// Parts of a second in which Linux counts a process's time (proc(5), `_SC_CLK_TCK`, 100 on all its processors).
const TICKS_PER_S: f64 = 100.0;
const BETWEEN_LOOKS: Duration = Duration::from_millis(3);

#[derive(Debug, Clone, Copy)]
pub(super) struct Cost {
    /// User and system time of all threads \[s\].
    pub(super) processor_s: f64,
    /// Most that was in memory \[MB\].
    pub(super) memory_mb: f64,
}

/// Runs a program to its end; what it writes to the terminal is dropped.
pub(super) fn cost(program: &Path, words: &[String]) -> Result<Cost> {
    let mut command = Command::new(program);
    let command = command.args(words).stdin(Stdio::null());
    let mut child = command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .with_context(|| program.display().to_string())?;
    let folder = format!("/proc/{}", child.id());
    let mut memory_mb: f64 = 0.0;
    // one that has ended keeps its times until it is waited for
    let ticks = loop {
        let stat = fs::read_to_string(format!("{folder}/stat"))?;
        let (state, ticks) = state_and_ticks(&stat).context("a line of /proc/PID/stat")?;
        if state == 'Z' {
            break ticks;
        }
        if let Ok(status) = fs::read_to_string(format!("{folder}/status")) {
            memory_mb = memory_mb.max(peak_mb(&status).unwrap_or(0.0));
        }
        sleep(BETWEEN_LOOKS);
    };
    let status = child.wait()?;
    ensure!(
        status.success(),
        "{} {}: {status}",
        program.display(),
        words.join(" ")
    );
    Ok(Cost {
        processor_s: ticks / TICKS_PER_S,
        memory_mb,
    })
}

/// State, and user and system time: fields 3, 14 and 15; the name before them may have blanks.
fn state_and_ticks(stat: &str) -> Option<(char, f64)> {
    let (_, rest) = stat.rsplit_once(')')?;
    let mut fields = rest.split_whitespace();
    let state = fields.next()?.chars().next()?;
    let mut times = fields.skip(10).map(str::parse::<f64>);
    let (user, system) = (times.next()?.ok()?, times.next()?.ok()?);
    Some((state, user + system))
}

fn peak_mb(status: &str) -> Option<f64> {
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kb: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kb / 1024.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_counted_behind_the_name() {
        let stat = "7 (a b) c) Z 1 7 7 0 -1 4 9 9 0 0 120 30 8 8 20 0";
        assert_eq!(state_and_ticks(stat), Some(('Z', 150.0)));
        assert_eq!(peak_mb("Name: a\nVmHWM:\t   2048 kB\n"), Some(2.0));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_program_that_ends_with_an_error_is_one() {
        let program = Path::new("/bin/sh");
        assert!(cost(program, &["-c".to_owned(), "exit 3".to_owned()]).is_err());
        let busy = "i=0; while [ $i -lt 200000 ]; do i=$((i+1)); done";
        let found = cost(program, &["-c".to_owned(), busy.to_owned()]).unwrap();
        assert!(
            found.processor_s > 0.02 && found.memory_mb > 0.3,
            "{found:?}"
        );
    }
}
