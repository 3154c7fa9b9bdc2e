//! Logs of another arm with as many joints, one or both.

use anyhow::{Context, Result, bail};

use super::felt::{largest_apart, needed};
use super::{Tale, built, effect, words};
use crate::moving::arms::{Arm, OTHER_SEVEN, OTHER_SIX, SEVEN, SIX};
use crate::moving::trial::Built;
use crate::planted::Planted;
use crate::random::Random;
use crate::trial::{Trial, TrialId};
use crate::truth::Besides;

/// Every error is right.
const ANY: [&str; 1] = [""];
/// Torques of the two arms are this share of a range apart in a fiftieth of the moments, worst joint.
pub(crate) const LEAST_APART: f64 = 0.1;
/// Courses that are drawn until they are.
const DRAWS: usize = 20;

/// Of the file, and another one.
fn arms(random: &mut Random) -> Result<[&'static Arm; 2]> {
    let (own, others) = match random.unit() < 0.5 {
        true => (&SIX, &OTHER_SIX),
        false => (&SEVEN, &OTHER_SEVEN),
    };
    let other = random.index(others.len());
    let other = others.get(other).context("there is no other arm")?;
    Ok([own, other])
}

pub(super) fn draw(number: usize, id: TrialId, random: &mut Random) -> Result<Trial> {
    let [own, other] = arms(random)?;
    match number % 2 {
        0 => both(own, other, id, random),
        _ => second(own, other, number / 2, id, random),
    }
}

/// The other arm on a course along which the own one would need other torques, and how far they are apart.
fn apart(own: &Arm, other: &'static Arm, random: &mut Random) -> Result<(Built, f64)> {
    for _ in 0..DRAWS {
        let built = built(&[other], None, random)?;
        let [ours, theirs] = [own, other].map(|arm| needed(&built.scene, &arm.chain()));
        let apart = largest_apart(own, &ours, &theirs);
        if apart >= LEAST_APART {
            return Ok((built, apart));
        }
    }
    bail!("`{}` is like `{}`", other.name, own.name)
}

/// The other arm, as it was put in.
fn planted(other: &Arm, apart_of_range: f64) -> Planted {
    Planted {
        name: other.name,
        law: [("apart_of_range".to_owned(), apart_of_range)].into(),
        ..Planted::default()
    }
}

fn both(own: &Arm, other: &'static Arm, id: TrialId, random: &mut Random) -> Result<Trial> {
    let (built, apart) = apart(own, other, random)?;
    let logs = built.logs(random);
    let tale = Tale {
        label: "other-arm".to_owned(),
        planted: vec![planted(other, apart)],
        is_unknown: true,
        besides: Besides {
            refusals: words(&ANY),
            ..Besides::default()
        },
        ..Tale::default()
    };
    tale.trial_of(id, own, built.scene.sensors.has_outputs, logs)
}

/// The first log is of the arm in the file, clean or with a load.
fn second(
    own: &'static Arm,
    other: &'static Arm,
    number: usize,
    id: TrialId,
    random: &mut Random,
) -> Result<Trial> {
    let kind = match number % 2 {
        0 => None,
        _ => Some(effect(0)?),
    };
    let first = built(&[own], kind, random)?;
    let [log, _] = first.logs(random);
    let (mut later, apart) = apart(own, other, random)?;
    // the same columns
    let sensors = &first.scene.sensors;
    later.scene.sensors.has_command = sensors.has_command;
    later.scene.sensors.has_outputs = sensors.has_outputs;
    let [log2, _] = later.logs(random);
    let mut all = first.planted(kind);
    all.push(planted(other, apart));
    let tale = Tale {
        label: "other-second".to_owned() + kind.map_or("", |_| "+payload"),
        planted: all,
        besides: Besides {
            refusals: words(&ANY),
            unknown: true,
            second_is_foreign: true,
            ..Besides::default()
        },
        ..Tale::default()
    };
    tale.trial(id, &first.scene, [log, log2])
}
