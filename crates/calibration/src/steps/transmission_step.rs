//! Step 1: each transmission's error from its external encoder.

use std::borrow::Cow;

use haptical_model::{Device, ParameterId, Recording, TransmissionKind};

use crate::problem::added::added_readings;
use crate::steps::evidence::{form, range_of, weigh};
use crate::{
    CalibrationError, Channel, Degree, EvidenceEntry, FitRequest, Options, ParameterFit,
    TransmissionTerms, Weights, fit_parameters,
};

/// The fit of one transmission.
#[derive(Debug, Clone)]
pub struct TransmissionFit {
    /// Joint, from 0.
    pub joint: usize,
    /// Form that was chosen.
    pub terms: TransmissionTerms,
    /// Forms that were weighed.
    pub evidence: Vec<EvidenceEntry>,
    /// Range of readings \[rad\].
    pub range_rad: [f64; 2],
    /// The fit; none where no error at all is supported.
    pub fit: Option<ParameterFit>,
}

/// Below this many samples for each parameter of equation (1) the evidence decides the form.
const SAMPLES_PER_PARAMETER: usize = 8;
/// Samples of one transmission that errors advise: twenty for each parameter of equation (1).
const ADVISED_SAMPLES: usize = 120;
/// Difference of a criterion below which the form with fewer parameters is taken
/// (Burnham & Anderson 2002, section 2.6: models within 2 have substantial support).
const SUBSTANTIAL_SUPPORT: f64 = 2.0;
/// Weight above which a sample has a say in the choice of the form.
const TRUSTED: f64 = 0.25;
/// Samples below which AICc decides instead of BIC.
const FEW_SAMPLES: usize = 100;

/// Fits the transmissions of all joints that have an external encoder; `device` gets their errors.
///
/// # Errors
/// [`CalibrationError`] naming the joint.
pub fn fit_transmissions(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
    weights: &Weights,
    options: &Options,
) -> Result<(Device, Vec<TransmissionFit>), CalibrationError> {
    let mut fitted = device.clone();
    let mut fits = Vec::new();
    for channel in channels {
        let Channel::Output { joint } = *channel else {
            continue;
        };
        let fit = fit_transmission(device, joint, recording, weights, options)?;
        fitted.joints[joint].transmission_error = match &fit.fit {
            Some(fit) => fit.device.joints[joint].transmission_error.clone(),
            None => form(TransmissionTerms::None, fit.range_rad),
        };
        fits.push(fit);
    }
    Ok((fitted, fits))
}

/// Fits one joint's transmission (joint from 0) to its external encoder.
///
/// A capstan with enough samples gets equation (1); a parallelogram a polynomial whose degree is
/// given or weighed; a direct joint, or any with few samples, the form that the evidence favours.
///
/// # Errors
/// [`CalibrationError`] naming the joint.
pub fn fit_transmission(
    device: &Device,
    joint: usize,
    recording: &Recording,
    weights: &Weights,
    options: &Options,
) -> Result<TransmissionFit, CalibrationError> {
    let what = format!("transmission of joint {}", joint + 1);
    let channel = Channel::Output { joint };
    let rows: Vec<usize> = (0..recording.len())
        .filter(|&row| channel.has_reading(recording, row))
        .collect();
    let part = match rows.len() == recording.len() {
        true => Cow::Borrowed(recording),
        false => Cow::Owned(recording.select(&rows)),
    };
    let readings = part.joint[joint].clone();
    let output = part.output[joint].clone().unwrap_or_default();
    let mut differences: Vec<f64> = output
        .iter()
        .zip(&readings)
        .map(|(out, at)| out - at)
        .collect();
    // what effects do is no term of the transmission
    if let Some(added) = added_readings(device, &part, channel) {
        for (difference, added) in differences.iter_mut().zip(added) {
            *difference -= added;
        }
    }
    let range_rad = range_of(&readings);
    let trusted: Vec<usize> = (0..part.len())
        .filter(|&row| {
            part.line
                .get(row)
                .is_none_or(|&line| weights.trust(channel, line) > TRUSTED)
        })
        .collect();
    let of_trusted = |values: &[f64]| trusted.iter().map(|&row| values[row]).collect::<Vec<f64>>();
    let (readings_trusted, differences_trusted) = (of_trusted(&readings), of_trusted(&differences));
    let (terms, evidence) = choose(
        &what,
        device,
        joint,
        &readings_trusted,
        &differences_trusted,
        options,
    )?;
    let mut start = device.clone();
    start.joints[joint].transmission_error = form(terms, range_rad);
    let free = terms.free_parameters();
    let held = terms.unsupported_parameters(device.joints[joint].transmission);
    let unsupported: Vec<usize> = (free.len()..free.len() + held.len()).collect();
    let all = free.into_iter().chain(held);
    let parameters: Vec<ParameterId> = all
        .map(|index| ParameterId::Transmission { joint, index })
        .collect();
    // Terms that the evidence chose are supported, however large their scatter is against a
    // plausible size: on a worn arm both can be tens of milliradians.
    let mut options = options.clone();
    if !evidence.is_empty() {
        options.rules.weak_share = f64::MAX;
    }
    let fit = if parameters.is_empty() {
        None
    } else {
        Some(fit_parameters(&FitRequest {
            what: &what,
            device: &start,
            recording: part.as_ref(),
            channels: &[channel],
            parameters: &parameters,
            unsupported: &unsupported,
            weights,
            options: &options,
            start: None,
            yielded: None,
        })?)
    };
    Ok(TransmissionFit {
        joint,
        terms,
        evidence,
        range_rad,
        fit,
    })
}

fn choose(
    what: &str,
    device: &Device,
    joint: usize,
    readings: &[f64],
    differences: &[f64],
    options: &Options,
) -> Result<(TransmissionTerms, Vec<EvidenceEntry>), CalibrationError> {
    let rows = readings.len();
    let kind = device.joints[joint].transmission;
    let plenty = rows >= SAMPLES_PER_PARAMETER * 6;
    let forms: Vec<TransmissionTerms> = match (kind, options.degree) {
        (TransmissionKind::Capstan, _) if plenty => {
            let terms = if options.zeroed_at_home {
                TransmissionTerms::ZeroedCapstan
            } else {
                TransmissionTerms::Capstan
            };
            return Ok((terms, vec![]));
        }
        (TransmissionKind::Parallelogram, Degree::Fixed(degree)) => {
            return Ok((TransmissionTerms::Polynomial(degree), vec![]));
        }
        (TransmissionKind::Parallelogram, Degree::UpTo(highest)) => (2..=highest.min(rows / 4))
            .map(TransmissionTerms::Polynomial)
            .chain([TransmissionTerms::None, TransmissionTerms::Offset])
            .collect(),
        (TransmissionKind::Capstan | TransmissionKind::Direct, _) => {
            let mut forms = vec![
                TransmissionTerms::None,
                TransmissionTerms::Offset,
                TransmissionTerms::OffsetRatio,
                TransmissionTerms::OffsetEccentricity,
                TransmissionTerms::OffsetRatioEccentricity,
            ];
            if kind == TransmissionKind::Capstan {
                forms.push(TransmissionTerms::Capstan);
            } else {
                forms.extend((2..=6.min(rows / 4)).map(TransmissionTerms::Polynomial));
            }
            forms
        }
    };
    let entries = weigh(what, &device.joints[joint], &forms, readings, differences)?;
    let criterion = |entry: &EvidenceEntry| {
        if rows < FEW_SAMPLES {
            entry.aicc
        } else {
            entry.bic
        }
    };
    let best = entries.iter().map(criterion).fold(f64::INFINITY, f64::min);
    let chosen = entries
        .iter()
        .filter(|entry| criterion(entry) <= best + SUBSTANTIAL_SUPPORT)
        .min_by_key(|entry| entry.parameters)
        .map(|entry| entry.terms);
    match chosen {
        Some(terms) => Ok((terms, entries)),
        None => Err(CalibrationError::TooFewRows {
            what: what.to_owned(),
            rows,
            // an offset and the size of the noise
            parameters: 2,
            advised: ADVISED_SAMPLES,
        }),
    }
}
