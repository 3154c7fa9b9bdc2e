//! Robust losses: slopes, efficiency, outliers, estimating equations, standard deviations.

use haptical_identification::{
    Loss, Matrix, NoiseScale, RobustFit, Settings, robust_covariance, robust_scale, solve,
    solve_robust, uncertainty,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use statrs::distribution::{ContinuousCDF, Normal};

use crate::support::decay;

const ROBUST: [Loss; 4] = [Loss::Huber, Loss::Cauchy, Loss::Tukey, Loss::StudentT];
const TRUTH: [f64; 3] = [2.0, 0.7, 0.3];
const NOISE: f64 = 0.02;
const FREE: [usize; 3] = [0, 1, 2];

#[test]
fn slopes_are_those_of_the_influence() {
    const STEP: f64 = 1e-6;
    for loss in ROBUST {
        for tenth in -80..80 {
            // between the kinks of Huber and Tukey
            let u = f64::from(tenth) * 0.1 + 0.033;
            let difference = (loss.influence(u + STEP) - loss.influence(u - STEP)) / (2.0 * STEP);
            assert!(
                (difference - loss.influence_slope(u)).abs() < 1e-8,
                "{loss} {u}"
            );
            assert!((loss.influence(u) - u * loss.weight(u)).abs() < 1e-15);
            assert!((0.0..=1.0).contains(&loss.weight(u)));
        }
        for wild in [f64::MAX, f64::INFINITY, 1e200] {
            assert!(
                loss.influence(wild).is_finite() && loss.weight(-wild) < 1e-100,
                "{loss}"
            );
        }
    }
}

#[test]
fn tuning_constants_have_the_efficiency_that_they_are_known_for() {
    let normal = Normal::new(0.0, 1.0).unwrap();
    let count = 200_000;
    let sample: Vec<f64> = (0..count)
        .map(|k| normal.inverse_cdf((f64::from(k) + 0.5) / f64::from(count)))
        .collect();
    for loss in [Loss::Huber, Loss::Cauchy, Loss::Tukey] {
        let weight = sample.iter().map(|&u| loss.weight(u)).sum::<f64>() / f64::from(count);
        let efficiency = weight / loss.variance_factor(&sample).unwrap();
        assert!((efficiency - 0.95).abs() < 5e-4, "{loss}: {efficiency}");
    }
    assert!((robust_scale(&sample, 0.0) - 1.0).abs() < 1e-4);
    assert_eq!(Loss::Squares.variance_factor(&[1.0, -1.0]).unwrap(), 1.0);
}

fn sample(seed: u64, count: u32, outliers: bool) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let t: Vec<f64> = (0..count)
        .map(|k| 5.0 * f64::from(k) / f64::from(count))
        .collect();
    let clean: Vec<f64> = t
        .iter()
        .map(|t| {
            let noise: f64 = StandardNormal.sample(&mut random);
            TRUTH[0] * (-TRUTH[1] * t).exp() + TRUTH[2] + NOISE * noise
        })
        .collect();
    let dirty = clean
        .iter()
        .map(|y| {
            let is_wild = random.random_bool(0.2);
            let size = random.random_range(0.5..3.0);
            if outliers && is_wild { y + size } else { *y }
        })
        .collect();
    (t, clean, dirty)
}

#[test]
fn a_fifth_of_gross_one_sided_outliers_moves_nothing() {
    for seed in 0..20 {
        let (t, clean, dirty) = sample(seed, 300, true);
        let start = [1.0, 1.0, 0.0];
        let settings = Settings::default();
        let good = solve(&decay(&t, &clean, NOISE), &start, &FREE, &settings).unwrap();
        let spread = uncertainty(&good.reduction, &FREE, good.cost, NoiseScale::Stated).unwrap();
        let problem = decay(&t, &dirty, NOISE);
        let plain = solve(&problem, &start, &FREE, &settings).unwrap();
        let moved = |parameters: &[f64]| {
            let moves = FREE
                .map(|k| (parameters[k] - good.parameters[k]).abs() / spread.standard_deviation(k));
            moves.into_iter().fold(0.0, f64::max)
        };
        assert!(
            moved(&plain.parameters) > 10.0,
            "{seed}: the outliers are no challenge"
        );
        for loss in [Loss::Cauchy, Loss::Tukey, Loss::StudentT] {
            let robust = solve_robust(&problem, &start, &FREE, &settings, loss).unwrap();
            assert!(robust.settled && robust.fit.convergence.was_successful());
            let moved = moved(&robust.fit.parameters);
            // Tukey's forgets them; the others keep a pull of each
            assert!(
                moved < if loss == Loss::Tukey { 3.0 } else { 8.0 },
                "{seed} {loss}: {moved}"
            );
        }
    }
}

#[test]
fn the_estimating_equations_hold() {
    let (t, _, dirty) = sample(7, 200, true);
    let problem = decay(&t, &dirty, NOISE);
    for loss in ROBUST {
        let found = solve_robust(
            &problem,
            &[1.0, 1.0, 0.0],
            &FREE,
            &Settings::default(),
            loss,
        )
        .unwrap();
        let (residuals, slopes) = (problem.evaluate)(&found.fit.parameters).unwrap();
        let scale = robust_scale(&residuals, 3.0);
        assert!((scale - found.scale).abs() < 1e-12 * scale);
        for column in FREE {
            let pulls = residuals.iter().zip(&slopes);
            let terms: Vec<f64> = pulls
                .map(|(r, slopes)| loss.influence(r / scale) * slopes[column])
                .collect();
            let size = terms.iter().map(|term| term.abs()).sum::<f64>();
            assert!(
                terms.iter().sum::<f64>().abs() < 3e-3 * size,
                "{loss} {column}"
            );
        }
    }
}

#[test]
fn stated_deviations_are_those_of_many_fits() {
    const RUNS: u64 = 600;
    for loss in ROBUST {
        let mut squares = [0.0; 3];
        for seed in 0..RUNS {
            let (t, clean, _) = sample(1000 + seed, 150, false);
            let problem = decay(&t, &clean, NOISE);
            let found = solve_robust(&problem, &TRUTH, &FREE, &Settings::default(), loss).unwrap();
            let RobustFit {
                fit,
                scale,
                variance_factor,
                ..
            } = &found;
            let spread = uncertainty(&fit.reduction, &FREE, fit.cost, NoiseScale::Stated).unwrap();
            for k in FREE {
                let deviation = spread.standard_deviation(k) * scale * variance_factor.sqrt();
                squares[k] += ((fit.parameters[k] - TRUTH[k]) / deviation).powi(2) / RUNS as f64;
            }
        }
        for square in squares {
            // the median of 150 sizes scatters by 6 %, its square's mean is a little above one
            assert!((0.85..1.25).contains(&square), "{loss}: {squares:?}");
        }
    }
}

#[test]
fn squares_are_least_squares() {
    let (t, _, dirty) = sample(3, 50, true);
    let problem = decay(&t, &dirty, NOISE);
    let plain = solve(&problem, &TRUTH, &FREE, &Settings::default()).unwrap();
    let found = solve_robust(&problem, &TRUTH, &FREE, &Settings::default(), Loss::Squares).unwrap();
    assert_eq!(found.fit.parameters, plain.parameters);
    assert_eq!((found.rounds, found.settled), (1, true));
}

/// The last third of the rows has six times the noise: the loss's own factor states too little, the sandwich does not.
#[test]
fn deviations_of_rows_with_sizes_of_their_own_are_those_of_many_fits() {
    const RUNS: u64 = 400;
    let (mut usual, mut allowed) = ([0.0; 3], [0.0; 3]);
    for seed in 0..RUNS {
        let (t, clean, _) = sample(5000 + seed, 240, false);
        let truth = |t: f64| TRUTH[0] * (-TRUTH[1] * t).exp() + TRUTH[2];
        let louder = t.iter().zip(&clean).map(|(&t, y)| match t > 3.4 {
            true => truth(t) + 6.0 * (y - truth(t)),
            false => *y,
        });
        let louder: Vec<f64> = louder.collect();
        let problem = decay(&t, &louder, NOISE);
        let settings = Settings::default();
        let found = solve_robust(&problem, &TRUTH, &FREE, &settings, Loss::Tukey).unwrap();
        let (residuals, slopes) = (problem.evaluate)(&found.fit.parameters).unwrap();
        let derivatives = Matrix::from_fn(240, 3, |row, k| slopes[row][k] / found.scale);
        let of = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
            residuals.iter().map(|r| of(r / found.scale)).collect()
        };
        let bends = of(&|u| Loss::Tukey.influence_slope(u));
        let pulls = of(&|u| Loss::Tukey.influence(u).powi(2));
        let covariance = robust_covariance(&derivatives, &bends, &pulls).unwrap();
        let fit = &found.fit;
        let spread = uncertainty(&fit.reduction, &FREE, fit.cost, NoiseScale::Stated).unwrap();
        for k in FREE {
            let square = (fit.parameters[k] - TRUTH[k]).powi(2) / RUNS as f64;
            let stated = spread.standard_deviation(k) * found.scale;
            usual[k] += square / stated.powi(2) / found.variance_factor;
            allowed[k] += square / covariance[(k, k)];
        }
    }
    // the offset rests on the louder rows
    assert!(usual[2] > 1.5, "the noise is no challenge: {usual:?}");
    for square in allowed {
        assert!(
            (0.8..1.3).contains(&square),
            "{allowed:?}, usually {usual:?}"
        );
    }
}
