//! Noise, its growth with speed, and outliers of made-up series are found.

use std::ops::Range;

use super::{Known, Noise, NoiseSource, estimate, outliers, speed_scale};

fn one_run(rows: usize) -> [Range<usize>; 1] {
    [Range {
        start: 0,
        end: rows,
    }]
}

/// The noise of a moving recording's values, `rounding` of whose stated variance is rounding.
fn moving(values: &[f64], rounding: f64) -> Noise {
    let known = Known {
        runs: &one_run(values.len()),
        ordered: true,
        repeats: None,
        are_of_one_side: false,
        lost: 0.0,
        stated: true,
        rounding,
    };
    estimate(values, &known)
}

/// A linear congruential sequence made normal by the sum of twelve uniforms.
fn normal(count: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut uniform = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..count)
        .map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0)
        .collect()
}

#[test]
fn white_noise_on_a_slow_signal_is_measured() {
    let values: Vec<f64> = normal(6000, 1)
        .into_iter()
        .enumerate()
        .map(|(k, e)| 1.3 * e + 20.0 * (k as f64 * 0.01).sin())
        .collect();
    let noise = moving(&values, 0.0);
    assert!((noise.ratio - 1.3).abs() < 0.06, "{noise:?}");
    assert!(noise.colour.abs() < 0.05);
}

#[test]
fn coloured_noise_is_measured() {
    let mut value = 0.0;
    let values: Vec<f64> = normal(6000, 2)
        .into_iter()
        .map(|e| {
            value = 0.5 * value + 0.75_f64.sqrt() * e;
            value
        })
        .collect();
    let noise = moving(&values, 0.0);
    assert!((noise.colour - 0.5).abs() < 0.03, "{noise:?}");
    assert!((noise.ratio - 1.0).abs() < 0.08, "{noise:?}");
}

#[test]
fn a_white_part_of_known_share_leaves_the_colour() {
    // with a third of the variance white, the correlation of successive rows rises up to a colour of
    // 0.6 alone, and is flat there
    for (colour, tolerance) in [(0.3_f64, 0.12), (0.5, 0.15), (0.6, 0.25)] {
        let mut value = 0.0;
        let values: Vec<f64> = normal(12_000, 7)
            .chunks_exact(2)
            .map(|pair| {
                value = colour * value + (1.0 - colour * colour).sqrt() * pair[0];
                value + 0.7 * pair[1]
            })
            .collect();
        let noise = moving(&values, 0.49 / 1.49);
        let low = noise.ratio.powi(2)
            * (1.0 + noise.coloured_share * 2.0 * noise.colour / (1.0 - noise.colour));
        // level at low frequency: (1 + c) / (1 - c) of the coloured part, 0.49 of the white one
        let truth = (1.0 + colour) / (1.0 - colour) + 0.49;
        assert!(
            (low / truth - 1.0).abs() < tolerance,
            "{colour}: {noise:?} {low} {truth}"
        );
    }
}

#[test]
fn noise_that_grows_with_speed_is_scaled() {
    let speed: Vec<f64> = (0..6000).map(|k| (f64::from(k) * 0.01).sin()).collect();
    let values: Vec<f64> = normal(6000, 5)
        .iter()
        .zip(&speed)
        .map(|(e, v)| e * (1.0 + 2.0 * v.abs()))
        .collect();
    let (scale, ratio) = speed_scale(&values, &speed, &one_run(6000)).unwrap_or_default();
    assert!((1.7..3.0).contains(&ratio), "{ratio}");
    assert!(scale[157] > 1.4 * scale[1], "{} {}", scale[157], scale[1]);
    assert!(speed_scale(&normal(6000, 6), &speed, &one_run(6000)).is_none());
}

/// Readings that repeat while the device rests differ by rounding alone, which is no noise to compare with.
#[test]
fn noise_that_a_rest_does_not_show_does_not_grow_with_speed() {
    let speed: Vec<f64> = (0..6000).map(|k| f64::from(k / 2000)).collect();
    let values: Vec<f64> = (normal(6000, 5).iter().zip(&speed))
        .map(|(value, speed)| if *speed == 0.0 { 1e-17 * value } else { *value })
        .collect();
    assert!(speed_scale(&values, &speed, &one_run(6000)).is_none());
}

#[test]
fn single_disturbed_rows_are_outliers_and_a_jump_is_not() {
    let mut values = normal(1000, 3);
    for row in 500..1000 {
        values[row] += 30.0;
    }
    values[100] += 12.0;
    values[700] -= 12.0;
    assert_eq!(
        outliers(&values, &one_run(1000), Some(3), 6.0, &[0.0; 1000]),
        vec![100, 700]
    );
    // what rounding may do is none
    assert_eq!(
        outliers(&values, &one_run(1000), Some(3), 0.1, &[8.0; 1000]),
        vec![100, 700]
    );
}

/// Where chance puts the size by neighbours above all that is left, the stated size must not make the noise white: a
/// wave of chance passed for a gap.
#[test]
fn noise_of_a_stated_size_keeps_its_colour() {
    let mut value = 0.0;
    let values: Vec<f64> = normal(6000, 12)
        .into_iter()
        .map(|e| {
            value = 0.5 * value + 0.75_f64.sqrt() * e;
            value
        })
        .collect();
    let segments = moving(&values, 0.0);
    let stated = Noise::of_postures(1.0, 22.0, NoiseSource::Stated);
    let found = super::colour::with_colour_of(stated.clone(), &segments);
    assert!((found.colour - 0.5).abs() < 0.05, "{found:?}");
    assert_eq!((found.ratio, found.source), (1.0, NoiseSource::Stated));
    // segments of a signal ten times as large say nothing of the colour
    let large = Noise {
        ratio: 10.0,
        ..segments
    };
    assert_eq!(
        super::colour::with_colour_of(stated.clone(), &large),
        stated
    );
}

/// A smooth signal passes for noise of long memory: its floor came out far above all that was left.
#[test]
fn a_floor_above_all_that_is_left_is_estimated_again() {
    // second differences of a slow wave with a tremor that fades within a few rows
    let mut value = 0.0;
    let values: Vec<f64> = normal(4000, 11)
        .into_iter()
        .map(|e| {
            value = 0.999 * value + 1e-3 * e;
            0.02 * value
        })
        .collect();
    let rms = (values.iter().map(|v| v * v).sum::<f64>() / 4000.0).sqrt();
    let noise = moving(&values, 0.0);
    assert!(
        !noise.is_above(rms, 4000.0 * noise.independent()),
        "{noise:?} {rms}"
    );
}

#[test]
fn noise_of_other_size_is_above_beyond_chance_alone() {
    let noise = Noise::of_postures(2.0, 386.0, NoiseSource::Repeats);
    assert!(noise.is_above(1.0, 30.0) && !noise.is_above(1.95, 1000.0));
    // eight repeats know a deviation to a quarter
    assert!(!Noise::of_postures(2.0, 8.0, NoiseSource::Repeats).is_above(1.0, 1000.0));
}

#[test]
fn noise_is_no_smaller_than_the_rounding_of_counts() {
    let seen = Noise::of_postures(0.5, 1000.0, NoiseSource::Motion);
    // the counts are all of it, and as uncertain as 32 readings
    let raised = seen.clone().with_counts(0.8, 32.0);
    assert_eq!((raised.ratio, raised.source), (0.8, NoiseSource::Counts));
    assert!((raised.freedom - 1.0 / (1.0 / 32.0 + 1.0 / 1000.0)).abs() < 1e-9);
    // a quarter of it, and hardly more uncertain than it was
    let kept = seen.with_counts(0.25, 32.0);
    assert_eq!((kept.ratio, kept.source), (0.5, NoiseSource::Motion));
    assert!((kept.freedom - 1.0 / (1.0 / 512.0 + 1.0 / 1000.0)).abs() < 1e-9);
}
