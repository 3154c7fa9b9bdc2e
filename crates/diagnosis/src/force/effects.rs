//! The effects on torques and forces, as columns beside the base model.

use haptical_effects::signal::{dahl, local_motion, smooth};
use haptical_effects::transmission::INPUT_DRUM_HARMONIC;
use haptical_effects::{Spec, force as specs};
use nalgebra::Vector3;

use super::along::Along;
use super::base::Base;
use super::harmonics::ORDERS;
use super::rows::TorqueRows;
use crate::engine::system::Column;

/// Kinds of effects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Bias,
    Gain,
    Crosstalk,
    Hysteresis,
    Friction,
    Cogging,
    Scale,
    /// Not a torque: a harmonic error of the motor-side angle, whose second derivative looks like
    /// one.
    Ripple,
}

impl Kind {
    /// What is known of it.
    pub(super) fn spec(self) -> &'static Spec {
        match self {
            Self::Bias => &specs::BIAS,
            Self::Gain => &specs::GAIN,
            Self::Crosstalk => &specs::CROSSTALK,
            Self::Hysteresis => &specs::HYSTERESIS,
            Self::Friction => &specs::JOINT_FRICTION,
            Self::Cogging => &specs::MOTOR_COGGING,
            Self::Scale => &specs::TORQUE_GAIN,
            Self::Ripple => &INPUT_DRUM_HARMONIC,
        }
    }

    /// Its name.
    pub(super) fn name(self) -> &'static str {
        self.spec().name
    }
}

/// An effect at a place with a shape (a transition, an order).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub(super) kind: Kind,
    pub(super) channel: Option<usize>,
    pub(super) shape: f64,
    /// Shapes that were tried beside it.
    pub(super) shapes: usize,
}

impl Place {
    /// Whether shapes between those of the grid exist.
    pub(super) fn is_continuous(&self) -> bool {
        matches!(self.kind, Kind::Friction | Kind::Hysteresis)
    }
}

/// Travel over which friction changes sides \[rad\]; below zero, the rate over which it does
/// \[rad/s\].
const FRICTION_SHAPES: [f64; 4] = [1e-3, 1e-2, 0.1, -0.02];
/// Rate within which friction is that of rest rather than of motion, for Stribeck's term \[rad/s\].
const STRIBECK_RAD_PER_S: f64 = 0.1;
/// Transitions of a sensor's hysteresis over the force's root mean square.
const HYSTERESIS_SHAPES: [f64; 3] = [0.1, 0.4, 1.5];
/// Periods of cogging that a joint's travel must show.
const LEAST_PERIODS: f64 = 2.0;
/// Samples on each side over which the force is averaged before its reversals are counted.
const FORCE_REACH: usize = 4;

/// What columns are computed from.
#[derive(Debug)]
pub(super) struct Effects<'e, 'a> {
    pub(super) along: &'e Along<'a>,
    /// Names that are left out of the catalogue.
    without: &'e [String],
    /// Smoothed force of the hand per axis, and its root mean square.
    force_n: [Vec<f64>; 3],
    force_rms_n: f64,
    /// Whether force and temperature vary.
    pub(super) force_varies: bool,
}

impl<'e, 'a> Effects<'e, 'a> {
    pub(super) fn new(along: &'e Along<'a>, without: &'e [String]) -> Self {
        let recorded = along.recorded;
        let runs = &recorded.context.runs;
        let force_n: [Vec<f64>; 3] = std::array::from_fn(|axis| {
            let force = recorded.force_n.as_deref().unwrap_or_default();
            let values: Vec<f64> = force.iter().map(|force| force[axis]).collect();
            if values.is_empty() {
                values
            } else {
                smooth(&values, FORCE_REACH, runs)
            }
        });
        let (mut square, mut spread) = (0.0, 0.0);
        for values in &force_n {
            let count = values.len().max(1) as f64;
            let mean = values.iter().sum::<f64>() / count;
            square += values.iter().map(|value| value * value).sum::<f64>() / count;
            spread += values
                .iter()
                .map(|value| (value - mean).powi(2))
                .sum::<f64>()
                / count;
        }
        Self {
            along,
            without,
            force_rms_n: square.sqrt(),
            force_varies: spread > 1e-6 * square && spread > 0.0,
            force_n,
        }
    }

    /// Whether an effect is not to be named.
    pub(super) fn is_left_out(&self, name: &str) -> bool {
        self.without.iter().any(|other| other == name)
    }

    /// Every effect at every place and shape; cogging first by orders.
    pub(super) fn places(&self) -> Vec<Place> {
        let mut places = Vec::new();
        let mut add = |kind: Kind, channel: Option<usize>, shapes: &[f64]| {
            if self.is_left_out(kind.name()) {
                return;
            }
            places.extend(shapes.iter().map(|&shape| Place {
                kind,
                channel,
                shape,
                shapes: shapes.len(),
            }));
        };
        let recorded = self.along.recorded;
        if recorded.force_n.is_some() {
            let warm = recorded.context.warming_k.is_some();
            add(Kind::Bias, None, if warm { &[0.0, 1.0] } else { &[0.0] });
            if self.force_varies {
                add(Kind::Gain, None, &[0.0]);
                add(Kind::Crosstalk, None, &[0.0]);
                let scaled = HYSTERESIS_SHAPES.map(|shape| shape * self.force_rms_n);
                add(Kind::Hysteresis, None, &scaled);
            }
        }
        for channel in 0..recorded.channels.len() {
            add(Kind::Friction, Some(channel), &FRICTION_SHAPES);
            add(Kind::Cogging, Some(channel), &self.orders(channel));
            add(Kind::Scale, Some(channel), &[0.0]);
        }
        places
    }

    /// Orders of cogging of which a channel's travel shows periods enough: fewer look like any
    /// other function of the angle.
    fn orders(&self, channel: usize) -> Vec<f64> {
        let recorded = self.along.recorded;
        let joint = recorded.channels[channel];
        let angle = &recorded.motion[joint].value;
        let low = angle.iter().copied().fold(f64::INFINITY, f64::min);
        let high = angle.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let ratio = recorded.context.device.joints[joint]
            .transmission_ratio
            .abs();
        let turns = ratio * (high - low) / std::f64::consts::TAU;
        (1..=ORDERS)
            .map(|order| order as f64)
            .filter(|order| order * turns >= LEAST_PERIODS)
            .collect()
    }

    /// Columns of an effect.
    pub(super) fn columns(&self, base: &Base, place: &Place) -> Vec<Column> {
        let rows = &base.regression.system.layout;
        let means: Vec<Vec<f64>> = match (place.kind, place.channel) {
            (Kind::Bias, _) => self.bias(place.shape > 0.0),
            (Kind::Gain, _) => self.map_force(&[(0, 0), (1, 1), (2, 2)]),
            (Kind::Crosstalk, _) => {
                self.map_force(&[(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)])
            }
            (Kind::Hysteresis, _) => self.hysteresis(place.shape),
            (Kind::Friction, Some(channel)) => self.friction(channel, place.shape),
            (Kind::Cogging, Some(channel)) => return self.cogging(rows, channel, place.shape),
            (Kind::Scale, Some(channel)) => return vec![base.release(base.scales + channel)],
            _ => Vec::new(),
        };
        means.iter().map(|means| rows.of_means(means)).collect()
    }

    /// E1: the sensor reads a constant, or one that grows with temperature, too much: `J^T b`.
    fn bias(&self, warms: bool) -> Vec<Vec<f64>> {
        let unit = |axis: usize| Vector3::ith(axis, 1.0);
        let constant = (0..3).map(|axis| self.along.hand_column(|_, _| unit(axis)));
        let mut columns: Vec<Vec<f64>> = constant.collect();
        if let Some(warming) = self
            .along
            .recorded
            .context
            .warming_k
            .as_ref()
            .filter(|_| warms)
        {
            let warming = self.along.half_means(warming);
            columns.extend(
                (0..3).map(|axis| self.along.hand_column(|half, _| unit(axis) * warming[half])),
            );
        }
        columns
    }

    /// E2, E3: axis `to` reads part of the force along axis `from`: `J^T X F`.
    fn map_force(&self, entries: &[(usize, usize)]) -> Vec<Vec<f64>> {
        let column = |&(to, from): &(usize, usize)| {
            self.along
                .hand_column(|_, force| Vector3::ith(to, force[from]))
        };
        entries.iter().map(column).collect()
    }

    /// Columns of a constant bias and of a gain of each axis.
    pub(super) fn bias_and_gain(&self, rows: &TorqueRows) -> Vec<Column> {
        let mut columns = self.bias(false);
        columns.extend(self.map_force(&[(0, 0), (1, 1), (2, 2)]));
        columns.iter().map(|means| rows.of_means(means)).collect()
    }

    /// E4: each axis of the sensor lags in a loop, Dahl's state of the force: `J^T h(F)`.
    fn hysteresis(&self, transition_n: f64) -> Vec<Vec<f64>> {
        let runs = &self.along.recorded.context.runs;
        (0..3)
            .map(|axis| {
                let state = dahl(&self.force_n[axis], transition_n, runs);
                let state = self.along.half_means(&state);
                self.along
                    .hand_column(|half, _| Vector3::ith(axis, state[half]))
            })
            .collect()
    }

    /// E6: the drive overcomes Coulomb's friction (its presliding by Dahl's state, or regularised
    /// by a rate), viscous friction and what Stribeck adds at low rates.
    fn friction(&self, channel: usize, shape: f64) -> Vec<Vec<f64>> {
        let recorded = self.along.recorded;
        let columns = self.friction_rows(channel, shape).into_iter();
        columns
            .map(|values| self.along.on(channel, &recorded.means(|row| values[row])))
            .collect()
    }

    fn friction_rows(&self, channel: usize, shape: f64) -> Vec<Vec<f64>> {
        let recorded = self.along.recorded;
        let motion = &recorded.motion[recorded.channels[channel]];
        let rate = &motion.velocity;
        let side: Vec<f64> = if shape > 0.0 {
            dahl(&motion.value, shape, &recorded.context.runs)
        } else {
            rate.iter().map(|rate| (rate / -shape).tanh()).collect()
        };
        let slow = side
            .iter()
            .zip(rate)
            .map(|(side, rate)| side * (-(rate / STRIBECK_RAD_PER_S).powi(2)).exp())
            .collect();
        vec![side, rate.clone(), slow]
    }

    /// E7: a torque at a multiple of the motor's angle.
    fn cogging(&self, rows: &TorqueRows, channel: usize, order: f64) -> Vec<Column> {
        let recorded = self.along.recorded;
        let first = 2 * (order as usize).saturating_sub(1);
        (first..first + 2)
            .map(|index| {
                let values = &recorded.harmonics[channel][index];
                let means = self.along.on(channel, &recorded.means(|row| values[row]));
                let mut column = rows.of_means(&means);
                column.parts.extend(rows.fast(channel, index));
                column
            })
            .collect()
    }

    /// Columns of an effect on one channel row by row; nothing for effects that hardly change
    /// within a block.
    pub(super) fn rows(&self, place: &Place) -> Vec<Vec<f64>> {
        match (place.kind, place.channel) {
            (Kind::Friction, Some(channel)) => self.friction_rows(channel, place.shape),
            (Kind::Cogging, Some(channel)) => {
                let first = 2 * (place.shape as usize).saturating_sub(1);
                self.along.recorded.harmonics[channel][first..first + 2].to_vec()
            }
            _ => Vec::new(),
        }
    }

    /// A10 as the torques see it: an error of the motor-side angle at a multiple of the motor's
    /// angle makes an acceleration that the link does not have.
    pub(super) fn ripple(&self, base: &Base, place: &Place) -> Vec<Column> {
        let Some(channel) = place.channel else {
            return Vec::new();
        };
        let recorded = self.along.recorded;
        let joint = recorded.channels[channel];
        let mass = self.along.mass_column(joint, &base.inertia);
        let Some(time_s) = &recorded.context.recording.time_s else {
            return Vec::new();
        };
        let first = 2 * (place.shape as usize).saturating_sub(1);
        let blocks = recorded.blocks.len();
        (first..first + 2)
            .map(|index| {
                let values = &self.along.recorded.harmonics[channel][index];
                let runs = &recorded.context.runs;
                let motion = local_motion(values, time_s, runs);
                let acceleration = self.along.half_means(&motion.acceleration);
                let mut column = vec![0.0; recorded.len()];
                for (half, (torques, rate)) in mass.iter().zip(&acceleration).enumerate() {
                    for (channel, torque) in torques.iter().enumerate() {
                        column[channel * blocks + half / 2] -= 0.5 * torque * rate;
                    }
                }
                base.regression.system.layout.of_means(&column)
            })
            .collect()
    }

    /// Whether an effect with these amplitudes can exist: friction takes energy.
    pub(super) fn is_possible(&self, place: &Place, amplitudes: &[f64]) -> bool {
        let (Kind::Friction, Some(channel)) = (place.kind, place.channel) else {
            return true;
        };
        let recorded = self.along.recorded;
        let rates = &recorded.motion[recorded.channels[channel]].velocity;
        let count = rates.len().max(1) as f64;
        let mean = rates.iter().map(|rate| rate.abs()).sum::<f64>() / count;
        let square = rates.iter().map(|rate| rate * rate).sum::<f64>() / count;
        let power = amplitudes[0] * mean + amplitudes[1] * square;
        power > 0.0 && amplitudes[0] * mean > -0.25 * power
    }
}
