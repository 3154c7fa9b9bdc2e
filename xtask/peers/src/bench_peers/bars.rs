//! The bars that the comparisons are held against, and what one run says of each.

use xtask_blind::rows;

use super::distance::{LARGE, SMALL};
use super::ours::{COLD, WARM};
use super::ratio::MedianRatio;
use super::rounds::Comparison;

/// Names of the works with Pinocchio.
pub(crate) const ONE_POSE: &str = "pose and Jacobian, one pose";
pub(crate) const BATCH: &str = "pose and Jacobian, 1000 poses";

/// Least ratio of the fastest way of a family to ours.
struct Bar {
    work: &'static str,
    /// Family of ours.
    ours: &'static str,
    family: &'static str,
    /// Threads of ours and of the other.
    threads: (usize, usize),
    least: f64,
}

const BARS: [Bar; 7] = rows! {
    Bar {work ours family threads least}
    SMALL.name, COLD, "Ceres", (1, 1), 15.0;
    SMALL.name, COLD, "SciPy", (1, 1), 400.0;
    LARGE.name, COLD, "Ceres", (1, 1), 15.0;
    LARGE.name, WARM, "Ceres", (1, 1), 30.0;
    LARGE.name, COLD, COLD, (2, 1), 1.7;
    // at most 0.25 and 0.15 of the peer's time
    ONE_POSE, COLD, "Pinocchio", (1, 1), 1.0 / 0.25;
    BATCH, COLD, "Pinocchio", (1, 1), 1.0 / 0.15;
};

/// Whether each bar that this run can judge is reached, in words. The fastest way of a family counts, so
/// a bar is not judged where any way of the family has no ratio.
pub(crate) fn verdicts(comparisons: &[Comparison]) -> Vec<(bool, String)> {
    let judged = BARS.iter().filter_map(|bar| {
        let of_family: Vec<(&Comparison, MedianRatio)> = comparisons
            .iter()
            .filter(|each| each.work == bar.work)
            .filter(|each| each.ours.family == bar.ours && each.other.family == bar.family)
            .filter(|each| (each.ours.threads, each.other.threads) == bar.threads)
            .map(|each| Some((each, each.ratio()?)))
            .collect::<Option<_>>()?;
        let (fastest, ratio) = of_family
            .into_iter()
            .min_by(|(_, a), (_, b)| a.median.total_cmp(&b.median))?;
        let text = format!(
            "{}: {} takes {:.2} times as long as {} ({:.2} to {:.2}; bar: at least {:.2})",
            bar.work,
            fastest.other.full(),
            ratio.median,
            fastest.ours.full(),
            ratio.low,
            ratio.high,
            bar.least,
        );
        Some((ratio.median >= bar.least, text))
    });
    judged.collect()
}
