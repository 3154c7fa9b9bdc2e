//! Bootstrap: the ends from replicates that are known, the stream of indices, the limits of the settings.

use haptical_metrics::{Bootstrap, Interval, MetricsError, normal_two_sided_p};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const PLAIN: Bootstrap = Bootstrap {
    replicates: 400,
    seed: 11,
    level: 0.95,
    block_length: 1,
};

/// The interval when the sample itself gives `observed` and the resamples give 1, 2, ... 400.
fn corrected(observed: f64) -> Interval {
    let mut call = 0;
    let statistic = |_: &[usize]| {
        call += 1;
        Some(if call == 1 {
            observed
        } else {
            f64::from(call - 1)
        })
    };
    PLAIN.bias_corrected_interval(6, statistic).unwrap()
}

fn normal_below(z: f64) -> f64 {
    let tail = 0.5 * normal_two_sided_p(z).unwrap();
    if z < 0.0 { tail } else { 1.0 - tail }
}

/// Efron & Tibshirani (1993), section 14.3: with the printed normal quantile of each share, the type 7
/// quantile of 1, 2, ... 400 at p is 1 + 399 p.
#[test]
fn bias_corrected_ends_are_those_of_the_formula() {
    let shares = [
        (200.5, 0.0),                    // half of them below
        (100.5, -0.674_489_750_196_082), // a quarter
        (300.5, 0.674_489_750_196_082),
        (41.0, -1.274_461_242_221_932), // 40 below and one tie: 40.5 of 400
        (1e9, 3.023_341_439_739_156),   // all: half a resample from 1
        (-1e9, -3.023_341_439_739_156), // none
    ];
    for (observed, quantile) in shares {
        let found = corrected(observed);
        let end = |z: f64| 1.0 + 399.0 * normal_below(2.0 * quantile + z);
        let expected = [end(-1.959_963_984_540_054), end(1.959_963_984_540_054)];
        assert!(
            (found.low - expected[0]).abs() < 1e-6 && (found.high - expected[1]).abs() < 1e-6,
            "{observed}: {found:?}, {expected:?}"
        );
    }
}

/// One index of the generator for each block: the stream that a seed stands for.
#[test]
fn a_seed_stands_for_one_stream() {
    for block_length in [1, 3, 7] {
        let bootstrap = Bootstrap {
            block_length,
            ..PLAIN
        };
        let mut generator = ChaCha8Rng::seed_from_u64(PLAIN.seed);
        let statistic = |rows: &[usize]| {
            assert_eq!(rows.len(), 7);
            for block in rows.chunks(block_length) {
                assert_eq!(block[0], generator.random_range(0..7));
            }
            Some(0.0)
        };
        bootstrap.interval(7, statistic).unwrap();
    }
}

#[test]
fn half_of_the_resamples_are_enough() {
    let defined_in = |count: u32| {
        let mut call = 0;
        PLAIN.interval(5, |_: &[usize]| {
            call += 1;
            (call <= count).then_some(1.0)
        })
    };
    assert!(defined_in(200).is_ok());
    let few = defined_in(199).unwrap_err();
    let expected = MetricsError::StatisticUndefined {
        defined: 199,
        replicates: 400,
        needed: 200,
    };
    assert_eq!(few, expected);
}

#[test]
fn the_least_settings_are_served() {
    let ones = |_: &[usize]| Some(1.0);
    assert!(PLAIN.interval(2, ones).is_ok());
    let whole = Bootstrap {
        block_length: 5,
        ..PLAIN
    };
    assert!(whole.interval(5, ones).is_ok());
    // 2 / (1 - 0.99) of them leave one resample in each tail
    let wide = |replicates| Bootstrap {
        replicates,
        level: 0.99,
        ..PLAIN
    };
    assert!(wide(200).interval(5, ones).is_ok() && wide(199).interval(5, ones).is_err());
    let nan = PLAIN
        .bias_corrected_interval(5, |_: &[usize]| Some(f64::NAN))
        .unwrap_err();
    assert!(matches!(nan, MetricsError::NonFinite { .. }), "{nan}");
}
