//! Says that work goes on: a line that moves on a terminal, else nothing, or lines for a program that asks for them.

use std::env;

use crate::terminal::write_message;

/// Environment variable: with the value `lines` each step of the work is a line on standard error.
const VARIABLE: &str = "HAPTICAL_PROGRESS";

/// Shows what is being done until it is dropped.
pub(crate) struct Progress {
    /// None where lines are printed.
    bar: Option<bar::Bar>,
}

impl Progress {
    pub(crate) fn start(message: impl Into<String>) -> Self {
        let prints_lines = env::var_os(VARIABLE).is_some_and(|value| value == "lines");
        let progress = Self {
            bar: (!prints_lines).then(bar::Bar::start),
        };
        progress.say(message);
        progress
    }

    pub(crate) fn say(&self, message: impl Into<String>) {
        let message = message.into();
        match &self.bar {
            Some(bar) => bar.say(message),
            None => write_message(&format!("progress: {message}")),
        }
    }
}

#[cfg(not(target_family = "wasm"))]
mod bar {
    use std::time::Duration;

    use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

    /// A line on a terminal's standard error; it disappears when dropped.
    pub(super) struct Bar(ProgressBar);

    impl Bar {
        pub(super) fn start() -> Self {
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} {elapsed}") {
                bar.set_style(style);
            }
            if !bar.is_hidden() {
                bar.enable_steady_tick(Duration::from_millis(120));
            }
            Self(bar)
        }

        pub(super) fn say(&self, message: String) {
            self.0.set_message(message);
        }
    }

    impl Drop for Bar {
        fn drop(&mut self) {
            self.0.finish_and_clear();
        }
    }
}

#[cfg(target_family = "wasm")]
mod bar {
    /// A program in a sandbox has no terminal.
    pub(super) struct Bar;

    impl Bar {
        pub(super) fn start() -> Self {
            Self
        }

        pub(super) fn say(&self, _: String) {}
    }
}
