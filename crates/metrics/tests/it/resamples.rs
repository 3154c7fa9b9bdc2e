//! Bootstrap: the stream of indices, the limits of the settings.

use haptical_metrics::{Bootstrap, MetricsError};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const PLAIN: Bootstrap = Bootstrap {
    replicates: 400,
    seed: 11,
    level: 0.95,
    block_length: 1,
};

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
}
