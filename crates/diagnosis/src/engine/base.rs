//! The calibrated model without any effect: its fit, and its residuals and derivatives at every row.

use haptical_calibration::{
    Channel, Degree, DeviceProblem, HeldOut, LossChoice, Options, ParameterFit, Weighting, Weights,
    channels, fit_device, fit_transmissions, prepare_device,
};
use haptical_effects::Stream;
use haptical_identification::{Matrix, Problem, Settings};
use haptical_model::{Device, ParameterId, Recording};

use crate::DiagnosisError;
use crate::engine::anchor::{Anchor, anchored, is_needed};
use crate::noise::stated::is_stated;
use crate::thresholds::fit::{MOST_STEPS, POLYNOMIAL_DEGREE, ROWS_FOR_A_POLYNOMIAL, START_ROWS};

/// A fitted base model.
#[derive(Debug, Clone)]
pub(crate) struct Base {
    pub(crate) device: Device,
    pub(crate) channels: Vec<Channel>,
    /// Everything that the base model could adjust: what an effect can hide in.
    pub(crate) parameters: Vec<ParameterId>,
    /// Positions (within `parameters`) of those that the recording fixes.
    pub(crate) free: Vec<usize>,
    /// Where they are known to be from elsewhere than the recording; none where it fixes all of them well.
    pub(crate) anchor: Option<Anchor>,
    /// Where the search ended, and why, if that was no minimum.
    pub(crate) unfinished: Option<Unfinished>,
}

/// End of a search that found no minimum.
#[derive(Debug, Clone)]
pub(crate) struct Unfinished {
    pub(crate) reason: String,
    pub(crate) device: Device,
}

impl Base {
    /// Fits the device jointly to evenly spread rows.
    pub(crate) fn fit(
        device: &Device,
        recording: &Recording,
        loss: LossChoice,
    ) -> Result<Self, DiagnosisError> {
        let channels = channels(device, recording)?;
        let part = recording.select(&spread_rows(recording, &channels));
        let rows = part.len();
        let options = Options {
            degree: if rows >= ROWS_FOR_A_POLYNOMIAL {
                Degree::Fixed(POLYNOMIAL_DEGREE)
            } else {
                Options::default().degree
            },
            held_out: HeldOut::None,
            loss,
            weighting: weighting(device, &channels),
            search: Settings {
                max_iterations: MOST_STEPS,
                ..Settings::default()
            },
            unfinished: true,
            ..Options::default()
        };
        let fitted = fit_device(device, &part, &options)?;
        let mut parameters = Vec::new();
        let mut free = Vec::new();
        let mut unfinished = None;
        let mut note = |fit: &ParameterFit| {
            if !fit.convergence.was_successful() {
                unfinished = Some(fit.convergence.to_string());
            }
        };
        match &fitted.whole {
            Some(whole) => {
                note(whole);
                (parameters, free) = whole.supported();
            }
            None => {
                for fit in fitted
                    .transmissions
                    .iter()
                    .filter_map(|fit| fit.fit.as_ref())
                {
                    note(fit);
                    let first = parameters.len();
                    let (own, fitted) = fit.supported();
                    parameters.extend(own);
                    free.extend(fitted.iter().map(|index| first + index));
                }
            }
        }
        if let (Some(whole), true) = (&fitted.whole, is_needed(&channels)) {
            // where a search ended that found no minimum can be anywhere
            let from = match unfinished {
                None => whole.device.clone(),
                Some(_) => prepare_device(device, &part)?,
            };
            let weights = &fitted.weights;
            let found = anchored(whole, &from, &part, &channels, weights, &options.search)?;
            if let Some(found) = found {
                return Ok(Self {
                    device: found.device,
                    channels,
                    parameters,
                    free: found.free,
                    anchor: Some(found.anchor),
                    unfinished: None,
                });
            }
        }
        let (device, unfinished) = match unfinished {
            // where such a search ends can be anywhere, while the drives alone are fitted soundly
            Some(reason) => {
                let weights = Weights::stated(device, &channels);
                let drives = fit_transmissions(device, &part, &channels, &weights, &options)?.0;
                let end = Unfinished {
                    reason,
                    device: fitted.device,
                };
                (drives, Some(end))
            }
            None => (fitted.device, None),
        };
        Ok(Self {
            device,
            channels,
            parameters,
            free,
            anchor: None,
            unfinished,
        })
    }

    /// From values to where they are known to be, in standard deviations; empty without an anchor.
    pub(crate) fn pull(&self, values: &[f64]) -> Vec<f64> {
        let anchor = self.anchor.as_ref();
        anchor.map_or_else(Vec::new, |anchor| anchor.pull(values, &self.free))
    }

    /// One over the standard deviations of the pull.
    pub(crate) fn stiffness(&self) -> &[f64] {
        self.anchor.as_ref().map_or(&[], Anchor::stiffness)
    }
}

/// The noise that the device file states; where it states none of its touches, that of their residuals, as no number
/// is fixed better than these allow.
fn weighting(device: &Device, channels: &[Channel]) -> Weighting {
    match is_needed(channels) && channels.iter().any(|channel| !is_stated(device, *channel)) {
        true => Weighting::Estimated,
        false => Weighting::Stated,
    }
}

/// Of every channel's readings each k-th, and the extreme rows of each joint: channels may be read at
/// different rates, and a polynomial's range is that of the log.
fn spread_rows(recording: &Recording, channels: &[Channel]) -> Vec<usize> {
    let rows = recording.len();
    let mut chosen = Vec::new();
    for channel in channels {
        let with: Vec<usize> = (0..rows)
            .filter(|&row| channel.has_reading(recording, row))
            .collect();
        let step = with.len().div_ceil(START_ROWS).max(1);
        chosen.extend(with.into_iter().step_by(step));
    }
    for column in &recording.joint {
        let by_reading = |a: &usize, b: &usize| column[*a].total_cmp(&column[*b]);
        chosen.extend((0..rows).min_by(by_reading));
        chosen.extend((0..rows).max_by(by_reading));
    }
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

/// Residuals (measured minus model) and derivatives of the base model on one recording.
#[derive(Debug)]
pub(crate) struct BaseProblem<'a> {
    problem: DeviceProblem<'a>,
    /// The same at the postures that derivatives are taken at, where these are others.
    slopes: Option<DeviceProblem<'a>>,
    /// Per stream and row: place among the problem's residuals; `usize::MAX` without a reading.
    place: Vec<Vec<usize>>,
    /// Per stream and row: stated standard deviation, quantization included.
    pub(crate) sd: Vec<Vec<f64>>,
    parameters: usize,
}

impl<'a> BaseProblem<'a> {
    /// Residuals of `recording`, derivatives at `postures`: the same rows, at the same readings or near them.
    pub(crate) fn new(
        base: &'a Base,
        recording: &'a Recording,
        postures: &'a Recording,
        streams: &[Stream],
        weights: &Weights,
    ) -> Result<Self, DiagnosisError> {
        let (device, parameters) = (&base.device, &base.parameters);
        // touches in metres, as the effects' columns are
        let problem = |recording: &'a Recording| {
            DeviceProblem::new(device, recording, &base.channels, parameters, weights)
        };
        let slopes = match std::ptr::eq(recording, postures) {
            true => None,
            false => Some(problem(postures)?),
        };
        let problem = problem(recording)?;
        let layout = problem.layout();
        let mut deviations = std::collections::BTreeMap::new();
        for &channel in &base.channels {
            deviations.insert(
                channel,
                weights.residual_sd(&base.device, recording, channel)?,
            );
        }
        let mut place = Vec::new();
        let mut sd = Vec::new();
        for stream in streams {
            let mut places = vec![usize::MAX; recording.len()];
            let width = stream.channel.width();
            if let Some(&(first, _)) = layout.get(&stream.channel) {
                let with_reading =
                    (0..recording.len()).filter(|&row| stream.channel.has_reading(recording, row));
                for (index, row) in with_reading.enumerate() {
                    places[row] = first + index * width + stream.axis;
                }
            }
            place.push(places);
            sd.push(deviations.get(&stream.channel).cloned().unwrap_or_default());
        }
        Ok(Self {
            parameters: base.parameters.len(),
            problem,
            slopes,
            place,
            sd,
        })
    }

    pub(crate) fn start(&self) -> Vec<f64> {
        self.problem.start()
    }

    pub(crate) fn device_with(&self, values: &[f64]) -> Device {
        self.problem.device_with(values)
    }

    /// Measured minus model per stream and row, in the stream's unit; NaN without a reading. With
    /// `derivatives`, those of all parameters too.
    pub(crate) fn evaluate(
        &self,
        values: &[f64],
        derivatives: bool,
    ) -> Result<Evaluated, DiagnosisError> {
        let count = self.problem.residual_count();
        let mut residuals = vec![0.0; count];
        let matrix = if derivatives && self.parameters > 0 {
            let all: Vec<usize> = (0..self.parameters).collect();
            let mut matrix = Matrix::zeros(count, self.parameters);
            let at = self.slopes.as_ref().unwrap_or(&self.problem);
            at.evaluate(values, &mut residuals, Some((&all, &mut matrix)))?;
            if self.slopes.is_some() {
                self.problem.evaluate(values, &mut residuals, None)?;
            }
            Some(matrix)
        } else {
            self.problem.evaluate(values, &mut residuals, None)?;
            None
        };
        let residual = self
            .place
            .iter()
            .zip(&self.sd)
            .map(|(places, sd)| {
                places
                    .iter()
                    .zip(sd)
                    .map(|(&place, sd)| match residuals.get(place) {
                        Some(scaled) => -scaled * sd,
                        None => f64::NAN,
                    })
                    .collect()
            })
            .collect();
        Ok(Evaluated { residual, matrix })
    }

    /// Takes a reading out.
    pub(crate) fn forget(&mut self, stream: usize, row: usize) {
        if let Some(place) = self.place[stream].get_mut(row) {
            *place = usize::MAX;
        }
    }

    /// One parameter's derivative on one stream, by row, in the stream's unit; 0 without a reading.
    pub(crate) fn derivative<'m>(
        &'m self,
        matrix: &'m Matrix,
        stream: usize,
        parameter: usize,
    ) -> impl Fn(usize) -> f64 + 'm {
        let column = matrix.column(parameter);
        let (place, sd) = (&self.place[stream], &self.sd[stream]);
        move |row| column.get(place[row]).map_or(0.0, |entry| entry * sd[row])
    }
}

/// Outcome of [`BaseProblem::evaluate`].
#[derive(Debug)]
pub(crate) struct Evaluated {
    pub(crate) residual: Vec<Vec<f64>>,
    /// Over the standard deviations, in the problem's order of residuals.
    pub(crate) matrix: Option<Matrix>,
}
