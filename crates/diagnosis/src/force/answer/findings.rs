//! Chosen effects as findings, with their numbers in the units of the effects.

use std::collections::BTreeMap;

use haptical_effects::device::with_variances;
use haptical_effects::{Family, Hook, LawError, Role};
use nalgebra::DMatrix;

use crate::answer::{CauseAnswer, ParameterAnswer};
use crate::force::Model;
use crate::force::effects::is_scale;
use crate::force::select::Pick;
use crate::thresholds::torque::LISTED_PROBABILITY;

/// Coefficients of a model of the torques, with their covariance; what the model leaves counts as noise.
pub(in crate::force) struct Sizes<'m, 'a> {
    pub(in crate::force) model: &'m Model<'a>,
    solution: Vec<f64>,
    covariance: DMatrix<f64>,
}

impl<'m, 'a> Sizes<'m, 'a> {
    pub(in crate::force) fn new(model: &'m Model<'a>, dispersion: f64) -> Self {
        let regression = &model.base.regression;
        Self {
            model,
            solution: regression.solution(),
            covariance: regression.covariance() * dispersion,
        }
    }

    pub(super) fn of_pick(&self, pick: &Pick, share: f64) -> CauseAnswer {
        let effect = self.model.effects.effect(pick.effect);
        let (parameters, plausible) = self.parameters(pick);
        let probability = LISTED_PROBABILITY * pick.probability;
        CauseAnswer {
            confusable_with: pick.rivals.iter().map(|&name| name.to_owned()).collect(),
            parameters,
            share,
            plausible,
            implausible: !plausible,
            ..CauseAnswer::named(effect.name(), effect.joint(), probability)
        }
    }

    /// Values with intervals, and whether a sound device can show them.
    pub(in crate::force) fn parameters(
        &self,
        pick: &Pick,
    ) -> (BTreeMap<String, ParameterAnswer>, bool) {
        let effect = self.model.effects.effect(pick.effect);
        let device = self.model.effects.along.recorded.context.device;
        let joint = effect.joint().map(|joint| &device.joints[joint]);
        let ratio = joint.map_or(1.0, |joint| joint.transmission_ratio);
        let values = self.values(pick);
        let mut pairs = effect.spec().parameters.iter().zip(&values);
        let answers = pairs.clone().map(|(parameter, &(value, sd))| {
            let answer = ParameterAnswer::normal(value, sd);
            (parameter.name.to_owned(), answer)
        });
        let answers = answers.collect();
        let is_plausible =
            pairs.all(|(parameter, (value, _))| parameter.is_plausible(*value, ratio));
        (answers, is_plausible)
    }

    /// Deviation from 1 of the scale through which a pick's torque is read, with its standard deviation.
    pub(in crate::force) fn scale(&self, pick: &Pick) -> (f64, f64) {
        let channel = self.model.effects.channel(pick.effect);
        channel.map_or((0.0, 0.0), |channel| {
            let column = self.model.base.scales.start + channel;
            let variance = self.covariance[(column, column)];
            (self.solution[column], variance.max(0.0).sqrt())
        })
    }

    /// Amplitudes of a pick with their covariance, without its shape.
    pub(in crate::force) fn amplitudes(&self, pick: &Pick) -> (&[f64], DMatrix<f64>) {
        let count = self.model.effects.effect(pick.effect).spec().amplitudes;
        let values = &self.solution[pick.first..pick.first + count];
        (values, self.covariance_of(pick.first, count))
    }

    fn covariance_of(&self, first: usize, count: usize) -> DMatrix<f64> {
        let block = self.covariance.view((first, first), (count, count));
        block.into_owned()
    }

    /// A pick's numbers with their standard deviations.
    fn values(&self, pick: &Pick) -> Vec<(f64, f64)> {
        let effect = self.model.effects.effect(pick.effect);
        let context = self.model.effects.along.recorded.context;
        let (gain, gain_sd) = self.scale(pick);
        let spec = effect.spec();
        if is_scale(effect) {
            // the part of it that is the drive's scale is known only to the stated deviation
            let joint = effect.joint().unwrap_or_default();
            let stated = context.device.joints[joint].torque_scale_sd * (1.0 + gain);
            return vec![(gain, gain_sd.hypot(stated))];
        }
        let (amplitudes, _) = self.amplitudes(pick);
        let covariance = self.covariance_of(pick.first, pick.columns.len());
        let values = with_variances(effect, context, amplitudes, pick.shape, &covariance);
        let is_rubbing = spec.hook == Hook::Torque && spec.family == Family::Loop;
        let reported = spec.parameters.iter().zip(values).enumerate();
        let reported = reported.map(|(index, (parameter, (value, variance)))| {
            let sd = variance.max(0.0).sqrt();
            if parameter.role != Role::Size {
                return (value, sd);
            }
            // the size is a torque of the joint, read through a scale with the fit's uncertainty
            let (value, sd) = (value / (1.0 + gain), sd / (1.0 + gain));
            let of_law = value * gain_sd.hypot(spec.law_error.amplitude);
            // Stribeck's rate separates the terms that depend on the rate, and it is not fitted
            let apart = match is_rubbing && index > 0 {
                true => value * LawError::of(Family::Loop).amplitude,
                false => 0.0,
            };
            (value, sd.hypot(of_law).hypot(apart))
        });
        reported.collect()
    }
}
