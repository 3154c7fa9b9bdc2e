//! Noise with memory, drift and uneven size: an independent program in Python, and coverage.

use haptical_identification::{
    Component, Matrix, NoiseScale, OrderedProblem, Signal, correlated_noise, pooled,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde_json::Value;
use statrs::distribution::{ContinuousCDF, StudentsT};

fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|entry| entry.as_f64().unwrap())
        .collect()
}

fn half_widths(components: &[Component], count: usize) -> Vec<f64> {
    let half_width = |k: usize| {
        let (variance, freedom) = pooled(components, &|part| part[(k, k)]);
        let spread = StudentsT::new(0.0, 1.0, freedom).unwrap();
        spread.inverse_cdf(0.975) * variance.sqrt()
    };
    (0..count).map(half_width).collect()
}

/// Signals of one group, one after the other.
fn signals(groups: &[usize], rows: usize) -> Vec<Signal> {
    let of_signal = |(index, &group): (usize, &usize)| Signal {
        group,
        rows: (index * rows..(index + 1) * rows).collect(),
        at: (0..rows).collect(),
        has_drift: false,
    };
    groups.iter().enumerate().map(of_signal).collect()
}

/// fixtures/correlated/python.json: problems of a chain and of a capstan with noise of several kinds, and the answers of
/// the program in xtask/evidence/second-opinion.
#[test]
fn an_independent_program_says_the_same() {
    let text = include_str!("../../../../fixtures/correlated/python.json");
    let cases: Value = serde_json::from_str(text).unwrap();
    let cases = cases.as_array().unwrap();
    assert_eq!(cases.len(), 7);
    for case in cases {
        let name = case["name"].as_str().unwrap();
        let derivatives = case["derivatives"].as_array().unwrap();
        let axes: Vec<Vec<Vec<f64>>> = derivatives
            .iter()
            .map(|axis| axis.as_array().unwrap().iter().map(numbers).collect())
            .collect();
        let residuals: Vec<f64> = case["residuals"]
            .as_array()
            .unwrap()
            .iter()
            .flat_map(numbers)
            .collect();
        let (rows, count) = (axes[0][0].len(), axes[0].len());
        let matrix = Matrix::from_fn(residuals.len(), count, |row, column| {
            axes[row / rows][column][row % rows]
        });
        let covariates: Vec<Vec<f64>> = case["covariates"]
            .as_array()
            .unwrap()
            .iter()
            .map(numbers)
            .collect();
        let signals = signals(&vec![0; axes.len()], rows);
        let found = correlated_noise(&OrderedProblem {
            derivatives: &matrix,
            fitted: matrix.columns(),
            residuals: &residuals,
            signals: &signals,
            covariates: &covariates,
            noise: NoiseScale::Estimated,
            known: None,
        });
        let is_plain =
            ["memory", "drift"].iter().all(|key| case[*key] == false) && case["used"] == 0;
        assert_eq!(found.is_none(), is_plain, "{name}");
        let Some(found) = found else { continue };
        assert_eq!(
            !found.correlated.is_empty(),
            case["memory"] == true,
            "{name}"
        );
        assert_eq!(!found.drift.is_empty(), case["drift"] == true, "{name}");
        assert_eq!(
            found.uneven.len() as u64,
            case["used"].as_u64().unwrap(),
            "{name}"
        );
        let (steps, halves) = (numbers(&case["step"]), numbers(&case["half"]));
        for (k, half) in half_widths(&found.components, count)
            .into_iter()
            .enumerate()
        {
            assert!(
                (half / halves[k] - 1.0).abs() < 1e-6,
                "{name} {k}: {half} {}",
                halves[k]
            );
            let apart = (found.step[k] - steps[k]).abs();
            assert!(
                apart < 1e-6 * halves[k],
                "{name} {k}: {} {}",
                found.step[k],
                steps[k]
            );
        }
    }
}

/// A line and a constant through AR(1) noise: intervals of the usual covariance hold in a third of the draws.
#[test]
fn intervals_hold_the_truth_where_the_noise_has_memory() {
    const ROWS: usize = 400;
    const DRAWS: usize = 300;
    const RHO: f64 = 0.9;
    let wave = |row: usize, column: usize| {
        let phase = std::f64::consts::TAU * row as f64 / ROWS as f64;
        if column == 0 {
            (2.0 * phase).sin()
        } else {
            (3.0 * phase + 0.7).cos()
        }
    };
    let matrix = Matrix::from_fn(ROWS, 2, wave);
    let reduce =
        |residuals: &[f64]| haptical_identification::Reduction::new(&matrix, residuals).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let (mut usual, mut found) = (0, 0);
    for _ in 0..DRAWS {
        let mut before: f64 = StandardNormal.sample(&mut random);
        let noise: Vec<f64> = (0..ROWS)
            .map(|_| {
                let next: f64 = StandardNormal.sample(&mut random);
                before = RHO * before + (1.0 - RHO * RHO).sqrt() * next;
                before
            })
            .collect();
        let solved = reduce(&noise).solve(&[0, 1], 0.0, 1e-12).unwrap();
        let residuals: Vec<f64> = (0..ROWS)
            .map(|row| {
                solved.values[0] * matrix[(row, 0)] + solved.values[1] * matrix[(row, 1)]
                    - noise[row]
            })
            .collect();
        let answer = correlated_noise(&OrderedProblem {
            derivatives: &matrix,
            fitted: matrix.columns(),
            residuals: &residuals,
            signals: &signals(&[0], ROWS),
            covariates: &[],
            noise: NoiseScale::Estimated,
            known: None,
        });
        let answer = answer.unwrap();
        let sd = (2.0 / ROWS as f64).sqrt();
        for (k, half) in half_widths(&answer.components, 2).into_iter().enumerate() {
            usual += usize::from(solved.values[k].abs() <= 1.96 * sd);
            found += usize::from((solved.values[k] + answer.step[k]).abs() <= half);
        }
    }
    let share = |hits: usize| hits as f64 / (2 * DRAWS) as f64;
    // two standard errors of 600 draws are 0.018
    assert!(share(usual) < 0.5, "{}", share(usual));
    assert!((share(found) - 0.95).abs() < 0.03, "{}", share(found));
}

#[test]
fn even_noise_without_memory_keeps_the_usual_covariance() {
    const ROWS: usize = 300;
    const DRAWS: usize = 200;
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let ramp: Vec<f64> = (0..ROWS).map(|row| (row as f64 * 0.37).sin()).collect();
    let matrix = Matrix::from_fn(ROWS, 1, |row, _| ramp[row]);
    let mut kept = 0;
    for _ in 0..DRAWS {
        let noise: Vec<f64> = (0..ROWS)
            .map(|_| StandardNormal.sample(&mut random))
            .collect();
        let slope = ramp.iter().zip(&noise).map(|(x, e)| x * e).sum::<f64>()
            / ramp.iter().map(|x| x * x).sum::<f64>();
        let residuals: Vec<f64> = ramp
            .iter()
            .zip(&noise)
            .map(|(x, e)| slope * x - e)
            .collect();
        let answer = correlated_noise(&OrderedProblem {
            derivatives: &matrix,
            fitted: matrix.columns(),
            residuals: &residuals,
            signals: &signals(&[0], ROWS),
            covariates: std::slice::from_ref(&ramp),
            noise: NoiseScale::Estimated,
            known: None,
        });
        kept += usize::from(answer.is_none());
    }
    // a drift is allowed for in a quarter of the draws, memory is seen in a tenth of the others
    let share = f64::from(u32::try_from(kept).unwrap()) / DRAWS as f64;
    assert!((share - 0.68).abs() < 0.10, "{share}");
}

/// Two sensors show a parameter that is the drift of the first one, and the second one drifts by itself: a line in time joins
/// the second alone, and the first tells the parameter as well as if there were no lines.
#[test]
fn a_signal_whose_drift_is_a_parameter_has_no_line_besides() {
    const ROWS: usize = 400;
    let line = |row: usize| (row as f64 + 0.5) / ROWS as f64 - 0.5;
    let wave = |row: usize| 0.1 * (std::f64::consts::TAU * line(row)).cos();
    let column: Vec<f64> = (0..ROWS).map(line).chain((0..ROWS).map(wave)).collect();
    let matrix = Matrix::from_fn(2 * ROWS, 1, |row, _| column[row]);
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let drifting = |row: usize| {
        if row < ROWS {
            0.0
        } else {
            3.0 * line(row - ROWS)
        }
    };
    let readings: Vec<f64> = (0..2 * ROWS)
        .map(|row| {
            let noise: f64 = StandardNormal.sample(&mut random);
            noise + drifting(row)
        })
        .collect();
    let square: f64 = column.iter().map(|entry| entry * entry).sum();
    let pairs = column.iter().zip(&readings);
    let value = pairs.clone().map(|(own, read)| own * read).sum::<f64>() / square;
    let residuals: Vec<f64> = pairs.map(|(own, read)| value * own - read).collect();
    let of = |has_drift: bool| {
        let mut signals = signals(&[0, 1], ROWS);
        signals[0].has_drift = has_drift;
        let found = correlated_noise(&OrderedProblem {
            derivatives: &matrix,
            fitted: matrix.columns(),
            residuals: &residuals,
            signals: &signals,
            covariates: &[],
            noise: NoiseScale::Stated,
            known: None,
        });
        found.unwrap()
    };
    let found = of(true);
    assert_eq!(found.drift[0], 0.0);
    assert!((found.drift[1] - 3.0).abs() < 0.6, "{:?}", found.drift);
    // the line's own information is 400 / 12
    let half = half_widths(&found.components, 1)[0];
    assert!(
        (half / (1.96 * (12.0 / 400.0_f64).sqrt()) - 1.0).abs() < 0.15,
        "{half}"
    );
    // with a line beside it the first sensor says nothing
    let half = half_widths(&of(false).components, 1)[0];
    assert!(half > 1.0, "{half}");
}

/// An encoder that sees two parameters and a sensor that sees all five. Entries that are nothing but not zero let the encoder see all
/// of them: its columns then span as little, and every answer stays.
#[test]
fn a_sensor_is_worked_out_in_the_columns_that_it_sees() {
    const ROWS: usize = 300;
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let waves: Vec<Vec<f64>> = (0..6)
        .map(|_| (0..2 * ROWS).map(|_| normal()).collect())
        .collect();
    let mut memory = 0.0;
    let readings: Vec<f64> = (0..2 * ROWS)
        .map(|row| {
            memory = 0.8 * memory + normal();
            // louder in a part of the range
            if row % ROWS > 200 {
                4.0 * memory
            } else {
                memory
            }
        })
        .collect();
    let ramp: Vec<f64> = (0..ROWS).map(|row| row as f64).collect();
    let answer = |unseen: f64| {
        // five parameters of the fit, and one that it held
        let is_seen = |row: usize, column: usize| row >= ROWS || [1, 3].contains(&column);
        let matrix = Matrix::from_fn(2 * ROWS, 6, |row, column| match is_seen(row, column) {
            true => waves[column][row],
            false => unseen,
        });
        let fitted = Matrix::from_fn(2 * ROWS, 5, |row, column| matrix[(row, column)]);
        let reduction = haptical_identification::Reduction::new(&fitted, &readings).unwrap();
        let all: Vec<usize> = (0..5).collect();
        let values = reduction.solve(&all, 0.0, 1e-12).unwrap().values;
        let made = fitted.times(&values).unwrap();
        let residuals: Vec<f64> = made.iter().zip(&readings).map(|(a, b)| a - b).collect();
        let found = correlated_noise(&OrderedProblem {
            derivatives: &matrix,
            fitted: 5,
            residuals: &residuals,
            signals: &signals(&[0, 1], ROWS),
            covariates: std::slice::from_ref(&ramp),
            noise: NoiseScale::Estimated,
            known: None,
        });
        found.unwrap()
    };
    let (sparse, dense) = (answer(0.0), answer(1e-200));
    assert!(!sparse.uneven.is_empty() && !sparse.correlated.is_empty());
    assert_eq!(sparse.uneven.len(), dense.uneven.len());
    let halves = [&sparse, &dense].map(|found| half_widths(&found.components, 5));
    for k in 0..5 {
        assert!(
            (halves[0][k] / halves[1][k] - 1.0).abs() < 1e-9,
            "{k}: {halves:?}"
        );
        assert!(
            (sparse.step[k] - dense.step[k]).abs() < 1e-9 * halves[0][k],
            "{k}"
        );
    }
    for (one, other) in sparse.sizes.iter().zip(&dense.sizes) {
        assert!((one / other - 1.0).abs() < 1e-9);
    }
    let [one, other] = [sparse.held.unwrap(), dense.held.unwrap()];
    assert!((one.information[(0, 0)] / other.information[(0, 0)] - 1.0).abs() < 1e-9);
    assert!((one.scatter[(0, 0)] / other.scatter[(0, 0)] - 1.0).abs() < 1e-9);
}
