//! What was found of commands, in the words of what torques are examined for.

use haptical_linalg::dot;

use super::fit::rest_of;
use super::rows::Rows;
use super::{Explained, NAME, Untracked};
use crate::MotionError;
use crate::examined::{ChannelFit, Examined, Finding};
use crate::thresholds::plausible;
use crate::unseen::Unseen;

pub(super) fn examined(
    found: &Explained,
    (late, nats): (&[usize], f64),
    is_named: bool,
    second: Option<Result<Rows, Untracked>>,
) -> Examined {
    let rows = &found.rows;
    let count = rows.count() as f64;
    let mut channels = Vec::new();
    let (mut before_nats, mut after_nats) = (0.0, 0.0);
    for at in 0..found.joints.len() {
        let index = found.joints[at].0;
        let noise = rows.noise[index];
        let scaled = |rest: Vec<f64>| {
            rest.into_iter()
                .map(|own| noise * own)
                .collect::<Vec<f64>>()
        };
        let is_late = late.contains(&at);
        // a delay that a sound arm may have is none
        let (before, after) = (found.fit(at, !is_late), found.fit(at, !is_late || is_named));
        before_nats += 0.5 * (before.square - count);
        after_nats += 0.5 * (after.square - count);
        let (before, after) = (scaled(before.rest), scaled(after.rest));
        let rms = |rest: &[f64]| (dot(rest, rest) / count).sqrt();
        channels.push(ChannelFit {
            joint: rows.joints[index],
            rms_before: rms(&before),
            rms_after: rms(&after),
            noise,
            scale: None,
            before,
            after,
            depends_on: Vec::new(),
            share_of_posture: 0.0,
            share_of_friction: [0.0; 2],
        });
    }
    let finding = |joint: Option<usize>, at: usize, nats: f64| {
        let (_, delay_s, sd_s) = found.joints[at];
        Finding {
            effect: NAME,
            joint,
            change: None,
            nats,
            numbers: vec![(
                "delay_s",
                delay_s,
                sd_s.hypot(plausible::OF_STEP * rows.step_s),
            )],
            rivals: Vec::new(),
            is_told: true,
        }
    };
    let is_of_all = found.is_shared && late.len() == found.joints.len();
    let findings = match (is_named, is_of_all) {
        (false, _) => Vec::new(),
        (true, true) => late
            .first()
            .map(|at| finding(None, *at, nats))
            .into_iter()
            .collect(),
        (true, false) => (late.iter())
            .map(|at| {
                finding(
                    Some(rows.joints[found.joints[*at].0]),
                    *at,
                    found.nats(&[*at]),
                )
            })
            .collect(),
    };
    let (unseen, why) = match second {
        Some(Ok(second)) => match on_second(found, late, &second) {
            Some(unseen) => (unseen, None),
            None => (Vec::new(), Some(short())),
        },
        Some(Err(_)) => (Vec::new(), Some(short())),
        None => (Vec::new(), None),
    };
    Examined {
        channels,
        findings,
        before_nats,
        after_nats,
        freedom: count * found.joints.len() as f64,
        edge_hz: rows.states.pass.edge_hz,
        numbers: found.joints.len(),
        tried: 1,
        unseen,
        second: why,
        jitter: rows.jitter,
        early_s: rows.early_s,
        time_s: rows
            .states
            .centre
            .iter()
            .map(|own| rows.states.time_s[*own])
            .collect(),
        ..Examined::default()
    }
}

fn short() -> MotionError {
    MotionError::Sampling("the second recording has too few rows with commands".to_owned())
}

/// A second recording's torques by the gains of the first, with the delay and without; none where it lacks joints.
fn on_second(found: &Explained, late: &[usize], second: &Rows) -> Option<Vec<Unseen>> {
    let signals = super::Signals::of(second).ok()?;
    let count = second.count();
    let row_of: Vec<usize> = second.row_of().collect();
    let mut all = Vec::new();
    for at in 0..found.joints.len() {
        let (index, delay_s, _) = found.joints[at];
        let joint = found.rows.joints[index];
        let there = second.joints.iter().position(|own| *own == joint)?;
        let (own_sd, sd) = (found.rows.noise[index], second.noise[there]);
        let rests = [!late.contains(&at), true].map(|is_as_found| {
            let delay_s = second.early_s + if is_as_found { delay_s } else { 0.0 };
            let equations = signals.equations(second, there, (found.law, delay_s));
            // columns and target are over the same noise: the numbers are the gains themselves
            rest_of(&equations, &found.fit(at, is_as_found).solution)
        });
        let mut own = Unseen::new(joint, own_sd.max(sd));
        for row in 0..count {
            let [before, after] = [0, 1].map(|k: usize| sd * rests[k][row]);
            let torque = second.torque[there][row];
            own.add((row, count), [before * before, after * after]);
            own.predictions
                .push((row_of[row], [torque, torque - before, torque - after]));
        }
        all.push(own);
    }
    Some(all)
}
