//! The 28-parameter distance identification: who takes part, and who meets whom.

use std::cell::RefCell;
use std::rc::Rc;

use anyhow::{Context, Result};
use xtask_output::Progress;

use super::agreement::check_costs;
use super::contender::{Contender, Label};
use super::files::DataSet;
use super::ours::{COLD, WARM, solvers};
use super::peer::{Peer, PeerContender};
use super::report::{Results, Solution};
use super::rounds::{Plan, compare, repeats, time_s};

/// One size of the work.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Work {
    pub(crate) name: &'static str,
    pub(crate) poses: usize,
    /// Share of the cost below which its fall ends the search, for all.
    pub(crate) tolerance: f64,
    pub(crate) rounds: usize,
    /// Whether ours runs on two threads as well.
    pub(crate) two_threads: bool,
    /// Whether ours takes part with a warm start as well: a recording of one block has no subset to start from.
    pub(crate) warm: bool,
    /// Ways of SciPy: `DERIVATIVES METHOD`.
    scipy: &'static [&'static str],
}

/// The paper's number of poses.
pub(crate) const SMALL: Work = Work {
    name: "200 poses",
    poses: 200,
    tolerance: 1e-10,
    rounds: 15,
    two_threads: false,
    warm: false,
    scipy: &[
        "analytic lm",
        "analytic trf",
        "differences lm",
        "differences trf",
    ],
};

/// A long recording. SciPy's differences would take half a minute a run.
pub(crate) const LARGE: Work = Work {
    name: "100 000 poses",
    poses: 100_000,
    tolerance: 1e-8,
    rounds: 5,
    two_threads: true,
    warm: true,
    scipy: &["analytic lm", "analytic trf"],
};

/// Ways of Ceres: its own name for the family, `DERIVATIVES SOLVER`, words for tables.
const CERES: [(&str, &str, &str); 5] = [
    ("Ceres", "automatic qr", "automatic, dense QR"),
    ("Ceres", "automatic cholesky", "automatic, normal Cholesky"),
    ("Ceres", "analytic qr", "analytic, dense QR"),
    ("Ceres", "analytic cholesky", "analytic, normal Cholesky"),
    (TINY, "analytic tiny", "analytic, normal LDLT"),
];
/// Ceres' header for small dense problems; one thread only.
pub(crate) const TINY: &str = "Ceres TinySolver";

#[derive(Debug)]
pub(crate) struct Peers {
    pub(crate) ceres: Option<Rc<RefCell<Peer>>>,
    pub(crate) scipy: Option<Rc<RefCell<Peer>>>,
}

/// Runs of each way of ours, the least time of which decides which way meets the others: a single one may be
/// disturbed.
const PROBES: usize = 7;

/// Solves by everyone, checks that all found the same, and only then times the pairs.
///
/// Ours in a pair is the fastest of ours on as many threads; it meets everyone else. Those of ours with a warm
/// start are a family of their own, whose fastest meets every peer as well. `file` is the set's place among
/// the peers' files.
pub(crate) fn run(
    work: &Work,
    set: &DataSet,
    file: usize,
    peers: &Peers,
    plan: Plan,
    results: &mut Results,
) -> Result<()> {
    let mut contenders: Vec<Box<dyn Contender + '_>> = Vec::new();
    for threads in 1..=if work.two_threads { 2 } else { 1 } {
        for ours in solvers(set, work.tolerance, threads)? {
            if work.warm || ours.label().family != WARM {
                contenders.push(Box::new(ours));
            }
        }
    }
    for theirs in theirs(work, file, peers) {
        contenders.push(Box::new(theirs));
    }
    let progress = Progress::new(work.name, 2 * contenders.len());
    let mut times_s = Vec::new();
    let mut costs = Vec::new();
    for contender in &mut contenders {
        let first = contender.run(1)?;
        let (label, cost) = (contender.label().clone(), first.cost.context("no cost")?);
        costs.push((label.full(), cost));
        // the first run meets cold caches and sleeping threads
        let is_ours = [COLD, WARM].contains(&label.family);
        let probes = if is_ours { PROBES } else { 1 };
        let mut least_s = f64::INFINITY;
        for _ in 0..probes {
            least_s = least_s.min(time_s(&contender.run(1)?)?);
        }
        times_s.push(least_s);
        results.solutions.push(Solution {
            work: work.name.to_owned(),
            label,
            cost,
            iterations: first.iterations,
            construction_s: first.construction_s.first().copied(),
        });
        progress.step();
    }
    check_costs(work.name, plan.agreement, &costs)?;
    let champion = |contenders: &[Box<dyn Contender + '_>], family: &str, threads: usize| {
        (0..contenders.len())
            .filter(|&index| {
                let label = contenders[index].label();
                (label.family, label.threads) == (family, threads)
            })
            .min_by(|&a, &b| times_s[a].total_cmp(&times_s[b]))
    };
    let alone = champion(&contenders, COLD, 1).context("nothing of ours")?;
    results.alone(work.name, contenders[alone].as_ref(), times_s[alone]);
    let mut pairs = Vec::new();
    for other in 0..contenders.len() {
        let Label {
            family, threads, ..
        } = *contenders[other].label();
        let cold = champion(&contenders, COLD, threads).unwrap_or(alone);
        if other != alone {
            pairs.push((cold, other));
        } else if let Some(two) = champion(&contenders, COLD, 2) {
            // ours on two threads meets ours on one
            pairs.push((two, other));
        }
        let is_peer = ![COLD, WARM].contains(&family);
        if is_peer && let Some(warm) = champion(&contenders, WARM, threads) {
            pairs.push((warm, other));
        }
    }
    for (ours, other) in pairs {
        progress.step();
        let Ok([first, second]) = contenders.get_disjoint_mut([ours, other]) else {
            continue;
        };
        let compared = compare(
            work.name,
            (first.as_mut(), repeats(times_s[ours])),
            (second.as_mut(), repeats(times_s[other])),
            plan,
        )?;
        results.comparisons.push(compared);
    }
    Ok(())
}

/// Every way of the peers that are there.
fn theirs(work: &Work, file: usize, peers: &Peers) -> Vec<PeerContender> {
    let mut theirs = Vec::new();
    let mut add = |family, name: &str, threads, peer: &Rc<RefCell<Peer>>, way: &str| {
        theirs.push(PeerContender {
            label: Label::new(family, name, threads),
            request: format!("{file} {way} {threads} {:e}", work.tolerance),
            calls: 1,
            peer: Rc::clone(peer),
        });
    };
    if let Some(ceres) = &peers.ceres {
        for threads in 1..=2 {
            for (family, way, name) in CERES {
                if threads == 1 || family != TINY {
                    add(family, name, threads, ceres, way);
                }
            }
        }
    }
    if let Some(scipy) = &peers.scipy {
        for way in work.scipy {
            add("SciPy", &way.replace(' ', ", "), 1, scipy, way);
        }
    }
    theirs
}
