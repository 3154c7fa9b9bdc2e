//! Our own contenders in the distance identification. One more is a line in [`SOLVERS`] and a function.

use std::time::Instant;

use anyhow::{Context, Result, ensure};
use haptical_batch::{
    DistanceModel, PoseBatch, Sines, Threads, solve_distances, solve_distances_warm,
};
use haptical_calibration::{
    CalibrationMethod, Channel, DeviceProblem, Options, ReducedProblem, Weighting, Weights,
    fit_kinematics,
};
use haptical_identification::{Fit, Method, Settings, solve};
use haptical_model::ParameterId;
use rayon::ThreadPool;

use super::contender::{Answer, Contender};
use super::files::DataSet;

/// Family of what starts at the nominal values, as every peer does.
pub(crate) const COLD: &str = "ours";
/// Family of what starts at the solution for a share of the poses: bars of the cold fit are never judged by it.
pub(crate) const WARM: &str = "ours, warm start";

/// Every way of ours to the solution: family, name.
const SOLVERS: [(&str, &str, Solver); 5] = [
    (COLD, "solve, in lanes", in_lanes),
    (
        WARM,
        "solve, in lanes, after every 16th block",
        in_lanes_warm,
    ),
    (COLD, "solve, all rows", all_rows),
    (COLD, "solve, reduced", reduced),
    (COLD, "step 2, with rank and intervals", step_two),
];

type Solver = fn(&Task<'_>) -> Result<Search>;

/// One search from the start values.
struct Search {
    cost: f64,
    iterations: usize,
    construction_s: f64,
    solve_s: f64,
}

/// What is to be solved, until the linearised problem promises less than a share of the cost.
#[derive(Clone)]
struct Task<'d> {
    set: &'d DataSet,
    settings: Settings,
    channels: [Channel; 1],
    weights: Weights,
    /// All of the set's parameters.
    free: Vec<usize>,
}

impl<'d> Task<'d> {
    fn new(set: &'d DataSet, tolerance: f64) -> Self {
        Self {
            set,
            settings: Settings {
                cost_tolerance: tolerance,
                // the cost decides alone
                step_tolerance: 0.0,
                ..Settings::default()
            },
            channels: DataSet::channels(),
            weights: set.weights(),
            free: (0..set.free.len()).collect(),
        }
    }

    fn problem(&self) -> Result<DeviceProblem<'_>> {
        let DataSet {
            nominal, recording, ..
        } = self.set;
        let (channels, free) = (&self.channels, &self.set.free);
        let problem = DeviceProblem::new(nominal, recording, channels, free, &self.weights)?;
        Ok(problem)
    }
}

/// Constructs and solves, each with its time; `solve` gives cost and steps.
fn timed<P>(
    construct: impl FnOnce() -> Result<P>,
    solve: impl FnOnce(&P) -> Result<(f64, usize)>,
) -> Result<Search> {
    let start = Instant::now();
    let problem = construct()?;
    let construction_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let (cost, iterations) = solve(&problem)?;
    Ok(Search {
        cost,
        iterations,
        construction_s,
        solve_s: start.elapsed().as_secs_f64(),
    })
}

/// Joint angles from the readings, without transmissions: the sets have none.
fn angles_rad(set: &DataSet) -> Vec<Vec<f64>> {
    let joints = set.nominal.joints.iter().zip(&set.recording.joint);
    joints
        .map(|(joint, column)| {
            column
                .iter()
                .map(|reading| reading + joint.home_rad)
                .collect()
        })
        .collect()
}

/// All poses at once, reduced tile by tile. The sines of the readings belong to the solution: the peers work
/// theirs out as well.
fn lanes(
    task: &Task<'_>,
    solve: impl Fn(&DistanceModel, &PoseBatch, &[f64]) -> Result<Fit>,
) -> Result<Search> {
    let set = task.set;
    let device = &set.nominal;
    timed(
        || {
            let chosen: Vec<_> = set
                .free
                .iter()
                .filter_map(|id| match id {
                    ParameterId::Link { row, parameter } => Some((*row, *parameter)),
                    _ => None,
                })
                .collect();
            let motions = device.motions();
            let model = DistanceModel::new(device.convention, &device.links, &motions, [0.0; 3])?;
            let distances_m = set.recording.cable_m.first().and_then(Option::as_ref);
            let distances_m = distances_m.context("no distances")?;
            let weights = vec![1.0 / set.sd_m; distances_m.len()];
            Ok((
                model.with_parameters(&chosen)?,
                angles_rad(set),
                distances_m,
                weights,
            ))
        },
        |(model, angles, distances_m, weights)| {
            let motions = model.motions();
            let poses = PoseBatch::new(motions, angles, distances_m, weights, Sines::Cached)?;
            let fit = solve(model, &poses, &model.start())?;
            Ok((fit.cost, fit.iterations))
        },
    )
}

/// As Ceres is given a trust region that never binds, ours takes undamped steps.
fn undamped(task: &Task<'_>) -> Settings {
    Settings {
        method: Method::GaussNewton,
        ..task.settings
    }
}

fn in_lanes(task: &Task<'_>) -> Result<Search> {
    lanes(task, |model, poses, start| {
        let (free, settings) = (&task.free, &undamped(task));
        Ok(solve_distances(
            model,
            poses,
            start,
            free,
            settings,
            Threads::Several,
        )?)
    })
}

/// The same, from the solution of every 16th block of 4096 poses.
fn in_lanes_warm(task: &Task<'_>) -> Result<Search> {
    lanes(task, |model, poses, start| {
        let (free, settings) = (&task.free, &undamped(task));
        let threads = Threads::Several;
        Ok(solve_distances_warm(model, poses, start, free, settings, threads, 16)?.fit)
    })
}

/// The whole derivative matrix is held.
fn all_rows(task: &Task<'_>) -> Result<Search> {
    timed(
        || task.problem(),
        |problem| {
            let fit = solve(problem, &problem.start(), &task.free, &task.settings)?;
            Ok((fit.cost, fit.iterations))
        },
    )
}

/// It is reduced to a triangle on the way.
fn reduced(task: &Task<'_>) -> Result<Search> {
    timed(
        || task.problem(),
        |problem| {
            let (reduced, start) = (ReducedProblem::new(problem), problem.start());
            let fit = solve(&reduced, &start, &task.free, &task.settings)?;
            Ok((fit.cost, fit.iterations))
        },
    )
}

/// What a user gets: also which parameters can be fixed, before and after, and intervals.
fn step_two(task: &Task<'_>) -> Result<Search> {
    let options = Options {
        method: CalibrationMethod::TwoStep,
        weighting: Weighting::Stated,
        search: task.settings,
        ..Options::default()
    };
    timed(
        || Ok(()),
        |()| {
            let (device, recording) = (&task.set.nominal, &task.set.recording);
            let fit = fit_kinematics(device, recording, &task.channels, &task.weights, &options)?;
            let (fitted, wanted) = (fit.fitted.len(), task.free.len());
            ensure!(
                fitted == wanted,
                "{fitted} parameters were fitted, not {wanted}"
            );
            Ok((fit.cost, fit.iterations))
        },
    )
}

/// One of ours, with threads of its own.
pub(crate) struct Ours<'d> {
    family: &'static str,
    name: &'static str,
    solver: Solver,
    task: Task<'d>,
    threads: usize,
    pool: ThreadPool,
}

/// All of ours on `threads` threads each.
pub(crate) fn solvers(set: &DataSet, tolerance: f64, threads: usize) -> Result<Vec<Ours<'_>>> {
    SOLVERS
        .into_iter()
        .map(|(family, name, solver)| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            Ok(Ours {
                family,
                name,
                solver,
                task: Task::new(set, tolerance),
                threads,
                pool: pool.build().context("a thread cannot be started")?,
            })
        })
        .collect()
}

impl Contender for Ours<'_> {
    fn name(&self) -> &str {
        self.name
    }

    fn family(&self) -> &str {
        self.family
    }

    fn threads(&self) -> usize {
        self.threads
    }

    fn run(&mut self, repeats: usize) -> Result<Answer> {
        let (solver, task) = (self.solver, &self.task);
        // inside the pool, so that its hand-over is not in the times
        let searches: Result<Vec<Search>> = self
            .pool
            .install(|| (0..repeats.max(1)).map(|_| solver(task)).collect());
        let searches = searches.with_context(|| format!("ours: {}", self.name))?;
        let last = searches.last().context("nothing was run")?;
        Ok(Answer {
            cost: Some(last.cost),
            iterations: Some(last.iterations as u64),
            construction_s: searches.iter().map(|each| each.construction_s).collect(),
            solve_s: searches.iter().map(|each| each.solve_s).collect(),
        })
    }
}
