//! Passes over poses of a 7-joint device, to be counted and timed.
//!
//! `distance_passes WORK POSES TIMES`, WORK one of `sweep` (residuals and derivatives), `reduce` (the same, folded into
//! a triangle) and `batch` (the batch itself). Prints the least time of all.
#![allow(
    clippy::print_stdout,
    reason = "a program that answers on standard output"
)]

mod arm;

use std::hint::black_box;
use std::time::{Duration, Instant};

use haptical_batch::PoseBatch;
use haptical_linalg::Triangle;

type Outcome = Result<(), Box<dyn std::error::Error>>;

fn main() -> Outcome {
    let words: Vec<String> = std::env::args().collect();
    let [_, work, poses, times] = words.as_slice() else {
        return Err("usage: distance_passes WORK POSES TIMES".into());
    };
    let (poses, times): (usize, usize) = (poses.parse()?, times.parse()?);
    let arm = arm::Arm::new(poses)?;
    let (start, free) = (arm.model.start(), &arm.free);
    let sweep = || -> Outcome {
        Ok(arm
            .poses
            .visit(&arm.model, black_box(&start), free, |tile| {
                black_box(tile.residuals());
            })?)
    };
    let reduce = || -> Outcome {
        let mut triangle = Triangle::new(free.len());
        let mut folded = Ok(());
        arm.poses
            .visit(&arm.model, black_box(&start), free, |tile| {
                let columns: Vec<&[f64]> = tile.derivatives().collect();
                if folded.is_ok() {
                    folded = triangle.fold_rows(&columns, tile.residuals());
                }
            })?;
        black_box(triangle.cost());
        Ok(folded?)
    };
    let batch = || -> Outcome {
        let motions = arm.model.motions();
        black_box(PoseBatch::new(
            motions,
            &arm.joints,
            &arm.distances_m,
            &arm.weights,
        )?);
        Ok(())
    };
    let run: &dyn Fn() -> Outcome = match work.as_str() {
        "sweep" => &sweep,
        "reduce" => &reduce,
        _ => &batch,
    };
    let mut least = Duration::MAX;
    for _ in 0..times {
        let from = Instant::now();
        run()?;
        least = least.min(from.elapsed());
    }
    println!(
        "{:.2} ns per pose",
        least.as_secs_f64() * 1e9 / poses as f64
    );
    Ok(())
}
