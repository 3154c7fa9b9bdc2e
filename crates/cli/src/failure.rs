//! A refusal as three lines for people (what, where, next step) or as JSON for programs, and its exit status.

pub(crate) use haptical::Error as Failure;
use haptical::ErrorKind;
use serde_json::{Value, json};

use crate::interrupt::STATUS_INTERRUPTED;
use crate::{STATUS_BAD_INPUT, STATUS_UNIDENTIFIABLE, terminal};

/// A refusal for programs.
pub(crate) fn as_json(refused: &Failure) -> Value {
    let place = refused.place();
    json!({
        "kind": refused.name(),
        "what": refused.what(),
        "where": place.to_string(),
        "file": place.file,
        "line": place.line,
        "column": place.column,
        "column_name": place.column_name,
        "next": refused.next_step(),
    })
}

/// A refusal for people: what, where, next step.
pub(crate) fn lines(refused: &Failure) -> String {
    format!(
        "error: {}\n  where: {}\n  next: {}\n",
        one_line(refused.what()),
        one_line(&refused.place().to_string()),
        one_line(refused.next_step())
    )
}

/// Prints a refusal, and gives its exit status.
pub(crate) fn report(refused: &Failure, as_json: bool) -> u8 {
    if as_json {
        let object = json!({"error": self::as_json(refused)});
        // Where standard output fails too, the text below still says what happened.
        let _ = terminal::write_output(format!("{object:#}\n").as_bytes());
    }
    terminal::write_message(&lines(refused));
    match refused.kind() {
        ErrorKind::Unidentifiable => STATUS_UNIDENTIFIABLE,
        ErrorKind::Interrupted => STATUS_INTERRUPTED,
        _ => STATUS_BAD_INPUT,
    }
}

/// The three lines stay three, whatever a file name or a cell holds.
fn one_line(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect()
}
