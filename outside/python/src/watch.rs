//! Work beside the interpreter: its lock is free meanwhile, Ctrl-C is heard, and a listener hears how long it takes.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use haptical::identification::Interrupt;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// How often Ctrl-C is looked for.
const STEP: Duration = Duration::from_millis(50);
/// Stack of the thread, as large as a program's first one.
const STACK_BYTES: usize = 8 << 20;

/// Does the work in a thread of its own. Ctrl-C raises KeyboardInterrupt at once, and so does an exception of `progress`, which
/// is called with the seconds since the beginning; the work, which nothing of Python holds any more, then ends where it next
/// looks at its [`Interrupt`].
pub(crate) fn watched<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Interrupt) -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, mut receiver) = channel();
    let interrupt = Interrupt::default();
    let heard = interrupt.clone();
    let thread = std::thread::Builder::new().stack_size(STACK_BYTES);
    thread.spawn(move || {
        // nobody listens after Ctrl-C
        let _ = sender.send(work(&heard));
    })?;
    let begun = Instant::now();
    loop {
        let (found, back) = py.detach(move || (receiver.recv_timeout(STEP), receiver));
        receiver = back;
        match found {
            Ok(found) => return Ok(found),
            Err(RecvTimeoutError::Timeout) => {
                go_on(py, progress, begun).inspect_err(|_| interrupt.request())?;
            }
            Err(RecvTimeoutError::Disconnected) => {
                let text =
                    "a fault of haptical itself; please report it with the device file and the log";
                return Err(PyRuntimeError::new_err(text));
            }
        }
    }
}

/// What Ctrl-C or the listener raises.
fn go_on(py: Python<'_>, progress: Option<&Bound<'_, PyAny>>, begun: Instant) -> PyResult<()> {
    py.check_signals()?;
    if let Some(progress) = progress {
        progress.call1((begun.elapsed().as_secs_f64(),))?;
    }
    Ok(())
}
