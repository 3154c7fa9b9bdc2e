//! Builds what a check needs in the copy of the sources, and runs it.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, ensure};
use serde_json::Value;

use xtask_output::{cargo, said};

use super::fault::{Check, Target};

/// What runs for longer hangs by the fault: the tests named take seconds without it.
const LONGEST: Duration = Duration::from_secs(90);
const NO_END: &str = "no end within 90 s";

/// The copy, a folder for what is built from it, and a file for what a check prints.
pub(super) struct Bench {
    tree: PathBuf,
    built: PathBuf,
    printed: PathBuf,
}

impl Bench {
    pub(super) fn new(tree: &Path, folder: &Path) -> Self {
        Self {
            tree: tree.to_owned(),
            built: folder.join("target"),
            printed: folder.join("printed.txt"),
        }
    }

    /// Builds a check and runs it: what fails, in words; an error where it does not build or runs nothing.
    pub(super) fn run(&self, check: &Check) -> Result<Option<String>> {
        match check {
            Check::Tests {
                package,
                target,
                only,
            } => {
                let target: &[&str] = match target {
                    Target::It => &["--test", "it"],
                    Target::Lib => &["--lib"],
                };
                let folder = self.tree.join("crates").join(package);
                let package = format!("haptical-{package}");
                let words = ["test", "--no-run", "--package", &package];
                let program = self.build(&[&words, target].concat())?;
                self.tests(Command::new(program).args(only).current_dir(folder))
            }
            Check::Scene { scene } => {
                let program = self.build(&["build", "--package", "xtask"])?;
                self.scene(
                    Command::new(program)
                        .args(["compare-results", "--only", scene])
                        .current_dir(&self.tree),
                )
            }
        }
    }

    /// Builds with cargo; the program that it makes.
    fn build(&self, words: &[&str]) -> Result<PathBuf> {
        let further = "--locked --quiet --message-format json-render-diagnostics";
        let mut command = cargo();
        command.args(words).args(further.split(' '));
        command
            .current_dir(&self.tree)
            .env("CARGO_TARGET_DIR", &self.built)
            .env("CARGO_PROFILE_DEV_DEBUG", "0");
        let built = said(&mut command).context("NOT BUILT")?;
        built
            .lines()
            .filter_map(|line| serde_json::from_str::<Value>(line).ok())
            .filter_map(|message| message["executable"].as_str().map(PathBuf::from))
            .next_back()
            .with_context(|| format!("cargo {} makes no program", words.join(" ")))
    }

    fn tests(&self, command: &mut Command) -> Result<Option<String>> {
        // that a property fails is enough; its smallest case is not asked for
        command.env("PROPTEST_MAX_SHRINK_ITERS", "0");
        command.env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "true");
        let Some((passed, printed)) = self.printed(command)? else {
            return Ok(Some(NO_END.to_owned()));
        };
        ensure!(
            !printed.contains("running 0 tests"),
            "no test has that name"
        );
        if passed {
            return Ok(None);
        }
        let failed: Vec<&str> = printed
            .lines()
            .filter_map(|line| line.strip_prefix("test ")?.strip_suffix(" ... FAILED"))
            .collect();
        Ok(Some(match failed.as_slice() {
            [] => "the binary crashes".to_owned(),
            [first] => (*first).to_owned(),
            [first, others @ ..] => format!("{first} and {} more", others.len()),
        }))
    }

    fn scene(&self, command: &mut Command) -> Result<Option<String>> {
        let words = match self.printed(command)? {
            None => NO_END,
            Some((true, _)) => return Ok(None),
            Some((false, _)) => "its answer differs",
        };
        Ok(Some(words.to_owned()))
    }

    /// Runs a program: whether it succeeds and what it prints, or nothing where it takes too long.
    fn printed(&self, command: &mut Command) -> Result<Option<(bool, String)>> {
        let file = std::fs::File::create(&self.printed)?;
        let mut child = command.stdout(file).stderr(Stdio::null()).spawn()?;
        let began = Instant::now();
        loop {
            if let Some(status) = child.try_wait()? {
                let printed = std::fs::read(&self.printed)?;
                let printed = String::from_utf8_lossy(&printed).into_owned();
                return Ok(Some((status.success(), printed)));
            }
            if began.elapsed() > LONGEST {
                child.kill()?;
                child.wait()?;
                return Ok(None);
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}
