//! The content of identified.json: what was identified, how well, and what was not.

use std::collections::{BTreeMap, BTreeSet};

use haptical_calibration::{
    Calibration, ChannelReport, Combination, ForceDirection, Growth, Held, Intervals, Kept,
    Outlier, ParameterFit, RobustChannel, Robustness, Starts,
};
use haptical_identification::{Convergence, Identifiability, Loss, Observability, Status, Term};
use haptical_model::{Device, ParameterId, TransmissionError};
use serde::Serialize;

use super::effects::EffectEntry;
use super::moved::MovedEntry;
use super::summary::{answer, next_step};
use super::transmissions::{TransmissionEntry, transmissions};
use crate::files::Record;

/// identified.json.
#[derive(Debug, Clone, Serialize)]
pub struct Identified {
    /// Version that made it.
    pub haptical_version: String,
    /// The result in a line.
    pub answer: String,
    /// Device file.
    pub device: String,
    /// Log.
    pub log: String,
    /// `two-step` or `joint`.
    pub method: &'static str,
    /// Rows of the log.
    pub rows: usize,
    /// Rows that the fit did not see, in words.
    pub held_out: String,
    /// How the search ended.
    pub convergence: Option<Convergence>,
    /// Steps of the search.
    pub iterations: usize,
    /// On held-out rows: empty where none of them could be checked. On the rows of the fit where a user wants nothing
    /// held out.
    pub channels: Vec<ChannelReport>,
    /// The same on the rows of the fit.
    pub channels_fit: Vec<ChannelReport>,
    /// The transmissions with an external encoder.
    pub transmissions: Vec<TransmissionEntry>,
    /// All candidates.
    pub parameters: Vec<ParameterEntry>,
    /// How far numbers moved, those that moved most first.
    pub moved: Vec<MovedEntry>,
    /// Effects that were fitted, with their own numbers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<EffectEntry>,
    /// What the data fix of parameters that they do not fix alone.
    pub combinations: Vec<Combination>,
    /// Those that kept their nominal values.
    pub not_identified: Vec<NotIdentified>,
    /// Which row each number in a parameter's name stands for, where the joints have names of their own; else empty.
    #[serde(skip)]
    pub(super) named_rows: String,
    /// How the intervals were made; none where nothing but transmissions was fitted.
    pub intervals: Option<Intervals>,
    /// Searches from other places than the device file's values, where the first one was doubted.
    pub search: Option<Starts>,
    /// Rank and conditioning.
    pub identifiability: IdentifiabilityEntry,
    /// Pairs of parameters whose errors go together.
    pub correlations_above_0_95: Vec<(String, String, f64)>,
    /// How far the force may still lean from the wanted direction; none where the device or the log does
    /// not tell.
    pub force_direction: Option<ForceDirection>,
    /// Noise of each channel.
    pub noise: BTreeMap<String, NoiseEntry>,
    /// What large residuals cost.
    pub loss: LossEntry,
    /// Readings that noise does not explain, farthest first, where a robust loss was used.
    pub outliers: Vec<Outlier>,
    /// What to do where more than noise is left; none where nothing is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next: Option<String>,
    /// What is odd.
    pub warnings: Vec<String>,
    /// What became of the full fit, where it is worse than none on rows that it did not see.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rejected: Option<RejectedEntry>,
    /// How the result came about.
    pub provenance: Record,
}

/// A fit that was not kept: its device is in rejected.toml.
#[derive(Debug, Clone, Serialize)]
pub struct RejectedEntry {
    /// What was kept in its place: `nominal` or `joint-offsets`.
    pub kept: Kept,
    /// The channel that is worse.
    pub growth: Growth,
    /// Before and after the rejected fit, on rows that it did not see.
    pub channels: Vec<ChannelReport>,
}

impl Identified {
    /// Takes up what was found of effects.
    pub(super) fn tell_effects(&mut self, effects: Vec<EffectEntry>) {
        self.effects = effects;
        self.answer = answer(self);
    }

    /// Takes up what the identified device leaves of a channel on all rows of the log.
    pub(super) fn tell_fit(&mut self, channel: &str, rms: f64) {
        let all = self.channels.iter_mut().chain(&mut self.channels_fit);
        for own in all.filter(|own| own.channel == channel) {
            own.rms_fit = Some(rms);
        }
    }

    /// Channels of the fit that no row outside it checks.
    pub fn unchecked(&self) -> impl Iterator<Item = &ChannelReport> {
        let is_checked = |name: &str| self.channels.iter().any(|checked| checked.channel == name);
        let fit = self.channels_fit.iter();
        fit.filter(move |report| !is_checked(&report.channel))
    }

    /// SI unit of a channel; empty for an unknown one.
    pub(super) fn unit(&self, channel: &str) -> &str {
        let mut reports = self.channels.iter().chain(&self.channels_fit);
        let report = reports.find(|report| report.channel == channel);
        report.map_or("", |report| report.unit.as_str())
    }
}

/// One candidate parameter.
#[derive(Debug, Clone, Serialize)]
pub struct ParameterEntry {
    /// Name.
    pub name: String,
    /// Place in the device file.
    pub key: String,
    /// SI unit.
    pub unit: String,
    /// Value in the given device; none where its transmission error has another form.
    pub nominal: Option<f64>,
    /// Identified value; none where the data do not fix it and the nominal value was kept.
    pub value: Option<f64>,
    /// Value minus nominal.
    pub deviation: Option<f64>,
    /// Standard deviation.
    pub standard_deviation: Option<f64>,
    /// 95 % interval.
    pub ci95: Option<[f64; 2]>,
    /// Size that a deviation may plausibly have.
    pub plausible_size: f64,
    /// `identifiable`: fixed by the data alone. `combination`: fixed only together with others ([`Identified`] lists the
    /// sums); the interval counts what these may be. Not fixed: `weak`, `dependent`, `invisible`, or `held`, which the
    /// samples do not support.
    pub status: &'static str,
    /// For a dependent parameter: changes of others that act like a unit change of it.
    pub combination: Option<Vec<Term>>,
    /// Why it has no value, or no sure one.
    pub reason: Option<String>,
}

/// A parameter that kept its nominal value.
#[derive(Debug, Clone, Serialize)]
pub struct NotIdentified {
    /// Name.
    pub name: String,
    /// Whether the data fix it.
    pub status: &'static str,
    /// Why it has no value, or no sure one.
    pub reason: String,
}

/// Rank and conditioning at the solution.
#[derive(Debug, Clone, Serialize)]
pub struct IdentifiabilityEntry {
    /// At the solution.
    #[serde(flatten)]
    pub solution: RankEntry,
    /// At the given device.
    pub at_nominal: RankEntry,
}

/// Rank and conditioning of the derivative matrix. A device without links has one problem for each
/// transmission: then ranks and candidates are sums, and the figures of a single matrix are none.
#[derive(Debug, Clone, Default, Serialize)]
pub struct RankEntry {
    /// Rank.
    pub rank: usize,
    /// Number of candidates.
    pub candidates: usize,
    /// Rank by singular values.
    pub singular_rank: usize,
    /// Condition number with columns of unit norm.
    pub condition_unit_norm: Option<f64>,
    /// Singular values, largest first.
    pub singular_values: Vec<f64>,
    /// Remainders between which the rank's tolerance lies: smallest kept, largest dropped.
    pub gap: Option<[f64; 2]>,
    /// Observability indices.
    pub observability: Option<Observability>,
}

/// Noise of a channel.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct NoiseEntry {
    /// Standard deviation by the device file, in the channel's unit.
    pub stated: f64,
    /// Factor on it that the fit used.
    pub factor: f64,
}

/// What large residuals cost.
#[derive(Debug, Clone, Serialize)]
pub struct LossEntry {
    /// The loss.
    pub used: Loss,
    /// Reweighted fits; 0 for least squares.
    pub rounds: usize,
    /// Whether the weights stood still in the end.
    pub settled: bool,
    /// The channels' noise by their good readings; empty for least squares.
    pub scales: Vec<RobustChannel>,
}

impl LossEntry {
    fn new(robust: Option<&Robustness>) -> Self {
        Self {
            used: robust.map_or(Loss::Squares, |own| own.loss),
            rounds: robust.map_or(0, |own| own.rounds),
            settled: robust.is_none_or(|own| own.settled),
            scales: robust.map_or(Vec::new(), |own| own.channels.clone()),
        }
    }
}

/// Collects everything for identified.json; `labels` are those of the device file and of the log.
pub(super) fn identified(
    calibration: &Calibration,
    labels: [&str; 2],
    (method, rows): (&'static str, usize),
    force_direction: Option<ForceDirection>,
    warnings: Vec<String>,
    provenance: Record,
) -> Identified {
    let fitted = &calibration.fitted;
    let [device, log] = labels.map(str::to_owned);
    let steps = fitted.transmissions.iter();
    let steps = steps.filter_map(|transmission| transmission.fit.as_ref());
    let steps: Vec<&ParameterFit> = steps.collect();
    let fits: Vec<&ParameterFit> = match &fitted.whole {
        Some(whole) => vec![whole],
        None => steps.clone(),
    };
    let mut parameters: Vec<ParameterEntry> = Vec::new();
    // In two steps the whole fit has the kinematics alone; the transmissions come from step 1.
    for fit in fits.iter().chain(&steps) {
        for entry in entries(fit, &calibration.nominal, &calibration.device) {
            // not by key: the three turns of a frame share one
            if parameters.iter().all(|other| other.name != entry.name) {
                parameters.push(entry);
            }
        }
    }
    let all = fits.iter().chain(&steps);
    let mut combinations: Vec<Combination> = all.flat_map(|fit| fit.combinations()).collect();
    let mut listed = BTreeSet::new();
    combinations.retain(|sum| listed.insert(sum.terms[0].name.clone()));
    let not_identified = parameters.iter().filter_map(refusal).collect();
    let correlations = fits.iter().flat_map(|fit| fit.high_correlations());
    let at_nominal = fits.iter().map(|fit| &fit.nominal_identifiability);
    let weights = &fitted.weights;
    let noise = weights.channel_sd.iter().map(|(channel, &stated)| {
        let factor = weights.factor.get(channel).copied().unwrap_or(1.0);
        (channel.name(), NoiseEntry { stated, factor })
    });
    let mut result = Identified {
        haptical_version: provenance.haptical_version.clone(),
        answer: String::new(),
        device,
        log,
        method,
        rows,
        held_out: calibration.held_out.clone(),
        convergence: fits.first().map(|fit| fit.convergence),
        iterations: fits.iter().map(|fit| fit.iterations).sum(),
        channels: with_fit(calibration.judged_channels(), &calibration.fit_channels),
        channels_fit: with_fit(&calibration.fit_channels, &calibration.fit_channels),
        transmissions: transmissions(calibration, &parameters),
        moved: Vec::new(),
        effects: Vec::new(),
        combinations,
        not_identified,
        named_rows: String::new(),
        intervals: fits.first().map(|first| Intervals {
            channel_noise: (fits.iter())
                .flat_map(|fit| fit.channel_noise.clone())
                .collect(),
            ..first.intervals()
        }),
        search: fitted.whole.as_ref().map(|whole| whole.starts.clone()),
        identifiability: IdentifiabilityEntry {
            solution: RankEntry::from_judgements(fits.iter().map(|fit| &fit.identifiability)),
            at_nominal: RankEntry::from_judgements(at_nominal),
        },
        correlations_above_0_95: correlations.collect(),
        force_direction,
        noise: noise.collect(),
        loss: LossEntry::new(fitted.robust.as_ref()),
        outliers: calibration.outliers.clone(),
        parameters,
        next: None,
        warnings,
        rejected: calibration.rejected.as_ref().map(|rejected| RejectedEntry {
            kept: rejected.kept,
            growth: rejected.growth.clone(),
            channels: figures(&rejected.held_out_channels),
        }),
        provenance,
    };
    result.answer = answer(&result);
    result.next = next_step(&result);
    result
}

/// The figures of channels, and what the fit leaves of them on its own rows.
fn with_fit(channels: &[ChannelReport], fit: &[ChannelReport]) -> Vec<ChannelReport> {
    let mut all = figures(channels);
    for own in &mut all {
        let seen = fit.iter().find(|seen| seen.channel == own.channel);
        own.rms_fit = seen.map(|seen| seen.rms_after);
    }
    all
}

fn figures(channels: &[ChannelReport]) -> Vec<ChannelReport> {
    channels.iter().map(ChannelReport::figures).collect()
}

/// The candidates of one fit.
fn entries(fit: &ParameterFit, nominal: &Device, device: &Device) -> Vec<ParameterEntry> {
    let combinations = fit.combinations();
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
            let name = &estimate.name;
            let held = || format!("{name} was held: it could not be fitted at the nominal device");
            let sum = combinations.iter().find(|sum| sum.parameter == index);
            let (status, reason) = match (sum, fit.considered.reason(parameter)) {
                (Some(sum), _) => ("combination", Some(in_a_sum(sum))),
                (None, Some(Held::Unsupported)) => {
                    let why = format!("{name} is held: the samples support a form without it");
                    ("held", Some(why))
                }
                _ => {
                    let reason = fit.identifiability.reason(index);
                    let reason = reason.or_else(|| estimate.value.is_none().then(held));
                    (estimate.status.name(), reason)
                }
            };
            ParameterEntry {
                name: estimate.name.clone(),
                key: parameter.key(device),
                unit: estimate.unit.clone(),
                nominal,
                value: estimate.value,
                deviation: estimate.value.zip(nominal).map(|(value, was)| value - was),
                standard_deviation: estimate.standard_deviation,
                ci95: estimate.ci95,
                plausible_size: parameter.plausible_size(device),
                status,
                combination,
                reason,
            }
        })
        .collect()
}

/// The reason for which a parameter is not fixed alone.
fn in_a_sum(sum: &Combination) -> String {
    let (own, others) = (&sum.terms[0].name, &sum.terms[1..]);
    let others: Vec<&str> = others.iter().map(|term| term.name.as_str()).collect();
    let others = match others.is_empty() {
        true => "what no reading shows".to_owned(),
        false => others.join(", "),
    };
    format!(
        "{own} is fixed only together with {others}: its interval counts their plausible errors"
    )
}

/// Value in the given device. A transmission error of zero is zero in every form; one of another
/// form has no such parameter.
fn nominal_value(parameter: ParameterId, nominal: &Device, device: &Device) -> Option<f64> {
    let ParameterId::Transmission { joint, .. } = parameter else {
        return Some(parameter.value(nominal));
    };
    let was = &nominal.joints[joint].transmission_error;
    let now = &device.joints[joint].transmission_error;
    let series = |error: &TransmissionError| match error {
        TransmissionError::Chebyshev {
            range_rad,
            coefficients,
        } => Some((*range_rad, coefficients.len())),
        _ => None,
    };
    let is_same_form = std::mem::discriminant(was) == std::mem::discriminant(now);
    if is_same_form && series(was) == series(now) {
        return Some(parameter.value(nominal));
    }
    (*was == TransmissionError::default()).then_some(0.0)
}

fn refusal(entry: &ParameterEntry) -> Option<NotIdentified> {
    if matches!(entry.status, "identifiable" | "combination") && entry.value.is_some() {
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
    pub fn from_judgements<'a>(judgements: impl Iterator<Item = &'a Identifiability>) -> Self {
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
