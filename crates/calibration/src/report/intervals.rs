//! The method behind the intervals of a fit, for those who cite them.

use haptical_identification::{Matrix, NoiseScale, pooled};
use haptical_model::{Device, LengthScale, ParameterId};
use serde::Serialize;

use crate::fit::considered::Held;
use crate::problem::gauge::are_touches_without_length;
use crate::{Channel, ChannelNoise, ParameterFit};

/// How the intervals of a fit were made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Intervals {
    /// Share of such intervals that hold the truth.
    pub level: f64,
    /// In words: which distribution, by which noise.
    pub kind: String,
    /// Residuals less parameters.
    pub degrees_of_freedom: usize,
    /// The fewest degrees of freedom of a parameter, where the noise has memory; none otherwise.
    pub least_degrees_of_freedom: Option<f64>,
    /// Whether memory, drifts and uneven size of the noise were looked for: not in very long logs, nor in very short ones.
    pub noise_checked: bool,
    /// The noise of the fit's channels, where it is not independent and of one size.
    pub channel_noise: Vec<ChannelNoise>,
    /// What lengths are in proportion to, counted in their intervals.
    pub length_scales: Vec<ScaleOfLengths>,
    /// Parameters that were not fitted (weak, or those of step 1) and whose plausible errors widen the intervals.
    pub considered: Vec<String>,
    /// Whether the ends of the linearised intervals were compared with the sum of squares there; not where so many
    /// readings leave intervals over which everything is straight, nor where the noise is not independent and of one
    /// size.
    pub checked: bool,
    /// Parameters whose interval is by profile likelihood instead, because the two differ.
    pub profile_likelihood: Vec<String>,
    /// Those of them without an end on one side or both, and so without an interval.
    pub open: Vec<String>,
}

/// What all lengths of a device are in proportion to: every length that rests on it alone has its error.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScaleOfLengths {
    /// Name of the instrument's reading per length, of the held length, or of the known distance's points.
    pub name: String,
    /// Standard deviation of its error, 1 being the whole length.
    pub sd: f64,
    /// Whether the device file states it (`scale_sd`, `sd_m`); else it is assumed.
    pub is_stated: bool,
    /// What it is.
    pub source: SourceOfScale,
}

impl ScaleOfLengths {
    /// The scale of an instrument of a device.
    pub fn of_instrument(device: &Device, scale: &LengthScale) -> Self {
        Self {
            name: ParameterId::Surrounding(scale.parameter).name(device),
            sd: scale.sd,
            is_stated: scale.is_stated,
            source: SourceOfScale::Instrument,
        }
    }
}

/// What tells the size of a device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SourceOfScale {
    /// An instrument that measures lengths.
    Instrument,
    /// A length that is held, as touches do not tell it.
    HeldLength,
    /// A known distance between touched points.
    KnownDistance,
}

impl ParameterFit {
    /// How the intervals of this fit were made.
    pub fn intervals(&self) -> Intervals {
        let has_memory = self.channel_noise.iter().any(|own| own.has_memory);
        let kind = match self.noise {
            _ if has_memory => {
                "linearised at the solution, with the spectrum of the noise that the residuals show (sandwich over bands of \
                 frequency), Student's t with Satterthwaite's degrees of freedom"
            }
            _ if self.is_widened => {
                "linearised at the solution, not narrower than with noise of its own size for every reading (sandwich, HC1)"
            }
            NoiseScale::Stated => "linearised at the solution, normal, with the stated noise",
            NoiseScale::Estimated => {
                "linearised at the solution, Student's t, with the noise that the residuals show"
            }
        };
        let freedom = |position: usize| {
            let own = |covariance: &Matrix| covariance[(position, position)];
            pooled(&self.uncertainty.components, &own).1
        };
        let least = (0..self.fitted.len()).map(freedom).reduce(f64::min);
        let considered = self.considered.parameters.iter().zip(&self.considered.held);
        let considered = considered.filter(|(_, held)| !matches!(**held, Held::Scale | Held::Size));
        let names = |indices: &[usize]| {
            let names = indices.iter().map(|&index| &self.estimates[index].name);
            names.cloned().collect()
        };
        Intervals {
            checked: self.profiled.is_checked,
            profile_likelihood: names(&self.profiled.parameters),
            open: names(&self.profiled.open),
            level: 0.95,
            kind: kind.to_owned(),
            degrees_of_freedom: self.uncertainty.degrees_of_freedom,
            least_degrees_of_freedom: least.filter(|_| has_memory),
            noise_checked: self.noise_is_checked,
            channel_noise: self.channel_noise.clone(),
            length_scales: self.length_scales(),
            considered: considered
                .map(|(parameter, _)| parameter.name(&self.device))
                .collect(),
        }
    }

    fn length_scales(&self) -> Vec<ScaleOfLengths> {
        let (device, considered) = (&self.device, &self.considered);
        let instruments = device.length_scales().into_iter().filter_map(|scale| {
            let parameter = ParameterId::Surrounding(scale.parameter);
            let own = considered.reason(parameter) == Some(Held::Scale);
            own.then(|| ScaleOfLengths::of_instrument(device, &scale))
        });
        let held = considered.parameters.iter().zip(&considered.held);
        let held: Vec<ParameterId> = held
            .filter_map(|(parameter, held)| (*held == Held::Size).then_some(*parameter))
            .collect();
        let sizes = held.iter().map(|parameter| parameter.value(device).abs());
        let size = sizes.fold(f64::MIN_POSITIVE, f64::max);
        let lengths = held.iter().map(|parameter| ScaleOfLengths {
            name: parameter.name(device),
            sd: parameter.plausible_size(device) / size,
            is_stated: false,
            source: SourceOfScale::HeldLength,
        });
        let channels: Vec<Channel> = self.channel_parameters.keys().copied().collect();
        let is_fixed = are_touches_without_length(device, &channels);
        let known = channels.iter().filter_map(|channel| match *channel {
            Channel::ContactPair { index } if is_fixed => device.contact_pairs.get(index),
            _ => None,
        });
        let known = known.map(|pair| ScaleOfLengths {
            name: format!("{}, {}", pair.a, pair.b),
            sd: pair.sd_m / pair.distance_m,
            is_stated: true,
            source: SourceOfScale::KnownDistance,
        });
        instruments.chain(lengths).chain(known).collect()
    }
}
