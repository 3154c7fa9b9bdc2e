//! Rows of what an encoder on a link reads beside its motor's, and of the motion and the load that explain it.

use haptical_linalg::dot;
use haptical_model::Recording;

use super::LoadSource;
use crate::MotionError;
use crate::signal::local_polynomial::LocalPolynomial;
use crate::signal::low_pass::LowPass;
use crate::signal::noise::Noise;
use crate::signal::samples::{Piece, Samples};
use crate::survey::check_rate;
use crate::thresholds::between::{
    DRIVES_EDGE_HZ, EDGE_OF_RATE, LEAST_ROWS, LINKS_EDGE_HZ, MOST_ROWS, STILL_RAD_PER_S,
};

/// Rows of all joints that have an encoder on the link.
pub(super) struct Rows {
    pub(super) joints: Vec<JointRows>,
    pub(super) edge_hz: f64,
    pub(super) jitter: f64,
    /// Time of each row \[s\], and the row of the recording that it is centred at.
    pub(super) time_s: Vec<f64>,
    pub(super) row_of: Vec<usize>,
}

/// Rows of one joint.
#[derive(Clone)]
pub(super) struct JointRows {
    pub(super) joint: usize,
    /// First row of each piece of the recording, and one beyond the last row.
    pub(super) pieces: Vec<usize>,
    /// What the link's encoder reads beside the motor's \[rad\], and the link's own reading.
    pub(super) beside: Vec<f64>,
    pub(super) link: Vec<f64>,
    /// Motor's angle \[rad\], speed and acceleration.
    pub(super) angle: Vec<f64>,
    pub(super) speed: Vec<f64>,
    pub(super) acceleration: Vec<f64>,
    /// Torque that the gear carries \[N m\].
    pub(super) load: Vec<f64>,
    /// Root mean square of that torque, and its standard deviation.
    pub(super) load_rms: f64,
    pub(super) load_sd: f64,
    /// Step of the log \[s\].
    pub(super) step_s: f64,
    /// Standard deviation of a row's noise \[rad\].
    pub(super) noise: f64,
    /// That torque sample by sample, piece by piece, and the samples in the middle of each piece's rows.
    samples: Vec<(Vec<f64>, Vec<usize>)>,
    weights: Vec<f64>,
}

impl Rows {
    /// Rows of a recording.
    pub(super) fn of(recording: &Recording, source: LoadSource) -> Result<Self, MotionError> {
        let samples = Samples::new(recording, false)?;
        check_rate(&samples)?;
        let edge_hz = match source {
            LoadSource::Links => LINKS_EDGE_HZ,
            LoadSource::Drives => DRIVES_EDGE_HZ,
        };
        let edge_hz = edge_hz.min(EDGE_OF_RATE * samples.rate_hz());
        let grid = Grid::new(&samples, edge_hz, source);
        let [time_s, row_of] = grid.times(&samples);
        let first = &samples.pieces[0];
        let has_both =
            |joint: &usize| first.link[*joint].is_some() && first.torque[*joint].is_some();
        let joints: Vec<JointRows> = (0..first.motor.len())
            .filter(has_both)
            .map(|joint| grid.joint(&samples, joint))
            .collect();
        if joints.is_empty() {
            return Err(MotionError::Missing {
                what: "out1_rad".to_owned(),
                why: "delays and springs of a gear are seen by an encoder on its link",
            });
        }
        if time_s.len() < LEAST_ROWS {
            return Err(MotionError::too_short());
        }
        let speeds = joints.iter().flat_map(|own| &own.speed);
        if speeds.fold(0.0_f64, |most, own| most.max(own.abs())) < STILL_RAD_PER_S {
            return Err(MotionError::Standstill);
        }
        Ok(Self {
            joints,
            edge_hz,
            jitter: samples.jitter,
            time_s,
            row_of: row_of.into_iter().map(|own| own as usize).collect(),
        })
    }
}

/// Where the rows are.
struct Grid {
    weights: Vec<f64>,
    /// Those of the load's own low pass; none where it has no noise. A regressor with noise makes every spring too stiff (A166).
    of_load: Option<Vec<f64>>,
    local: LocalPolynomial,
    /// Samples in the middle of the rows of each piece.
    centres: Vec<Vec<usize>>,
    step_s: f64,
}

impl Grid {
    fn new(samples: &Samples, edge_hz: f64, source: LoadSource) -> Self {
        let step_s = samples.step_s;
        let pass = LowPass { edge_hz };
        let local = LocalPolynomial::new(step_s, 2.0 * edge_hz);
        let weights = pass.weights(step_s, 0.0).1;
        let of_load =
            (source == LoadSource::Drives).then(|| LowPass { edge_hz }.weights(step_s, 0.0).1);
        let half = |own: &Vec<f64>| own.len() / 2;
        let reach = half(&weights) + of_load.as_ref().map_or(0, half).max(local.half);
        let every = (pass.row_s() / step_s).round().max(1.0) as usize;
        let inner = |piece: &Piece| piece.length.saturating_sub(2 * reach);
        let possible: usize = samples.pieces.iter().map(|own| inner(own) / every).sum();
        let every = every * possible.div_ceil(MOST_ROWS).max(1);
        let centres = |piece: &Piece| {
            let last = reach + inner(piece);
            (reach..last).step_by(every).collect()
        };
        Self {
            centres: samples.pieces.iter().map(centres).collect(),
            weights,
            of_load,
            local,
            step_s,
        }
    }

    /// Times of the rows, and rows of the recording.
    fn times(&self, samples: &Samples) -> [Vec<f64>; 2] {
        let mut found = [Vec::new(), Vec::new()];
        for (piece, centres) in samples.pieces.iter().zip(&self.centres) {
            for &centre in centres {
                found[0].push(piece.start_s + centre as f64 * self.step_s);
                found[1].push((piece.first_row + centre) as f64);
            }
        }
        found
    }

    fn joint(&self, samples: &Samples, joint: usize) -> JointRows {
        let empty = [const { Vec::new() }; 5];
        let [mut link, mut beside, mut angle, mut speed, mut acceleration] = empty;
        let mut pieces = vec![0];
        let mut loads = Vec::new();
        let mut raw = Vec::new();
        for (piece, centres) in samples.pieces.iter().zip(&self.centres) {
            let motor = &piece.motor[joint];
            let none = Vec::new();
            let own = piece.link[joint].as_ref().unwrap_or(&none);
            let torque = piece.torque[joint].as_ref().unwrap_or(&none);
            let apart: Vec<f64> = own.iter().zip(motor).map(|(a, b)| a - b).collect();
            // speeds are taken of samples that the window reaches
            let inner = self.local.half..piece.length.saturating_sub(self.local.half);
            let of_order = |order: usize| -> Vec<f64> {
                let at = |k: usize| match inner.contains(&k) {
                    true => self.local.at(order, motor, k),
                    false => 0.0,
                };
                (0..piece.length).map(at).collect()
            };
            let [first, second] = [of_order(1), of_order(2)];
            for &centre in centres {
                let pass = |own: &[f64]| filtered(&self.weights, own, centre);
                link.push(pass(own));
                beside.push(pass(&apart));
                angle.push(pass(motor));
                speed.push(pass(&first));
                acceleration.push(pass(&second));
            }
            pieces.push(beside.len());
            loads.push((self.load(torque), centres.clone()));
            raw.push(apart);
        }
        let noise = Noise::white(raw.iter().map(Vec::as_slice), &self.local);
        let weights = self.weights.clone();
        let mut found = JointRows {
            joint,
            pieces,
            link,
            beside,
            angle,
            speed,
            acceleration,
            load: Vec::new(),
            load_rms: 0.0,
            load_sd: 0.0,
            step_s: self.step_s,
            noise: noise.behind(&weights).max(1e-12),
            samples: loads,
            weights,
        };
        found.load = found.of_load(|own| own);
        let count = found.load.len().max(1) as f64;
        let square = dot(&found.load, &found.load) / count;
        let mean = found.load.iter().sum::<f64>() / count;
        found.load_rms = square.sqrt();
        found.load_sd = (square - mean * mean).max(0.0).sqrt();
        found
    }

    /// A torque as the load of a gear.
    fn load(&self, torque: &[f64]) -> Vec<f64> {
        let Some(weights) = &self.of_load else {
            return torque.to_vec();
        };
        let half = weights.len() / 2;
        let at = |k: usize| match k >= half && k + half < torque.len() {
            true => filtered(weights, torque, k),
            false => 0.0,
        };
        (0..torque.len()).map(at).collect()
    }
}

impl JointRows {
    pub(super) fn count(&self) -> usize {
        self.beside.len()
    }

    /// Rows of a function of the load.
    pub(super) fn of_load(&self, law: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut found = Vec::new();
        for (load, centres) in &self.samples {
            let own: Vec<f64> = load.iter().map(|own| law(*own)).collect();
            found.extend(centres.iter().map(|k| filtered(&self.weights, &own, *k)));
        }
        found
    }
}

/// The weighted sum of the samples around one.
fn filtered(weights: &[f64], samples: &[f64], centre: usize) -> f64 {
    let half = weights.len() / 2;
    dot(weights, &samples[centre - half..=centre + half])
}
