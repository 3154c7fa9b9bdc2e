//! One factor on all torques, and a joint's zero that is off.

use anyhow::{Context, Result, bail};

use super::felt::{FELT, held, largest_apart};
use super::{ARMS, Tale, any, plan, words};
use crate::moving::scene::placed_on;
use crate::moving::trial::{Built, build};
use crate::planted::Planted;
use crate::random::Random;
use crate::rig::readings::rounded;
use crate::trial::{Trial, TrialId};
use crate::truth::Besides;

/// Factors on torques: below and above what a sound scale is off by.
const BELOW: [f64; 2] = [0.5, 0.9];
const ABOVE: [f64; 2] = [1.1, 4.0];
/// Outside of these factors a refusal is right, too.
const REFUSED: [f64; 2] = [0.6, 2.0];
/// A refusal says this of the torques' unit.
const OF_UNIT: [&str; 4] = ["another unit", "other unit", "wrong unit", "in N mm"];
/// Angles by which a zero is off \[rad\].
pub(crate) const ZERO_RAD: [f64; 2] = [0.03, 0.15];
/// Arms and zeros that are drawn until one is felt.
const DRAWS: usize = 500;
/// Digits of a log.
const ANGLE_STEPS: f64 = 1e6;
const TORQUE_STEPS: f64 = 1e3;

pub(super) fn scale(number: usize, id: TrialId, random: &mut Random) -> Result<Trial> {
    let built = any(None, random)?;
    let mut logs = built.logs(random);
    let [low, high] = if number.is_multiple_of(3) {
        BELOW
    } else {
        ABOVE
    };
    let middle = libm::sqrt(low * high);
    let factor = random.around(middle, high / low);
    for torque in logs.iter_mut().flat_map(|log| &mut log.torque_nm).flatten() {
        for reading in torque {
            *reading = rounded(*reading * factor, TORQUE_STEPS);
        }
    }
    let is_far = !(REFUSED[0]..=REFUSED[1]).contains(&factor);
    let tale = Tale {
        label: "scale".to_owned(),
        planted: vec![Planted {
            name: "torque-gain",
            right: vec!["torque-gain"],
            law: [("factor".to_owned(), factor)].into(),
            ..Planted::default()
        }],
        besides: Besides {
            is_of_whole: true,
            refusals: if is_far { words(&OF_UNIT) } else { Vec::new() },
            ..Besides::default()
        },
        ..Tale::default()
    };
    tale.trial(id, &built.scene, logs)
}

/// An arm, a joint of it whose zero is off by an angle, and how much the torques feel of it.
pub(crate) struct Zero {
    pub(crate) built: Built,
    pub(crate) joint: usize,
    pub(crate) off_rad: f64,
    pub(crate) felt: f64,
}

/// Every second zero is one that the torques feel.
pub(crate) fn with_zero(number: usize, random: &mut Random) -> Result<Zero> {
    let plan = plan(None);
    for _ in 0..DRAWS {
        let (mut scene, joints) = placed_on(&ARMS, &plan, 0.0, random)?;
        // an encoder behind the drive has its own zero
        scene.sensors.has_outputs = false;
        let axes = scene.arm.axes.iter().enumerate();
        let turning: Vec<usize> = axes
            .filter(|(_, axis)| !axis.slides)
            .map(|(joint, _)| joint)
            .collect();
        let joint = random.choose(&turning).context("no joint turns")?;
        let off_rad = random.sign() * random.uniform(ZERO_RAD[0], ZERO_RAD[1]);
        let [right, wrong] = [0.0, off_rad].map(|off_rad| held(&scene, joint, off_rad));
        let felt = largest_apart(scene.arm, &right, &wrong);
        if number.is_multiple_of(2) || felt >= FELT {
            return Ok(Zero {
                built: build(&plan, (scene, joints), random)?,
                joint,
                off_rad,
                felt,
            });
        }
    }
    bail!("no zero is felt by the torques")
}

pub(super) fn zero(number: usize, id: TrialId, random: &mut Random) -> Result<Trial> {
    let Zero {
        built,
        joint,
        off_rad,
        felt,
    } = with_zero(number, random)?;
    let mut logs = built.logs(random);
    let command = format!("command{}_rad", joint + 1);
    for log in &mut logs {
        let commands = log.covariates.iter_mut();
        let own = commands.filter(|(name, _)| *name == command);
        let columns = own.map(|(_, column)| column);
        for column in columns.chain([&mut log.joint[joint]]) {
            for angle in column {
                *angle = rounded(*angle + off_rad, ANGLE_STEPS);
            }
        }
    }
    let right = match joint {
        0 => vec!["joint-offset", "gravity-direction"],
        _ => vec!["joint-offset"],
    };
    let tale = Tale {
        label: "zero".to_owned(),
        planted: vec![Planted {
            name: "joint-offset",
            joint: Some(joint),
            right,
            law: named!(off_rad, felt)
                .map(|(name, value)| (name.to_owned(), value))
                .into(),
            ..Planted::default()
        }],
        no_gap_is_right: joint == 0 || felt < FELT,
        ..Tale::default()
    };
    tale.trial(id, &built.scene, logs)
}
