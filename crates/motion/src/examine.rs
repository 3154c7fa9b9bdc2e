//! One recording from torques to what they show.

use haptical_linalg::dot;
use haptical_model::{Device, Recording};

use crate::MotionError;
use crate::arm::Arm;
use crate::change::Change;
use crate::dependence::{Dependence, dependences, share_of_posture};
use crate::effect::{
    CONTACT, ENCODER_LATENCY, GRAVITY_DIRECTION, GRAVITY_SPRING, JOINT_SPRING, is_exact,
    is_of_own_joint,
};
use crate::findings::{SAMPLING, findings};
use crate::fit::base::{Base, Term};
use crate::fit::problem::{Problem, Reading, is_still};
use crate::later::Later;
use crate::scale::{Doubt, Scale, doubts};
use crate::select::{Fitted, Pick, Selection, select};
use crate::survey::usable;
use crate::unseen::{Unseen, within};

/// A channel's rest is a gap beyond this multiple of the square of its noise, and beyond `GAP_SDS` standard deviations of such a
/// square by chance: a sound arm's friction is no law to the last digit.
const GAP: f64 = 1.21;
const GAP_SDS: f64 = 4.0;
/// Rivals nearer than this are not told apart: ln 100 (Kass & Raftery 1995) \[nats\].
const NOT_TOLD_APART: f64 = 4.605;
/// Share of what the base model leaves beyond noise that effects may leave.
const UNEXPLAINED: f64 = 0.02;
/// And of each joint's root mean square, beyond twice its noise.
const LEFT: f64 = 0.1;
const QUIET: f64 = 2.0;
/// Edges of the band in which a spring between motor and link is looked for once more \[Hz\].
const SPRING_EDGES_HZ: [f64; 2] = [8.0, 5.0];
/// An effect whose law is exact leaves noise of a torque's dependence on the posture: more than this share of a rest is another law's.
const OF_POSTURE: f64 = 0.5;
/// But a spring's, whose levers are not known, may leave this share of the gap, and so may a tilt's, which bodies feel that are off themselves.
const OF_SPRING: f64 = 1e-3;
/// A noise with a memory is at most this many times a white one that is as large at its fastest: more is a disturbance of a colour of its own.
const MOST_OF_MEMORY: f64 = 4.0;
/// A joint with less than this share of the gap may keep it: that is a gap of its own beside the one that has a name.
const PART: f64 = 0.01;

/// Share of a second recording's squares beyond noise that effects may leave of it; beside a spring between motor and link, which is known to
/// first order alone.
const OF_SECOND: f64 = 0.1;
const OF_SECOND_BESIDE_SPRING: f64 = 0.6;
/// Effects that a second recording may refute, until no more are looked for in their place.
const MOST_REFUTED: usize = 4;

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
    /// Numbers of the base model.
    pub numbers: usize,
    /// Effects at places that were tried.
    pub tried: usize,
    /// Torques of rows that were not fitted: of the second recording, where there is one; of parts that were left out in turn,
    /// where effects were found; else none.
    pub unseen: Vec<Unseen>,
    /// Why the second recording is not among them.
    pub second: Option<MotionError>,
    /// Effects and joints (from 0) that explained something of the log, and made the second recording's torques less well predicted: they were
    /// left out.
    pub refuted: Vec<(&'static str, Option<usize>)>,
    /// Share of the second recording's squares beyond noise that the effects leave; none where they leave noise, or were not checked on it.
    pub left_of_second: Option<f64>,
    /// Joints whose armature no device file states, with the one that was fitted \[kg m^2\].
    pub free_armatures: Vec<(usize, f64)>,
    /// Whether the noise of the torques was taken to have a memory: a white one leaves a gap without a name.
    pub has_memory: bool,
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
        self.behind_nats < NOT_TOLD_APART
    }
}

impl Examined {
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
        let holds = move |own: &&ChannelFit| energy(own) > PART * whole;
        let keeps =
            |own: &&ChannelFit| own.rms_after > (QUIET * own.noise).max(LEFT * own.rms_before);
        self.channels.iter().filter(holds).filter(keeps)
    }

    /// Whether the effects explain the gap; a joint with a small part of it may keep that ([`ChannelFit::has_rest`]).
    pub fn is_adequate(&self) -> bool {
        let is_quiet = !self.channels.iter().any(ChannelFit::has_rest);
        let is_explained = self.unexplained_share() <= UNEXPLAINED && self.kept().next().is_none();
        self.doubts.is_empty()
            && self
                .findings
                .iter()
                .any(|own| self.is_where_the_gap_is(own))
            && (self.findings.iter())
                .all(|own| own.is_told || own.rivals.iter().any(NearRival::is_near))
            && (is_quiet || is_explained)
            && !self.is_of_another_law()
            && !self.is_contradicted()
    }

    /// Whether the effects leave more of a second recording's gap than they may.
    pub fn is_contradicted(&self) -> bool {
        // a spring between motor and link is known to first order alone
        let has_spring = self.findings.iter().any(|own| own.effect == JOINT_SPRING);
        let most = match has_spring {
            true => OF_SECOND_BESIDE_SPRING,
            false => OF_SECOND,
        };
        self.left_of_second.is_some_and(|left| left > most)
    }

    /// Whether an effect acts on a channel that shows more than noise, if any does: what it explains elsewhere explains no gap.
    fn is_where_the_gap_is(&self, found: &Finding) -> bool {
        let joint = found.joint.filter(|_| is_of_own_joint(found.effect));
        let is_there = |own: &ChannelFit| joint.is_none_or(|joint| joint == own.joint);
        let mut gaps = self.channels.iter().filter(|own| own.has_gap()).peekable();
        gaps.peek().is_none() || gaps.any(is_there)
    }

    /// Whether weights, springs, offsets and factors alone were found, whose laws are exact, and a rest still follows the posture: then
    /// they only look like what is there.
    fn is_of_another_law(&self) -> bool {
        let acts = |found: &Finding, joint: usize| found.joint.is_none_or(|own| own == joint);
        let are_exact = |joint: usize| {
            let mut all = self.findings.iter();
            all.all(|own| is_exact(own.effect) || !acts(own, joint))
        };
        let follows = |own: &ChannelFit| {
            own.has_rest() && own.share_of_posture > OF_POSTURE && are_exact(own.joint)
        };
        let is_loose = |own: &Finding| [GRAVITY_SPRING, GRAVITY_DIRECTION].contains(&own.effect);
        let of_springs = self.findings.iter().all(is_loose);
        let is_small = of_springs && self.unexplained_share() < OF_SPRING;
        let exact = self.findings.iter().any(|own| is_exact(own.effect));
        exact && !is_small && self.channels.iter().any(follows)
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
fn gap(rows: usize) -> f64 {
    GAP - 1.0 + GAP_SDS * (2.0 / rows.max(1) as f64).sqrt()
}

/// Whether a device and a recording are those of a moving arm: its file gives the mass and the inertia of every row, and the recording has
/// torques in time, of a motion, without a hand's force.
pub fn is_moving_arm(device: &Device, recording: &Recording) -> bool {
    let has_torques = (recording.torque_nm.iter().flatten().flatten()).any(|own| own.is_finite());
    has_torques && recording.force_n.is_none() && usable(device, recording).is_ok()
}

/// Examines the torques of a motion, and what is found on a second recording, if there is one; `without`: names of effects that are left
/// out.
///
/// # Errors
/// [`MotionError`] for a recording that says nothing of a moving arm.
pub fn examine(
    device: &Device,
    recording: &Recording,
    second: Option<&Recording>,
    without: &[String],
) -> Result<Examined, MotionError> {
    let first = examine_with(device, (recording, second), without, Reading::default())?;
    // what only looks like an effect still does beside a larger noise
    if !first.has_gap()
        || first.is_adequate()
        || first.is_of_another_law()
        || !first.doubts.is_empty()
    {
        return Ok(first);
    }
    // a push at the flange that explains a part may be one at a tool
    if first.findings.iter().any(|own| own.effect == CONTACT) {
        let at_tool = Reading {
            at_tool: true,
            ..Reading::default()
        };
        let again = examine_with(device, (recording, second), without, at_tool)?;
        if again.is_adequate() {
            return Ok(again);
        }
    }
    // a noise with a memory may be all of a gap that has no name
    let with_memory = Reading {
        has_memory: true,
        ..Reading::default()
    };
    let again = examine_with(device, (recording, second), without, with_memory)?;
    let mut noises = first.channels.iter().zip(&again.channels);
    let is_noise = noises.all(|(white, own)| own.noise < MOST_OF_MEMORY * white.noise);
    if is_noise && !again.has_gap() || again.has_gap() && again.is_adequate() {
        return Ok(again);
    }
    // a spring between motor and link is known to first order alone, well below its resonance
    for edge_hz in SPRING_EDGES_HZ
        .into_iter()
        .filter(|own| *own < first.edge_hz)
    {
        let slower = Reading {
            edge_hz: Some(edge_hz),
            ..Reading::default()
        };
        let slow = examine_with(device, (recording, second), without, slower)?;
        let is_spring = |own: &Finding| own.effect == JOINT_SPRING;
        if slow.is_adequate() && slow.findings.iter().all(is_spring) {
            return Ok(Examined {
                above_hz: Some(edge_hz),
                ..slow
            });
        }
    }
    Ok(first)
}

fn examine_with(
    device: &Device,
    (recording, second): (&Recording, Option<&Recording>),
    without: &[String],
    reading: Reading,
) -> Result<Examined, MotionError> {
    let mut arm = Arm::new(device)?;
    let reading = Reading {
        sets_right: !without.iter().any(|name| name == SAMPLING),
        ..reading
    };
    let mut problem = Problem::new(arm.clone(), recording, reading)?;
    let mut base = Base::weighted(&mut problem);
    if let Some(likely) = base.likely_armature(&problem) {
        arm.likely_armature = likely;
        let reading = Reading {
            edge_hz: Some(problem.states.pass.edge_hz),
            ..reading
        };
        problem = Problem::new(arm.clone(), recording, reading)?;
        base = Base::weighted(&mut problem);
    }
    let of_channel =
        |(channel, joint): (usize, &usize)| (*joint, Scale::of(&problem, &base, channel));
    let scales: Vec<(usize, Scale)> = problem
        .channels
        .iter()
        .enumerate()
        .map(of_channel)
        .collect();
    if scales.iter().all(|(_, own)| own.is_noise()) && doubts(&scales).is_empty() {
        return Err(MotionError::Noise);
    }
    let later = second.map(|second| Later::new(&arm, second, (&problem, &base)));
    let mut refuted = Vec::new();
    let selection = loop {
        let mut selection = select(&problem, &base, without, &refuted);
        // in a narrower band the gap that was seen in the whole one is looked for again
        if reading.edge_hz.is_none() {
            selection = shown(&problem, selection);
        }
        let further = match &later {
            Some(Ok(later)) if refuted.len() < MOST_REFUTED => {
                later.refuted((&problem, &base), &selection)
            }
            _ => Vec::new(),
        };
        if further.is_empty() {
            break selection;
        }
        refuted.extend(further);
    };
    let (unseen, why) = match later {
        Some(Ok(later)) => (later.unseen(&selection), None),
        Some(Err(why)) => (within(&problem, &base, &selection), Some(why)),
        None => (within(&problem, &base, &selection), None),
    };
    let is_checked = second.is_some() && why.is_none();
    let left_of_second = (is_checked
        && !selection.picks.is_empty()
        && selection.picks.iter().all(|own| !own.is_of_recording))
    .then(|| left_of(&unseen))
    .flatten();
    Ok(Examined {
        unseen,
        second: why,
        refuted,
        left_of_second,
        ..examined(&problem, &base, (&selection, &scales))
    })
}

/// Share of a second recording's squares beyond noise that effects leave of it; none where they leave no more than noise of any joint's torque.
fn left_of(unseen: &[Unseen]) -> Option<f64> {
    let sums = |own: &Unseen| {
        let rows: usize = own.rows.iter().sum();
        let of_noise = |sums: &[f64]| sums.iter().sum::<f64>() / own.noise.powi(2);
        (rows, of_noise(&own.before), of_noise(&own.after))
    };
    let is_left = |own: &Unseen| {
        let (rows, _, after) = sums(own);
        is_beyond_noise((after / rows.max(1) as f64).sqrt(), rows)
    };
    unseen.iter().find(|own| is_left(own))?;
    let [before, after] = unseen.iter().fold([0.0; 2], |[before, after], own| {
        let (rows, of_before, of_after) = sums(own);
        [
            before + of_before - rows as f64,
            after + of_after - rows as f64,
        ]
    });
    Some(after.max(0.0) / before.max(1.0))
}

/// What was selected, where a channel has a gap, the effects take as much off one as a gap is, or the law of all is exact; else nothing: what
/// friction and ripple explain beside noise by less is that a sound arm's are no law to the last digit.
fn shown(problem: &Problem, selection: Selection) -> Selection {
    let rows = problem.states.rows();
    let squares = |fitted: &Fitted| -> Vec<f64> {
        let channels = fitted.solved.rest.chunks(rows);
        channels.map(|own| dot(own, own) / rows as f64).collect()
    };
    let (before, after) = (squares(&selection.bare), squares(&selection.fitted));
    let has_gap = before.iter().any(|own| is_beyond_noise(own.sqrt(), rows));
    let mut both = before.iter().zip(&after);
    let is_exact = |own: &Pick| is_exact(own.effect) || own.effect == ENCODER_LATENCY;
    if has_gap
        || selection.picks.iter().all(is_exact)
        || both.any(|(before, after)| before - after > gap(rows))
    {
        return selection;
    }
    Selection {
        picks: Vec::new(),
        fitted: selection.bare.clone(),
        early_s: 0.0,
        ..selection
    }
}

fn examined(
    problem: &Problem,
    base: &Base,
    (selection, scales): (&Selection, &[(usize, Scale)]),
) -> Examined {
    let rows = problem.states.rows();
    let (before, after) = (&selection.bare.solved.rest, &selection.fitted.solved.rest);
    let channels = problem
        .channels
        .iter()
        .enumerate()
        .map(|(channel, &joint)| {
            let noise = problem.row_sd[channel];
            let own = |rest: &[f64]| -> Vec<f64> {
                rest[channel * rows..][..rows]
                    .iter()
                    .map(|own| noise * own)
                    .collect()
            };
            let rms = |rest: &[f64]| (dot(rest, rest) / rows as f64).sqrt();
            let (before, after) = (own(before), own(after));
            let mut fit = ChannelFit {
                joint,
                rms_before: rms(&before),
                rms_after: rms(&after),
                noise,
                scale: Some(scales[channel].1),
                before,
                after,
                depends_on: Vec::new(),
                share_of_posture: 0.0,
            };
            if fit.has_gap() {
                fit.depends_on = dependences(problem, base, &selection.bare, joint);
            }
            if fit.has_rest() {
                fit.share_of_posture = share_of_posture(problem, &selection.fitted, joint);
            }
            fit
        });
    let solution = &selection.fitted.solved.solution;
    let free = base
        .columns
        .iter()
        .zip(solution)
        .filter_map(|(own, value)| match own.term {
            Term::Armature { joint } if own.known_sd.is_none() => Some((joint, *value)),
            _ => None,
        });
    let centres = problem.states.centre.iter();
    let fastest = |dq: &Vec<f64>| dq.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
    let fastest: Vec<f64> = problem.states.motor.dq.iter().map(fastest).collect();
    let most = fastest.iter().copied().fold(0.0, f64::max);
    Examined {
        channels: channels.collect(),
        findings: findings(problem, selection),
        before_nats: selection.bare.excess,
        after_nats: selection.fitted.excess,
        freedom: selection.fitted.freedom,
        edge_hz: problem.states.pass.edge_hz,
        numbers: base.columns.len(),
        tried: selection.tried,
        unseen: Vec::new(),
        second: None,
        refuted: Vec::new(),
        left_of_second: None,
        free_armatures: free.collect(),
        has_memory: problem.has_memory,
        above_hz: None,
        jitter: problem.samples.jitter,
        is_stamped_late: problem.samples.is_stamped_late,
        early_s: early_s(base, selection),
        doubts: doubts(scales),
        constant: (0..problem.arm.joints())
            .filter_map(|joint| Some((joint, problem.samples.constant_torque(joint)??)))
            .collect(),
        still: (0..fastest.len())
            .filter(|joint| is_still(fastest[*joint], most))
            .collect(),
        fastest,
        time_s: centres.map(|step| problem.states.time_s[*step]).collect(),
    }
}

/// How long the torques are logged before their positions, within what a sound arm's may be and beyond.
fn early_s(base: &Base, selection: &Selection) -> f64 {
    let numbers = base.columns.iter().zip(&selection.fitted.solved.solution);
    let within = numbers.filter(|(own, _)| matches!(own.term, Term::Delay));
    selection.early_s + within.map(|own| own.1).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

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
            numbers: 10,
            tried: 10,
            ..Examined::default()
        }
    }

    #[test]
    fn an_effect_of_one_law_leaves_nothing_that_follows_the_posture() {
        assert!(!left("torque-offset", 0.9, 600.0).is_adequate());
        assert!(!left("torque-offset", 0.9, 50.0).is_adequate());
        assert!(left("torque-offset", 0.2, 600.0).is_adequate());
        // friction has many laws, a spring levers of its own
        assert!(left("stribeck-friction", 0.9, 600.0).is_adequate());
        assert!(!left("gravity-spring", 0.9, 600.0).is_adequate());
        assert!(left("gravity-spring", 0.9, 50.0).is_adequate());
    }
}
