//! Rows of the torques with the positions, the commands and the bodies that a controller computes them from.

use haptical_model::Recording;

use super::Untracked;
use crate::arm::Arm;
use crate::fit::problem::is_still;
use crate::signal::local_polynomial::LocalPolynomial;
use crate::signal::noise::Noise;
use crate::signal::samples::Samples;
use crate::signal::states::States;
use crate::thresholds::tracking::{EARLIEST_S, LATEST_S, LEAST_ROWS, MOST_READINGS, MOST_ROWS};

/// How a log is read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reading {
    /// How long the torques are logged before their positions \[s\].
    pub(super) early_s: f64,
    /// Edge of the band of the rows \[Hz\].
    pub(super) edge_hz: f64,
}

/// The rows.
pub(super) struct Rows {
    pub(super) arm: Arm,
    /// The motion: the motors' side is measured, the links' side stands for the commands.
    pub(super) states: States,
    /// Joints that have torque and commands and move; the rest is in their order.
    pub(super) joints: Vec<usize>,
    /// Rows of the torques, less their offsets.
    pub(super) torque: Vec<Vec<f64>>,
    /// Standard deviation of the noise of a row.
    pub(super) noise: Vec<f64>,
    pub(super) step_s: f64,
    pub(super) early_s: f64,
    pub(super) jitter: f64,
    /// First reading of the log that was looked at.
    first: usize,
}

impl Rows {
    pub(super) fn of(arm: &Arm, log: &Recording, reading: Reading) -> Result<Self, Untracked> {
        let all = log.joint.len();
        let has_command = |joint: usize| {
            let own = log.command(joint);
            own.is_some_and(|own| own.iter().any(|value| value.is_finite()))
        };
        if !(0..all).any(has_command) {
            return Err(Untracked::NoCommands);
        }
        let busiest = busiest(log);
        let (first, taken) = match &busiest {
            Some(rows) => (
                rows.start,
                Some(log.select(&rows.clone().collect::<Vec<_>>())),
            ),
            None => (0, None),
        };
        let log = taken.as_ref().unwrap_or(log);
        // commands in the place of encoders on the links: the same pieces, the same grid
        let beside = Recording {
            output: (0..all)
                .map(|joint| log.command(joint).filter(|_| has_command(joint)))
                .map(|own| own.map(<[f64]>::to_vec))
                .collect(),
            ..log.clone()
        };
        let few = |_| Untracked::Short;
        let samples = Samples::new(&beside, true).map_err(few)?;
        let mut states = States::new(&samples, reading.edge_hz).ok_or(Untracked::Short)?;
        keep_inner(&mut states);
        if states.rows() < LEAST_ROWS {
            return Err(Untracked::Short);
        }
        let fastest = |joint: usize| {
            let own = states.link.dq[joint].iter();
            own.fold(0.0_f64, |most, dq| most.max(dq.abs()))
        };
        let most = (0..all).map(fastest).fold(0.0, f64::max);
        let is_told = |joint: &usize| {
            has_command(*joint)
                && samples.constant_torque(*joint) == Some(None)
                && !is_still(fastest(*joint), most)
        };
        let joints: Vec<usize> = (0..all).filter(is_told).collect();
        if joints.is_empty() {
            return Err(Untracked::Short);
        }
        let local = LocalPolynomial::new(samples.step_s, 2.0 * reading.edge_hz);
        let mut torque = Vec::new();
        let mut noise = Vec::new();
        for &joint in &joints {
            let early_s = reading.early_s + arm.early_s[joint];
            let own = states.torque(&samples, joint, early_s);
            torque.push(own.iter().map(|own| own - arm.offset[joint]).collect());
            let columns = (samples.pieces.iter()).filter_map(|own| own.torque[joint].as_deref());
            let largest =
                (columns.clone().flatten()).fold(0.0_f64, |most, own| most.max(own.abs()));
            let sd = states.behind(Noise::white(columns, &local));
            // torques that are computed have no noise at all: their rounding then
            noise.push(sd.max(1e-6 * largest).max(1e-12));
        }
        Ok(Self {
            arm: arm.clone(),
            joints,
            torque,
            noise,
            step_s: samples.step_s,
            early_s: reading.early_s,
            jitter: samples.jitter,
            states,
            first,
        })
    }

    pub(super) fn count(&self) -> usize {
        self.states.rows()
    }

    /// Reading of the log in the middle of each row.
    pub(super) fn row_of(&self) -> impl Iterator<Item = usize> + '_ {
        let centre = self.states.centre.iter();
        centre.map(|&step| self.first + self.states.row_of[step])
    }

    /// A signal at the fine steps as it was some time before: the cubic through the four steps around.
    pub(super) fn late(&self, signal: &[f64], delay_s: f64) -> Vec<f64> {
        let steps = delay_s / self.states.fine_s;
        let (whole, part) = (steps.floor(), steps - steps.floor());
        // with x from the second of the four on
        let x = 1.0 - part;
        let weights = [
            -x * (x - 1.0) * (x - 2.0) / 6.0,
            (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0,
            -(x + 1.0) * x * (x - 2.0) / 2.0,
            (x + 1.0) * x * (x - 1.0) / 6.0,
        ];
        let last = signal.len() as isize - 1;
        let from = -(whole as isize) - 2;
        (0..signal.len() as isize)
            .map(|k| {
                let at = |i: usize| signal[(k + from + i as isize).clamp(0, last) as usize];
                (weights.iter().enumerate())
                    .map(|(i, weight)| weight * at(i))
                    .sum()
            })
            .collect()
    }
}

/// Readings in which the commands move most, of a log that has many.
fn busiest(log: &Recording) -> Option<std::ops::Range<usize>> {
    if log.len() <= MOST_READINGS {
        return None;
    }
    let way = |rows: &std::ops::Range<usize>| -> f64 {
        let commands = (0..log.joint.len()).filter_map(|joint| log.command(joint));
        let steps = commands.flat_map(|own| own[rows.clone()].windows(2));
        let steps = steps.map(|own| (own[1] - own[0]).abs());
        steps.filter(|own| own.is_finite()).sum()
    };
    let count = log.len() / MOST_READINGS;
    let parts = (0..count).map(|part| part * MOST_READINGS..(part + 1) * MOST_READINGS);
    parts.max_by(|a, b| way(a).total_cmp(&way(b)))
}

/// Keeps rows whose window, shifted by any delay that is tried, is within their piece; not more than are needed.
fn keep_inner(states: &mut States) {
    if states.rows() == 0 {
        return;
    }
    let half = states.window(0).1.len() / 2;
    let before = half + (LATEST_S / states.fine_s).ceil() as usize + 3;
    let after = half + (-EARLIEST_S / states.fine_s).ceil() as usize + 3;
    let times = &states.time_s;
    let is_inner = |step: &usize| {
        let (Some(from), to) = (step.checked_sub(before), step + after) else {
            return false;
        };
        let whole = (to - from) as f64 * states.fine_s;
        to < times.len() && ((times[to] - times[from]) - whole).abs() < 0.5 * states.fine_s
    };
    let inner: Vec<usize> = states.centre.iter().copied().filter(is_inner).collect();
    let every = inner.len().div_ceil(MOST_ROWS).max(1);
    states.centre = inner.into_iter().step_by(every).collect();
}
