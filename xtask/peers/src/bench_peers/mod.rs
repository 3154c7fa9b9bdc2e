//! Ours against its peers on the same files: `cargo xtask bench-peers` (docs/performance.md, Peers).

mod agreement;
mod bars;
mod contender;
mod distance;
pub(crate) mod files;
mod kinematics;
mod load;
mod ours;
mod peer;
mod ratio;
mod report;
mod rounds;
#[cfg(test)]
mod tests;
pub(crate) mod tools;

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use anyhow::{Result, bail};

use agreement::COST_AGREEMENT;
use contender::{Contender, Label};
use distance::{LARGE, Peers, SMALL, Work};
use files::DataSet;
use kinematics::{OursChain, POSES, Poses, check_values};
use peer::{Peer, PeerContender};
use report::{PeerRecord, Results};
use rounds::{Plan, compare, repeats, time_s};
use tools::{Found, Tools};

/// Arguments of `bench-peers`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask bench-peers --quick --offline")]
pub struct Arguments {
    /// Folder for table, figure and report.
    #[arg(long, default_value = "target/bench-peers")]
    out: PathBuf,
    /// Folder for the files, the peers' programs and the Python environment.
    #[arg(long, default_value = "target/peers")]
    scratch: PathBuf,
    /// Three rounds on 200 poses only: a check that everything works.
    #[arg(long)]
    quick: bool,
    /// Install no Python packages: take what is there.
    #[arg(long)]
    offline: bool,
    /// Count rounds that other processes disturbed too: to try the job, not to quote its figures.
    #[arg(long)]
    keep_disturbed: bool,
}

/// Runs the job.
pub fn bench(arguments: &Arguments) -> Result<()> {
    let tools = Tools::new(&arguments.scratch, !arguments.offline)?;
    let file = |poses: usize| arguments.scratch.join(format!("distances_{poses}.bin"));
    let works: &[Work] = match arguments.quick {
        true => &[SMALL],
        false => &[SMALL, LARGE],
    };
    let plan = |work: &Work| Plan {
        rounds: if arguments.quick { 3 } else { work.rounds },
        keep_disturbed: arguments.keep_disturbed,
        agreement: COST_AGREEMENT.max(work.tolerance),
    };
    let mut sets = Vec::new();
    for work in works {
        let set = DataSet::simulate(work.poses)?;
        set.write(&file(work.poses))?;
        sets.push(set);
    }
    let files: Vec<PathBuf> = works.iter().map(|work| file(work.poses)).collect();
    let mut results = Results {
        load_before: load::load_average(),
        ..Results::default()
    };
    let peers = Peers {
        ceres: start("Ceres", tools.ceres(), &files, &mut results),
        scipy: start("SciPy", tools.scipy(), &files, &mut results),
    };
    for (index, (work, set)) in works.iter().zip(&sets).enumerate() {
        distance::run(work, set, index, &peers, plan(work), &mut results)?;
    }
    drop(peers);
    forward_kinematics(&tools, &file(POSES), plan(&SMALL), &mut results)?;
    results.load_after = load::load_average();
    let quick = arguments.quick.then_some(" --quick");
    let kept = arguments.keep_disturbed.then_some(" --keep-disturbed");
    let flags = [quick, kept].map(Option::unwrap_or_default).concat();
    let command = format!("cargo xtask bench-peers{flags}");
    for text in report::write(&results, &arguments.out, &command, arguments.keep_disturbed)? {
        println!("{text}");
    }
    println!("report: {}", arguments.out.join("report.html").display());
    Ok(())
}

/// Starts a peer, or notes that it is missing and why.
fn start(
    name: &'static str,
    found: Found,
    files: &[PathBuf],
    results: &mut Results,
) -> Option<Rc<RefCell<Peer>>> {
    let started = found.and_then(|program| {
        let peer = Peer::start(&program, files).map_err(|error| format!("{error:#}"))?;
        Ok((peer, program.built))
    });
    let built = started
        .as_ref()
        .map(|(peer, built)| format!("{}; {built}", peer.version));
    let state = built.map_err(String::clone);
    let record = PeerRecord { name, state };
    println!("{}", record.words());
    results.peers.push(record);
    started.ok().map(|(peer, _)| Rc::new(RefCell::new(peer)))
}

/// Ours and Pinocchio, one pose and a batch.
fn forward_kinematics(tools: &Tools, path: &Path, plan: Plan, results: &mut Results) -> Result<()> {
    let set = DataSet::simulate(POSES)?;
    set.write(path)?;
    let poses = Poses::new(&set)?;
    let peer = start("Pinocchio", tools.pinocchio(), &[path.to_owned()], results);
    if let Some(peer) = &peer {
        let ours = poses.values()?;
        for request in ["values", "frame-values"] {
            let answer = peer.borrow_mut().ask(&format!("{request} {POSES} 1 1"))?;
            let largest = check_values("Pinocchio", &answer, &ours)?;
            results.largest_difference =
                Some(results.largest_difference.unwrap_or(0.0).max(largest));
        }
    }
    for (work, count, calls) in [(bars::ONE_POSE, 1, POSES), (bars::BATCH, POSES, 1)] {
        let mut ours = OursChain::new(&poses, count, calls);
        let once_s = time_s(&ours.run(1)?)? * POSES as f64;
        results.alone(work, &ours, once_s / POSES as f64);
        let Some(peer) = &peer else { continue };
        for (name, call) in [
            ("computeJointJacobians + placement", "joint"),
            ("computeFrameJacobian", "frame"),
        ] {
            let mut theirs = PeerContender {
                label: Label::new("Pinocchio", name, 1),
                request: format!("{call} {count} {calls}"),
                calls: POSES,
                peer: Rc::clone(peer),
            };
            let theirs_s = time_s(&theirs.run(1)?)? * POSES as f64;
            if !(theirs_s.is_finite() && theirs_s > 0.0) {
                bail!("Pinocchio answered a time of {theirs_s} s");
            }
            let (ours, theirs): (&mut dyn Contender, &mut dyn Contender) = (&mut ours, &mut theirs);
            results.comparisons.push(compare(
                work,
                (ours, repeats(once_s)),
                (theirs, repeats(theirs_s)),
                plan,
            )?);
        }
    }
    Ok(())
}
