//! Our own contenders in the distance identification. One more is a line in [`SOLVERS`] and a function.

use std::time::Instant;

use anyhow::{Context, Result, ensure};
use haptical_calibration::{
    CalibrationMethod, Channel, DeviceProblem, Options, ReducedProblem, Weighting, Weights,
    fit_kinematics,
};
use haptical_identification::{Fit, Method, Settings, solve};
use haptical_model::Recording;
use rayon::ThreadPool;

use super::contender::{Answer, Contender, Label};
use super::files::DataSet;

/// Family of what starts at the nominal values, as every peer does.
pub(crate) const COLD: &str = "ours";
/// Family of what starts at the solution for a share of the poses: bars of the cold fit are never judged by it.
pub(crate) const WARM: &str = "ours, warm start";

/// Every way of ours to the solution: family, name.
const SOLVERS: [(&str, &str, Solver); 4] = [
    (COLD, "solve, in lanes", in_lanes),
    (
        WARM,
        "solve, in lanes, after every 16th pose",
        in_lanes_warm,
    ),
    (COLD, "solve, all rows", all_rows),
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

    fn problem<'p>(&'p self, recording: &'p Recording) -> Result<DeviceProblem<'p>> {
        let (nominal, channels, free) = (&self.set.nominal, &self.channels, &self.set.free);
        let problem = DeviceProblem::new(nominal, recording, channels, free, &self.weights)?;
        Ok(problem)
    }

    fn solve_in_lanes(&self, problem: &DeviceProblem<'_>, start: &[f64]) -> Result<Fit> {
        let settings = Settings {
            method: Method::GaussNewton,
            ..self.settings.clone()
        };
        let reduced = ReducedProblem::new(problem);
        Ok(solve(&reduced, start, &self.free, &settings)?)
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

/// The whole derivative matrix is held.
fn all_rows(task: &Task<'_>) -> Result<Search> {
    timed(
        || task.problem(&task.set.recording),
        |problem| {
            let fit = solve(problem, &problem.start(), &task.free, &task.settings)?;
            Ok((fit.cost, fit.iterations))
        },
    )
}

/// All poses at once in lanes, reduced to a triangle on the way. The sines of the readings belong to the solution: the
/// peers work theirs out as well. As Ceres is given a trust region that never binds, ours takes undamped steps.
fn in_lanes(task: &Task<'_>) -> Result<Search> {
    timed(
        || task.problem(&task.set.recording),
        |problem| {
            let fit = task.solve_in_lanes(problem, &problem.start())?;
            Ok((fit.cost, fit.iterations))
        },
    )
}

/// The same, from the solution of every 16th pose, which are picked before the time begins.
fn in_lanes_warm(task: &Task<'_>) -> Result<Search> {
    let recording = &task.set.recording;
    let every: Vec<usize> = (0..recording.len()).step_by(16).collect();
    let part = recording.select(&every);
    timed(
        || Ok((task.problem(recording)?, task.problem(&part)?)),
        |(problem, part)| {
            let warm = task.solve_in_lanes(part, &part.start())?;
            let fit = task.solve_in_lanes(problem, &warm.parameters)?;
            Ok((fit.cost, fit.iterations))
        },
    )
}

/// What a user gets: also which parameters can be fixed, before and after, and intervals.
fn step_two(task: &Task<'_>) -> Result<Search> {
    let options = Options {
        method: CalibrationMethod::TwoStep,
        weighting: Weighting::Stated,
        search: task.settings.clone(),
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
    label: Label,
    solver: Solver,
    task: Task<'d>,
    pool: ThreadPool,
}

/// All of ours on `threads` threads each.
pub(crate) fn solvers(set: &DataSet, tolerance: f64, threads: usize) -> Result<Vec<Ours<'_>>> {
    SOLVERS
        .into_iter()
        .map(|(family, name, solver)| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            Ok(Ours {
                label: Label::new(family, name, threads),
                solver,
                task: Task::new(set, tolerance),
                pool: pool.build().context("a thread cannot be started")?,
            })
        })
        .collect()
}

impl Contender for Ours<'_> {
    fn label(&self) -> &Label {
        &self.label
    }

    fn run(&mut self, repeats: usize) -> Result<Answer> {
        let (solver, task) = (self.solver, &self.task);
        // inside the pool, so that its hand-over is not in the times
        let searches: Result<Vec<Search>> = self
            .pool
            .install(|| (0..repeats.max(1)).map(|_| solver(task)).collect());
        let searches = searches.with_context(|| format!("ours: {}", self.label.name))?;
        let last = searches.last().context("nothing was run")?;
        Ok(Answer {
            cost: Some(last.cost),
            iterations: Some(last.iterations as u64),
            construction_s: searches.iter().map(|each| each.construction_s).collect(),
            solve_s: searches.iter().map(|each| each.solve_s).collect(),
        })
    }
}
