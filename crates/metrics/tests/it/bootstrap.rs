//! Bootstrap: structure of the resamples, repeatability, coverage and errors.

use haptical_metrics::{Bootstrap, MetricsError};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const PLAIN: Bootstrap = Bootstrap {
    replicates: 400,
    seed: 11,
    level: 0.95,
    block_length: 1,
};

/// Coverage allowed of a nominal 95 % interval over 400 repetitions, stated before the first run:
/// the percentile interval of 30 samples covers about 93 %, and three standard errors are 4 %.
const COVERAGE_ALLOWED: std::ops::RangeInclusive<f64> = 0.88..=0.99;

fn normal(generator: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (generator.random(), generator.random());
    (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

fn mean_of(values: &[f64]) -> impl FnMut(&[usize]) -> Option<f64> + '_ {
    |rows| Some(rows.iter().map(|&row| values[row]).sum::<f64>() / rows.len() as f64)
}

#[test]
fn interval_of_the_mean_covers_at_the_stated_rate() {
    let mut generator = ChaCha8Rng::seed_from_u64(2026);
    let mut covered = 0;
    for seed in 0..400 {
        let sample: Vec<f64> = (0..30).map(|_| 5.0 + normal(&mut generator)).collect();
        let bootstrap = Bootstrap { seed, ..PLAIN };
        let percentile = bootstrap.interval(30, mean_of(&sample)).unwrap();
        covered += u32::from(percentile.contains(5.0));
    }
    let share = f64::from(covered) / 400.0;
    assert!(COVERAGE_ALLOWED.contains(&share), "{covered} of 400");
}

#[test]
fn interval_has_the_width_of_the_normal_approximation() {
    let mut generator = ChaCha8Rng::seed_from_u64(5);
    let sample: Vec<f64> = (0..400).map(|_| normal(&mut generator)).collect();
    let mean = sample.iter().sum::<f64>() / 400.0;
    let variance = sample.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 400.0;
    let expected = 2.0 * 1.959_964 * (variance / 400.0).sqrt();
    let wide = Bootstrap {
        replicates: 4000,
        ..PLAIN
    };
    let width = wide.interval(400, mean_of(&sample)).unwrap().width();
    // The end of a 95 % interval from 4000 resamples has a standard error of about 2 %.
    assert!((width / expected - 1.0).abs() < 0.1, "{width} / {expected}");
}

#[test]
fn the_same_seed_gives_the_same_interval_and_another_seed_does_not() {
    let sample: Vec<f64> = (0..50).map(|k| (f64::from(k) * 0.7).sin()).collect();
    let first = PLAIN.interval(50, mean_of(&sample)).unwrap();
    assert_eq!(first, PLAIN.interval(50, mean_of(&sample)).unwrap());
    let other = Bootstrap { seed: 12, ..PLAIN };
    assert_ne!(first, other.interval(50, mean_of(&sample)).unwrap());
}

#[test]
fn blocks_hold_successive_samples_and_wrap() {
    let blocks = Bootstrap {
        block_length: 4,
        ..PLAIN
    };
    let (mut wrapped, mut starts) = (0, [0_usize; 10]);
    let statistic = |rows: &[usize]| {
        assert_eq!(rows.len(), 10);
        for block in rows.chunks(4) {
            starts[block[0]] += 1;
            for pair in block.windows(2) {
                assert_eq!(pair[1], (pair[0] + 1) % 10);
                wrapped += usize::from(pair[1] == 0);
            }
        }
        Some(0.0)
    };
    blocks.interval(10, statistic).unwrap();
    assert!(wrapped > 0);
    // 1200 starts over ten samples: 120 each, six standard deviations are 63.
    assert!(
        starts.iter().all(|count| count.abs_diff(120) < 63),
        "{starts:?}"
    );
}

#[test]
fn blocks_widen_the_interval_of_a_correlated_series() {
    // First-order series with coefficient 0.8: the standard error of the mean is three times that
    // of independent samples; blocks of 40 of 2000 samples see nearly all of it.
    let mut generator = ChaCha8Rng::seed_from_u64(8);
    let mut state = 0.0;
    let mut step = || {
        state = 0.8 * state + normal(&mut generator);
        state
    };
    let series: Vec<f64> = (0..2000).map(|_| step()).collect();
    let single = PLAIN.interval(2000, mean_of(&series)).unwrap().width();
    let blocks = Bootstrap {
        block_length: 40,
        ..PLAIN
    };
    let ratio = blocks.interval(2000, mean_of(&series)).unwrap().width() / single;
    assert!((2.0..4.0).contains(&ratio), "{ratio}");
}

#[test]
fn undefined_resamples_are_left_out_up_to_half() {
    let mut call = 0;
    let sometimes = |_: &[usize]| {
        call += 1;
        (call % 3 != 0).then_some(f64::from(call))
    };
    assert!(PLAIN.interval(5, sometimes).is_ok());
    let error = PLAIN.interval(5, |_| None).unwrap_err();
    let expected = MetricsError::StatisticUndefined {
        defined: 0,
        replicates: 400,
        needed: 200,
    };
    assert_eq!(error, expected);
    let nan = PLAIN.interval(5, |_| Some(f64::NAN)).unwrap_err();
    assert!(
        matches!(nan, MetricsError::NonFinite { index: 0, .. }),
        "{nan}"
    );
}

#[test]
fn settings_that_cannot_give_an_interval_are_refused() {
    let ones = |_: &[usize]| Some(1.0);
    assert!(
        Bootstrap {
            replicates: 40,
            ..PLAIN
        }
        .interval(5, ones)
        .is_ok()
    );
    let few = Bootstrap {
        replicates: 39,
        ..PLAIN
    }
    .interval(5, ones)
    .unwrap_err();
    assert!(
        matches!(
            few,
            MetricsError::TooFew {
                got: 39,
                needed: 40,
                ..
            }
        ),
        "{few}"
    );
    assert!(
        Bootstrap {
            block_length: 0,
            ..PLAIN
        }
        .interval(5, ones)
        .is_err()
    );
    assert!(
        Bootstrap {
            block_length: 6,
            ..PLAIN
        }
        .interval(5, ones)
        .is_err()
    );
    assert!(
        Bootstrap {
            level: 1.0,
            ..PLAIN
        }
        .interval(5, ones)
        .is_err()
    );
    assert!(
        Bootstrap {
            level: f64::NAN,
            ..PLAIN
        }
        .interval(5, ones)
        .is_err()
    );
    assert!(PLAIN.interval(1, ones).is_err());
}
