//! Scores the solver in certified digits.

use haptical_identification::{
    Fit, Method, NoiseScale, Settings, solve, uncertainty,
};

use super::fixture::{Certified, all};

/// Certified values carry 11 digits: more cannot be shown.
const CERTIFIED_DIGITS: f64 = 11.0;

/// Log relative error: -log10 |x - c| / |c|, between 0 and 11.
fn digits(value: f64, certified: f64) -> f64 {
    let relative = ((value - certified) / certified).abs();
    if relative.is_nan() {
        return 0.0;
    }
    (-relative.log10()).clamp(0.0, CERTIFIED_DIGITS)
}

fn worst(values: &[f64], certified: &[f64]) -> f64 {
    values
        .iter()
        .zip(certified)
        .map(|(value, certified)| digits(*value, *certified))
        .fold(CERTIFIED_DIGITS, f64::min)
}

struct Score {
    fit: Fit,
    parameters: f64,
    standard_deviations: f64,
    residual_sum_of_squares: f64,
}

fn run(problem: &Certified, start: usize, settings: &Settings) -> Score {
    let free: Vec<usize> = (0..problem.parameters.len()).collect();
    let fit = solve(problem, &problem.starts[start], &free, settings).unwrap();
    let deviations: Vec<f64> =
        match uncertainty(&fit.reduction, &free, fit.cost, NoiseScale::Estimated) {
            Ok(answer) => free.iter().map(|&p| answer.standard_deviation(p)).collect(),
            Err(_) => vec![f64::NAN; free.len()],
        };
    Score {
        parameters: worst(&fit.parameters, &problem.parameters),
        standard_deviations: worst(&deviations, &problem.standard_deviations),
        residual_sum_of_squares: digits(fit.cost, problem.residual_sum_of_squares),
        fit,
    }
}

#[test]
fn print_all() {
    let Some(problems) = all() else { return };
    for method in [Method::LevenbergMarquardt, Method::GaussNewton] {
        for start in [0, 1] {
            for problem in &problems {
                let settings = Settings {
                    method,
                    max_iterations: 1000,
                    ..Settings::default()
                };
                let score = run(problem, start, &settings);
                println!(
                    "{:?} start {} {:10} p {:5.1} sd {:5.1} rss {:5.1} it {:4} ev {:4} {:?}",
                    method,
                    start + 1,
                    problem.name,
                    score.parameters,
                    score.standard_deviations,
                    score.residual_sum_of_squares,
                    score.fit.iterations,
                    score.fit.evaluations,
                    score.fit.convergence
                );
            }
        }
    }
}
