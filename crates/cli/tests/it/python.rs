//! Programs of Python that read what the command writes: those of HAPTICAL_PYTHON, or of `python3`.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::text;

/// An interpreter in which these words succeed; where there is none, standard output says what is missing.
pub(crate) fn interpreter(tried: &[&str], missing: &str) -> Option<String> {
    let python = std::env::var("HAPTICAL_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let asked = Command::new(&python).args(tried).output();
    if asked.is_ok_and(|asked| asked.status.success()) {
        return Some(python);
    }
    println!(
        "skipped: `{python}` has no {missing} and numpy; install them with pip, and name the interpreter in HAPTICAL_PYTHON"
    );
    None
}

/// What a script answers to a question on its standard input.
pub(crate) fn ask(python: &str, script: &Path, question: &Value) -> Value {
    let mut child = Command::new(python)
        .arg(script)
        // MuJoCo writes its log where it runs
        .current_dir(std::env::temp_dir())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    stdin.write_all(question.to_string().as_bytes()).unwrap();
    drop(stdin);
    let answer = child.wait_with_output().unwrap();
    assert!(answer.status.success(), "{}", text(&answer.stderr));
    serde_json::from_slice(&answer.stdout).unwrap()
}
