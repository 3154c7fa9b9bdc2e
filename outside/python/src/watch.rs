//! Work beside the interpreter: its lock is free meanwhile, Ctrl-C is heard, and a listener hears how long it takes.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// How often Ctrl-C is looked for.
const STEP: Duration = Duration::from_millis(50);
/// Stack of the thread, as large as a program's first one.
const STACK_BYTES: usize = 8 << 20;

/// Does the work in a thread of its own. Ctrl-C raises KeyboardInterrupt at once; the work, which nothing of Python holds any
/// more, then ends by itself and is thrown away. `progress` is called with the seconds since the beginning.
pub(crate) fn watched<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, mut receiver) = channel();
    let thread = std::thread::Builder::new().stack_size(STACK_BYTES);
    thread.spawn(move || {
        // nobody listens after Ctrl-C
        let _ = sender.send(work());
    })?;
    let begun = Instant::now();
    loop {
        let (found, back) = py.detach(move || (receiver.recv_timeout(STEP), receiver));
        receiver = back;
        match found {
            Ok(found) => return Ok(found),
            Err(RecvTimeoutError::Timeout) => {
                py.check_signals()?;
                if let Some(progress) = progress {
                    progress.call1((begun.elapsed().as_secs_f64(),))?;
                }
            }
            Err(RecvTimeoutError::Disconnected) => {
                let text =
                    "a fault of haptical itself; please report it with the device file and the log";
                return Err(PyRuntimeError::new_err(text));
            }
        }
    }
}
