//! How far a prediction is from a log.

use serde::Serialize;

/// How far predictions of one horizon are from the log.
#[derive(Debug, Clone, Serialize)]
pub struct Drift {
    /// Time after which a prediction begins again from the log's state \[s\]; none for each run as a whole.
    pub horizon_s: Option<f64>,
    /// Windows.
    pub windows: usize,
    /// Rows that are compared, of each joint.
    pub rows: usize,
    /// Joint by joint.
    pub joints: Vec<JointDrift>,
}

/// One joint's.
#[derive(Debug, Clone, Default, Serialize)]
pub struct JointDrift {
    /// Root mean square of prediction minus log \[rad\], \[m\].
    pub rms: f64,
    /// The same at the last row of each window.
    pub end_rms: f64,
    /// The largest.
    pub largest: f64,
    /// Root mean square of a controller's torque minus the logged one \[N m\], \[N\]; none without a controller or torques.
    pub torque_rms: Option<f64>,
}

/// A sum of squares and how many there are.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Squares {
    sum: f64,
    count: usize,
}

impl Squares {
    pub(super) fn add(&mut self, gap: f64) {
        self.sum += gap * gap;
        self.count += 1;
    }

    pub(super) fn root_mean(self) -> f64 {
        (self.sum / self.count.max(1) as f64).sqrt()
    }
}

/// Sums of squares on their way to a [`JointDrift`].
#[derive(Debug, Clone, Default)]
pub(super) struct Sums {
    all: Squares,
    ends: Squares,
    largest: f64,
    torques: Squares,
}

impl Sums {
    /// Takes a row's gap; `is_end` at the last one of a window.
    pub(super) fn add(&mut self, gap: f64, is_end: bool) {
        self.all.add(gap);
        self.largest = self.largest.max(gap.abs());
        if is_end {
            self.ends.add(gap);
        }
    }

    pub(super) fn torque(&mut self, gap: f64) {
        if gap.is_finite() {
            self.torques.add(gap);
        }
    }

    pub(super) fn rows(&self) -> usize {
        self.all.count
    }

    pub(super) fn told(&self) -> JointDrift {
        JointDrift {
            rms: self.all.root_mean(),
            end_rms: self.ends.root_mean(),
            largest: self.largest,
            torque_rms: (self.torques.count > 0).then(|| self.torques.root_mean()),
        }
    }
}
