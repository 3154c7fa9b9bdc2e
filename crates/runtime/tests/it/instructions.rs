//! A step of the 7-DOF device takes fewer instructions than a control loop grants it.

use std::path::Path;
use std::process::Command;

/// Instructions of one step with torques that the loop grants.
const GRANTED: u64 = 4000;
/// The same with three effects at three joints.
const GRANTED_WITH_EFFECTS: u64 = 5400;
/// Steps of the two counted runs: their difference leaves start and end of the program out.
const STEPS: [u64; 2] = [500, 2500];

/// Instructions of a run of the example.
fn counted(example: &Path, steps: u64, device: &str) -> u64 {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(example)
        .args([&steps.to_string(), device])
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    let line = said.lines().find(|line| line.contains("Collected"));
    let count = line.and_then(|line| line.rsplit(' ').next()?.parse().ok());
    count.unwrap_or_else(|| panic!("no count from valgrind:\n{said}"))
}

#[test]
fn a_step_with_torques_takes_fewer_instructions_than_granted() {
    if cfg!(debug_assertions) {
        println!("skipped: only an optimised build is counted (cargo test --release)");
        return;
    }
    let test = std::env::current_exe().unwrap();
    let example = test.parent().unwrap().join("../examples/one_step_loop");
    if !example.exists() || Command::new("valgrind").arg("--version").output().is_err() {
        println!("skipped: there is no valgrind, or the example was not built");
        return;
    }
    for (device, granted) in [
        ("polynomial", GRANTED),
        ("parallelogram", GRANTED),
        ("effects", GRANTED_WITH_EFFECTS),
    ] {
        let [short, long] = STEPS.map(|steps| counted(&example, steps, device));
        let per_step = (long - short) / (STEPS[1] - STEPS[0]);
        println!("{device}: {per_step} instructions per step");
        assert!(per_step < granted, "{device}: {per_step}");
        assert!(per_step > 500, "{device}: {per_step} is not a step");
    }
}
