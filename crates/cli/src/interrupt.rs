//! Ctrl-C: ends the command at once, or while files are written as soon as they are cleaned up.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use haptical::files::{NewFile, ResultKind, WriteRule, WrittenResult};

use crate::failure::Failure;

/// Exit status after Ctrl-C, as shells count it: 128 and the number of the signal.
pub(crate) const STATUS_INTERRUPTED: u8 = 130;

/// What the thread that waits for Ctrl-C and the one that works tell each other.
struct State {
    /// Whether there are temporary files.
    writing: bool,
    /// Whether Ctrl-C was pressed since.
    requested: bool,
}

static STATE: Mutex<State> = Mutex::new(State {
    writing: false,
    requested: false,
});

fn state() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A WebAssembly program is ended by whoever runs it.
#[cfg(target_family = "wasm")]
pub(crate) fn listen() {}

/// Waits for Ctrl-C from now on. Where that cannot be done, the system ends the program as ever.
#[cfg(not(target_family = "wasm"))]
pub(crate) fn listen() {
    let _ = ctrlc::set_handler(|| {
        // Held while the program ends, so that no temporary file appears in the meantime.
        let mut state = state();
        if !state.writing || state.requested {
            std::process::exit(i32::from(STATUS_INTERRUPTED));
        }
        state.requested = true;
    });
}

/// To be held while temporary files exist: Ctrl-C then waits for [`Writing::go_on`] to be asked. A
/// second one does not wait.
#[derive(Debug)]
pub(crate) struct Writing;

impl Writing {
    /// To be called before the first temporary file.
    pub(crate) fn begin() -> Self {
        state().writing = true;
        Self
    }

    /// Whether Ctrl-C was pressed since.
    pub(crate) fn is_interrupted(&self) -> bool {
        state().requested
    }

    /// Refuses to go on after Ctrl-C; `out` is what was to be written.
    pub(crate) fn go_on(&self, out: &Path) -> Result<(), Failure> {
        if state().requested {
            return Err(Failure::interrupted(out));
        }
        Ok(())
    }
}

impl Drop for Writing {
    fn drop(&mut self) {
        state().writing = false;
    }
}

/// Writes all files into a folder, or after Ctrl-C none.
pub(crate) fn write_all(
    rule: &WriteRule,
    folder: &Path,
    files: &[NewFile<'_>],
) -> Result<Vec<PathBuf>, Failure> {
    let _writing = Writing::begin();
    rule.write(folder, files, &|| state().requested)
}

/// Writes the files of a result into a folder, or after Ctrl-C none.
pub(crate) fn write_result(
    folder: &Path,
    kind: &ResultKind,
    files: &[NewFile<'static>],
    rule: &WriteRule,
) -> Result<WrittenResult, Failure> {
    let _writing = Writing::begin();
    haptical::files::write_result(folder, kind, files, rule, &|| state().requested)
}
