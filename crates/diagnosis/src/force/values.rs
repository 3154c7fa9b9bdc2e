//! The numbers of a chosen effect, in its own units.

use haptical_effects::{Effect, Family, Hook, LawError, Role};
use nalgebra::{DMatrix, DVector};

use super::base::Base;
use super::effects::{Effects, is_scale};
use super::select::Pick;

/// Step of the derivatives of an effect's numbers, over the deviation of what they are made of.
const STEP: f64 = 1e-3;

/// Coefficients of a model of the torques with their covariance, what is left counting as noise.
#[derive(Debug)]
pub(super) struct Sizes<'s, 'e, 'a> {
    effects: &'s Effects<'e, 'a>,
    solution: Vec<f64>,
    covariance: DMatrix<f64>,
    scales: usize,
}

impl<'s, 'e, 'a> Sizes<'s, 'e, 'a> {
    pub(super) fn new(effects: &'s Effects<'e, 'a>, base: &Base, dispersion: f64) -> Self {
        Self {
            effects,
            solution: base.regression.solution(),
            covariance: base.regression.covariance() * dispersion,
            scales: base.scales,
        }
    }

    /// Names, values and standard deviations.
    pub(super) fn parameters(&self, pick: &Pick) -> Vec<(&'static str, f64, f64)> {
        let effect = self.effects.effect(pick.effect);
        let (gain, gain_sd) = self.scale(effect);
        let spec = effect.spec();
        if is_scale(effect) {
            // what of it is the drive's own scale is known to its stated deviation alone
            let joint = effect.joint().unwrap_or_default();
            let device = self.effects.along.recorded.context.device;
            let stated = device.joints[joint].torque_scale_sd * (1.0 + gain);
            return vec![(spec.parameters[0].name, gain, gain_sd.hypot(stated))];
        }
        let law = spec.law_error.amplitude;
        let values = self.values(effect, pick);
        let pairs = spec.parameters.iter().zip(values).enumerate();
        let reported = pairs.map(|(index, (parameter, (value, sd)))| {
            if parameter.role != Role::Size {
                return (parameter.name, value, sd);
            }
            // a torque of the joint, read through a scale that is known as well as the fit says
            let value = value / (1.0 + gain);
            let sd = (sd / (1.0 + gain)).hypot(value * gain_sd.hypot(law));
            // how far apart terms that depend on the rate are follows Stribeck's rate, which is not fitted
            let is_rubbing = spec.hook == Hook::Torque && spec.family == Family::Loop;
            let apart = match is_rubbing && index > 0 {
                true => value * LawError::LOOP.amplitude,
                false => 0.0,
            };
            (parameter.name, value, sd.hypot(apart))
        });
        reported.collect()
    }

    /// Deviation from 1 of the scale through which an effect's torque is read, with its standard deviation.
    fn scale(&self, effect: &dyn Effect) -> (f64, f64) {
        let recorded = self.effects.along.recorded;
        let channel = effect.joint().and_then(|joint| recorded.channel(joint));
        channel.map_or((0.0, 0.0), |channel| {
            let column = self.scales + channel;
            let variance = self.covariance[(column, column)];
            (self.solution[column], variance.max(0.0).sqrt())
        })
    }

    /// An effect's numbers with their standard deviations, by the derivatives of [`Effect::values`].
    fn values(&self, effect: &dyn Effect, pick: &Pick) -> Vec<(f64, f64)> {
        let context = self.effects.along.recorded.context;
        let count = effect.spec().amplitudes;
        let amplitudes = &self.solution[pick.first..pick.first + count];
        let own = (pick.first, pick.first);
        let covariance = self.covariance.view(own, (pick.count, pick.count));
        let moved = |number: usize, step: f64| {
            let mut amplitudes = amplitudes.to_vec();
            let mut shape = pick.shape;
            match amplitudes.get_mut(number) {
                Some(amplitude) => *amplitude += step,
                None => shape *= step.exp(),
            }
            DVector::from_vec(effect.values(context, &amplitudes, shape))
        };
        let slopes: Vec<DVector<f64>> = (0..pick.count)
            .map(|number| {
                let step = STEP * covariance[(number, number)].max(1e-300).sqrt();
                (moved(number, step) - moved(number, -step)) / (2.0 * step)
            })
            .collect();
        let slopes = DMatrix::from_columns(&slopes);
        let spread = &slopes * covariance * slopes.transpose();
        let values = effect.values(context, amplitudes, pick.shape);
        let sds = spread.diagonal().map(|variance| variance.max(0.0).sqrt());
        values.into_iter().zip(sds.iter().copied()).collect()
    }

    /// Whether a sound device can show it.
    pub(super) fn is_plausible(
        &self,
        pick: &Pick,
        parameters: &[(&'static str, f64, f64)],
    ) -> bool {
        let effect = self.effects.effect(pick.effect);
        let device = self.effects.along.recorded.context.device;
        let ratio = effect
            .joint()
            .map_or(1.0, |joint| device.joints[joint].transmission_ratio);
        parameters.iter().all(|(name, value, _)| {
            let parameter = effect.spec().parameter(name);
            parameter.is_none_or(|parameter| parameter.is_plausible(*value, ratio))
        })
    }
}
