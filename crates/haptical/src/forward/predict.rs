//! Predictions window by window.

use std::ops::Range;

use haptical_model::ModelError;
use haptical_simulator::{
    Command, Controller, ControllerState, ForwardModel, ForwardState, ForwardWork,
};

use super::drift::{Drift, Squares, Sums};
use super::inputs::{Inputs, Piece};
use super::{CHECKED_WINDOWS, ForwardDevice, HORIZONS_S, KEPT_HORIZON_S};

/// A device with what moves it.
pub(super) struct Prediction<'p> {
    pub(super) inputs: &'p Inputs,
    /// One for each run.
    pub(super) models: &'p [ForwardModel],
    /// What drives it; none for the torques of the log.
    pub(super) controller: Option<&'p Controller>,
}

/// Rows of a window, with the piece that they are of.
type Window<'p> = (Range<usize>, &'p Piece);

/// Positions and torques of a window's rows, row after row.
#[derive(Debug, Default)]
struct Path {
    theta: Vec<f64>,
    torque: Vec<f64>,
}

impl Prediction<'_> {
    pub(super) fn device(
        &self,
        name: &str,
        starts: &mut Vec<usize>,
    ) -> Result<ForwardDevice, ModelError> {
        let joints = self.inputs.theta.len();
        let rows = self.inputs.time_s.len();
        let mut theta = vec![vec![f64::NAN; rows]; joints];
        let mut torque = self.controller.map_or(Vec::new(), |_| theta.clone());
        let mut drifts = Vec::new();
        for horizon_s in HORIZONS_S.map(Some).into_iter().chain([None]) {
            let windows = self.windows(horizon_s);
            let mut sums = vec![Sums::default(); joints];
            for window in &windows {
                let path = self.path(window, 1.0)?;
                self.compare(window, &path, &mut sums);
                if horizon_s == Some(KEPT_HORIZON_S) {
                    put(&mut theta, &window.0, &path.theta);
                    put(&mut torque, &window.0, &path.torque);
                }
            }
            if horizon_s == Some(KEPT_HORIZON_S) {
                *starts = windows.iter().map(|(rows, _)| rows.start).collect();
            }
            drifts.push(Drift {
                horizon_s,
                windows: windows.len(),
                rows: sums.first().map_or(0, Sums::rows),
                joints: sums.iter().map(Sums::told).collect(),
            });
        }
        Ok(ForwardDevice {
            name: name.to_owned(),
            drifts,
            step_s: (self.models.first()).map_or(0.0, ForwardModel::longest_step_s),
            halved_step_moves: self.halved()?,
            theta,
            torque,
        })
    }

    /// Windows of a length in time, or whole pieces. The first row of one may be the last of the one before.
    fn windows(&self, horizon_s: Option<f64>) -> Vec<Window<'_>> {
        let time_s = &self.inputs.time_s;
        let mut windows = Vec::new();
        for piece in &self.inputs.pieces {
            let rows = &piece.predicted;
            let Some(horizon_s) = horizon_s else {
                windows.push((rows.clone(), piece));
                continue;
            };
            let mut start = rows.start;
            for row in rows.start + 1..rows.end {
                // rounding of times is no reason for another row
                if time_s[row] - time_s[start] >= horizon_s * (1.0 - 1e-9) {
                    windows.push((start..row + 1, piece));
                    start = row;
                }
            }
            if rows.end - start > 1 {
                windows.push((start..rows.end, piece));
            }
        }
        windows
    }

    fn compare(&self, (rows, piece): &Window<'_>, path: &Path, sums: &mut [Sums]) {
        let joints = sums.len();
        for (place, values) in path.theta.chunks(joints).enumerate().skip(1) {
            let row = rows.start + place;
            for (joint, value) in values.iter().enumerate() {
                let gap = value - self.inputs.theta[joint][row];
                sums[joint].add(gap, row + 1 == rows.end);
            }
        }
        if self.inputs.torque.is_empty() {
            return;
        }
        let model = &self.models[piece.run];
        for (place, values) in path.torque.chunks(joints).enumerate().skip(1) {
            let now_s = self.inputs.time_s[rows.start + place];
            for (joint, value) in values.iter().enumerate() {
                let logged_s = now_s + model.delay_s(joint);
                sums[joint].torque(value - self.inputs.torque_at(joint, piece, logged_s));
            }
        }
    }

    /// By how much half the step moves predictions, in a few windows of the log.
    fn halved(&self) -> Result<Vec<f64>, ModelError> {
        let joints = self.inputs.theta.len();
        let windows = self.windows(Some(KEPT_HORIZON_S));
        let each = windows.len().div_ceil(CHECKED_WINDOWS).max(1);
        let mut squares = vec![Squares::default(); joints];
        for window in windows.iter().step_by(each) {
            let (whole, half) = (self.path(window, 1.0)?, self.path(window, 0.5)?);
            let both = whole.theta.chunks(joints).zip(half.theta.chunks(joints));
            for (whole, half) in both {
                for (squares, (whole, half)) in squares.iter_mut().zip(whole.iter().zip(half)) {
                    squares.add(whole - half);
                }
            }
        }
        Ok(squares.into_iter().map(Squares::root_mean).collect())
    }

    /// Positions of a window's rows, from the log's state at the first, in steps of this share of the usual ones.
    fn path(&self, (rows, piece): &Window<'_>, share: f64) -> Result<Path, ModelError> {
        let model = &self.models[piece.run];
        let at = |columns: &[Vec<f64>], row: usize| -> Vec<f64> {
            columns.iter().map(|column| column[row]).collect()
        };
        let mut mover = Mover {
            inputs: self.inputs,
            model,
            work: model.work(),
            state: model.start(
                &at(&self.inputs.theta, rows.start),
                &at(&self.inputs.dtheta, rows.start),
            ),
            longest_s: share * model.longest_step_s(),
            rows,
            piece,
        };
        match self.controller {
            None => mover.by_torques(),
            Some(controller) => mover.by_controller(controller),
        }
    }
}

/// Puts the values of some rows, row after row, into columns.
fn put(columns: &mut [Vec<f64>], rows: &Range<usize>, values: &[f64]) {
    for (row, values) in rows.clone().zip(values.chunks(columns.len().max(1))) {
        for (column, value) in columns.iter_mut().zip(values) {
            column[row] = *value;
        }
    }
}

/// A device on its way through a window.
struct Mover<'m> {
    inputs: &'m Inputs,
    model: &'m ForwardModel,
    work: ForwardWork,
    state: ForwardState,
    longest_s: f64,
    rows: &'m Range<usize>,
    piece: &'m Piece,
}

impl Mover<'_> {
    fn by_torques(&mut self) -> Result<Path, ModelError> {
        let mut path = Path {
            theta: self.state.theta.clone(),
            torque: Vec::new(),
        };
        let mut begin_s = self.inputs.time_s[self.rows.start];
        let mut from = self.given_at(begin_s);
        for row in self.rows.start + 1..self.rows.end {
            for end_s in self.ends_of_lines(row) {
                let to = self.given_at(end_s);
                let (state, work) = (&mut self.state, &mut self.work);
                let span = (end_s - begin_s, self.longest_s);
                self.model.run_by(state, work, span, [&from, &to])?;
                (begin_s, from) = (end_s, to);
            }
            path.theta.extend_from_slice(&self.state.theta);
        }
        Ok(path)
    }

    /// What the drives give at a time: what was logged their delay later.
    fn given_at(&self, now_s: f64) -> Vec<f64> {
        let joints = 0..self.inputs.torque.len();
        let given = joints.map(|joint| {
            let logged_s = now_s + self.model.delay_s(joint);
            let reading = self.inputs.torque_at(joint, self.piece, logged_s);
            self.model.given(joint, reading)
        });
        given.collect()
    }

    /// Times from a row to the one before it at which a straight line of a torque ends: those of rows, less the delays.
    fn ends_of_lines(&self, row: usize) -> Vec<f64> {
        let time_s = &self.inputs.time_s;
        let (begin_s, end_s) = (time_s[row - 1], time_s[row]);
        let piece = &time_s[self.piece.rows.clone()];
        let shortest_s = 1e-6 * (end_s - begin_s);
        let mut ends = vec![end_s];
        for joint in 0..self.inputs.torque.len() {
            let delay_s = self.model.delay_s(joint);
            if delay_s == 0.0 {
                continue;
            }
            let first = piece.partition_point(|own| own - delay_s <= begin_s + shortest_s);
            let within = piece[first..].iter().map(|own| own - delay_s);
            ends.extend(within.take_while(|own| *own < end_s - shortest_s));
        }
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|later, earlier| *later - *earlier < shortest_s);
        ends
    }

    fn by_controller(&mut self, controller: &Controller) -> Result<Path, ModelError> {
        let time_s = &self.inputs.time_s;
        let (tick_s, begin_s) = (1.0 / controller.rate_hz, time_s[self.rows.start]);
        let mut own = controller.start(&self.state.dtheta);
        let mut path = Path::default();
        let mut torques = vec![0.0; self.state.theta.len()];
        // a controller sets what its drives read (assumption A255)
        let mut given = torques.clone();
        let mut now_s = begin_s;
        let mut ticks = 0_u64;
        for row in self.rows.clone() {
            loop {
                let next_s = begin_s + ticks as f64 * tick_s;
                // a tick at a row's time comes first
                if next_s <= time_s[row] + 1e-9 * tick_s {
                    self.pass(now_s, next_s, &given)?;
                    now_s = next_s.max(now_s);
                    self.tick(controller, &mut own, row, now_s, &mut torques)?;
                    for (joint, (given, torque)) in given.iter_mut().zip(&torques).enumerate() {
                        *given = self.model.given(joint, *torque);
                    }
                    ticks += 1;
                    continue;
                }
                self.pass(now_s, time_s[row], &given)?;
                now_s = time_s[row].max(now_s);
                break;
            }
            path.theta.extend_from_slice(&self.state.theta);
            path.torque.extend_from_slice(&torques);
        }
        Ok(path)
    }

    /// Moves on under a constant torque.
    fn pass(&mut self, from_s: f64, to_s: f64, torques: &[f64]) -> Result<(), ModelError> {
        let seconds = to_s - from_s;
        if seconds <= 0.0 {
            return Ok(());
        }
        let (state, work) = (&mut self.state, &mut self.work);
        self.model
            .run_by(state, work, (seconds, self.longest_s), [torques, torques])
    }

    /// One tick, at or before a row's time.
    fn tick(
        &mut self,
        controller: &Controller,
        own: &mut ControllerState,
        row: usize,
        now_s: f64,
        torques: &mut [f64],
    ) -> Result<(), ModelError> {
        let last = row.max(self.rows.start + 1);
        let time_s = [self.inputs.time_s[last - 1], self.inputs.time_s[last]];
        let commands = self.inputs.command.iter().zip(&self.inputs.command_rate);
        let commands = commands.map(|(value, rate)| {
            let ends = [last - 1, last];
            let (values, rates) = (ends.map(|row| value[row]), ends.map(|row| rate[row]));
            hermite(time_s, values, rates, now_s)
        });
        let (theta, dtheta): (Vec<f64>, Vec<f64>) = commands.unzip();
        let command = Command {
            theta: &theta,
            dtheta: &dtheta,
        };
        let place = (&self.state.theta[..], &self.state.dtheta[..]);
        controller.tick(own, command, place, torques)
    }
}

/// The cubic through two values with their rates, and its rate.
fn hermite([from_s, to_s]: [f64; 2], [a, b]: [f64; 2], [u, v]: [f64; 2], now_s: f64) -> (f64, f64) {
    let span = to_s - from_s;
    let t = ((now_s - from_s) / span).clamp(0.0, 1.0);
    let (u, v) = (u * span, v * span);
    let rise = b - a;
    let (second, third) = (3.0 * rise - 2.0 * u - v, u + v - 2.0 * rise);
    let value = a + t * (u + t * (second + t * third));
    let rate = (u + t * (2.0 * second + 3.0 * t * third)) / span;
    (value, rate)
}
