//! Growth of time and memory of the distance identification with poses, parameters and joints.

mod arms;
mod peak;

use std::path::PathBuf;
use std::time::Instant;

use anyhow::Result;
use haptical_calibration::ReducedProblem;
use haptical_identification::{Method, Settings, solve};
use haptical_linalg::{Matrix, RANK_TOLERANCE, Reduction};
use haptical_model::Recording;
use haptical_report::{Figure, FigureGrid, Table};
use xtask_output::{Layout, Output, Progress, cells};

use arms::Arm;

/// Arguments of `bench-scaling`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask bench-scaling")]
pub struct Arguments {
    /// Folder for tables, figures and report.
    #[arg(long, default_value = "target/bench-scaling")]
    out: PathBuf,
    #[arg(long, hide = true, default_value_t = 1)]
    seed: u64,
}

/// Joints of the paper's device.
const JOINTS: usize = 7;
/// Poses held in memory.
const HELD: [usize; 6] = [200, 1000, 10_000, 100_000, 300_000, 1_000_000];
/// Joints of the arms that are compared, and their poses.
const ARMS: [usize; 6] = [2, 3, 5, 7, 10, 14];
const ARM_POSES: usize = 20_000;
/// Flops of the derivatives of one row of a chain, forth and back: a joint's turn with its sine and cosine turned by
/// the offset, a constant turn, and what each derivative takes.
const FLOPS_PER_ROW: usize = 30;
/// A time is the least of repeats that take this long together \[s\].
const REPEATED_S: f64 = 0.4;

/// Runs the job.
pub fn measure(arguments: &Arguments) -> Result<()> {
    let mut output = Output::new(Layout::in_folders("scaling"));
    let seed = arguments.seed;
    let progress = Progress::new("scaling", HELD.len() + ARMS.len() + 2);
    let peak = peak::flops_per_s();
    output.section("The floor");
    output.words(format!(
        "One core computes {:.1} GFlop/s (fused multiply-adds in lanes, on numbers in registers). A pass over n poses of \
         an arm of m joints with k parameters needs about n (2 k^2 + {FLOPS_PER_ROW} (m + 1)) flops, {:.0} a pose for the \
         28 parameters of 7 joints: at that rate {:.1} ns a pose.",
        peak / 1e9,
        flops(JOINTS, 4 * JOINTS),
        1e9 * flops(JOINTS, 4 * JOINTS) / peak,
    ));
    output.value("peak_flops_per_s", peak.into());
    output.terminal(format!("one core: {:.1} GFlop/s", peak / 1e9));
    let by_poses = poses_section(&mut output, seed, peak, &progress)?;
    let by_parameters = parameters_section(&mut output, seed, peak, &progress)?;
    let panel = |title: &str, label: &str, points: &[(f64, f64)]| {
        let mut figure = Figure::new(title, label, "log10 of the time [s]");
        let points = points.iter().map(|(x, y)| (x.log10(), y.log10())).collect();
        figure.legend = false;
        figure.points("ours", 0, points);
        figure
    };
    let panels = vec![
        panel("by poses", "log10 of the poses", &by_poses),
        panel("by parameters", "log10 of the parameters", &by_parameters),
    ];
    let grid = FigureGrid::new("Time of one fit, one thread", 2, panels);
    let caption = "Time of one fit over poses and parameters";
    output.grid("scaling", caption, &grid)?;
    let lead = "How time and memory of the 28-parameter distance identification grow, on the machine that ran it. Times \
                are the least of several; exponents are slopes of straight lines through logarithms.";
    output.write(&arguments.out, "Scaling", lead)
}

/// Flops of a pass, a pose.
fn flops(joints: usize, parameters: usize) -> f64 {
    (2 * parameters * parameters + FLOPS_PER_ROW * (joints + 1)) as f64
}

/// Least time of one fit \[s\], and its steps.
fn fit_s(arm: &Arm, recording: &Recording, threads: usize) -> Result<(f64, usize)> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let settings = Settings {
        method: Method::GaussNewton,
        cost_tolerance: 1e-8,
        ..Settings::default()
    };
    let problem = arm.problem(recording)?;
    let free: Vec<usize> = (0..arm.free.len()).collect();
    pool.build()?.install(|| {
        let reduced = ReducedProblem::new(&problem);
        let (mut least, mut steps) = (f64::INFINITY, 0);
        let begin = Instant::now();
        while begin.elapsed().as_secs_f64() < REPEATED_S {
            let from = Instant::now();
            let fit = solve(&reduced, &problem.start(), &free, &settings)?;
            least = least.min(from.elapsed().as_secs_f64());
            steps = fit.iterations;
        }
        Ok((least, steps))
    })
}

fn poses_section(
    output: &mut Output,
    seed: u64,
    peak: f64,
    progress: &Progress,
) -> Result<Vec<(f64, f64)>> {
    let arm = Arm::new(JOINTS, seed)?;
    let columns = "poses | one thread [ms] | two threads [ms] | one over two | steps | each pose and pass [ns] | over \
             the floor";
    let mut table = Table::with_heads("Time over the number of poses, 28 parameters", columns);
    let mut points = Vec::new();
    for poses in HELD {
        let batch = arm.record(poses, seed)?;
        let (one_s, steps) = fit_s(&arm, &batch, 1)?;
        let (two_s, _) = fit_s(&arm, &batch, 2)?;
        points.push((poses as f64, one_s));
        // a pass at the start and one for each step
        let passes = (steps + 1) as f64;
        let each_s = one_s / passes / poses as f64;
        table.push(cells! {
            poses => 0, 1e3 * one_s => 3, 1e3 * two_s => 3, one_s / two_s => 2, steps => 0,
            1e9 * each_s => 1, each_s * peak / flops(JOINTS, arm.free.len()) => 2,
        })?;
        progress.step();
    }
    output.section("Poses in memory");
    output.terminal_table(&table, &[0, 1, 2, 3, 4, 5, 6]);
    output.table("poses", table)?;
    let most: Vec<(f64, f64)> = points.iter().copied().filter(|(n, _)| *n >= 1e4).collect();
    let words = format!(
        "Exponent of the time over the poses: {:.3} from 10 000 on, {:.3} from 200 on.",
        exponent(&most)?,
        exponent(&points)?
    );
    output.terminal(words.clone());
    output.words(words);
    Ok(points)
}

fn parameters_section(
    output: &mut Output,
    seed: u64,
    peak: f64,
    progress: &Progress,
) -> Result<Vec<(f64, f64)>> {
    let columns =
        "joints | parameters | one thread [ms] | steps | each pose and pass [ns] | over the floor";
    let mut table = Table::with_heads("Time over the number of joints, 20 000 poses", columns);
    let mut points = Vec::new();
    for joints in ARMS {
        let arm = Arm::new(joints, seed)?;
        let batch = arm.record(ARM_POSES, seed)?;
        let (one_s, steps) = fit_s(&arm, &batch, 1)?;
        let each_s = one_s / (steps + 1) as f64;
        points.push((arm.free.len() as f64, each_s));
        let over_floor = each_s * peak / ARM_POSES as f64 / flops(joints, arm.free.len());
        table.push(cells! {
            joints => 0, arm.free.len() => 0, 1e3 * one_s => 3, steps => 0,
            1e9 * each_s / ARM_POSES as f64 => 1, over_floor => 2,
        })?;
        progress.step();
    }
    output.section("Parameters");
    output.terminal_table(&table, &[0, 1, 2, 3, 4, 5]);
    output.table("parameters", table)?;
    // the parameters are four times the joints, so the floor's own slope over either is one number
    let floor: Vec<(f64, f64)> = ARMS
        .iter()
        .map(|&joints| ((4 * joints) as f64, flops(joints, 4 * joints)))
        .collect();
    let upper = |points: &[(f64, f64)]| exponent(&points[ARMS.len() / 2 - 1..]);
    let words = format!(
        "Exponent of a pass over the parameters, and over the joints, as there are four of them to a joint: {:.2} from 8 \
         parameters on, {:.2} from 20 on; that of the floor's flops: {:.2} and {:.2}. The derivatives alone have the \
         exponent 1, the reduction alone 2.",
        exponent(&points)?,
        upper(&points)?,
        exponent(&floor)?,
        upper(&floor)?,
    );
    output.terminal(words.clone());
    output.words(words);
    Ok(points)
}

/// Slope of the straight line of least squares through the logarithms.
fn exponent(points: &[(f64, f64)]) -> Result<f64> {
    let design = Matrix::from_fn(points.len(), 2, |row, column| match column {
        0 => 1.0,
        _ => points[row].0.ln(),
    });
    let logs: Vec<f64> = points.iter().map(|(_, y)| y.ln()).collect();
    let line = Reduction::new(&design, &logs)?.solve(&[0, 1], 0.0, RANK_TOLERANCE)?;
    Ok(line.values[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exponent_is_a_slope_of_logarithms() {
        let points: Vec<(f64, f64)> = (1..6)
            .map(|n| (f64::from(n), 3.0 * f64::from(n).powf(1.7)))
            .collect();
        assert!((exponent(&points).unwrap() - 1.7).abs() < 1e-12);
    }
}
