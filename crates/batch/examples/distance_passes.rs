//! Passes over poses of a 7-joint device, or whole fits, to be counted and timed.
//!
//! `distance_passes WORK POSES TIMES`, WORK one of `sweep-cached`, `sweep` (residuals and derivatives),
//! `reduce-cached`, `reduce` (derivatives and reduction), `solve`, `solve-loose` (stops where the
//! promised fall is 1e-10 of the cost), `solve-two` (the threads of the pool), `solve-warm` (from every
//! 16th block), `batch` (the batch itself). Prints the least time of all.
#![allow(
    clippy::print_stdout,
    reason = "a program that answers on standard output"
)]

mod arm;

use std::hint::black_box;
use std::time::{Duration, Instant};

use haptical_batch::{
    DistanceProblem, PoseBatch, ReducedDistance, Sines, Threads, Triangle, solve_distances,
    solve_distances_warm,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().collect();
    let [_, work, poses, times] = words.as_slice() else {
        return Err("usage: distance_passes WORK POSES TIMES".into());
    };
    let (poses, times): (usize, usize) = (poses.parse()?, times.parse()?);
    let sines = if work.ends_with("cached") || work.starts_with("solve") || work == "batch" {
        Sines::Cached
    } else {
        Sines::EachPass
    };
    let arm = arm::Arm::new(poses, sines)?;
    let (start, free) = (arm.model.start(), &arm.free);
    let mut least = Duration::MAX;
    let mut timed = |work: &mut dyn FnMut() -> Result<(), Box<dyn std::error::Error>>| {
        for _ in 0..times {
            let from = Instant::now();
            work()?;
            least = least.min(from.elapsed());
        }
        Ok::<(), Box<dyn std::error::Error>>(())
    };
    if work.starts_with("sweep") {
        let problem = DistanceProblem::new(&arm.model, &arm.poses)?;
        timed(&mut || {
            problem.visit(black_box(&start), free, |tile| {
                black_box(tile.residuals());
            })?;
            Ok(())
        })?;
    } else if work.starts_with("reduce") {
        let problem = ReducedDistance::new(&arm.model, &arm.poses, Threads::One)?;
        timed(&mut || {
            black_box(problem.reduce(black_box(&start), free, Triangle::cost)?);
            Ok(())
        })?;
    } else if work == "batch" {
        timed(&mut || {
            let (motions, weights) = (arm.model.motions(), &arm.weights);
            let (joints, distances_m) = (&arm.joints, &arm.distances_m);
            black_box(PoseBatch::new(
                motions,
                joints,
                distances_m,
                weights,
                sines,
            )?);
            Ok(())
        })?;
    } else {
        let mut settings = arm.settings;
        if work == "solve-loose" {
            settings.cost_tolerance = 1e-10;
        }
        let threads = if work == "solve-two" {
            Threads::Several
        } else {
            Threads::One
        };
        let mut fit = None;
        timed(&mut || {
            let (model, poses) = (&arm.model, &arm.poses);
            fit = Some(if work == "solve-warm" {
                solve_distances_warm(model, poses, &start, free, &settings, threads, 16)?.fit
            } else {
                solve_distances(model, poses, &start, free, &settings, threads)?
            });
            Ok(())
        })?;
        if let Some(fit) = fit {
            let (steps, passes) = (fit.iterations, fit.evaluations);
            println!("{steps} steps, {passes} passes, {}", fit.convergence);
        }
        println!("{:.1} us", least.as_secs_f64() * 1e6);
        return Ok(());
    }
    println!(
        "{:.2} ns per pose",
        least.as_secs_f64() * 1e9 / poses as f64
    );
    Ok(())
}
