//! The content of identified.json: what was identified, how well, and what was not.

use std::collections::BTreeMap;

use haptical_calibration::{
    Calibration, ChannelReport, ForceDirection, Intervals, Outlier, ParameterFit, RobustChannel,
    Robustness, Starts,
};
use haptical_identification::{Convergence, Identifiability, Loss, Observability, Status, Term};
use haptical_model::{Device, ParameterId, TransmissionError};
use serde::Serialize;

use crate::provenance::Record;
use crate::transmissions::{TransmissionEntry, transmissions};

/// identified.json.
#[derive(Debug, Serialize)]
pub(crate) struct Identified {
    pub(crate) haptical_version: String,
    pub(crate) device: String,
    pub(crate) log: String,
    pub(crate) method: &'static str,
    pub(crate) rows: usize,
    pub(crate) held_out: String,
    pub(crate) convergence: Option<Convergence>,
    pub(crate) iterations: usize,
    /// On held-out rows: empty where none of them could be checked. On the rows of the fit where a user wants nothing
    /// held out.
    pub(crate) channels: Vec<ChannelReport>,
    pub(crate) channels_fit: Vec<ChannelReport>,
    pub(crate) transmissions: Vec<TransmissionEntry>,
    /// All candidates.
    pub(crate) parameters: Vec<ParameterEntry>,
    pub(crate) not_identified: Vec<NotIdentified>,
    /// How the intervals were made; none where nothing but transmissions was fitted.
    pub(crate) intervals: Option<Intervals>,
    /// Searches from other places than the device file's values, where the first one was doubted.
    pub(crate) search: Option<Starts>,
    pub(crate) identifiability: IdentifiabilityEntry,
    pub(crate) correlations_above_0_95: Vec<(String, String, f64)>,
    /// How far the force may still lean from the wanted direction; none where the device or the log does
    /// not tell.
    pub(crate) force_direction: Option<ForceDirection>,
    pub(crate) noise: BTreeMap<String, NoiseEntry>,
    pub(crate) loss: LossEntry,
    /// Readings that noise does not explain, farthest first, where a robust loss was used.
    pub(crate) outliers: Vec<Outlier>,
    pub(crate) warnings: Vec<String>,
    pub(crate) provenance: Record,
}

impl Identified {
    /// Channels of the fit that no row outside it checks.
    pub(crate) fn unchecked(&self) -> impl Iterator<Item = &ChannelReport> {
        let is_checked = |name: &str| self.channels.iter().any(|checked| checked.channel == name);
        let fit = self.channels_fit.iter();
        fit.filter(move |report| !is_checked(&report.channel))
    }
}

/// One candidate parameter.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ParameterEntry {
    pub(crate) name: String,
    pub(crate) key: String,
    pub(crate) unit: String,
    /// Value in the given device; none where its transmission error has another form.
    pub(crate) nominal: Option<f64>,
    /// Identified value; none where the data do not fix it and the nominal value was kept.
    pub(crate) value: Option<f64>,
    pub(crate) deviation: Option<f64>,
    pub(crate) standard_deviation: Option<f64>,
    pub(crate) ci95: Option<[f64; 2]>,
    pub(crate) status: &'static str,
    /// For a dependent parameter: changes of others that act like a unit change of it.
    pub(crate) combination: Option<Vec<Term>>,
    pub(crate) reason: Option<String>,
}

/// A parameter that kept its nominal value.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct NotIdentified {
    pub(crate) name: String,
    pub(crate) status: &'static str,
    pub(crate) reason: String,
}

/// Rank and conditioning at the solution.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct IdentifiabilityEntry {
    #[serde(flatten)]
    pub(crate) solution: RankEntry,
    pub(crate) at_nominal: RankEntry,
}

/// Rank and conditioning of the derivative matrix. A device without links has one problem for each
/// transmission: then ranks and candidates are sums, and the figures of a single matrix are none.
#[derive(Debug, Clone, Default, Serialize)]
pub(crate) struct RankEntry {
    pub(crate) rank: usize,
    pub(crate) candidates: usize,
    pub(crate) singular_rank: usize,
    pub(crate) condition_unit_norm: Option<f64>,
    pub(crate) singular_values: Vec<f64>,
    /// Remainders between which the rank's tolerance lies: smallest kept, largest dropped.
    pub(crate) gap: Option<[f64; 2]>,
    pub(crate) observability: Option<Observability>,
}

/// Noise of a channel.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct NoiseEntry {
    /// Standard deviation by the device file, in the channel's unit.
    pub(crate) stated: f64,
    /// Factor on it that the fit used.
    pub(crate) factor: f64,
}

/// What large residuals cost.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct LossEntry {
    pub(crate) used: Loss,
    /// Reweighted fits; 0 for least squares.
    pub(crate) rounds: usize,
    /// Whether the weights stood still in the end.
    pub(crate) settled: bool,
    /// The channels' noise by their good readings; empty for least squares.
    pub(crate) scales: Vec<RobustChannel>,
}

impl LossEntry {
    fn of(robust: Option<&Robustness>) -> Self {
        match robust {
            Some(robust) => Self {
                used: robust.loss,
                rounds: robust.rounds,
                settled: robust.settled,
                scales: robust.channels.clone(),
            },
            None => Self {
                used: Loss::Squares,
                rounds: 0,
                settled: true,
                scales: Vec::new(),
            },
        }
    }
}

/// What was calibrated, in names.
pub(crate) struct Described {
    pub(crate) device: String,
    pub(crate) log: String,
    pub(crate) method: &'static str,
    pub(crate) rows: usize,
    pub(crate) record: Record,
}

/// Collects everything for identified.json.
pub(crate) fn identified(
    calibration: &Calibration,
    nominal: &Device,
    described: Described,
    force_direction: Option<ForceDirection>,
    warnings: Vec<String>,
) -> Identified {
    let fitted = &calibration.fitted;
    let steps: Vec<&ParameterFit> = fitted
        .transmissions
        .iter()
        .filter_map(|transmission| transmission.fit.as_ref())
        .collect();
    let fits: Vec<&ParameterFit> = match &fitted.whole {
        Some(whole) => vec![whole],
        None => steps.clone(),
    };
    let mut parameters: Vec<ParameterEntry> = Vec::new();
    // In two steps the whole fit has the kinematics alone; the transmissions come from step 1.
    for fit in fits.iter().chain(&steps) {
        for entry in entries(fit, nominal, &calibration.device) {
            // not by key: the three turns of a frame share one
            if parameters.iter().all(|other| other.name != entry.name) {
                parameters.push(entry);
            }
        }
    }
    let not_identified = parameters.iter().filter_map(refusal).collect();
    Identified {
        haptical_version: described.record.haptical_version.clone(),
        device: described.device,
        log: described.log,
        method: described.method,
        rows: described.rows,
        held_out: calibration.held_out.clone(),
        convergence: fits.first().map(|fit| fit.convergence),
        iterations: fits.iter().map(|fit| fit.iterations).sum(),
        channels: calibration.judged_channels().to_vec(),
        channels_fit: calibration.fit_channels.clone(),
        transmissions: transmissions(calibration, &parameters),
        not_identified,
        intervals: fits.first().map(|fit| fit.intervals()),
        search: fitted.whole.as_ref().map(|whole| whole.starts.clone()),
        identifiability: IdentifiabilityEntry {
            solution: RankEntry::of(fits.iter().map(|fit| &fit.identifiability)),
            at_nominal: RankEntry::of(fits.iter().map(|fit| &fit.nominal_identifiability)),
        },
        correlations_above_0_95: fits
            .iter()
            .flat_map(|fit| fit.high_correlations())
            .collect(),
        force_direction,
        noise: fitted
            .weights
            .channel_sd
            .iter()
            .map(|(channel, &stated)| {
                let factor = fitted.weights.factor.get(channel).copied().unwrap_or(1.0);
                (channel.name(), NoiseEntry { stated, factor })
            })
            .collect(),
        loss: LossEntry::of(fitted.robust.as_ref()),
        outliers: calibration.outliers.clone(),
        parameters,
        warnings,
        provenance: described.record,
    }
}

/// The candidates of one fit.
pub(crate) fn entries(
    fit: &ParameterFit,
    nominal: &Device,
    device: &Device,
) -> Vec<ParameterEntry> {
    fit.parameters
        .iter()
        .zip(&fit.estimates)
        .enumerate()
        .map(|(index, (&parameter, estimate))| {
            let nominal = nominal_value(parameter, nominal, device);
            let combination = match &estimate.status {
                Status::Dependent { combination } => Some(combination.clone()),
                _ => None,
            };
            let reason = fit.identifiability.reason(index).or_else(|| {
                estimate.value.is_none().then(|| {
                    format!(
                        "{} was held: it could not be fitted at the nominal device",
                        estimate.name
                    )
                })
            });
            ParameterEntry {
                name: estimate.name.clone(),
                key: parameter.key(device),
                unit: estimate.unit.clone(),
                nominal,
                value: estimate.value,
                deviation: estimate.value.zip(nominal).map(|(value, was)| value - was),
                standard_deviation: estimate.standard_deviation,
                ci95: estimate.ci95,
                status: estimate.status.name(),
                combination,
                reason,
            }
        })
        .collect()
}

/// Value in the given device. A transmission error of zero is zero in every form; one of another
/// form has no such parameter.
fn nominal_value(parameter: ParameterId, nominal: &Device, device: &Device) -> Option<f64> {
    let ParameterId::Transmission { joint, .. } = parameter else {
        return Some(parameter.value(nominal));
    };
    let was = &nominal.joints[joint].transmission_error;
    match (was, &device.joints[joint].transmission_error) {
        (TransmissionError::Capstan(_), TransmissionError::Capstan(_))
        | (TransmissionError::Parallelogram { .. }, TransmissionError::Parallelogram { .. }) => {
            Some(parameter.value(nominal))
        }
        (
            TransmissionError::Chebyshev {
                range_rad,
                coefficients,
            },
            TransmissionError::Chebyshev {
                range_rad: range,
                coefficients: now,
            },
        ) if range_rad == range && coefficients.len() == now.len() => {
            Some(parameter.value(nominal))
        }
        _ if *was == TransmissionError::default() => Some(0.0),
        _ => None,
    }
}

fn refusal(entry: &ParameterEntry) -> Option<NotIdentified> {
    if entry.status == "identifiable" && entry.value.is_some() {
        return None;
    }
    Some(NotIdentified {
        name: entry.name.clone(),
        status: entry.status,
        reason: entry.reason.clone()?,
    })
}

impl RankEntry {
    /// The figures of one judgement, or the sums of several.
    pub(crate) fn of<'a>(judgements: impl Iterator<Item = &'a Identifiability>) -> Self {
        let judgements: Vec<&Identifiability> = judgements.collect();
        let mut entry = Self::default();
        for judged in &judgements {
            entry.rank += judged.rank;
            entry.candidates += judged.names.len();
            entry.singular_rank += judged.singular_rank;
        }
        if let [only] = judgements.as_slice() {
            entry.condition_unit_norm = Some(only.condition_unit_norm);
            entry.singular_values.clone_from(&only.singular_values);
            entry.gap = Some(only.gap);
            entry.observability = only.observability;
        }
        entry
    }
}
