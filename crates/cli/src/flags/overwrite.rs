//! What a run may write: the flag that lets it overwrite, and the files that its command line names to be read.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use clap::{ArgMatches, Args, Command, ValueHint};
use haptical::files::{Overwrite, WriteRule};

/// Names of the arguments that are paths to write; every other path of a command line is read.
pub(crate) const OUTPUTS: [&str; 3] = ["out", "page", "dir"];
/// Folders that may hold outputs, too: of a result the files that are read are those that it names, of a recording its data.
const FOLDERS: [&str; 2] = ["result", "recording"];

/// Files and folders that the command line names to be read.
static READ: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// The flag that lets a command overwrite files that it did not write.
#[derive(Debug, Clone, Copy, Default, Args)]
pub(crate) struct OverwriteOptions {
    /// Overwrite files (at --out, --page) that no earlier run of this command wrote, or that were changed since
    #[arg(long)]
    pub(crate) force: bool,
}

impl OverwriteOptions {
    /// What a run of a command may write.
    pub(crate) fn rule(self, command: &'static str) -> WriteRule {
        rule(command, self.force)
    }
}

/// What a run of a command may write, with or without --force.
pub(crate) fn rule(command: &'static str, force: bool) -> WriteRule {
    let read = READ.lock().unwrap_or_else(PoisonError::into_inner);
    let overwrite = match force {
        true => Overwrite::Any,
        false => Overwrite::Own,
    };
    WriteRule::new(command, read.clone(), overwrite)
}

/// Keeps the paths that a command line names to be read, whatever the flag or the place.
pub(crate) fn keep_inputs(command: &Command, matches: &ArgMatches) {
    let mut found = Vec::new();
    collect(command, matches, &mut found);
    *READ.lock().unwrap_or_else(PoisonError::into_inner) = found;
}

fn collect(command: &Command, matches: &ArgMatches, found: &mut Vec<PathBuf>) {
    for argument in command.get_arguments() {
        let name = argument.get_id().as_str();
        if argument.get_value_hint() != ValueHint::AnyPath || OUTPUTS.contains(&name) {
            continue;
        }
        let given = matches.try_get_raw(name).ok().flatten();
        let given = given.into_iter().flatten().map(PathBuf::from);
        found.extend(
            given.filter(|path| path.exists() && !(FOLDERS.contains(&name) && path.is_dir())),
        );
    }
    if let Some((name, matches)) = matches.subcommand()
        && let Some(command) = command.find_subcommand(name)
    {
        collect(command, matches, found);
    }
}
