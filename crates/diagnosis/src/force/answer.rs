//! From a selection to findings with values, intervals and shares.

use std::collections::BTreeMap;

use haptical_effects::force::{GRIP_FORCE, PAYLOAD, UNBALANCED_GRAVITY};
use haptical_effects::{Effect, Follows, Hook, Spec};

use super::base::Base;
use super::carried::Carried;
use super::effects::{Effects, is_scale};
use super::gaps::{channels, mean_square};
use super::gravity::{self, Unbalanced};
use super::grip::{self, Grip};
use super::names;
use super::recorded::Recorded;
use super::select::{Pick, Selection};
use super::trust;
use super::values::Sizes;
use crate::DiagnosisError;
use crate::answer::{CauseAnswer, ChannelGap, IN_NO_CATALOGUE, ParameterAnswer};
use crate::select::{excess, misfit};
use crate::thresholds::torque::{
    BEYOND_WRONG_ANGLES, GRIP_PROBABILITY, LEAST_STRUCTURE, LISTED_PROBABILITY, NOISE_DEVIATIONS,
    OMNIBUS_DEVIATIONS, STRAINED, UNEXPLAINED_SHARE,
};

/// What the torques say.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct ForceAnswer {
    pub(crate) channels: Vec<ChannelGap>,
    /// Strongest first.
    pub(crate) findings: Vec<CauseAnswer>,
    /// Effects that the recording cannot test, and why.
    pub(crate) untestable: Vec<(&'static str, String)>,
    /// Share of the torques' structured energy that the findings leave; 1 without findings where
    /// there is a gap, 0 without a gap.
    pub(crate) unexplained_share: f64,
    /// Whether the torques show more than noise, whether or not that has a name.
    pub(crate) significant: bool,
    /// Why recorded torques were not tested at all; none where they were, or where there are none.
    pub(crate) not_tested: Option<String>,
    /// Where a payload leaves a rest: the share of the squares beyond noise that it closes on unseen blocks.
    pub(crate) closed_unseen_share: Option<f64>,
    /// Numbers of the base model, and effects at their places that were tried.
    pub(crate) numbers: usize,
    pub(crate) tested: usize,
    /// Block means of the torques with the largest gap.
    pub(crate) course: Option<Course>,
}

/// Torques over time, block by block.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Course {
    pub(crate) channel: String,
    pub(crate) unit: &'static str,
    pub(crate) time_s: Vec<f64>,
    pub(crate) before: Vec<f64>,
    pub(crate) after: Vec<f64>,
}

impl ForceAnswer {
    /// Takes the findings back where a torque of this size, which wrong angles cause, could pass for them.
    pub(crate) fn beside_wrong_angles(mut self, torque_nm: f64) -> Self {
        let squares = self
            .channels
            .iter()
            .map(|gap| gap.rms_before.powi(2) - gap.noise_floor.powi(2));
        let found = squares.map(|square| square.max(0.0)).sum::<f64>().sqrt();
        if found < BEYOND_WRONG_ANGLES * torque_nm {
            self.findings.clear();
            self.significant = false;
        }
        self
    }

    /// The torques with the largest gap, where they show one that no finding explains.
    pub(crate) fn unexplained(&self) -> Option<&ChannelGap> {
        let is_open = self.significant && self.findings.is_empty();
        self.largest().filter(|_| is_open)
    }

    /// The torques with the largest gap over their noise.
    pub(crate) fn largest(&self) -> Option<&ChannelGap> {
        let gaps = self.channels.iter();
        gaps.max_by(|a, b| a.share_of_gap.total_cmp(&b.share_of_gap))
    }

    /// Nothing can be said.
    pub(super) fn untestable(why: &str, has_torques: bool) -> Self {
        Self {
            not_tested: has_torques.then(|| why.to_owned()),
            untestable: names().map(|name| (name, why.to_owned())).collect(),
            ..Self::default()
        }
    }
}

/// Puts the answer together.
pub(super) fn answer(
    effects: &Effects<'_, '_>,
    base: &Base,
    selection: &Selection,
    carried: &Carried,
) -> Result<ForceAnswer, DiagnosisError> {
    let recorded = effects.along.recorded;
    let along = effects.along;
    let rows = effects.rows();
    let row_sd: Vec<f64> = (0..recorded.channels.len())
        .map(|channel| recorded.row_sd(channel, &along.hand))
        .collect();
    let (before, before_sd) = excess(&selection.before);
    let (after, after_sd) = excess(&selection.after);
    let total = before.max(0.0) + base.explained_within_blocks();
    let is_noise = after < NOISE_DEVIATIONS * after_sd;
    let left = if is_noise { 0.0 } else { after };
    let is_adequate = left <= UNEXPLAINED_SHARE * total;
    let is_structured = before > OMNIBUS_DEVIATIONS * before_sd && before > LEAST_STRUCTURE * rows;
    let is_falsified = trust::is_falsified(recorded.context, base);
    let named = !selection.picks.is_empty() && is_adequate;
    let partial = match selection.picks.is_empty() || is_adequate || !recorded.moves_by_itself() {
        true => None,
        false => effects.supported(base, selection, carried),
    };
    let strained = strained_scale(effects, base, selection);
    let sizes = Sizes::new(effects, base, misfit(&selection.after));
    let mut findings = Vec::new();
    let mut unexplained_share = 0.0;
    let mut significant = !selection.picks.is_empty() || is_structured;
    let blocks = recorded.blocks.len();
    let of_channel = |torque_nm: &[f64], channel: usize| {
        mean_square(&torque_nm[channel * blocks..(channel + 1) * blocks])
    };
    let mut added = vec![0.0; recorded.channels.len()];
    let mut add_scaled = |joint: usize, gain: f64| {
        if let Some(channel) = recorded.channel(joint) {
            added[channel] += gain * gain * of_channel(&base.torque_nm, channel);
        }
    };
    let mut has_grip = false;
    if named {
        let scores: f64 = selection.picks.iter().map(|pick| pick.score).sum();
        let explained = (1.0 - left / total.max(scores).max(1.0)).clamp(0.0, 1.0);
        for pick in &selection.picks {
            let share = explained * pick.score / scores.max(1e-300);
            let effect = effects.effect(pick.effect);
            findings.push(of_pick(effect, &sizes, pick, share));
            if let Some(joint) = effect.joint().filter(|_| is_scale(effect)) {
                add_scaled(joint, sizes.scale(effect).0);
            }
        }
        unexplained_share = 1.0 - explained;
    } else if let Some(partial) = &partial {
        let scores: f64 = selection.picks.iter().map(|pick| pick.score).sum();
        let explained = (1.0 - left / total.max(scores).max(1.0)).clamp(0.0, 1.0);
        let kept = partial.kept.iter().map(|&index| &selection.picks[index]);
        let score: f64 = kept.clone().map(|pick| pick.score).sum();
        let part = explained * score / scores.max(1e-300);
        for pick in kept {
            let share = part * pick.score / score.max(1e-300);
            findings.push(of_pick(effects.effect(pick.effect), &sizes, pick, share));
        }
        unexplained_share = 1.0 - part;
    } else if significant && is_falsified {
        significant = false;
    } else if significant {
        unexplained_share = 1.0;
        if is_structured
            && !effects.is_left_out(GRIP_FORCE.name)
            && let Some(grip) = grip::grip(
                along,
                &base.regression.system.layout.whitener,
                &selection.rest_before,
                before,
            )
        {
            unexplained_share = grip.left;
            findings.push(of_grip(&grip));
            has_grip = true;
        }
    }
    // where a gap shows anyhow it is that gap's
    if let Some((joint, gain)) = strained.filter(|_| !is_falsified && !significant) {
        add_scaled(joint, gain);
        (significant, unexplained_share) = (true, 1.0);
    }
    if (named || !significant)
        && trust::weighs(base)
        && !effects.is_left_out(UNBALANCED_GRAVITY.name)
        && let Some(found) = gravity::unbalanced(along, base, &row_sd)?
    {
        for (channel, added) in added.iter_mut().enumerate() {
            *added += of_channel(&found.torque_nm, channel);
        }
        let is_beside_others = total > LEAST_STRUCTURE * rows;
        let mut finding = of_gravity(&found, total * f64::from(is_beside_others));
        if found.may_be_payload && !effects.is_left_out(PAYLOAD.name) {
            // in one run a mass at the flange and one of the last link are one column
            finding.confusable_with.push(PAYLOAD.name.to_owned());
            finding.probability *= 0.5;
        }
        findings.push(finding);
        significant = true;
    }
    let mut channels = channels(effects, base, selection, carried, &added);
    for gap in channels.iter_mut().filter(|_| has_grip) {
        gap.rms_after = gap.rms_after.min(gap.noise_floor);
    }
    findings.sort_by(|a, b| b.share.total_cmp(&a.share));
    // a payload's share is of the whole gap, friction's of what is left
    let closed_share = match (carried.closed_share(), &partial) {
        (Some(first), Some(partial)) => Some(first + (1.0 - first) * partial.closed_share),
        (first, partial) => first.or(partial.as_ref().map(|partial| partial.closed_share)),
    };
    let mut own = carried.findings(effects, total);
    // of a gap with a payload the rest is what the other effects were asked of
    let rest = carried.rest_share(total);
    findings
        .iter_mut()
        .for_each(|finding| finding.share *= rest);
    if !own.is_empty() && !is_falsified {
        unexplained_share = match significant {
            true => unexplained_share * rest,
            false => 0.0,
        };
        significant = true;
        own.append(&mut findings);
        findings = own;
    }
    Ok(ForceAnswer {
        course: course(effects, selection, carried, &channels),
        channels,
        findings,
        untestable: untestable(effects, carried, is_falsified && !named),
        unexplained_share,
        significant,
        closed_unseen_share: closed_share.filter(|_| unexplained_share > UNEXPLAINED_SHARE),
        numbers: base.scales + recorded.channels.len(),
        tested: effects.tested(),
        not_tested: match is_falsified && !named {
            true => Some(FALSIFIED.to_owned()),
            false => drowned(recorded, base).filter(|_| !significant),
        },
    })
}

/// The torques with the largest gap, over time.
fn course(
    effects: &Effects<'_, '_>,
    selection: &Selection,
    carried: &Carried,
    channels: &[ChannelGap],
) -> Option<Course> {
    let recorded = effects.along.recorded;
    let time_s = recorded.context.recording.time_s.as_ref()?;
    let blocks = recorded.blocks.len();
    let by_share = |a: &usize, b: &usize| {
        channels[*a]
            .share_of_gap
            .total_cmp(&channels[*b].share_of_gap)
    };
    let channel = (0..channels.len()).max_by(by_share)?;
    let own = channel * blocks..(channel + 1) * blocks;
    Some(Course {
        channel: channels[channel].channel.clone(),
        unit: recorded.unit(channel),
        time_s: recorded.means(|row| time_s[row]),
        before: carried
            .rest_before
            .as_ref()
            .unwrap_or(&selection.rest_before)[own.clone()]
        .to_vec(),
        after: selection.rest_after[own].to_vec(),
    })
}

/// Why torques say nothing while positions show an effect that is not in the model.
const FALSIFIED: &str = "an effect on positions that is not in the model falsifies the geometry";

/// The joint whose torque scale the base model moved far beyond what is stated of it, and that scale; none where a finding
/// has it.
fn strained_scale(
    effects: &Effects<'_, '_>,
    base: &Base,
    selection: &Selection,
) -> Option<(usize, f64)> {
    let recorded = effects.along.recorded;
    let is_named = |joint: usize| {
        let picks = selection.picks.iter();
        let mut effects = picks.map(|pick| effects.effect(pick.effect));
        effects.any(|effect| is_scale(effect) && effect.joint() == Some(joint))
    };
    let solution = base.regression.solution();
    let scales = recorded
        .channels
        .iter()
        .enumerate()
        .filter_map(|(channel, &joint)| {
            let gain = solution[base.scales + channel];
            let sd = recorded.context.device.joints[joint].torque_scale_sd;
            (gain.abs() > STRAINED * sd && !is_named(joint)).then_some((joint, gain))
        });
    scales.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

/// Torques whose noise exceeds what the links alone ask of the drive: a disturbance that is as fast as the noise cannot
/// be distinguished from it.
fn drowned(recorded: &Recorded<'_>, base: &Base) -> Option<String> {
    let blocks = recorded.blocks.len().max(1);
    let by_model = base.torque_nm.chunks(blocks);
    let channels = recorded
        .channels
        .iter()
        .zip(&recorded.torque_sd)
        .zip(by_model);
    let mut loud = channels.filter_map(|((joint, &sd_nm), torque_nm)| {
        let square = torque_nm.iter().map(|torque| torque * torque).sum::<f64>();
        let rms_nm = (square / blocks as f64).sqrt();
        (sd_nm > rms_nm).then(|| {
            let (column, unit) = (recorded.column(*joint), recorded.context.device.joints[*joint].torque_unit());
            format!(
                "the noise of {column} ({sd_nm:.3} {unit}) is larger than the torque that the model predicts \
                 ({rms_nm:.3} {unit})"
            )
        })
    });
    loud.next()
}

/// Effects that need what this recording lacks, though others can be tested.
fn untestable(
    effects: &Effects<'_, '_>,
    carried: &Carried,
    is_falsified: bool,
) -> Vec<(&'static str, String)> {
    let recorded = effects.along.recorded;
    let context = recorded.context;
    if is_falsified {
        return names().map(|name| (name, FALSIFIED.to_owned())).collect();
    }
    let mut untestable = Vec::new();
    let of_force = || haptical_effects::specs().filter(|spec| spec.hook == Hook::ForceSensor);
    let mut because = |name: &'static str, why: &str| {
        if !untestable.iter().any(|(other, _)| *other == name) {
            untestable.push((name, why.to_owned()));
        }
    };
    if recorded.force_n.is_none() {
        let why = match recorded.hand_is_unknown() {
            true => "no columns fx_n, fy_n, fz_n: a free force of the hand is allowed for",
            false => {
                "no columns fx_n, fy_n, fz_n, and none that sees the handle: nobody is taken to hold it"
            }
        };
        of_force().for_each(|spec| because(spec.name, why));
        because(GRIP_FORCE.name, why);
    } else {
        if !recorded.force_varies() {
            let driven = of_force().filter(|spec| spec.follows == Follows::Force);
            driven.for_each(|spec| because(spec.name, "the hand's force is constant"));
        }
        if !grip::is_testable(recorded.channels.len()) {
            because(GRIP_FORCE.name, "fewer than five torques");
        }
    }
    if let Some(why) = &carried.changes.not_tested {
        because(PAYLOAD.name, why);
    }
    let missing: Vec<String> = (0..context.device.joints.len())
        .filter(|&joint| context.recorded_torque_nm(joint).is_none())
        .map(|joint| recorded.column(joint))
        .collect();
    if !missing.is_empty() {
        let columns = if missing.len() == 1 {
            "column"
        } else {
            "columns"
        };
        let why = format!("no {columns} {}", missing.join(", "));
        for effect in &effects.all {
            if effect.joint().is_some() {
                because(effect.name(), &why);
            }
        }
    }
    if gravity::assumed(effects.along).iter().all(Option::is_none) {
        let why = "no mass_kg and centre_of_mass_m in the device file";
        because(UNBALANCED_GRAVITY.name, why);
    }
    untestable
}

/// A plausible name with its numbers, and with the probability that it is one of the catalogue's at all.
fn finding(
    spec: &Spec,
    joint: Option<usize>,
    probability: f64,
    share: f64,
    parameters: BTreeMap<String, ParameterAnswer>,
) -> CauseAnswer {
    CauseAnswer {
        parameters,
        share,
        ..CauseAnswer::named(spec.name, joint, LISTED_PROBABILITY * probability)
    }
}

fn of_pick(effect: &dyn Effect, sizes: &Sizes<'_, '_, '_>, pick: &Pick, share: f64) -> CauseAnswer {
    let (parameters, plausible) = sizes.parameters(pick);
    let (joint, probability) = (effect.joint(), pick.probability);
    CauseAnswer {
        confusable_with: pick.rivals.iter().map(|&name| name.to_owned()).collect(),
        plausible,
        implausible: !plausible,
        ..finding(effect.spec(), joint, probability, share, parameters)
    }
}

fn of_grip(grip: &Grip) -> CauseAnswer {
    let spec = &GRIP_FORCE.parameters[0];
    let mut force_n = ParameterAnswer::normal(grip.force_n, grip.force_sd_n);
    force_n.ci95[0] = force_n.ci95[0].max(0.0);
    let parameters = BTreeMap::from([(spec.name.to_owned(), force_n)]);
    let plausible = spec.is_plausible(grip.force_n, 1.0);
    CauseAnswer {
        confusable_with: vec![IN_NO_CATALOGUE.to_owned()],
        plausible,
        implausible: !plausible,
        ..finding(
            &GRIP_FORCE,
            None,
            GRIP_PROBABILITY,
            1.0 - grip.left,
            parameters,
        )
    }
}

/// `total`: structured energy of the rest, 0 where it is hardly any.
fn of_gravity(found: &Unbalanced, total: f64) -> CauseAnswer {
    let numbers = [
        Some((found.moment_nm, found.moment_sd_nm)),
        Some((found.deviations, 0.0)),
        found.mass_kg,
    ];
    let specs = UNBALANCED_GRAVITY.parameters.iter().zip(numbers);
    let parameters = specs.filter_map(|(spec, number)| {
        let (value, sd) = number?;
        Some((spec.name.to_owned(), ParameterAnswer::normal(value, sd)))
    });
    let square = found.deviations * found.deviations;
    let (joint, share) = (Some(found.joint), square / (square + total));
    finding(
        &UNBALANCED_GRAVITY,
        joint,
        found.probability,
        share,
        parameters.collect(),
    )
}
