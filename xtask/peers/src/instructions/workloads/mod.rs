//! The workloads: deterministic, on one thread, each with the number of poses, rows or calls in it.

mod distances;
mod fits;
mod formulas;
mod recordings;

use anyhow::Result;

pub(super) use self::recordings::{log, log_with};

/// What is counted, once everything that it needs is there.
pub(crate) type Job = Box<dyn FnMut() -> Result<()>>;

/// A piece of work whose instructions are counted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Workload {
    /// Its name in the committed files: never another work under the same name.
    pub(crate) name: &'static str,
    pub(crate) what: &'static str,
    /// What there are `units` of.
    pub(crate) unit: &'static str,
    pub(crate) units: u64,
    /// Takes valgrind more than ten seconds.
    pub(crate) is_long: bool,
    pub(crate) prepare: fn() -> Result<Job>,
}

impl Workload {
    /// Makes what the work needs; that is not counted.
    pub(crate) fn prepare(&self) -> Result<Job> {
        (self.prepare)()
    }
}

pub(crate) fn all() -> impl Iterator<Item = Workload> {
    formulas::WORKLOADS
        .into_iter()
        .chain(distances::WORKLOADS)
        .chain(fits::WORKLOADS)
        .chain(recordings::WORKLOADS)
}

/// Values in [-1, 1) without a visible order (SplitMix64).
fn spread(index: usize) -> f64 {
    let mut z = (index as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}
