//! Scatter of many fits against the stated standard deviations and intervals.

use haptical_identification::{
    NoiseScale, Reduction, Settings, evaluate_jacobian, solve, uncertainty,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::support::decay;

/// Seeds 0..400, fixed before the first run.
const SEEDS: u64 = 400;
const TRUTH: [f64; 3] = [2.0, 0.8, 0.5];
const SIGMA: f64 = 0.02;
const FREE: [usize; 3] = [0, 1, 2];

/// 4 standard deviations of a sample variance of 400 normal numbers, sqrt(2 / 399) each.
const VARIANCE_BOUND: f64 = 4.0 * 0.0708;
/// 4 standard deviations of the mean of 400 numbers, in standard deviations of one.
const MEAN_BOUND: f64 = 4.0 / 20.0;
/// A share of 95 % in 400 has the standard deviation 1.1 %.
const COVERAGE: std::ops::RangeInclusive<f64> = 0.92..=0.98;

/// A standard normal number (Box & Muller 1958).
fn normal(generator: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * (1.0 - generator.random::<f64>()).ln()).sqrt();
    radius * (2.0 * std::f64::consts::PI * generator.random::<f64>()).cos()
}

#[test]
fn scatter_reaches_the_bound_and_intervals_cover() {
    let t: Vec<f64> = (0..30).map(|k| 0.15 * f64::from(k)).collect();
    let exact: Vec<f64> = t
        .iter()
        .map(|t| TRUTH[0] * (-TRUTH[1] * t).exp() + TRUTH[2])
        .collect();
    // The bound: (J'J)^-1 at the truth.
    let (jacobian, residuals) =
        evaluate_jacobian(&decay(&t, &exact, SIGMA), &TRUTH, &FREE).unwrap();
    let bound = Reduction::new(&jacobian, &residuals).unwrap();
    let bound = uncertainty(&bound, &FREE, 0.0, NoiseScale::Stated).unwrap();

    let mut sums = [[0.0; 2]; 3];
    let mut covered = [[0.0; 2]; 3];
    let mut reduced_cost = 0.0;
    for seed in 0..SEEDS {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let y: Vec<f64> = exact
            .iter()
            .map(|value| value + SIGMA * normal(&mut generator))
            .collect();
        let problem = decay(&t, &y, SIGMA);
        let fit = solve(&problem, &[1.0, 0.5, 0.0], &FREE, &Settings::default()).unwrap();
        assert!(fit.convergence.was_successful());
        reduced_cost += fit.cost / (t.len() - 3) as f64 / SEEDS as f64;
        for p in FREE {
            let error = (fit.parameters[p] - TRUTH[p]) / bound.standard_deviation(p);
            sums[p][0] += error;
            sums[p][1] += error * error;
        }
        for (kind, noise) in [NoiseScale::Stated, NoiseScale::Estimated]
            .into_iter()
            .enumerate()
        {
            let spread = uncertainty(&fit.reduction, &FREE, fit.cost, noise).unwrap();
            for p in FREE {
                let half = spread.half_width_95(noise) * spread.standard_deviation(p);
                if (fit.parameters[p] - TRUTH[p]).abs() <= half {
                    covered[p][kind] += 1.0 / SEEDS as f64;
                }
            }
        }
    }
    let count = SEEDS as f64;
    for p in FREE {
        let mean = sums[p][0] / count;
        let variance = (sums[p][1] - count * mean * mean) / (count - 1.0);
        println!(
            "parameter {p}: mean {mean:+.3}, variance {variance:.3}, covered {:?}",
            covered[p]
        );
        assert!(mean.abs() < MEAN_BOUND, "parameter {p}: mean {mean}");
        assert!(
            (variance - 1.0).abs() < VARIANCE_BOUND,
            "parameter {p}: variance {variance}"
        );
        for share in covered[p] {
            assert!(COVERAGE.contains(&share), "parameter {p}: covered {share}");
        }
    }
    // Mean of 400 chi-square numbers of 27 degrees of freedom over 27: sqrt(2 / 27 / 400) each.
    let spread = (2.0 / 27.0 / count).sqrt();
    assert!((reduced_cost - 1.0).abs() < 4.0 * spread, "{reduced_cost}");
}
