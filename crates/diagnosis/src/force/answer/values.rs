//! The numbers of a chosen effect, in its own units.

use std::collections::BTreeMap;

use haptical_effects::{Effect, Family, Hook, LawError, Role};
use nalgebra::DMatrix;

use crate::answer::ParameterAnswer;
use crate::force::base::Base;
use crate::force::effects::{Effects, is_scale};
use crate::force::select::Pick;
use haptical_effects::device::with_variances;

/// Coefficients of a model of the torques with their covariance, what is left counting as noise.
#[derive(Debug)]
pub(in crate::force) struct Sizes<'s, 'e, 'a> {
    effects: &'s Effects<'e, 'a>,
    solution: Vec<f64>,
    covariance: DMatrix<f64>,
    scales: usize,
}

impl<'s, 'e, 'a> Sizes<'s, 'e, 'a> {
    pub(in crate::force) fn new(
        effects: &'s Effects<'e, 'a>,
        base: &Base,
        dispersion: f64,
    ) -> Self {
        Self {
            effects,
            solution: base.regression.solution(),
            covariance: base.regression.covariance() * dispersion,
            scales: base.scales,
        }
    }

    /// Values with intervals, and whether a sound device can show them.
    pub(in crate::force) fn parameters(
        &self,
        pick: &Pick,
    ) -> (BTreeMap<String, ParameterAnswer>, bool) {
        let effect = self.effects.effect(pick.effect);
        let device = self.effects.along.recorded.context.device;
        let joint = effect.joint().map(|joint| &device.joints[joint]);
        let ratio = joint.map_or(1.0, |joint| joint.transmission_ratio);
        let values = self.values(effect, pick);
        let pairs = effect.spec().parameters.iter().zip(&values);
        let is_plausible = pairs
            .clone()
            .all(|(parameter, (value, _))| parameter.is_plausible(*value, ratio));
        let answers = pairs.map(|(parameter, &(value, sd))| {
            let answer = ParameterAnswer::normal(value, sd);
            (parameter.name.to_owned(), answer)
        });
        (answers.collect(), is_plausible)
    }

    /// Deviation from 1 of the scale through which an effect's torque is read, with its standard deviation.
    pub(in crate::force) fn scale(&self, effect: &dyn Effect) -> (f64, f64) {
        let recorded = self.effects.along.recorded;
        let channel = effect.joint().and_then(|joint| recorded.channel(joint));
        channel.map_or((0.0, 0.0), |channel| {
            let column = self.scales + channel;
            let variance = self.covariance[(column, column)];
            (self.solution[column], variance.max(0.0).sqrt())
        })
    }

    /// The effect of a pick.
    pub(in crate::force) fn effect(&self, pick: &Pick) -> &'s dyn Effect {
        self.effects.effect(pick.effect)
    }

    /// Amplitudes of a pick with their covariance, its shape's left out.
    pub(in crate::force) fn amplitudes(&self, pick: &Pick) -> (&[f64], DMatrix<f64>) {
        let count = self.effect(pick).spec().amplitudes;
        let own = self
            .covariance
            .view((pick.first, pick.first), (count, count));
        let values = &self.solution[pick.first..pick.first + count];
        (values, own.into_owned())
    }

    /// An effect's numbers with their standard deviations.
    fn values(&self, effect: &dyn Effect, pick: &Pick) -> Vec<(f64, f64)> {
        let context = self.effects.along.recorded.context;
        let (gain, gain_sd) = self.scale(effect);
        let spec = effect.spec();
        if is_scale(effect) {
            // what of it is the drive's own scale is known to its stated deviation alone
            let joint = effect.joint().unwrap_or_default();
            let stated = context.device.joints[joint].torque_scale_sd * (1.0 + gain);
            return vec![(gain, gain_sd.hypot(stated))];
        }
        let amplitudes = &self.solution[pick.first..pick.first + spec.amplitudes];
        let own = (pick.first, pick.first);
        let covariance = self.covariance.view(own, (pick.count, pick.count));
        let covariance = covariance.into_owned();
        let values = with_variances(effect, context, amplitudes, pick.shape, &covariance);
        let is_rubbing = spec.hook == Hook::Torque && spec.family == Family::Loop;
        let reported = spec.parameters.iter().zip(values).enumerate();
        let reported = reported.map(|(index, (parameter, (value, variance)))| {
            let sd = variance.max(0.0).sqrt();
            if parameter.role != Role::Size {
                return (value, sd);
            }
            // a torque of the joint, read through a scale that is known as well as the fit says
            let (value, sd) = (value / (1.0 + gain), sd / (1.0 + gain));
            let of_law = value * gain_sd.hypot(spec.law_error.amplitude);
            // how far apart terms that depend on the rate are follows Stribeck's rate, which is not fitted
            let apart = match is_rubbing && index > 0 {
                true => value * LawError::of(Family::Loop).amplitude,
                false => 0.0,
            };
            (value, sd.hypot(of_law).hypot(apart))
        });
        reported.collect()
    }
}
