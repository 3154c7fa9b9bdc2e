//! Motions whose noise is another than that of the positions: the same motion a period later, or the commands that made it.
//!
//! The regressor of noisy positions is noisy, and in a closed loop the torques answer that noise: least squares are biased. Products
//! with the regressor of an independent recording of the same motion are not (Wooldridge, section 5.1; Janot, Vandanjon and Gautier
//! 2014 simulate that recording).

use haptical_model::Recording;

use crate::signal::samples::Samples;
use crate::thresholds::identify::{
    COMMAND_ROWS, COMMANDS_LEAVE, LONGEST_LAG_S, PERIOD_LEAVES, PERIOD_SAMPLES, SHORTER_LAG_LEAVES,
};

/// Where the regressor has a twin without its noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Instruments {
    /// The same motion, this much later or earlier \[s\].
    Repetition {
        /// Period \[s\].
        period_s: f64,
    },
    /// The commanded positions.
    Commands,
}

/// A recording with positions of another noise in the place of the measured ones, row by row; none where there is none.
pub(crate) fn twin(recording: &Recording, samples: &Samples) -> Option<(Recording, Instruments)> {
    repetition(recording, samples).or_else(|| commands(recording, samples))
}

fn repetition(recording: &Recording, samples: &Samples) -> Option<(Recording, Instruments)> {
    let [piece] = samples.pieces.as_slice() else {
        return None;
    };
    // rows stand for samples where none was left out or put on a grid
    if piece.length != recording.len() {
        return None;
    }
    let lag = period(&piece.motor)?;
    let shifted = |column: &[f64]| -> Vec<f64> {
        let later = |k: usize| column.get(k + lag).or_else(|| column.get(k - lag));
        (0..column.len())
            .map(|k| later(k).copied().unwrap_or(column[k]))
            .collect()
    };
    let twin = Recording {
        joint: recording.joint.iter().map(|own| shifted(own)).collect(),
        output: (recording.output.iter())
            .map(|own| own.as_deref().map(shifted))
            .collect(),
        ..recording.clone()
    };
    let period_s = lag as f64 * samples.step_s;
    Some((twin, Instruments::Repetition { period_s }))
}

/// The shortest lag at which all columns repeat themselves; at most half of their length.
pub(crate) fn period(columns: &[Vec<f64>]) -> Option<usize> {
    let length = columns.first()?.len();
    let variances: Vec<f64> = columns.iter().map(|own| variance(own)).collect();
    let largest = variances.iter().fold(0.0_f64, |most, own| most.max(*own));
    let moving: Vec<usize> = (0..columns.len())
        .filter(|k| variances[*k] > 1e-4 * largest && variances[*k] > 0.0)
        .collect();
    let left = |lag: usize, every: usize| {
        let of = |k: &usize| {
            let column = &columns[*k];
            let at = (0..length - lag).step_by(every);
            let count = (length - lag).div_ceil(every) as f64;
            let square: f64 = at
                .map(|row| (column[row + lag] - column[row]).powi(2))
                .sum();
            square / (2.0 * count * variances[*k])
        };
        moving.iter().map(of).fold(0.0_f64, f64::max)
    };
    if moving.is_empty() || length < 8 {
        return None;
    }
    let every = length.div_ceil(PERIOD_SAMPLES);
    let coarse: Vec<f64> = (0..=length / 2)
        .step_by(every)
        .map(|lag| left(lag, every))
        .collect();
    let apart = coarse.iter().position(|own| *own > SHORTER_LAG_LEAVES)?;
    let near = (apart + 1..coarse.len()).find(|k| {
        let next = coarse.get(k + 1).copied().unwrap_or(f64::INFINITY);
        // the coarse grid may miss the period by half of a step
        coarse[*k] < 4.0 * PERIOD_LEAVES && coarse[*k] <= coarse[k - 1] && coarse[*k] <= next
    })?;
    let from = (near * every).saturating_sub(every).max(1);
    let to = (near * every + every).min(length / 2);
    let fine = (from..=to).map(|lag| (lag, left(lag, 1)));
    let (lag, least) = fine.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (least < PERIOD_LEAVES).then_some(lag)
}

fn commands(recording: &Recording, samples: &Samples) -> Option<(Recording, Instruments)> {
    let longest = (LONGEST_LAG_S / samples.step_s).ceil() as usize;
    let mut twin = recording.clone();
    for (joint, own) in recording.joint.iter().enumerate() {
        let command = recording.command(joint)?;
        let sound =
            (own.iter().zip(command)).all(|(own, command)| own.is_finite() && command.is_finite());
        if !sound || own.len() <= longest + 2 || variance(own) == 0.0 {
            return None;
        }
        // mean square beside the command of so many rows before, about its mean
        let every = own.len().div_ceil(COMMAND_ROWS);
        let left = |lag: usize| {
            let pairs = own[lag..].iter().zip(command).step_by(every);
            let difference: Vec<f64> = pairs.map(|(a, b)| a - b).collect();
            (lag, variance(&difference))
        };
        let lags = (0..=longest).map(left);
        let (lag, least) = lags.min_by(|a, b| a.1.total_cmp(&b.1))?;
        if least > COMMANDS_LEAVE * variance(own) {
            return None;
        }
        twin.joint[joint] = (0..own.len())
            .map(|row| command[row.saturating_sub(lag)])
            .collect();
        twin.output[joint] = None;
    }
    Some((twin, Instruments::Commands))
}

fn variance(column: &[f64]) -> f64 {
    let count = column.len().max(1) as f64;
    let mean = column.iter().sum::<f64>() / count;
    column.iter().map(|own| (own - mean).powi(2)).sum::<f64>() / count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(periods: f64) -> Vec<Vec<f64>> {
        let of = |harmonic: f64| {
            let at = |k: i32| (harmonic * f64::from(k) * 0.01).sin() + (0.02 * f64::from(k)).cos();
            let length = (periods * 628.0) as i32;
            (0..length).map(at).collect::<Vec<f64>>()
        };
        vec![of(1.0), of(3.0)]
    }

    #[test]
    fn a_period_is_found_where_two_are_recorded() {
        assert_eq!(period(&wave(2.5)), Some(628));
        assert_eq!(period(&wave(1.7)), None);
    }

    #[test]
    fn a_motion_that_does_not_come_back_has_none() {
        let sweep = (0..2000).map(|k| (1e-5 * f64::from(k * k)).sin()).collect();
        assert_eq!(period(&[sweep]), None);
        assert_eq!(period(&[vec![0.3; 500]]), None);
    }
}
