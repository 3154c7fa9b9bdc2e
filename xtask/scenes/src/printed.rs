//! `cargo xtask printed-commands`: every command that `diagnose` and `identify` print for a golden scene, run where they were.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use anyhow::{Context, Result, bail, ensure};

use crate::catalogue::named;
use crate::scene::{Identified, Made, Scene};
use crate::workers::each;

/// Arguments of `printed-commands`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask printed-commands --only moving")]
pub struct PrintedArguments {
    /// Only scenes whose name contains this.
    #[arg(long)]
    only: Option<String>,
    /// The command that is run; built where none is given.
    #[arg(long)]
    binary: Option<PathBuf>,
    /// Where its files go.
    #[arg(long, default_value = "target/printed-commands")]
    out: PathBuf,
}

/// Runs the job: an error where a printed command does not end well.
pub fn printed_commands(arguments: &PrintedArguments) -> Result<()> {
    let binary = match &arguments.binary {
        Some(binary) => binary.clone(),
        None => built()?,
    };
    let binary = std::fs::canonicalize(&binary).with_context(|| binary.display().to_string())?;
    let scenes = named(arguments.only.as_deref().unwrap_or_default());
    ensure!(!scenes.is_empty(), "no scene of this name");
    let found = each(&scenes, |scene| {
        let folder = arguments.out.join(scene.name);
        of_scene(scene, &binary, &folder).with_context(|| scene.name)
    });
    let (mut ran, mut failed) = (0, 0);
    for (scene, found) in scenes.iter().zip(found) {
        for (command, why) in found? {
            ran += 1;
            if let Some(why) = why {
                failed += 1;
                println!("FAILS   {:32} {command}\n        {why}", scene.name);
            }
        }
    }
    println!(
        "{ran} printed commands of {} scenes, {failed} fail",
        scenes.len()
    );
    if ran == 0 || failed > 0 {
        bail!("a command that is printed has to run");
    }
    Ok(())
}

/// The command, built as the tests build it.
fn built() -> Result<PathBuf> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut build = Command::new(cargo);
    build.args(["build", "--quiet", "--locked", "--package", "haptical-cli"]);
    ensure!(build.status()?.success(), "the command was not built");
    Ok(PathBuf::from("target/debug/haptical"))
}

/// Each printed command of a scene, and why it fails, if it does.
fn of_scene(scene: &Scene, binary: &Path, folder: &Path) -> Result<Vec<(String, Option<String>)>> {
    let made = (scene.make)()?;
    if folder.exists() {
        std::fs::remove_dir_all(folder)?;
    }
    std::fs::create_dir_all(folder)?;
    let given = made.write(folder)?;
    let run = |words: &[&str]| -> Result<Output> {
        Ok(Command::new(binary)
            .args(words)
            .current_dir(folder)
            .output()?)
    };
    let mut printed = Vec::new();
    let diagnosed: Vec<&str> = ["diagnose"]
        .into_iter()
        .chain(given.iter().map(String::as_str))
        .chain(["--out", "gap"])
        .collect();
    printed.extend(commands(&run(&diagnosed)?));
    let is_geometry = matches!(made.identify, Identified::Geometry(_));
    if is_geometry && made.model.is_none() {
        let device = given.iter().take_while(|word| *word != "--log");
        let identified: Vec<&str> = ["identify"]
            .into_iter()
            .chain(device.map(String::as_str))
            .chain(["--log", "log.csv", "--out", "fit"])
            .collect();
        printed.extend(commands(&run(&identified)?));
    }
    let fresh = match made.validate {
        Some(_) => "second.csv",
        None => "log.csv",
    };
    let mut found = Vec::new();
    for command in printed {
        let words: Vec<&str> = command.split(' ').skip(1).collect();
        let words: Vec<&str> = words
            .into_iter()
            .map(|word| if word == "NEW_LOG" { fresh } else { word })
            .collect();
        let done = run(&words)?;
        let why = (!done.status.success()).then(|| {
            let said = String::from_utf8_lossy(&done.stderr).into_owned();
            let error = said.lines().find(|line| line.starts_with("error"));
            error.unwrap_or(&said).to_owned()
        });
        found.push((command, why));
    }
    Ok(found)
}

/// The commands that a run printed, each a line of its own, with or without a word before it.
fn commands(output: &Output) -> Vec<String> {
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let of_line = |line: &str| {
        let at = line.find("haptical ")?;
        let label = line[..at].trim();
        let is_command = at == 2 || (at == 9 && !label.contains(' ') && !label.is_empty());
        is_command.then(|| line[at..].to_owned())
    };
    said.lines().filter_map(of_line).collect()
}

impl Made {
    /// Writes its files into a folder, and gives the flags that name them.
    fn write(&self, folder: &Path) -> Result<Vec<String>> {
        let mut flags = Vec::new();
        let mut write = |flag: &str, name: &str, text: &str| -> Result<()> {
            std::fs::write(folder.join(name), text)?;
            flags.extend([flag.to_owned(), name.to_owned()]);
            Ok(())
        };
        write("--device", self.device.name, &self.device.text)?;
        if let Some(rig) = &self.device.rig {
            write("--rig", "rig.toml", rig)?;
        }
        if let Some(model) = &self.model {
            write("--model", "model.toml", model)?;
        }
        write("--log", "log.csv", &self.log.csv())?;
        if let Some(also) = &self.also {
            write("--log", "also.csv", &also.csv())?;
        }
        if let Some(second) = &self.validate {
            write("--validate", "second.csv", &second.csv())?;
        }
        let tips = self.device.tips.iter();
        let tips = tips.flat_map(|tip| ["--tip".to_owned(), (*tip).to_owned()]);
        let tips: Vec<String> = tips.collect();
        flags.splice(2..2, tips);
        let left_out = self.without.iter();
        flags.extend(left_out.flat_map(|name| ["--without".to_owned(), (*name).to_owned()]));
        if self.joint_compliance {
            flags.extend(["--with".to_owned(), "joint-compliance".to_owned()]);
        }
        Ok(flags)
    }
}
