//! The calibrated model without any effect: its fit.

pub(crate) mod anchor;
pub(crate) mod problem;

use haptical_calibration::{
    Channel, Degree, HeldOut, LossChoice, Options, ParameterFit, Weighting, Weights, channels,
    fit_device, fit_transmissions, prepare_device,
};
use haptical_identification::{Interrupt, Settings};
use haptical_model::{Device, ParameterId, Recording};

use self::anchor::{Anchor, anchored, is_needed};
use crate::Result;
use crate::noise::is_stated;
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
    /// Numbers of links as the device file has them, by position within `parameters`: from where a search begins anew.
    pub(crate) described: Vec<(usize, f64)>,
    /// Where they are known to be from elsewhere than the recording; none where it fixes all of them well.
    pub(crate) anchor: Option<Anchor>,
    /// Where the search ended, and why, if that was no minimum.
    pub(crate) unfinished: Option<Unfinished>,
    /// Stops everything that is worked out from it.
    pub(crate) interrupt: Interrupt,
}

/// End of a search that found no minimum.
#[derive(Debug, Clone)]
pub(crate) struct Unfinished {
    pub(crate) reason: String,
    pub(crate) device: Device,
}

impl Base {
    /// A device as it is: nothing of it is adjusted.
    pub(crate) fn held(device: Device, channels: Vec<Channel>) -> Self {
        Self {
            device,
            channels,
            parameters: Vec::new(),
            free: Vec::new(),
            described: Vec::new(),
            anchor: None,
            unfinished: None,
            interrupt: Interrupt::default(),
        }
    }

    /// Fits the device jointly to evenly spread rows.
    pub(crate) fn fit(
        device: &Device,
        recording: &Recording,
        loss: LossChoice,
        interrupt: &Interrupt,
    ) -> Result<Self> {
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
                interrupt: interrupt.clone(),
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
        let described = links_of(device, &parameters);
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
                    parameters,
                    free: found.free,
                    described,
                    anchor: Some(found.anchor),
                    interrupt: interrupt.clone(),
                    ..Self::held(found.device, channels)
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
            parameters,
            free,
            described,
            unfinished,
            interrupt: interrupt.clone(),
            ..Self::held(device, channels)
        })
    }

    /// Adds a share of a step of the free parameters to values. Angles of links stay within half a turn of the device's.
    pub(crate) fn step(&self, values: &mut [f64], step: &[f64], share: f64) {
        for (&place, change) in self.free.iter().zip(step) {
            let (parameter, value) = (self.parameters[place], values[place] + share * change);
            values[place] = parameter.in_nearest_turn(value, parameter.value(&self.device));
        }
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

/// Numbers of links as a device has them, by position.
fn links_of(device: &Device, parameters: &[ParameterId]) -> Vec<(usize, f64)> {
    let all = parameters.iter().enumerate();
    let links = all.filter(|(_, parameter)| matches!(parameter, ParameterId::Link { .. }));
    links
        .map(|(place, parameter)| (place, parameter.value(device)))
        .collect()
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
