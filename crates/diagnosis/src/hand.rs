//! The force of a hand that is not there.

use haptical_model::Recording;
use haptical_motion::usual_step_s;

use crate::thresholds::hand::{CLOSE_S, FEWEST_ROWS, WHITE_SD};

/// The recording with forces of zero where its sensor shows white noise about zero and nothing else, and what is said of it; none for
/// other recordings. Rows of separate postures say nothing of that: a hand may push anew at each.
///
/// The ratio of von Neumann (1941, *Annals of Mathematical Statistics* 12): half the mean square of successive differences over the mean
/// square is 1 for white noise about zero, with a standard deviation of 1 over the root of the number of rows, and less where a hand
/// holds the handle for longer than one row.
pub(crate) fn without_idle_force(recording: &Recording) -> Option<(Recording, String)> {
    let axes = recording.force_n.as_ref()?;
    if usual_step_s(recording)? > CLOSE_S || !axes.iter().all(|axis| is_white(axis)) {
        return None;
    }
    let (sum, count) = (axes.iter().flatten())
        .filter(|force| force.is_finite())
        .fold((0.0, 0), |(sum, count), force| {
            (sum + force * force, count + 1)
        });
    // nothing is to be done, and nothing to be said, of zeros
    if sum == 0.0 {
        return None;
    }
    let words = format!(
        "the force sensor shows no more than its noise, {:.2} N on each axis: no hand is taken to hold the handle",
        (sum / f64::from(count)).sqrt()
    );
    let zero = |axis: &Vec<f64>| axis.iter().map(|force| 0.0 * force).collect();
    let without = Recording {
        force_n: Some(axes.each_ref().map(zero)),
        ..recording.clone()
    };
    Some((without, words))
}

fn is_white(axis: &[f64]) -> bool {
    let finite = axis.iter().copied().filter(|force| force.is_finite());
    let readings: Vec<f64> = finite.collect();
    let count = readings.len();
    if count < FEWEST_ROWS {
        return false;
    }
    let square: f64 = readings.iter().map(|force| force * force).sum();
    let steps = readings.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
    let half: f64 = 0.5 * steps.sum::<f64>();
    half >= (1.0 - WHITE_SD / (count as f64).sqrt()) * square
}

#[cfg(test)]
mod tests {
    use haptical_testkit::Random;

    use super::*;

    fn recording(step_s: f64, force: impl Fn(usize) -> f64) -> Recording {
        let mut random = Random::new(3);
        let mut axis = || {
            let rows = (0..2000).map(|row| force(row) + 0.1 * random.normal());
            rows.collect::<Vec<f64>>()
        };
        Recording {
            line: (2..2002).collect(),
            time_s: Some((0..2000).map(|row| step_s * row as f64).collect()),
            joint: vec![vec![0.0; 2000]],
            force_n: Some([axis(), axis(), axis()]),
            ..Recording::default()
        }
    }

    #[test]
    fn noise_about_zero_is_no_hand_and_anything_else_is_one() {
        let (without, words) = without_idle_force(&recording(0.01, |_| 0.0)).unwrap();
        assert!(words.contains("0.10 N"), "{words}");
        let forces = without.force_n.unwrap();
        assert!(forces.iter().flatten().all(|force| *force == 0.0));
        // a bias, a touch of 0.2 s, a hand that leans on it
        assert_eq!(without_idle_force(&recording(0.01, |_| 0.05)), None);
        let touch = |row: usize| if (700..720).contains(&row) { 1.0 } else { 0.0 };
        assert_eq!(without_idle_force(&recording(0.01, touch)), None);
        let lean = |row: usize| 0.06 * (0.01 * row as f64).sin();
        assert_eq!(without_idle_force(&recording(0.01, lean)), None);
        // a posture a row: each may have another push
        assert_eq!(without_idle_force(&recording(5.0, |_| 0.0)), None);
    }
}
