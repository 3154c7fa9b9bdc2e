//! Work on many trials at once, one core each.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::ScopedJoinHandle;

use anyhow::{Context, Result, anyhow};
use xtask_output::Progress;

/// Trials at once: as many as are asked for, or one for each core.
pub(crate) fn jobs(asked: Option<usize>) -> usize {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    asked.unwrap_or_else(cores)
}

/// `work(0)`, ..., `work(count - 1)` on `jobs` threads, in the order of the numbers.
///
/// Each thread has a pool of its own with one worker, so that what a diagnosis does in parallel stays on
/// one core: its time does not depend on what its neighbours do.
pub(crate) fn in_parallel<T: Send>(
    jobs: usize,
    count: usize,
    progress: &Progress,
    work: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>> {
    let next = AtomicUsize::new(0);
    let worker = || -> Result<Vec<(usize, T)>> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .context("a thread cannot be started")?;
        Ok(pool.install(|| {
            let numbers = std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
            let mine = numbers.take_while(|number| *number < count);
            mine.map(|number| {
                let done = (number, work(number));
                progress.step();
                done
            })
            .collect()
        }))
    };
    let parts: Vec<Result<Vec<(usize, T)>>> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..jobs.clamp(1, count.max(1)))
            .map(|_| scope.spawn(worker))
            .collect();
        let joined = threads.into_iter().map(ScopedJoinHandle::join);
        joined
            .map(|part| part.unwrap_or_else(|_| Err(anyhow!("a thread panicked"))))
            .collect()
    });
    let mut all = Vec::with_capacity(count);
    for part in parts {
        all.extend(part?);
    }
    all.sort_by_key(|(number, _)| *number);
    Ok(all.into_iter().map(|(_, done)| done).collect())
}
