//! What was examined of a motion, and whether its causes are an answer.

use crate::MotionError;
use crate::adjusted::Adjusted;
use crate::change::Change;
use crate::dependence::Dependence;
use crate::effect::{contact, is_exact, is_of_own_joint, joint_compliance};
use crate::findings::SAMPLING;
use crate::scale::{Doubt, Scale};
use crate::signal::line::Line;
use crate::signal::noise::Noise;
use crate::thresholds::examine::{
    ALLOWED_REST, FRICTION_OF_SECOND, GAP_SDS, LEFT_BY_LAW, LEFT_OF_JOINT, LEFT_OF_POSTURE,
    LEFT_OF_SECOND, MOST_OF_GAP, NEAR_RIVAL_NATS, OF_SECOND_BESIDE_SPRING, PART_OF_GAP,
    QUIET_NOISES, UNEXPLAINED,
};
use crate::unseen::Unseen;

/// What the torques of a moving arm show.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Examined {
    /// One entry a joint with torques.
    pub channels: Vec<ChannelFit>,
    /// Effects, strongest first.
    pub findings: Vec<Finding>,
    /// Energy beyond noise that the base model leaves, and that all effects leave \[nats\].
    pub before_nats: f64,
    /// See [`Examined::before_nats`].
    pub after_nats: f64,
    /// Independent rows behind both.
    pub freedom: f64,
    /// Edge of the band that rows were taken of \[Hz\].
    pub edge_hz: f64,
    /// What is said of a log of which stretches alone were looked at.
    pub of_stretches: Option<String>,
    /// Numbers of the base model.
    pub numbers: usize,
    /// Effects at places that were tried.
    pub tried: usize,
    /// Torques of rows that were not fitted: of the second recording, where there is one; of parts that were left out in turn,
    /// where effects were found; else none.
    pub unseen: Vec<Unseen>,
    /// Rows (from 0) that the log repeats, which were left out, and those behind ones that it lacks, from which on time was set right.
    pub repeated_rows: Vec<usize>,
    /// See [`Examined::repeated_rows`].
    pub behind_missing_rows: Vec<usize>,
    /// Where the log repeats rows or lacks some: torques as they are read, and once that is set right, by the base model.
    pub set_right: Vec<Unseen>,
    /// Why the second recording is not among them.
    pub second: Option<MotionError>,
    /// Effects and joints (from 0) that explained something of the log and were left out: the second recording's torques are predicted better
    /// without, or it misses them at other joints than their own.
    pub refuted: Vec<(&'static str, Option<usize>)>,
    /// Share of the second recording's squares beyond noise that the effects leave; none where they leave noise, or were not checked on it.
    pub left_of_second: Option<f64>,
    /// Whether a push was found, and the second recording has a gap that none explains.
    pub is_push_contradicted: bool,
    /// Joints whose armature no device file states, with the one that was fitted \[kg m^2\].
    pub free_armatures: Vec<(usize, f64)>,
    /// Friction and armature of the drives as they were fitted, which counts as calibration.
    pub adjusted: Vec<Adjusted>,
    /// Bodies as they were fitted within what is plausible, next to the causes.
    pub bodies: Vec<Change>,
    /// What the description leaves of each joint's torque as it is, nothing adjusted: joint, from 0, and root mean square.
    pub as_described: Vec<(usize, f64)>,
    /// Joints whose friction differs from that of the device's file by more than a quarter and more than noise, with how many times that it is.
    pub other_friction: Vec<(usize, f64)>,
    /// Whether the torques lack what gravity asks of the links.
    pub lacks_gravity: bool,
    /// Joints (from 0) whose torque oscillates faster than the motion: that counts as noise, and is none.
    pub oscillations: Vec<(usize, Line)>,
    /// Joints (from 0) whose torque was taken to have a noise with a memory: a white one leaves a gap without a name.
    pub memories: Vec<(usize, Noise)>,
    /// Joints whose rest has the spectrum of such a noise.
    pub(crate) may_have_memory: Vec<(usize, Noise)>,
    /// What is faster than this was left out, and has no name: a spring was found in what is slower \[Hz\].
    pub above_hz: Option<f64>,
    /// Root mean square deviation of the time stamps from an even grid, as a share of a step.
    pub jitter: f64,
    /// Whether positions are smoother on an even grid than at their stamps, which were left aside then.
    pub is_stamped_late: bool,
    /// How long the torques are logged before their positions, as fitted \[s\].
    pub early_s: f64,
    /// What is wrong with the torques, so that nothing gets a name.
    pub doubts: Vec<Doubt>,
    /// Joints (from 0) whose torque has one value throughout, with it: nothing is said of them.
    pub constant: Vec<(usize, f64)>,
    /// Fastest motion of each joint \[rad/s\], \[m/s\].
    pub fastest: Vec<f64>,
    /// Joints (from 0) that stand still: of their torques the load alone was looked at.
    pub still: Vec<usize>,
    /// Time of each row \[s\].
    pub time_s: Vec<f64>,
}

/// One joint's torque.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelFit {
    /// Joint, from 0.
    pub joint: usize,
    /// Root mean square of what the base model leaves within the band, in the torque's unit.
    pub rms_before: f64,
    /// With all effects.
    pub rms_after: f64,
    /// Noise of a row.
    pub noise: f64,
    /// How a recorded torque goes with that of the nominal bodies; none of an encoder.
    pub scale: Option<Scale>,
    /// What the base model leaves, row by row, in the torque's unit.
    pub before: Vec<f64>,
    /// With all effects.
    pub after: Vec<f64>,
    /// What the gap depends on, most first; nothing where there is no gap.
    pub depends_on: Vec<Dependence>,
    /// Share of what all effects leave beyond noise that functions of the posture explain.
    pub share_of_posture: f64,
    /// Share of what the base model leaves beyond noise that friction by the joint's position explains, and of what all effects leave.
    pub share_of_friction: [f64; 2],
}

/// An effect that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Name.
    pub effect: &'static str,
    /// Joint, from 0.
    pub joint: Option<usize>,
    /// What it changes of a device's numbers, where it does.
    pub change: Option<Change>,
    /// What it explains \[nats\].
    pub nats: f64,
    /// Numbers with their standard deviations.
    pub numbers: Vec<(&'static str, f64, f64)>,
    /// Effects that would explain nearly as much in its place, nearest first.
    pub rivals: Vec<NearRival>,
    /// Whether it is told from an inertia that the model lacks: a scale shows in all that a torque carries.
    pub is_told: bool,
}

impl Finding {
    /// Whether it is rows that the log repeats or lacks.
    pub fn is_of_sampling(&self) -> bool {
        self.effect == SAMPLING
    }

    /// Whether something pushes for a part of the log.
    pub fn is_push(&self) -> bool {
        self.effect == contact::EFFECT.name
    }

    /// Whether a log cannot distinguish it from another effect.
    pub fn has_near_rival(&self) -> bool {
        self.rivals.iter().any(NearRival::is_near)
    }

    /// Whether it is a spring between motor and link, which is known to first order alone.
    pub(crate) fn is_joint_spring(&self) -> bool {
        self.effect == joint_compliance::EFFECT.name
    }
}

/// An effect in the place of a finding.
#[derive(Debug, Clone, PartialEq)]
pub struct NearRival {
    /// Name.
    pub effect: &'static str,
    /// Joint, from 0.
    pub joint: Option<usize>,
    /// How far behind it is \[nats\], what all effects leave allowed for.
    pub behind_nats: f64,
    /// Share of the finding's gain that it has.
    pub share: f64,
}

impl NearRival {
    /// Whether a log does not tell it from the finding.
    pub fn is_near(&self) -> bool {
        self.behind_nats < NEAR_RIVAL_NATS
    }
}

impl Examined {
    /// Whether the noise of a torque was taken to have a memory.
    pub fn has_memory(&self) -> bool {
        !self.memories.is_empty()
    }

    /// Whether a channel shows more than noise, or is in doubt.
    pub fn has_gap(&self) -> bool {
        self.channels.iter().any(ChannelFit::has_gap) || !self.doubts.is_empty()
    }

    /// Share of what the base model leaves beyond noise that the effects leave.
    pub fn unexplained_share(&self) -> f64 {
        (self.after_nats.max(0.0) / self.before_nats.max(1.0)).clamp(0.0, 1.0)
    }

    /// Joints that hold a part of the gap and keep more of it than effects may leave.
    fn kept(&self) -> impl Iterator<Item = &ChannelFit> {
        let energy = |own: &ChannelFit| ((own.rms_before / own.noise).powi(2) - 1.0).max(0.0);
        let whole: f64 = self.channels.iter().map(energy).sum();
        let holds = move |own: &&ChannelFit| energy(own) > PART_OF_GAP * whole;
        let keeps = |own: &&ChannelFit| {
            own.rms_after > (QUIET_NOISES * own.noise).max(LEFT_OF_JOINT * own.rms_before)
        };
        self.channels.iter().filter(holds).filter(keeps)
    }

    /// Whether the effects explain the gap; a joint with a small part of it may keep that ([`ChannelFit::has_rest`]).
    pub fn is_adequate(&self) -> bool {
        let is_quiet = !self.channels.iter().any(ChannelFit::has_rest);
        let is_explained = self.unexplained_share() <= UNEXPLAINED && self.kept().next().is_none();
        self.doubts.is_empty()
            && !self.lacks_gravity
            && self
                .findings
                .iter()
                .any(|own| self.is_where_the_gap_is(own))
            && (self.findings.iter())
                .all(|own| own.is_told || own.has_near_rival() || self.is_small(own))
            && (is_quiet || is_explained)
            && !self.findings.iter().any(|own| self.is_undoing(own))
            && !self.is_of_another_law()
            && !self.is_contradicted()
            && !self.is_disproved()
            && !self.is_unchecked()
    }

    /// Whether several effects were found, and no row that no fit saw says how they fare where the gap is.
    fn is_unchecked(&self) -> bool {
        let mut with_gap = self.channels.iter().filter(|own| own.has_gap()).peekable();
        let is_seen = |own: &ChannelFit| {
            let mut unseen = self.unseen.iter().filter(|other| other.joint == own.joint);
            unseen.any(|other| other.rows_in_all() > 0)
        };
        self.findings.len() > 1
            && !self.unseen.is_empty()
            && with_gap.peek().is_some()
            && !with_gap.any(is_seen)
    }

    /// Whether the effects make a gap of rows that no fit saw, where the base model leaves none. A push belongs to its rows.
    fn is_disproved(&self) -> bool {
        let is_of_all = !self.findings.iter().any(Finding::is_push);
        is_of_all && self.unseen.iter().any(Unseen::gets_gap)
    }

    /// Whether a finding explains so little that the gap may keep it.
    fn is_small(&self, found: &Finding) -> bool {
        let all: f64 = self.findings.iter().map(|own| own.nats.max(0.0)).sum();
        found.nats < PART_OF_GAP * all
    }

    /// Whether what was found is an answer.
    pub fn is_answer(&self) -> bool {
        self.is_adequate() || self.is_borne_out() || self.is_partial()
    }

    /// Share of the squares beyond noise that the effects close on rows that no fit saw.
    pub fn closed_unseen_share(&self) -> Option<f64> {
        let sum = |of: fn(&Unseen) -> f64| self.unseen.iter().map(of).sum::<f64>();
        let (before, after) = (sum(Unseen::beyond_before), sum(Unseen::beyond_after));
        (before > 0.0).then(|| (1.0 - after / before).clamp(0.0, 1.0))
    }

    /// What speaks against the effects as a whole, in words; none where they were not found, or are an answer.
    pub fn refusal(&self) -> Option<String> {
        let all = &self.findings;
        let may_be_freedom =
            |own: &Finding| !own.is_told && !own.has_near_rival() && !self.is_small(own);
        let why = if all.is_empty() {
            return None;
        } else if !self.doubts.is_empty() {
            "the torques themselves are in doubt".to_owned()
        } else if self.lacks_gravity {
            "the torques lack what gravity asks of the links".to_owned()
        } else if let Some(left) = self.left_of_second.filter(|_| self.is_contradicted()) {
            format!(
                "{:.0} % of the squares of the second recording's gap stay",
                100.0 * left
            )
        } else if self.is_contradicted() {
            "the second recording has a gap of another kind".to_owned()
        } else if !all.iter().any(|own| self.is_where_the_gap_is(own)) {
            "it acts on no torque that has a gap".to_owned()
        } else if all.iter().any(|own| self.is_undoing(own)) {
            "it explains more than there is to explain at its joint".to_owned()
        } else if all.iter().any(may_be_freedom) {
            "the freedom of the base model explains as much".to_owned()
        } else if self.is_unchecked() {
            "no rows that a fit did not see say how they fare where the gap is".to_owned()
        } else if self.is_disproved() {
            "rows that no fit saw get a gap by it".to_owned()
        } else if self.is_of_another_law() {
            "what it leaves follows the posture, as nothing does that its law leaves".to_owned()
        } else {
            return None;
        };
        Some(why)
    }

    /// Why the effects that were found are no answer, in words.
    pub fn why_no_answer(&self) -> String {
        let left = || {
            format!(
                "{:.0} % of the squares beyond noise stay",
                100.0 * self.unexplained_share()
            )
        };
        self.refusal().unwrap_or_else(left)
    }

    /// Whether effects that were found beside rows that the log repeats or lacks, which bend what is left, explain the gap of a second
    /// recording.
    pub fn is_borne_out(&self) -> bool {
        let beside = self.findings.iter().skip(1);
        let is_told = |own: &Finding| own.is_told && !self.is_undoing(own);
        let is_gap = |own: &Unseen| {
            let rows = own.rows_in_all();
            let square = own.before.iter().sum::<f64>() / rows.max(1) as f64;
            !own.predictions.is_empty() && is_beyond_noise(square.sqrt() / own.noise, rows)
        };
        let is_of_log = self.findings.first().is_some_and(Finding::is_of_sampling);
        is_of_log
            && self.findings.len() > 1
            && self.doubts.is_empty()
            && beside.clone().all(is_told)
            && self.unseen.iter().any(is_gap)
            && self
                .left_of_second
                .is_none_or(|left| left <= LEFT_OF_SECOND)
            && !self.is_push_contradicted
            && !beside.clone().any(Finding::is_push)
    }

    /// Whether the effects leave more of a second recording's gap than they may.
    pub fn is_contradicted(&self) -> bool {
        // a spring between motor and link is known to first order alone
        let has_spring = self.findings.iter().any(Finding::is_joint_spring);
        let most = match has_spring {
            true => OF_SECOND_BESIDE_SPRING,
            false => LEFT_OF_SECOND,
        };
        // friction that stays in the first stays in the second
        let stays = match self.leaves_friction() {
            true => FRICTION_OF_SECOND * self.unexplained_share(),
            false => 0.0,
        };
        self.is_push_contradicted
            || self
                .left_of_second
                .is_some_and(|left| left > most.max(stays))
    }

    /// Whether an effect acts on a channel that shows more than noise, if any does: what it explains elsewhere explains no gap.
    fn is_where_the_gap_is(&self, found: &Finding) -> bool {
        let joint = found.joint.filter(|_| is_of_own_joint(found.effect));
        let is_there = |own: &ChannelFit| joint.is_none_or(|joint| joint == own.joint);
        let mut gaps = self.channels.iter().filter(|own| own.has_gap()).peekable();
        gaps.peek().is_none() || gaps.any(is_there)
    }

    /// Whether an effect of one joint's torque explains much more than there was to explain there: then it undoes what another one does
    /// too much (A203).
    fn is_undoing(&self, found: &Finding) -> bool {
        let joint = found.joint.filter(|_| is_of_own_joint(found.effect));
        let own = self.channels.iter().find(|own| Some(own.joint) == joint);
        let most = |own: &ChannelFit| {
            let rows = own.before.len() as f64;
            let beyond = 0.5 * rows * ((own.rms_before / own.noise).powi(2) - 1.0);
            // of noise alone it scatters by the second
            MOST_OF_GAP * (beyond.max(0.0) + (0.5 * rows).sqrt())
        };
        self.findings.len() > 1 && own.is_some_and(|own| found.nats > most(own))
    }

    /// Whether weights, springs, offsets and factors alone were found, whose laws are exact, and a rest still follows the posture: then
    /// they only look like what is there.
    pub(crate) fn is_of_another_law(&self) -> bool {
        let acts = |found: &Finding, joint: usize| found.joint.is_none_or(|own| own == joint);
        let are_exact = |joint: usize| {
            let mut all = self.findings.iter();
            all.all(|own| is_exact(own.effect) || !acts(own, joint))
        };
        let follows = |own: &ChannelFit| {
            own.has_rest() && own.share_of_posture > LEFT_OF_POSTURE && are_exact(own.joint)
        };
        // the levers of a spring are not known, and bodies feel a tilt, or move what is put on, which are off themselves
        let is_small = self.unexplained_share() < LEFT_BY_LAW;
        let exact = self.findings.iter().any(|own| is_exact(own.effect));
        exact && !is_small && self.channels.iter().any(follows) && !self.leaves_friction()
    }
}

impl ChannelFit {
    /// Whether the base model leaves more than noise of it.
    pub fn has_gap(&self) -> bool {
        self.is_beyond_noise(self.rms_before)
    }

    /// Whether the effects leave more than noise of it.
    pub fn has_rest(&self) -> bool {
        self.is_beyond_noise(self.rms_after)
    }

    fn is_beyond_noise(&self, rms: f64) -> bool {
        is_beyond_noise(rms / self.noise, self.before.len())
    }
}

/// Whether a root mean square over that of the noise is more than so many rows of noise have.
pub(crate) fn is_beyond_noise(of_noise: f64, rows: usize) -> bool {
    of_noise.powi(2) - 1.0 > gap(rows)
}

/// What a gap adds to the mean square of so many rows at least, in squares of noise.
pub(crate) fn gap(rows: usize) -> f64 {
    ALLOWED_REST + GAP_SDS * (2.0 / rows.max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thresholds::examine::PARTS;

    /// A joint whose effects leave 1.9 times its noise of 60, of which a share follows the posture.
    fn left(effect: &'static str, share_of_posture: f64, after_nats: f64) -> Examined {
        Examined {
            channels: vec![ChannelFit {
                joint: 0,
                rms_before: 60.0,
                rms_after: 1.9,
                noise: 1.0,
                scale: None,
                before: vec![0.0; 1000],
                after: vec![0.0; 1000],
                depends_on: Vec::new(),
                share_of_posture,
                share_of_friction: [0.0; 2],
            }],
            findings: vec![Finding {
                effect,
                joint: Some(0),
                change: None,
                nats: 1e5,
                numbers: Vec::new(),
                rivals: Vec::new(),
                is_told: true,
            }],
            before_nats: 1e5,
            after_nats,
            freedom: 1000.0,
            edge_hz: 20.0,
            of_stretches: None,
            numbers: 10,
            tried: 10,
            ..Examined::default()
        }
    }

    #[test]
    fn an_effect_that_undoes_another_is_no_answer() {
        let with = |nats: f64| {
            let mut found = left("torque-offset", 0.2, 600.0);
            let mut other = found.channels[0].clone();
            (other.joint, other.rms_before, other.rms_after) = (1, 1.05, 0.99);
            found.channels.push(other);
            let mut gain = found.findings[0].clone();
            (gain.effect, gain.joint, gain.nats) = ("torque-gain", Some(1), nats);
            found.findings.push(gain);
            found
        };
        // there were 51 nats, and 22 of chance, to explain
        assert!(with(250.0).is_adequate());
        assert!(!with(350.0).is_adequate());
    }

    #[test]
    fn several_effects_need_rows_that_no_fit_saw_and_make_no_gap_of_them() {
        let with = |effects: usize, seen: &[(usize, f64, f64)]| {
            let mut found = left("stribeck-friction", 0.2, 600.0);
            let further = found.findings[0].clone();
            found.findings.resize(effects, further);
            let mut other = found.channels[0].clone();
            (other.joint, other.rms_before, other.rms_after) = (1, 1.0, 1.0);
            found.channels.push(other);
            let unseen = seen.iter().map(|(joint, before, after)| {
                let rows = if before.is_nan() { 0 } else { 100 };
                let sum = |square: f64| if rows == 0 { 0.0 } else { 100.0 * square };
                Unseen {
                    rows: [rows; PARTS],
                    before: [sum(*before); PARTS],
                    after: [sum(*after); PARTS],
                    ..Unseen::new(*joint, 1.0)
                }
            });
            Examined {
                unseen: unseen.collect(),
                ..found
            }
            .is_adequate()
        };
        let none = f64::NAN;
        assert!(with(2, &[(0, 3600.0, 1.0), (1, 1.0, 1.0)]));
        assert!(!with(2, &[(0, none, none), (1, 1.0, 1.0)]), "not predicted");
        assert!(with(1, &[(0, none, none), (1, 1.0, 1.0)]), "one effect");
        assert!(!with(1, &[(0, 3600.0, 1.0), (1, 1.0, 9.0)]), "a new gap");
    }

    #[test]
    fn an_effect_that_may_be_freedom_spoils_a_name_unless_it_is_small() {
        let with = |nats: f64, is_told: bool| {
            let mut found = left("payload", 0.2, 600.0);
            let armature = Finding {
                effect: "armature",
                nats,
                is_told,
                ..found.findings[0].clone()
            };
            found.findings.push(armature);
            found.is_adequate()
        };
        assert!(with(900.0, false));
        assert!(!with(1100.0, false));
        assert!(with(1100.0, true));
    }

    #[test]
    fn an_effect_beside_a_fault_of_the_log_is_borne_out_by_a_second_recording_alone() {
        let with = |before: f64, left_of_second: Option<f64>| {
            let mut found = left("presliding", 0.2, 3e4);
            let mut fault = found.findings[0].clone();
            (fault.effect, fault.joint) = (SAMPLING, None);
            found.findings.insert(0, fault);
            found.unseen = vec![Unseen {
                rows: [10; PARTS],
                before: [10.0 * before; PARTS],
                after: [10.0; PARTS],
                predictions: vec![(0, [0.0; 3])],
                ..Unseen::new(0, 1.0)
            }];
            Examined {
                left_of_second,
                ..found
            }
        };
        let borne_out = with(100.0, None);
        assert!(!borne_out.is_adequate() && borne_out.is_borne_out());
        assert!(with(100.0, Some(0.08)).is_borne_out());
        assert!(!with(100.0, Some(0.3)).is_borne_out());
        // a second recording without a gap says nothing
        assert!(!with(1.0, None).is_borne_out());
        let alone = Examined {
            findings: borne_out.findings[1..].to_vec(),
            ..borne_out
        };
        assert!(!alone.is_borne_out());
    }

    #[test]
    fn an_effect_of_one_law_leaves_nothing_that_follows_the_posture() {
        assert!(!left("torque-offset", 0.9, 600.0).is_adequate());
        assert!(left("torque-offset", 0.2, 600.0).is_adequate());
        // friction has many laws
        assert!(left("stribeck-friction", 0.9, 600.0).is_adequate());
        // next to nothing is left of the gap: the bodies that carry what is put on are off themselves
        for effect in ["gravity-spring", "payload"] {
            assert!(!left(effect, 0.9, 600.0).is_adequate());
            assert!(left(effect, 0.9, 50.0).is_adequate());
        }
    }
}
