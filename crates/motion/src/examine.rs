//! One recording from torques to what they show.

use haptical_linalg::dot;
use haptical_model::{Device, Recording};

use crate::MotionError;
use crate::adjusted::{adjusted, as_described, bodies};
use crate::arm::Arm;
use crate::dependence::{dependences, share_of_friction, share_of_posture};
use crate::effect::delay::ENCODER_LATENCY;
use crate::effect::{is_calibration, is_exact};
use crate::examined::{ChannelFit, Examined, Finding, gap, is_beyond_noise};
use crate::findings::{SAMPLING, findings};
use crate::fit::base::{Base, Term};
use crate::fit::problem::{Problem, Reading, is_still, noise_with_memory, oscillations};
use crate::later::Later;
use crate::recorded::Logs;
use crate::scale::{Scale, doubts};
use crate::select::{Fitted, Pick, Selection, select};
use crate::signal::memory::is_even;
use crate::signal::noise::Noise;
use crate::survey::usable;
use crate::thresholds::examine::{
    ALL_FRICTION, MOST_OF_MEMORY, MOST_REFUTED, PARTS, SPRING_EDGES_HZ,
};
use crate::unseen::{Unseen, within};
use crate::without_gravity::lacks_gravity;
use crate::zeros;

/// Whether a device and a recording are those of a moving arm: its file gives the mass and the inertia of every row, and the recording has
/// torques in time, of a motion.
pub fn is_moving_arm(device: &Device, recording: &Recording) -> bool {
    let has_torques = (recording.torque_nm.iter().flatten().flatten()).any(|own| own.is_finite());
    has_torques && usable(device, recording).is_ok()
}

/// Examines the torques of a motion, and what is found on a second recording, if there is one; `without`: names of effects that are left
/// out. What the device's effects add to the torques ([`Recording::added`]) is part of the base model; shares of the readings themselves are
/// taken off them.
///
/// # Errors
/// [`MotionError`] for a recording that says nothing of a moving arm.
pub fn examine(
    device: &Device,
    recording: &Recording,
    second: Option<&Recording>,
    without: &[String],
) -> Result<Examined, MotionError> {
    let logs = Logs::new(device, recording, second);
    let mut found = examined_each(device, &logs, without)?;
    if found.findings.first().is_some_and(Finding::is_of_sampling) {
        let mut others = without.to_vec();
        others.push(SAMPLING.to_owned());
        let as_read = examine_with(
            device,
            &Logs::new(device, recording, None),
            &others,
            Reading::default(),
        );
        found.set_right = as_read.map_or_else(|_| Vec::new(), |own| set_right(&own, &found));
    }
    if !found.is_adequate() || !found.findings.iter().any(Finding::is_push) {
        return Ok(found);
    }
    // a push that the second recording has no part of leaves it a gap, which has to be one of its own kind
    let seen = second.filter(|_| found.second.is_none() && left_of(&found.unseen).is_some());
    let contradicts = seen.is_some_and(|second| {
        let own = examined_each(device, &Logs::new(device, second, None), without);
        own.is_ok_and(|own| !own.is_adequate() || !own.findings.iter().any(Finding::is_push))
    });
    Ok(Examined {
        is_push_contradicted: contradicts,
        ..found
    })
}

/// What a recording shows, in the ways of looking at it that there are.
fn examined_each(
    device: &Device,
    logs: &Logs,
    without: &[String],
) -> Result<Examined, MotionError> {
    let first = examine_with(device, logs, without, Reading::default())?;
    // what only looks like an effect still does beside a larger noise
    if !first.has_gap()
        || first.is_adequate()
        || first.is_of_another_law()
        || !first.doubts.is_empty()
    {
        return Ok(first);
    }
    // a push at the flange that explains a part may be one at a tool
    if first.findings.iter().any(Finding::is_push) {
        let at_tool = Reading {
            at_tool: true,
            ..Reading::default()
        };
        let again = examine_with(device, logs, without, at_tool)?;
        if again.is_adequate() {
            return Ok(again);
        }
    }
    // a noise with a memory may be all of a gap that has no name
    if !first.may_have_memory.is_empty() {
        let with_memory = Reading {
            memories: first.may_have_memory.as_slice().into(),
            ..Reading::default()
        };
        let again = examine_with(device, logs, without, with_memory)?;
        let mut noises = first.channels.iter().zip(&again.channels);
        let is_noise = noises.all(|(white, own)| own.noise < MOST_OF_MEMORY * white.noise);
        if is_noise && (!again.has_gap() || again.is_adequate()) {
            return Ok(again);
        }
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
        let slow = examine_with(device, logs, without, slower)?;
        if slow.is_adequate() && slow.findings.iter().all(Finding::is_joint_spring) {
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
    logs: &Logs,
    without: &[String],
    reading: Reading,
) -> Result<Examined, MotionError> {
    let mut arm = Arm::new(device)?;
    let reading = Reading {
        sets_right: !without.iter().any(|name| name == SAMPLING),
        ..reading
    };
    let (recording, second) = (&logs.log, logs.second.as_ref());
    let mut problem = Problem::new(arm.clone(), recording, reading.clone())?;
    let mut base = Base::weighted(&mut problem);
    if let Some(likely) = base.likely_armature(&problem) {
        arm.likely_armature = likely;
        let reading = Reading {
            edge_hz: Some(problem.states.pass.edge_hz),
            ..reading.clone()
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
    let (selection, found) = loop {
        let mut selection = select(&problem, &base, without, &refuted);
        // in a narrower band the gap that was seen in the whole one is looked for again
        if reading.edge_hz.is_none() {
            selection = shown(&problem, selection);
        }
        let of_band = Reading {
            edge_hz: Some(problem.states.pass.edge_hz),
            ..reading.clone()
        };
        zeros::refit(
            &arm,
            (recording, of_band),
            &mut selection.picks,
            selection.misfit,
        );
        let found = examined(&problem, &base, (&selection, &scales));
        // beside a gap that is not explained what one effect adds says little of it
        let further = match &later {
            Some(Ok(later)) if refuted.len() < MOST_REFUTED && found.is_adequate() => {
                later.predicted(&selection).refuted((&problem, &base))
            }
            _ => Vec::new(),
        };
        if further.is_empty() {
            break (selection, found);
        }
        refuted.extend(further);
    };
    let (unseen, why) = match later {
        Some(Ok(later)) => (later.predicted(&selection).unseen((&problem, &base)), None),
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
        ..found
    })
}

/// Share of a second recording's squares beyond noise that effects leave of it; none where they leave no more than noise of any joint's torque.
fn left_of(unseen: &[Unseen]) -> Option<f64> {
    let sums = |own: &Unseen| {
        let rows = own.rows_in_all();
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

/// What the base model leaves of torques as they are read, and once rows are set right.
fn set_right(as_read: &Examined, found: &Examined) -> Vec<Unseen> {
    let by_parts = |rest: &[f64]| {
        let mut sums = ([0.0; PARTS], [0; PARTS]);
        for (row, own) in rest.iter().enumerate() {
            let part = row * PARTS / rest.len();
            sums.0[part] += own * own;
            sums.1[part] += 1;
        }
        sums
    };
    let of_joint = |own: &ChannelFit| {
        let as_read = as_read
            .channels
            .iter()
            .find(|other| other.joint == own.joint)?;
        let (before, rows) = by_parts(&as_read.before);
        let (mut after, rows_after) = by_parts(&own.before);
        // the rows that are left are fewer
        for (sum, (rows, own)) in after.iter_mut().zip(rows.iter().zip(&rows_after)) {
            *sum *= *rows as f64 / (*own).max(1) as f64;
        }
        Some(Unseen {
            rows,
            before,
            after,
            ..Unseen::new(own.joint, own.noise)
        })
    };
    found.channels.iter().filter_map(of_joint).collect()
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
    let is_exact = |own: &Pick| {
        (is_exact(own.effect) && !is_calibration(own.effect, &own.numbers))
            || own.effect == ENCODER_LATENCY.name
    };
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

/// What is left of each torque, and with all effects, and of all of them beyond noise \[nats\].
fn channels(
    problem: &Problem,
    base: &Base,
    (selection, scales): (&Selection, &[(usize, Scale)]),
) -> (Vec<ChannelFit>, f64) {
    let rows = problem.states.rows();
    let (before, mut after) = (
        &selection.bare.solved.rest,
        selection.fitted.solved.rest.clone(),
    );
    let in_model = dot(&after, &after);
    selection.put_in_readings(problem, &mut after);
    let after_nats = selection.fitted.excess + 0.5 * (dot(&after, &after) - in_model);
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
            let (before, after) = (own(before), own(&after));
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
                share_of_friction: [0.0; 2],
            };
            if fit.has_gap() {
                fit.depends_on = dependences(problem, base, &selection.bare, joint);
            }
            fit.share_of_friction = [
                (fit.has_gap(), &selection.bare),
                (fit.has_rest(), &selection.fitted),
            ]
            .map(|(is_any, fitted)| match is_any {
                true => share_of_friction(problem, base, fitted, joint),
                false => 0.0,
            });
            if fit.has_rest() {
                fit.share_of_posture = share_of_posture(problem, &selection.fitted, joint);
            }
            fit
        });
    (channels.collect(), after_nats)
}

fn examined(
    problem: &Problem,
    base: &Base,
    (selection, scales): (&Selection, &[(usize, Scale)]),
) -> Examined {
    let rows = problem.states.rows();
    let (channels, after_nats) = channels(problem, base, (selection, scales));
    let may_have_memory = may_have_memory(problem, &channels);
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
    let [repeated_rows, behind_missing_rows] = problem.samples.set_right.clone();
    Examined {
        set_right: Vec::new(),
        repeated_rows,
        behind_missing_rows,
        channels,
        findings: findings(problem, selection),
        before_nats: selection.bare.excess,
        after_nats,
        freedom: selection.fitted.freedom,
        edge_hz: problem.states.pass.edge_hz,
        of_stretches: problem.states.of_stretches.clone(),
        numbers: base.columns.len(),
        tried: selection.tried,
        unseen: Vec::new(),
        second: None,
        refuted: Vec::new(),
        left_of_second: None,
        is_push_contradicted: false,
        free_armatures: free.collect(),
        adjusted: adjusted(base, &selection.fitted),
        bodies: bodies(&problem.arm, base, &selection.fitted),
        as_described: as_described(problem, base),
        other_friction: base.other_friction(solution, rows),
        lacks_gravity: selection.bare.excess > 0.0 && lacks_gravity(problem, &selection.bare),
        oscillations: oscillations(problem),
        memories: problem.memories.to_vec(),
        may_have_memory,
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

/// Channels with a rest that has the spectrum of a noise with a memory, and is as large at each speed, load and posture; none where a rest
/// has not, which is a gap.
fn may_have_memory(problem: &Problem, channels: &[ChannelFit]) -> Vec<(usize, Noise)> {
    if !problem.memories.is_empty() {
        return Vec::new();
    }
    let states = &problem.states;
    let at_rows = |own: &[f64], of: fn(f64) -> f64| -> Vec<f64> {
        states.centre.iter().map(|step| of(own[*step])).collect()
    };
    let noise = |own: &ChannelFit| {
        let joint = own.joint;
        let quantities = [
            at_rows(&states.motor.dq[joint], f64::abs),
            at_rows(&problem.rigid[joint], f64::abs),
            at_rows(&states.motor.q[joint], |q| q),
        ];
        let mut even = quantities.iter().map(|by| is_even(&own.after, by));
        let is_friction = own.share_of_friction[1] > ALL_FRICTION;
        match !is_friction && even.all(|is_even| is_even) {
            true => Some((joint, noise_with_memory(problem, joint, &own.after)?)),
            false => None,
        }
    };
    let with_rest = channels.iter().filter(|own| own.has_rest());
    let noises = with_rest.map(noise);
    noises.collect::<Option<Vec<_>>>().unwrap_or_default()
}
