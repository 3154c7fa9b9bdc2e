//! The `haptical` command: flags, texts, exit status and progress; all numbers come from the libraries.
//!
//! The program `haptical` is [`run`] with the words of its command line; the Python package's command is the same function.

mod arguments;
mod catalogue;
mod check;
mod correct;
mod diagnose;
mod doctor;
mod export;
mod failure;
mod flags;
mod identify;
mod import;
mod init;
mod interrupt;
mod next;
mod plan;
mod play;
mod progress;
mod report;
mod result;
mod simulate;
mod terminal;
mod verify;
mod watch;
#[cfg(test)]
mod writes_tests;

use std::ffi::OsString;
use std::path::Path;

use clap::{CommandFactory, FromArgMatches};

use crate::arguments::{Arguments, Command};
use crate::failure::Failure;

/// Exit status of a command that did what it was asked.
const STATUS_SUCCESS: u8 = 0;
/// Exit status of bad arguments or input.
const STATUS_BAD_INPUT: u8 = 2;
/// Exit status where the numbers are sound but fix nothing.
const STATUS_UNIDENTIFIABLE: u8 = 3;

/// Runs a command line, whose first word is the program's name, and gives its exit status: 0 success, 2 bad arguments or
/// input, 3 nothing can be identified, 130 interrupted; `verify`, `watch` and `doctor` have others of their own.
///
/// ```
/// assert_eq!(haptical_cli::run(["haptical", "--version"].map(Into::into)), 0);
/// assert_eq!(haptical_cli::run(["haptical", "identify"].map(Into::into)), 2);
/// ```
pub fn run(words: impl IntoIterator<Item = OsString>) -> u8 {
    let words: Vec<OsString> = words.into_iter().collect();
    // Clap does not run where an argument is wrong, yet the answer depends on this flag.
    let wants_json = words.iter().any(|word| word == "--json");
    let arguments = match parsed(words) {
        Ok(arguments) => arguments,
        Err(error) => return arguments::explain(&error, wants_json),
    };
    interrupt::listen();
    let done = match arguments.command {
        Some(command) => run_command(command),
        None => next::run(arguments.json).map(|()| STATUS_SUCCESS),
    };
    match done {
        Ok(status) => status,
        Err(failure) => failure::report(&failure, wants_json),
    }
}

/// What `haptical doctor PATH --json` prints, for programs that link the command: `units` is `radians`, `degrees` or `percent`, `keys`
/// those of positions and commands where they are not found by themselves.
///
/// # Errors
/// As the command: no recording, or one that cannot be read.
pub fn doctor(
    path: &Path,
    units: Option<&str>,
    keys: [Option<&str>; 2],
) -> Result<serde_json::Value, haptical::Error> {
    doctor::report(path, units, keys)
}

/// The command line; its paths are kept for the rule of what may be written.
fn parsed(words: impl IntoIterator<Item = OsString>) -> Result<Arguments, clap::Error> {
    let mut command = Arguments::command();
    let matches = command.try_get_matches_from_mut(words)?;
    flags::keep_inputs(&command, &matches);
    Arguments::from_arg_matches(&matches).map_err(|error| error.format(&mut command))
}

fn run_command(command: Command) -> Result<u8, Failure> {
    let done = match command {
        Command::Identify(arguments) => identify::run(&arguments),
        Command::Diagnose(arguments) if arguments.list => catalogue::print(arguments.json),
        Command::Diagnose(arguments) => diagnose::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Init(arguments) => init::run(&arguments),
        Command::Export(arguments) => export::run(&arguments),
        Command::Correct(arguments) => correct::run(&arguments),
        Command::Import(arguments) => import::run(&arguments),
        Command::Plan(arguments) => plan::run(&arguments),
        Command::Play(arguments) => play::run(&arguments),
        Command::Report(arguments) => report::run(&arguments),
        // These have statuses of their own.
        Command::Doctor(arguments) => return doctor::run(&arguments),
        Command::Verify(arguments) => return verify::run(&arguments),
        Command::Watch(arguments) => return watch::run(&arguments),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            let mut command = Arguments::command();
            clap_complete::generate(shell, &mut command, "haptical", &mut script);
            terminal::write_output(&script)
        }
    };
    done.map(|()| STATUS_SUCCESS)
}
