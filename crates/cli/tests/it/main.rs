//! The command from outside: files, standard output and error, exit status.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test that cannot go on fails there; a skipped one says so"
)]

mod bad_input;
mod commands_alone;
mod correct;
mod correction;
mod diagnose;
mod diagnose_refusals;
mod doctor;
mod export;
mod export_header;
mod folder;
mod forward;
mod guides;
mod happy_path;
mod hostile_inputs;
mod hostile_sizes;
mod hostile_writes;
mod humanoid;
mod import;
mod import_poses;
mod import_tables;
mod millimetres;
mod moving_arm;
mod moving_log;
mod mujoco;
mod mujoco_truth;
mod next;
mod other_commands;
mod overwriting;
mod plan;
mod play_log;
mod play_page;
mod play_refusals;
mod python;
mod real_sets;
mod repair;
mod reproduced;
mod reproducible;
mod resealed;
mod robot_formats;
mod settle;
mod shared_data;
mod simulate;
mod simulate_poses;
mod strangers_logs;
mod torques_alone;
mod touches;
mod two_arms;
mod two_hands;
mod urdf;
mod urdf_tree;
mod verify;
mod verify_refusals;
mod watch;
mod wild_readings;

use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::Command;

/// The command under test.
fn haptical() -> Command {
    Command::new(env!("CARGO_BIN_EXE_haptical"))
}

/// A folder with the template device and its sample log.
struct Sandbox {
    folder: tempfile::TempDir,
}

impl Sandbox {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        haptical().arg("init").arg(folder.path()).assert().success();
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn device_text(&self) -> String {
        std::fs::read_to_string(self.path("device.toml")).unwrap()
    }

    fn log_text(&self) -> String {
        std::fs::read_to_string(self.path("log.csv")).unwrap()
    }

    /// Cells of the sample log, the header as row 0: row k is on line k + 1.
    fn cells(&self) -> Vec<Vec<String>> {
        self.log_text()
            .lines()
            .map(|line| line.split(',').map(str::to_owned).collect())
            .collect()
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    fn write_log(&self, cells: &[Vec<String>]) {
        let lines: Vec<String> = cells.iter().map(|row| row.join(",")).collect();
        self.write("log.csv", lines.join("\n") + "\n");
    }

    /// `haptical identify` in the sandbox, with further arguments.
    fn identify(&self, further: &[&str]) -> Output {
        self.run("identify", further)
    }

    /// `haptical diagnose` in the sandbox, with further arguments.
    fn diagnose(&self, further: &[&str]) -> Output {
        self.run("diagnose", further)
    }

    /// Standard output of a command in the sandbox that must succeed.
    fn ran(&self, words: &[&str]) -> String {
        let output = haptical()
            .current_dir(self.folder.path())
            .args(words)
            .output()
            .unwrap();
        assert_eq!(
            output.status.code(),
            Some(0),
            "{words:?}: {}{}",
            text(&output.stdout),
            text(&output.stderr)
        );
        text(&output.stdout)
    }

    /// A JSON file of the sandbox.
    fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_str(&std::fs::read_to_string(self.path(name)).unwrap()).unwrap()
    }

    fn run(&self, command: &str, further: &[&str]) -> Output {
        haptical()
            .current_dir(self.folder.path())
            .args([command, "--device", "device.toml", "--log", "log.csv"])
            .args(["--out", "result"])
            .args(further)
            .output()
            .unwrap()
    }
}

/// Index of a column in the header.
fn column(cells: &[Vec<String>], name: &str) -> usize {
    cells[0].iter().position(|cell| cell == name).unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Names of the files in a folder; none where there is no folder.
fn names_in(folder: &Path) -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}
