//! The effects on torques and forces as columns in addition to the base model.

use haptical_effects::signal::local_motion;
use haptical_effects::{Absorbed, Effect, Family, Follows, Hook, Shape, drive_catalogue};

use super::along::Along;
use super::base::Base;
use crate::select::{Candidate, Score};

/// The catalogue of a device, and what of it a recording can test.
#[derive(Debug)]
pub(super) struct Effects<'a> {
    pub(super) along: Along<'a>,
    pub(super) all: Vec<Box<dyn Effect>>,
    /// Positions in it of those that are tried.
    pub(super) tested: Vec<usize>,
    /// Names that are left out of the catalogue.
    without: &'a [String],
}

impl<'a> Effects<'a> {
    pub(super) fn new(along: Along<'a>, without: &'a [String]) -> Self {
        let mut effects = Self {
            all: drive_catalogue(along.recorded.context.device),
            along,
            tested: Vec::new(),
            without,
        };
        let all = 0..effects.all.len();
        effects.tested = all.filter(|&index| effects.is_tested(index)).collect();
        effects
    }

    /// Whether an effect is not to be named.
    pub(super) fn is_left_out(&self, name: &str) -> bool {
        self.without.iter().any(|other| other == name)
    }

    fn is_tested(&self, index: usize) -> bool {
        let (recorded, effect) = (&self.along.recorded, self.effect(index));
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

    pub(super) fn effect(&self, index: usize) -> &dyn Effect {
        self.all[index].as_ref()
    }

    /// Channel of an effect's joint.
    pub(super) fn channel(&self, index: usize) -> Option<usize> {
        self.along.recorded.channel(self.effect(index).joint()?)
    }

    /// Shapes of an effect that are tried.
    pub(super) fn shapes(&self, index: usize) -> Vec<f64> {
        self.effect(index).shapes(self.along.recorded.context)
    }

    /// Every effect at every shape.
    pub(super) fn candidates(&self, base: &Base) -> Vec<Candidate> {
        let at = |(index, shape): (usize, f64)| {
            let columns = self.columns(base, index, shape);
            base.candidate(&columns, index, shape)
        };
        let with_shapes = |&index: &usize| self.shapes(index).into_iter().map(move |s| (index, s));
        let shaped = self.tested.iter().flat_map(with_shapes);
        haptical_parallel::map(shaped.collect::<Vec<_>>(), at)
    }

    /// Scores of the candidates that are possible, each in addition to a model.
    pub(super) fn scores(&self, base: &Base, candidates: &mut [Candidate]) -> Vec<Score> {
        let system = &base.regression.system;
        let scores = candidates.iter_mut().map(|candidate| {
            // the columns before the scales never change
            candidate.reset(system, base.scales.start);
            candidate.score(system)
        });
        scores.filter(|score| self.is_possible(score)).collect()
    }

    /// Whether the amplitudes of a score are physically possible.
    pub(super) fn is_possible(&self, score: &Score) -> bool {
        let effect = self.effect(score.effect);
        score.rank > 0 && effect.is_possible(self.along.recorded.context, &score.amplitudes)
    }

    /// Columns of an effect: of what the base model has within a tolerance, its freedom.
    pub(super) fn columns(&self, base: &Base, index: usize, shape: f64) -> Vec<Vec<f64>> {
        let (effect, channel) = (self.effect(index), self.channel(index));
        let recorded = &self.along.recorded;
        let rows = &base.regression.system.layout;
        if let (true, Some(channel)) = (is_scale(effect), channel) {
            let scale = base.scales.start + channel;
            let weight = base.regression.column(scale)[rows.prior(scale)];
            return vec![rows.release(scale, weight)];
        }
        let zero = vec![0.0; effect.spec().amplitudes];
        let signals = effect.derivative(recorded.context, &zero, shape);
        let column = |(number, signal)| {
            let mut column = rows.of_means(&recorded.signal_means(signal));
            if let (true, Some(channel)) = (is_harmonic(effect), channel) {
                let harmonic = first_harmonic(shape) + number;
                rows.add_fast(channel, harmonic, &mut column);
            }
            column
        };
        signals.iter().enumerate().map(column).collect()
    }

    /// Columns of a constant bias and of a gain of each axis.
    pub(super) fn bias_and_gain(&self, base: &Base) -> Vec<Vec<f64>> {
        let is_plain = |index: &usize| {
            let spec = self.effect(*index).spec();
            let is_linear = spec.family == Family::Stated && spec.shape == Shape::NONE;
            spec.hook == Hook::ForceSensor && is_linear && spec.amplitudes == 3
        };
        let plain = (0..self.all.len()).filter(is_plain);
        let columns = plain.flat_map(|index| self.columns(base, index, 0.0));
        columns.collect()
    }

    /// A harmonic error of the motor-side angle, as the torques see it: it makes an acceleration that the link does not
    /// have.
    pub(super) fn ripple(&self, base: &Base, index: usize, order: f64) -> Vec<Vec<f64>> {
        let recorded = &self.along.recorded;
        let time_s = recorded.context.recording.time_s.as_ref();
        let joint = self.effect(index).joint();
        let (Some(joint), Some(channel), Some(time_s)) = (joint, self.channel(index), time_s)
        else {
            return Vec::new();
        };
        let column = |values: &Vec<f64>| {
            let motion = local_motion(values, time_s, &recorded.context.runs);
            let along = &self.along;
            let torques = along.accelerated(joint, &base.inertia, &motion.acceleration);
            base.regression.system.layout.of_means(&torques)
        };
        let first = first_harmonic(order);
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
