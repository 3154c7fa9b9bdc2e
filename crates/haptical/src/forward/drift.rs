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

/// Sums of squares on their way to a [`JointDrift`].
#[derive(Debug, Clone, Default)]
pub(super) struct Sums {
    square: f64,
    rows: usize,
    end_square: f64,
    ends: usize,
    largest: f64,
    torque_square: f64,
    torques: usize,
}

impl Sums {
    pub(super) fn add(&mut self, gap: f64) {
        self.square += gap * gap;
        self.rows += 1;
        self.largest = self.largest.max(gap.abs());
    }

    pub(super) fn end(&mut self, gap: f64) {
        self.end_square += gap * gap;
        self.ends += 1;
    }

    pub(super) fn torque(&mut self, gap: f64) {
        if gap.is_finite() {
            self.torque_square += gap * gap;
            self.torques += 1;
        }
    }

    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    pub(super) fn told(&self) -> JointDrift {
        let root = |square: f64, count: usize| (square / count.max(1) as f64).sqrt();
        JointDrift {
            rms: root(self.square, self.rows),
            end_rms: root(self.end_square, self.ends),
            largest: self.largest,
            torque_rms: (self.torques > 0).then(|| root(self.torque_square, self.torques)),
        }
    }
}
