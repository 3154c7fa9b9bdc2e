//! A progress bar on a terminal, silence in a pipe.

use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

/// Progress of a job of known length.
#[derive(Debug)]
pub struct Progress(ProgressBar);

impl Progress {
    /// A bar; indicatif hides it by itself where standard error is not a terminal.
    pub fn new(what: &str, steps: usize) -> Self {
        let bar = ProgressBar::new(steps as u64);
        if let Ok(style) = ProgressStyle::with_template("{msg:36} {bar:30} {pos}/{len} {eta}") {
            bar.set_style(style);
        }
        bar.set_message(what.to_owned());
        Self(bar)
    }

    /// What `job` makes of 0, 1, ..., `count` - 1, in parallel and in this order; each is a step.
    pub fn over<T: Send>(&self, count: usize, job: impl Fn(u64) -> T + Sync) -> Vec<T> {
        let stepped = |number| {
            let done = job(number);
            self.step();
            done
        };
        (0..count as u64).into_par_iter().map(stepped).collect()
    }

    /// One more step is done.
    pub fn step(&self) {
        self.0.inc(1);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
