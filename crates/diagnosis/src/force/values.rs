//! The numbers of a chosen effect, in its own units.

use haptical_effects::force::TORQUE_GAIN;
use nalgebra::DMatrix;

use super::base::Base;
use super::effects::{Kind, Place};
use super::select::{Pick, Selector};

/// What a law that is not quite the catalogue's changes of a torque's size, relative.
const LAW_SD: f64 = 0.01;
/// The same of a loop (a play and Dahl's state of equal energy differ so much in amplitude), and of
/// friction's dependence on the rate.
const LOOP_SD: f64 = 0.05;

/// Coefficients of a model of the torques with their covariance, what is left counting as noise.
#[derive(Debug)]
pub(super) struct Sizes {
    solution: Vec<f64>,
    covariance: DMatrix<f64>,
    scales: usize,
}

impl Sizes {
    pub(super) fn new(base: &Base, dispersion: f64) -> Self {
        Self {
            solution: base.regression.solution(),
            covariance: base.regression.covariance() * dispersion,
            scales: base.scales,
        }
    }

    /// Names, values and standard deviations; `own_scale_sd` is the stated deviation of the torque's
    /// scale.
    pub(super) fn parameters(
        &self,
        pick: &Pick,
        own_scale_sd: f64,
    ) -> Vec<(&'static str, f64, f64)> {
        let amplitudes = &self.solution[pick.first..pick.first + pick.count];
        let own = (pick.first, pick.first);
        let covariance = self.covariance.view(own, (pick.count, pick.count));
        let sd = |k: usize| covariance[(k, k)].max(0.0).sqrt();
        let spec = pick.place.kind.spec();
        let name = |index: usize| spec.parameters[index].name;
        let listed = |count: usize| -> Vec<(&'static str, f64, f64)> {
            (0..count.min(amplitudes.len()))
                .map(|k| (name(k), amplitudes[k], sd(k)))
                .collect()
        };
        // a torque of the joint, read through a scale that is known as well as the fit says
        let scale = pick.place.channel.map(|channel| self.scales + channel);
        let (gain, gain_sd) = scale.map_or((0.0, 0.0), |column| {
            (
                self.solution[column],
                self.covariance[(column, column)].max(0.0).sqrt(),
            )
        });
        let true_torque = |value: f64, sd: f64| {
            let value = value / (1.0 + gain);
            (
                value,
                (sd / (1.0 + gain)).hypot(value * gain_sd.hypot(LAW_SD)),
            )
        };
        match pick.place.kind {
            Kind::Bias => listed(6),
            Kind::Gain => {
                // the column is what the sensor read, not the force: a = e / (1 + e)
                let true_gain = |(name, a, sd): (&'static str, f64, f64)| {
                    let rest = (1.0 - a).max(0.01);
                    (name, a / rest, sd / (rest * rest))
                };
                listed(3).into_iter().map(true_gain).collect()
            }
            Kind::Crosstalk => listed(6),
            Kind::Hysteresis => {
                let mut parameters = listed(3);
                for (_, value, sd) in &mut parameters {
                    *sd = sd.hypot(*value * LOOP_SD);
                }
                parameters.push((name(3), pick.place.shape, pick.place.shape * sd(3)));
                parameters
            }
            Kind::Friction => {
                let (coulomb, coulomb_sd) = true_torque(amplitudes[0], sd(0));
                let (viscous, viscous_sd) = true_torque(amplitudes[1], sd(1));
                let (stribeck, stribeck_sd) = true_torque(amplitudes[2], sd(2));
                // how far apart the two are depends on Stribeck's rate, which is not fitted
                let apart = |value: f64, sd: f64| (value, sd.hypot(value * LOOP_SD));
                let (viscous, viscous_sd) = apart(viscous, viscous_sd);
                let (stribeck, stribeck_sd) = apart(stribeck, stribeck_sd);
                let mut parameters = vec![
                    (name(0), coulomb, coulomb_sd),
                    (name(1), viscous, viscous_sd),
                    (name(2), stribeck, stribeck_sd),
                ];
                let shape = pick.place.shape.abs();
                let shape_sd = sd(pick.count - 1);
                // a travel, or below zero a rate
                let transition = if pick.place.shape > 0.0 { 3 } else { 4 };
                parameters.push((name(transition), shape, shape * shape_sd));
                parameters
            }
            Kind::Cogging => {
                let (a, b) = (amplitudes[0], amplitudes[1]);
                let size = a.hypot(b).max(1e-300);
                let (along, across) = ([a / size, b / size], [-b / size, a / size]);
                let spread = |u: [f64; 2]| {
                    let mut sum = 0.0;
                    for row in 0..2 {
                        for column in 0..2 {
                            sum += u[row] * covariance[(row, column)] * u[column];
                        }
                    }
                    sum.max(0.0).sqrt()
                };
                let (amplitude, amplitude_sd) = true_torque(size, spread(along));
                vec![
                    (name(0), amplitude, amplitude_sd),
                    (name(1), b.atan2(a), spread(across) / size),
                    (name(2), pick.place.shape, 0.0),
                ]
            }
            Kind::Scale | Kind::Ripple => {
                // what of it is the drive's own scale is known to its stated deviation alone
                vec![(
                    TORQUE_GAIN.parameters[0].name,
                    gain,
                    gain_sd.hypot(own_scale_sd * (1.0 + gain)),
                )]
            }
        }
    }
}

/// Whether a sound device can show it.
pub(super) fn is_plausible(
    place: &Place,
    selector: &Selector<'_, '_>,
    parameters: &[(&'static str, f64, f64)],
) -> bool {
    let ratio = place.channel.map_or(1.0, |channel| {
        let joint = selector.recorded.channels[channel];
        selector.recorded.context.device.joints[joint].transmission_ratio
    });
    let spec = place.kind.spec();
    parameters.iter().all(|(name, value, _)| {
        let parameter = spec.parameter(name);
        parameter.is_none_or(|parameter| parameter.is_plausible(*value, ratio))
    })
}
