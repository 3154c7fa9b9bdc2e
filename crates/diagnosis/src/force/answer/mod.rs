//! From a selection to findings with values, intervals and shares.

mod findings;
mod gaps;
pub(super) mod names;
mod reasons;
pub(super) mod values;

use haptical_effects::force::{GRIP_FORCE, PAYLOAD, UNBALANCED_GRAVITY};

use self::findings::{of_gravity, of_grip, of_pick};
use self::gaps::{channels, mean_square};
use self::names::names;
use self::reasons::{FALSIFIED, drowned, untestable};
use self::values::Sizes;
use crate::DiagnosisError;
use crate::answer::{CauseAnswer, ChannelGap};
use crate::force::base::Base;
use crate::force::changes::carried::Carried;
use crate::force::effects::{Effects, is_scale};
use crate::force::grip::Grip;
use crate::force::select::Selection;
use crate::force::{gravity, grip, trust};
use crate::select::{excess, misfit};
use crate::thresholds::torque::{
    BEYOND_WRONG_ANGLES, LEAST_STRUCTURE, NOISE_DEVIATIONS, OMNIBUS_DEVIATIONS, SAID_BEYOND,
    STRAINED, UNEXPLAINED_SHARE,
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
    /// What the findings' numbers rest on that the torques do not fix.
    pub(crate) warnings: Vec<String>,
    /// What the findings change of the device's masses, armatures and gravity.
    pub(crate) changes: Vec<haptical_motion::Change>,
    /// Block means of the torques with the largest gap.
    pub(crate) course: Option<Course>,
    /// What the largest gap depends on, most first; nothing where that was not asked.
    pub(crate) depends_on: Vec<Followed>,
}

/// A column that a torque's gap follows.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Followed {
    pub(crate) column: String,
    pub(crate) words: String,
    /// Share of the gap that functions of it explain.
    pub(crate) share: f64,
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
            let is_loud = |own: &ChannelGap| own.rms_before > SAID_BEYOND * own.noise_floor;
            let has_gap = self.significant && self.channels.iter().any(is_loud);
            self.findings.clear();
            self.warnings.clear();
            self.significant = false;
            self.warnings.extend(has_gap.then(|| {
                format!(
                    "the torques' gap of {found:.3} N m was not judged: angles that the positions show to be wrong may cause \
                     {torque_nm:.3} N m of it"
                )
            }));
            let channels = self.channels.into_iter();
            self.channels = channels.map(ChannelGap::without_gap).collect();
        }
        self
    }

    /// Whether torques were tested and the findings, if any, leave nothing of their gap.
    pub(crate) fn is_explained(&self) -> bool {
        let is_tested = self.not_tested.is_none() && !self.channels.is_empty();
        let is_whole = self.unexplained_share <= UNEXPLAINED_SHARE;
        is_tested && is_whole && self.closed_unseen_share.is_none() && self.unexplained().is_none()
    }

    /// A gap that a hand may cause whose force nobody measured: it has no name. `held`: the answer with such a force allowed for.
    pub(crate) fn caused_by_hand(self, held: Self) -> Self {
        let why = "the torques show a gap, and a force at the hand that is not in the log would look like this: log fx_n, fy_n, \
                   fz_n, or leave the torques out";
        let channels = self.channels.into_iter();
        Self {
            channels: channels.map(ChannelGap::without_causes).collect(),
            findings: Vec::new(),
            untestable: held.untestable,
            unexplained_share: 1.0,
            not_tested: None,
            closed_unseen_share: None,
            warnings: vec![why.to_owned()],
            changes: Vec::new(),
            ..self
        }
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

    /// With the payloads before the other findings, whose shares are of what the payloads leave.
    fn with_payloads(
        mut self,
        effects: &Effects<'_, '_>,
        carried: &Carried,
        energies: &Energies,
    ) -> Self {
        let rest = carried.rest_share(energies.before, energies.total);
        let mut own = carried.findings(effects.along.recorded, rest);
        if own.is_empty() {
            return self;
        }
        for finding in &mut self.findings {
            finding.share *= rest;
        }
        self.unexplained_share = match self.significant {
            true => self.unexplained_share * rest,
            false => 0.0,
        };
        let of_rest = rest * self.closed_unseen_share.unwrap_or(0.0);
        let closed = carried.closed_share().map(|share| (1.0 - rest) * share);
        self.closed_unseen_share = closed.map(|share| share + of_rest);
        own.append(&mut self.findings);
        self.findings = own;
        self.warnings = carried.warnings();
        self.significant = true;
        self
    }

    /// Nothing can be said.
    pub(in crate::force) fn untestable(why: &str, has_torques: bool) -> Self {
        Self {
            not_tested: has_torques.then(|| why.to_owned()),
            untestable: names().map(|name| (name, why.to_owned())).collect(),
            ..Self::default()
        }
    }
}

/// Structured energy of a selection, and what it amounts to.
struct Energies {
    before: f64,
    total: f64,
    left: f64,
    is_adequate: bool,
    is_structured: bool,
}

impl Energies {
    fn new(base: &Base, selection: &Selection, rows: f64) -> Self {
        let (before, before_sd) = excess(&selection.before);
        let (after, after_sd) = excess(&selection.after);
        let total = before.max(0.0) + base.explained_within_blocks();
        let is_noise = after < NOISE_DEVIATIONS * after_sd;
        let left = if is_noise { 0.0 } else { after };
        Self {
            is_adequate: left <= UNEXPLAINED_SHARE * total,
            is_structured: before > OMNIBUS_DEVIATIONS * before_sd
                && before > LEAST_STRUCTURE * rows,
            before,
            total,
            left,
        }
    }
}

/// Chosen effects as findings.
struct Picked {
    findings: Vec<CauseAnswer>,
    /// Share of the structured energy that all picks explain.
    explained: f64,
    /// Joints whose torque has another scale, and that scale.
    scales: Vec<(usize, f64)>,
}

impl Picked {
    fn new(
        effects: &Effects<'_, '_>,
        base: &Base,
        selection: &Selection,
        energies: &Energies,
        kept: &[usize],
    ) -> Self {
        let sizes = Sizes::new(effects, base, misfit(&selection.after));
        let scores: f64 = selection.picks.iter().map(|pick| pick.score).sum();
        let total = energies.total.max(scores).max(1.0);
        let explained = (1.0 - energies.left / total).clamp(0.0, 1.0);
        let mut picked = Self {
            findings: Vec::new(),
            explained,
            scales: Vec::new(),
        };
        for pick in kept.iter().map(|&index| &selection.picks[index]) {
            let share = explained * pick.score / scores.max(1e-300);
            let effect = effects.effect(pick.effect);
            picked.findings.push(of_pick(effect, &sizes, pick, share));
            if let Some(joint) = effect.joint().filter(|_| is_scale(effect)) {
                picked.scales.push((joint, sizes.scale(effect).0));
            }
        }
        picked
    }
}

/// Puts the answer together.
pub(in crate::force) fn answer(
    effects: &Effects<'_, '_>,
    base: &Base,
    selection: &Selection,
    carried: &Carried,
) -> Result<ForceAnswer, DiagnosisError> {
    let recorded = effects.along.recorded;
    let energies = Energies::new(base, selection, effects.rows());
    let is_falsified = trust::is_falsified(recorded.context, base);
    let named = !selection.picks.is_empty() && energies.is_adequate;
    let partial = match selection.picks.is_empty() || named || !recorded.moves_by_itself() {
        true => None,
        false => effects.supported(base, selection),
    };
    let strained = strained_scale(effects, base, selection);
    let mut findings = Vec::new();
    let mut unexplained_share = 0.0;
    let mut significant = !selection.picks.is_empty() || energies.is_structured;
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
    let kept: Option<Vec<usize>> = match named {
        true => Some((0..selection.picks.len()).collect()),
        false => partial.as_ref().map(|partial| partial.kept.clone()),
    };
    if let Some(kept) = kept {
        let picked = Picked::new(effects, base, selection, &energies, &kept);
        findings = picked.findings;
        unexplained_share = match named {
            true => 1.0 - picked.explained,
            false => (1.0 - findings.iter().map(|finding| finding.share).sum::<f64>()).max(0.0),
        };
        picked
            .scales
            .iter()
            .for_each(|&(joint, gain)| add_scaled(joint, gain));
    } else if significant && is_falsified {
        significant = false;
    } else if significant {
        unexplained_share = 1.0;
        let found = held(effects, base, selection, &energies);
        if let Some(grip) = found {
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
        && let Some((finding, torque_nm)) = weights(effects, base, energies.total)?
    {
        for (channel, added) in added.iter_mut().enumerate() {
            *added += of_channel(&torque_nm, channel);
        }
        findings.push(finding);
        significant = true;
    }
    let mut channels = channels(effects, base, selection, carried, &added);
    for gap in channels.iter_mut().filter(|_| has_grip) {
        gap.rms_after = gap.rms_after.min(gap.noise_floor);
    }
    findings.sort_by(|a, b| b.share.total_cmp(&a.share));
    let mut answer = ForceAnswer {
        course: course(effects, selection, carried, &channels),
        depends_on: Vec::new(),
        channels,
        findings,
        untestable: untestable(effects, carried, is_falsified && !named),
        unexplained_share,
        significant,
        closed_unseen_share: partial.map(|partial| partial.closed_share),
        numbers: base.scales + recorded.channels.len(),
        tested: effects.tested(),
        warnings: Vec::new(),
        changes: Vec::new(),
        not_tested: match is_falsified && !named {
            true => Some(FALSIFIED.to_owned()),
            false => drowned(recorded, base).filter(|_| !significant),
        },
    };
    if !is_falsified {
        answer = answer.with_payloads(effects, carried, &energies);
    }
    let is_part = answer.unexplained_share > UNEXPLAINED_SHARE;
    answer.closed_unseen_share = answer.closed_unseen_share.filter(|_| is_part);
    Ok(answer)
}

/// A force of the hand that the sensor does not see, where the torques show more than noise.
fn held(
    effects: &Effects<'_, '_>,
    base: &Base,
    selection: &Selection,
    energies: &Energies,
) -> Option<Grip> {
    if !energies.is_structured || effects.is_left_out(GRIP_FORCE.name) {
        return None;
    }
    let whitener = &base.regression.system.layout.whitener;
    let rest = &selection.rest_before;
    grip::grip(effects.along, whitener, rest, energies.before)
}

/// A link whose weight is not the assumed one, with its torque, where weights can be judged.
fn weights(
    effects: &Effects<'_, '_>,
    base: &Base,
    total: f64,
) -> Result<Option<(CauseAnswer, Vec<f64>)>, DiagnosisError> {
    let recorded = effects.along.recorded;
    // a hand bears weights, and with moments that no force at the handle has
    if recorded.hand_is_unknown()
        || !trust::weighs(base)
        || effects.is_left_out(UNBALANCED_GRAVITY.name)
    {
        return Ok(None);
    }
    let row_sd: Vec<f64> = (0..recorded.channels.len())
        .map(|channel| recorded.row_sd(channel, &effects.along.hand))
        .collect();
    let Some(found) = gravity::unbalanced(effects.along, base, &row_sd)? else {
        return Ok(None);
    };
    let is_beside_others = total > LEAST_STRUCTURE * effects.rows();
    let mut finding = of_gravity(&found, total * f64::from(is_beside_others));
    if found.may_be_payload && !effects.is_left_out(PAYLOAD.name) {
        // in one run a mass at the flange and one of the last link are one column
        finding.confusable_with.push(PAYLOAD.name.to_owned());
        finding.probability *= 0.5;
    }
    Ok(Some((finding, found.torque_nm)))
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
