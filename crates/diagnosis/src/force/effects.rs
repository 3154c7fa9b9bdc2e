//! The effects on torques and forces as columns in addition to the base model.

use haptical_effects::signal::local_motion;
use haptical_effects::{Absorbed, Effect, Family, Follows, Hook, Shape, drive_catalogue};

use super::along::Along;
use super::base::Base;
use crate::engine::system::Column;
use crate::select::scan::{Candidate, Score};

/// The catalogue of a device, and what of it a recording can test.
#[derive(Debug)]
pub(super) struct Effects<'e, 'a> {
    pub(super) along: &'e Along<'a>,
    pub(super) all: Vec<Box<dyn Effect>>,
    /// Positions in it of those that are tried.
    tested: Vec<usize>,
    /// Names that are left out of the catalogue.
    without: &'e [String],
}

impl<'e, 'a> Effects<'e, 'a> {
    pub(super) fn new(along: &'e Along<'a>, without: &'e [String]) -> Self {
        let all = drive_catalogue(along.recorded.context.device);
        let mut effects = Self {
            along,
            all,
            tested: Vec::new(),
            without,
        };
        effects.tested = (0..effects.all.len())
            .filter(|&index| effects.is_tested(effects.all[index].as_ref()))
            .collect();
        effects
    }

    /// Whether an effect is not to be named.
    pub(super) fn is_left_out(&self, name: &str) -> bool {
        self.without.iter().any(|other| other == name)
    }

    pub(super) fn is_tested(&self, effect: &dyn Effect) -> bool {
        let recorded = self.along.recorded;
        let has_covariate = match effect.spec().follows {
            Follows::Force => recorded.force_varies(),
            Follows::Temperature => recorded.context.warming_k.is_some(),
            _ => true,
        };
        let is_recorded = match (effect.joint(), effect.spec().hook) {
            (Some(joint), _) => recorded.channel(joint).is_some(),
            (None, Hook::ForceSensor) => recorded.force_n.is_some(),
            // what runs differ by is asked before, of all of them (`changes`)
            (None, _) => false,
        };
        has_covariate && is_recorded && !self.is_left_out(effect.name())
    }

    /// How many effects at their places are tried.
    pub(super) fn tested(&self) -> usize {
        self.tested.len()
    }

    /// Usable rows of a channel.
    pub(super) fn rows(&self) -> f64 {
        let blocks = self.along.recorded.blocks.iter();
        blocks.map(|block| block.usable.len()).sum::<usize>() as f64
    }

    pub(super) fn effect(&self, index: usize) -> &dyn Effect {
        self.all[index].as_ref()
    }

    /// Shapes of an effect that are tried.
    pub(super) fn shapes(&self, index: usize) -> Vec<f64> {
        self.effect(index).shapes(self.along.recorded.context)
    }

    /// Every effect at every shape.
    pub(super) fn candidates(&self, base: &Base) -> Vec<Candidate> {
        let at = |(index, shape): (usize, f64)| {
            let columns = self.columns(base, index, shape);
            Candidate::of_columns(&base.regression.system, columns, index, shape)
        };
        let tested = self.tested.iter();
        let shaped =
            tested.flat_map(|&index| self.shapes(index).into_iter().map(move |s| (index, s)));
        let shaped: Vec<(usize, f64)> = shaped.collect();
        haptical_parallel::map(shaped, at)
    }

    /// Scores of candidates that are possible, after they have caught up with the model.
    pub(super) fn scores(&self, base: &Base, candidates: &mut [Candidate]) -> Vec<Score> {
        let scores = candidates.iter_mut().map(|candidate| {
            candidate.extend(&base.regression.system);
            candidate.score(&base.regression.system)
        });
        let context = self.along.recorded.context;
        let is_possible = |score: &Score| {
            let effect = self.effect(score.effect);
            score.rank > 0 && effect.is_possible(context, &score.amplitudes)
        };
        scores.filter(is_possible).collect()
    }

    /// Columns of an effect: of what the base model has within a tolerance, its freedom.
    pub(super) fn columns(&self, base: &Base, index: usize, shape: f64) -> Vec<Column> {
        let effect = self.effect(index);
        let recorded = self.along.recorded;
        let rows = &base.regression.system.layout;
        let channel = effect.joint().and_then(|joint| recorded.channel(joint));
        if let (true, Some(channel)) = (is_scale(effect), channel) {
            return vec![base.release(base.scales + channel)];
        }
        let zero = vec![0.0; effect.spec().amplitudes];
        let signals = effect.derivative(recorded.context, &zero, shape);
        let column = |(number, signal)| {
            let mut column = rows.of_means(&recorded.signal_means(signal));
            if let (true, Some(channel)) = (is_harmonic(effect), channel) {
                let harmonic = first_harmonic(shape) + number;
                column.parts.extend(rows.fast(channel, harmonic));
            }
            column
        };
        signals.iter().enumerate().map(column).collect()
    }

    /// Columns of a constant bias and of a gain of each axis.
    pub(super) fn bias_and_gain(&self, base: &Base) -> Vec<Column> {
        let is_plain = |effect: &dyn Effect| {
            let spec = effect.spec();
            let is_linear = spec.family == Family::Stated && spec.shape == Shape::NONE;
            spec.hook == Hook::ForceSensor && is_linear && spec.amplitudes == 3
        };
        let plain = (0..self.all.len()).filter(|&index| is_plain(self.effect(index)));
        plain
            .flat_map(|index| self.columns(base, index, 0.0))
            .collect()
    }

    /// A harmonic error of the motor-side angle, as the torques see it: it makes an acceleration that the link does not
    /// have.
    pub(super) fn ripple(&self, base: &Base, index: usize, order: f64) -> Vec<Column> {
        let recorded = self.along.recorded;
        let joint = self.effect(index).joint();
        let time_s = recorded.context.recording.time_s.as_ref();
        let (Some(joint), Some(time_s)) = (joint, time_s) else {
            return Vec::new();
        };
        let Some(channel) = recorded.channel(joint) else {
            return Vec::new();
        };
        let mass = self.along.mass_column(joint, &base.inertia);
        let blocks = recorded.blocks.len();
        let first = first_harmonic(order);
        let column = |values: &Vec<f64>| {
            let motion = local_motion(values, time_s, &recorded.context.runs);
            let acceleration = self.along.half_means(&motion.acceleration);
            let mut column = vec![0.0; recorded.len()];
            for (half, (torques, rate)) in mass.iter().zip(&acceleration).enumerate() {
                for (channel, torque) in torques.iter().enumerate() {
                    column[channel * blocks + half / 2] -= 0.5 * torque * rate;
                }
            }
            base.regression.system.layout.of_means(&column)
        };
        let harmonics = recorded.harmonics[channel][first..first + 2].iter();
        harmonics.map(column).collect()
    }
}

/// Place of an order's cosine among the harmonics of a motor's angle.
fn first_harmonic(order: f64) -> usize {
    2 * (order as usize).saturating_sub(1)
}

/// Whether an effect is a harmonic of the motor's angle.
pub(super) fn is_harmonic(effect: &dyn Effect) -> bool {
    effect.spec().hook == Hook::Torque && effect.spec().family == Family::Shape
}

/// Whether an effect is the scale of a torque.
pub(super) fn is_scale(effect: &dyn Effect) -> bool {
    effect.spec().absorbed_by == Absorbed::ByTorqueScale
}

/// Whether an effect is a loop of the force sensor.
pub(super) fn is_sensor_loop(effect: &dyn Effect) -> bool {
    effect.spec().hook == Hook::ForceSensor && effect.spec().family == Family::Loop
}
