//! From a selection to findings with values, intervals and shares.

mod findings;
mod gaps;
mod reasons;

use haptical_effects::force::{GRIP_FORCE, PAYLOAD, UNBALANCED_GRAVITY};
use haptical_judge::Admission;

pub(super) use self::findings::Sizes;
use self::reasons::FALSIFIED;
pub(crate) use self::reasons::names;
use super::effects::is_scale;
use super::recorded::positions_show_a_gap;
use super::select::Pick;
use super::{Means, Model, gravity, grip};
use crate::Result;
use crate::answer::{
    AdjustedAnswer, CandidateAnswer, CauseAnswer, ChannelGap, HeldOutAnswer, NoReduction, OnSecond,
    OwnModel, Trace, Untestable,
};
use crate::select::{excess, misfit};
use crate::thresholds::torque::{
    BEYOND_WRONG_ANGLES, LEAST_STRUCTURE, NOISE_DEVIATIONS, OMNIBUS_DEVIATIONS, SAID_BEYOND,
    STRAIN, STRAINED, UNEXPLAINED_SHARE, WEIGHT_STRAIN,
};

/// What the torques say.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct ForceAnswer {
    pub(crate) channels: Vec<ChannelGap>,
    /// Strongest first.
    pub(crate) findings: Vec<CauseAnswer>,
    /// Whether there may be a verdict.
    pub(crate) admission: Admission,
    /// What was fitted before it was judged, and how far the description was off without.
    pub(crate) adjusted: Vec<AdjustedAnswer>,
    pub(crate) own_model: Vec<OwnModel>,
    /// What was found and is no answer, and why.
    pub(crate) candidates: Vec<CandidateAnswer>,
    /// Effects that the recording cannot test, and why.
    pub(crate) untestable: Vec<Untestable>,
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
    /// Torques of which nothing, or next to nothing, is said.
    pub(crate) silent: Vec<String>,
    /// What the findings change of the device's masses, armatures and gravity.
    pub(crate) changes: Vec<haptical_motion::Change>,
    /// What the base model changes of the device's bodies next to them.
    pub(crate) bodies: Vec<haptical_motion::Change>,
    /// Block means of the torques with the largest gap.
    pub(crate) course: Option<Trace>,
    /// What is left of a second recording, where there is one.
    pub(crate) second: Option<OnSecond>,
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
            second: held.second,
            unexplained_share: 1.0,
            not_tested: None,
            closed_unseen_share: None,
            warnings: vec![why.to_owned()],
            changes: Vec::new(),
            bodies: Vec::new(),
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

    /// Nothing can be said.
    pub(super) fn untestable(why: &str, has_torques: bool) -> Self {
        Self {
            not_tested: has_torques.then(|| why.to_owned()),
            untestable: names().map(|name| Untestable::new(name, why)).collect(),
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

impl Model<'_> {
    fn energies(&self) -> Energies {
        let (before, before_sd) = excess(&self.selection.before);
        let (after, after_sd) = excess(&self.selection.after);
        let total = before.max(0.0) + self.base.explained_within_blocks();
        let is_noise = after < NOISE_DEVIATIONS * after_sd;
        let left = if is_noise { 0.0 } else { after };
        let least = LEAST_STRUCTURE * self.effects.along.recorded.rows();
        Energies {
            is_adequate: left <= UNEXPLAINED_SHARE * total,
            is_structured: before > OMNIBUS_DEVIATIONS * before_sd && before > least,
            before,
            total,
            left,
        }
    }

    /// Puts the answer together.
    pub(super) fn answer(&self) -> Result<ForceAnswer> {
        let recorded = &self.effects.along.recorded;
        let picks = &self.selection.picks;
        let energies = self.energies();
        // the torques strain the geometry and the positions show a gap: the geometry may be wrong
        let is_falsified = self.base.strain() > STRAIN && positions_show_a_gap(recorded.context);
        let named = !picks.is_empty() && energies.is_adequate;
        let may_be_part = !picks.is_empty() && !named && recorded.moves_by_itself();
        let partial = may_be_part.then(|| self.supported()).flatten();
        let kept: Option<Vec<&Pick>> = match (named, &partial) {
            (true, _) => Some(picks.iter().collect()),
            (_, Some(partial)) => Some(partial.kept.iter().map(|pick| &picks[*pick]).collect()),
            _ => None,
        };
        let mut added = vec![0.0; recorded.channels.len()];
        let gains = &self.base.regression.solution()[self.base.scales.clone()];
        let mut add_scaled = |channel: usize| {
            let torque_nm = self.base.torque_nm.column(channel);
            added[channel] += (torque_nm.clone_owned() * gains[channel]).norm_squared()
                / torque_nm.len().max(1) as f64;
        };
        let mut answer = ForceAnswer {
            significant: !picks.is_empty() || energies.is_structured,
            numbers: self.numbers(),
            tested: self.effects.tested.len(),
            closed_unseen_share: partial.map(|partial| partial.closed_share),
            ..ForceAnswer::default()
        };
        let mut left_by_grip = None;
        if let Some(kept) = kept {
            let (findings, explained) = self.picked(&energies, &kept);
            answer.unexplained_share = match named {
                true => 1.0 - explained,
                false => (1.0 - findings.iter().map(|finding| finding.share).sum::<f64>()).max(0.0),
            };
            answer.findings = findings;
            let channels = kept.iter().filter_map(|pick| self.scaled_by(pick));
            channels.for_each(&mut add_scaled);
        } else if answer.significant && is_falsified {
            answer.significant = false;
        } else if answer.significant {
            let found = self.held(&energies);
            left_by_grip = found.as_ref().map(|(_, left)| *left);
            answer.unexplained_share = left_by_grip.unwrap_or(1.0);
            answer.findings.extend(found.map(|(cause, _)| cause));
        }
        // a strained scale is a part of any other gap
        let strained = self
            .strained(gains)
            .filter(|_| !is_falsified && !answer.significant);
        if let Some(channel) = strained {
            add_scaled(channel);
            (answer.significant, answer.unexplained_share) = (true, 1.0);
        }
        if (named || !answer.significant)
            && let Some((finding, torque_nm)) = self.weights(energies.total)?
        {
            for (added, torque_nm) in added.iter_mut().zip(torque_nm.column_iter()) {
                *added += torque_nm.norm_squared() / torque_nm.len().max(1) as f64;
            }
            answer.findings.push(finding);
            answer.significant = true;
        }
        answer.channels = self.gaps(&added);
        if let Some(left) = left_by_grip {
            let channels = answer.channels.into_iter();
            answer.channels = channels.map(|own| own.with_left(left)).collect();
            // a hand's force is of its recording, and no other rows predict it
            let largest =
                (answer.channels.iter()).max_by(|a, b| a.share_of_gap.total_cmp(&b.share_of_gap));
            let held_out = largest.map(|own| {
                let no_reduction = Some(NoReduction::Undetermined);
                let own = own.as_held_out();
                HeldOutAnswer {
                    no_reduction,
                    ..own
                }
                .settled()
            });
            for own in &mut answer.findings {
                own.held_out.clone_from(&held_out);
            }
        }
        answer.course = self.course(&answer.channels);
        answer.findings.sort_by(|a, b| b.share.total_cmp(&a.share));
        if is_falsified && !named {
            let why = ForceAnswer::untestable(FALSIFIED, true);
            (answer.untestable, answer.not_tested) = (why.untestable, why.not_tested);
        } else {
            answer.untestable = self.untestable();
            answer.not_tested = self.drowned().filter(|_| !answer.significant);
        }
        if !is_falsified {
            answer = self.with_payloads(answer, &energies);
        }
        let is_part = answer.unexplained_share > UNEXPLAINED_SHARE;
        answer.closed_unseen_share = answer.closed_unseen_share.filter(|_| is_part);
        Ok(answer)
    }

    /// Counts the numbers of the base model.
    fn numbers(&self) -> usize {
        let links = &self.effects.along.inertia;
        let nothing = links.iter().filter(|column| column.amax() == 0.0);
        self.base.scales.end - nothing.count()
    }

    /// Picks as findings, and the share of the structured energy that all picks explain.
    fn picked(&self, energies: &Energies, kept: &[&Pick]) -> (Vec<CauseAnswer>, f64) {
        let sizes = Sizes::new(self, misfit(&self.selection.after));
        let scores: f64 = self.selection.picks.iter().map(|pick| pick.score).sum();
        let total = energies.total.max(scores).max(1.0);
        let explained = (1.0 - energies.left / total).clamp(0.0, 1.0);
        let share = |pick: &Pick| explained * pick.score / scores.max(1e-300);
        let findings = kept.iter().map(|pick| sizes.of_pick(pick, share(pick)));
        (findings.collect(), explained)
    }

    /// The channel whose torque scale a pick changes.
    fn scaled_by(&self, pick: &Pick) -> Option<usize> {
        let is_scale = is_scale(self.effects.effect(pick.effect));
        self.effects.channel(pick.effect).filter(|_| is_scale)
    }

    /// Puts the payloads before the other findings. The shares of the others are of what the payloads leave.
    fn with_payloads(&self, mut answer: ForceAnswer, energies: &Energies) -> ForceAnswer {
        let rest = self.carried.rest_share(energies.before, energies.total);
        let mut findings = self.carried.findings(rest);
        if findings.is_empty() {
            return answer;
        }
        for finding in &mut answer.findings {
            finding.share *= rest;
        }
        answer.unexplained_share = match answer.significant {
            true => answer.unexplained_share * rest,
            false => 0.0,
        };
        let of_rest = rest * answer.closed_unseen_share.unwrap_or(0.0);
        let closed = self
            .carried
            .closed_share()
            .map(|share| (1.0 - rest) * share);
        answer.closed_unseen_share = closed.map(|share| share + of_rest);
        findings.append(&mut answer.findings);
        answer.findings = findings;
        let payloads = self.carried.payloads.iter();
        answer.warnings = payloads
            .filter_map(|payload| payload.warning.clone())
            .collect();
        answer.significant = true;
        answer
    }

    /// A force of the hand that the sensor does not see, where the torques show more than noise.
    fn held(&self, energies: &Energies) -> Option<(CauseAnswer, f64)> {
        if !energies.is_structured || self.effects.is_left_out(GRIP_FORCE.name) {
            return None;
        }
        let whitener = &self.base.regression.system.layout.whitener;
        let rest = &self.selection.rest_before;
        grip::grip(&self.effects.along, whitener, rest, energies.before)
    }

    /// A link whose weight is not the assumed one, with the torque of the difference; none where weights cannot be
    /// judged.
    fn weights(&self, total: f64) -> Result<Option<(CauseAnswer, Means)>> {
        let recorded = &self.effects.along.recorded;
        // a hand bears weights, with moments that no force at the handle has
        if recorded.is_held
            || self.base.strain() > WEIGHT_STRAIN
            || self.effects.is_left_out(UNBALANCED_GRAVITY.name)
        {
            return Ok(None);
        }
        let has_others = total > LEAST_STRUCTURE * recorded.rows();
        let rest = total * f64::from(has_others);
        let may_be_payload = !self.effects.is_left_out(PAYLOAD.name);
        gravity::unbalanced(&self.effects.along, &self.base, (rest, may_be_payload))
    }

    /// The channel whose torque scale the base model moved farthest; none unless that is far beyond its stated
    /// deviation and no finding explains it.
    fn strained(&self, gains: &[f64]) -> Option<usize> {
        let recorded = &self.effects.along.recorded;
        let picks = &self.selection.picks;
        let is_strained = |channel: &usize| {
            let joint = &recorded.context.device.joints[recorded.channels[*channel]];
            let is_named = picks
                .iter()
                .any(|pick| self.scaled_by(pick) == Some(*channel));
            gains[*channel].abs() > STRAINED * joint.torque_scale_sd && !is_named
        };
        let channels = (0..gains.len()).filter(is_strained);
        channels.max_by(|a, b| gains[*a].abs().total_cmp(&gains[*b].abs()))
    }
}
