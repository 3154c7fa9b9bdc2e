//! Standard output and error: a reader that goes away is no failure.

use std::io::{ErrorKind, IsTerminal, Write};

use serde::Serialize;

use crate::failure::Failure;

/// Names in files are other people's: what would steer a terminal becomes a space.
fn harmless(text: &str) -> String {
    let steers = |c: char| c.is_control() && c != '\n' && c != '\t';
    text.replace(steers, " ")
}

/// Whether standard output is a terminal: elsewhere nothing is cut.
pub(crate) fn is_one() -> bool {
    std::io::stdout().is_terminal()
}

/// Writes text to standard output. A closed pipe ends the output silently, as `head` expects.
pub(crate) fn write_output(bytes: &[u8]) -> Result<(), Failure> {
    let text = harmless(&String::from_utf8_lossy(bytes));
    let mut output = std::io::stdout().lock();
    match output
        .write_all(text.as_bytes())
        .and_then(|()| output.flush())
    {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::bad_input(
            "output",
            format!("cannot write: {error}"),
            "standard output",
            "check where the output goes",
        )),
        _ => Ok(()),
    }
}

/// Writes a value to standard output as JSON.
pub(crate) fn write_json(value: &impl Serialize) -> Result<(), Failure> {
    let json = serde_json::to_string_pretty(value).map_err(Failure::internal)?;
    write_output(format!("{json}\n").as_bytes())
}

/// Writes what a command found to standard output: a value as JSON where that is asked for, else a text.
pub(crate) fn tell(
    json: bool,
    value: &impl Serialize,
    text: impl AsRef<str>,
) -> Result<(), Failure> {
    match json {
        true => write_json(value),
        false => write_output(text.as_ref().as_bytes()),
    }
}

/// Writes a text to standard error; there is nobody to tell if that fails.
pub(crate) fn write_message(text: &str) {
    let text = harmless(text);
    let mut output = std::io::stderr().lock();
    let _ = output.write_all(text.as_bytes());
    if !text.ends_with('\n') {
        let _ = output.write_all(b"\n");
    }
}

/// Writes warnings to standard error.
pub(crate) fn warn(warnings: &[String]) {
    for warning in warnings {
        write_message(&format!("warning: {warning}"));
    }
}
