//! The joint problem of a 60 s log, ours against the best dense path: `cargo bench -p haptical-calibration --bench
//! joint_sparse -- [ROWS] [ROUNDS] [ours|dense]`.
//!
//! One thread for both, in turns; the median of the rounds' ratios is what counts. With `ours` or `dense` that way
//! alone runs, once: to count its instructions.
#![allow(
    missing_docs,
    dead_code,
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a program that measures, on the devices of the tests"
)]

#[path = "../tests/it/dense.rs"]
mod dense;
#[path = "../tests/it/haptic.rs"]
mod haptic;

use std::time::Instant;

use dense::Dense;
use haptical_calibration::{DeviceProblem, ReducedProblem};
use haptical_identification::{Fit, Problem, Reduction, Settings, evaluate_jacobian, solve};
use haptical_simulator::Noise;

/// 100 rows a second for 60 s.
const ROWS: usize = 6000;
const ROUNDS: usize = 15;

fn main() {
    // cargo itself adds --bench
    let words: Vec<String> = std::env::args()
        .skip(1)
        .filter(|word| !word.starts_with("--"))
        .collect();
    let number = |index: usize, default| words.get(index).map_or(default, |w| w.parse().unwrap());
    let (rows, rounds) = (number(0, ROWS), number(1, ROUNDS));
    let Some(nominal) = haptic::haptic7() else {
        return;
    };
    let truth = haptic::truth_of(&nominal, 1.0);
    let recording = haptic::record(&truth, rows, 7, Noise::Gaussian);
    let joint = haptic::joint_problem(&nominal, &recording);
    let (device, weights) = (&joint.device, &joint.weights);
    let (channels, parameters) = (&joint.channels, &joint.parameters);
    let construct =
        || DeviceProblem::new(device, &recording, channels, parameters, weights).unwrap();
    let problem = construct();
    let start = problem.start();
    let settings = Settings::default();
    // what either prepares once (sines of the readings) is in its time
    let timed = |is_dense: bool| {
        let from = Instant::now();
        let ours = ReducedProblem::new(&problem);
        let dense = Dense(&ours);
        let searched: &dyn Problem = if is_dense { &dense } else { &ours };
        let fit = solve(searched, &start, &joint.free, &settings).unwrap();
        (from.elapsed().as_secs_f64(), fit)
    };
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let (one, two) = (pool(1).unwrap(), pool(2).unwrap());
    match words.get(2).map(String::as_str) {
        Some("ours") => println!("{:?}", one.install(|| timed(false)).0),
        Some("dense") => println!("{:?}", one.install(|| timed(true)).0),
        Some(other) => panic!("ours or dense, not {other}"),
        None => {
            let mut times: [Vec<f64>; 6] = Default::default();
            let mut fits: Option<[Fit; 2]> = None;
            for _ in 0..rounds {
                let (a, first) = one.install(|| timed(false));
                let (b, second) = one.install(|| timed(true));
                let (c, _) = two.install(|| timed(false));
                let d = one.install(|| all_rows_s(&problem, &start, &joint.free));
                let from = Instant::now();
                one.install(construct);
                let e = from.elapsed().as_secs_f64();
                for (times, each) in times.iter_mut().zip([b / a, a, b, a / c, d, e]) {
                    times.push(each);
                }
                fits = Some([first, second]);
            }
            let [ratios, ours_s, dense_s, threads, faer_s, new_s] = times.map(|mut each| {
                each.sort_by(f64::total_cmp);
                each
            });
            let half = ratios.len() / 2;
            let [first, second] = fits.unwrap();
            println!(
                "{rows} rows, {} parameters, {} and {} steps",
                joint.free.len(),
                first.iterations,
                second.iterations
            );
            println!(
                "dense, blocked QR of all rows, one thread: {:.2} ms",
                1e3 * dense_s[half]
            );
            println!("ours, one thread: {:.2} ms", 1e3 * ours_s[half]);
            println!(
                "dense / ours: {:.2} ({:.2} to {:.2}; bar: at least 3)",
                ratios[half],
                ratios[0],
                ratios[ratios.len() - 1]
            );
            println!("ours, one thread over two: {:.2}", threads[half]);
            println!(
                "evaluation row by row and column-pivoted QR of all rows, once: {:.2} ms",
                1e3 * faer_s[half]
            );
            println!(
                "the problem itself (weights with the steps of the readings), one thread: {:.2} ms",
                1e3 * new_s[half]
            );
            let apart = first
                .parameters
                .iter()
                .zip(&second.parameters)
                .map(|(a, b)| (a - b).abs() / b.abs().max(1e-3))
                .fold(0.0, f64::max);
            println!(
                "apart: costs {:.1e}, parameters at most {apart:.1e} (of 1e-3 at least)",
                (first.cost / second.cost - 1.0).abs()
            );
        }
    }
}

/// Time of one linearisation of the whole matrix, reduced by the pivoted QR that the general form uses \[s\].
fn all_rows_s(problem: &DeviceProblem<'_>, values: &[f64], free: &[usize]) -> f64 {
    let from = Instant::now();
    let (jacobian, residuals) = evaluate_jacobian(problem, values, free).unwrap();
    Reduction::new(&jacobian, &residuals).unwrap();
    from.elapsed().as_secs_f64()
}
