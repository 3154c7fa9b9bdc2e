//! Torque readings that are none: zeros, values that are held, wild ones, flipped signs.

use anyhow::Result;
use haptical_model::Recording;

use super::{Tale, any, effect};
use crate::moving::scene::Scene;
use crate::planted::Planted;
use crate::random::Random;
use crate::rig::readings::rounded;
use crate::trial::{Trial, TrialId};
use crate::truth::{Besides, Said};

/// Most rows in a row that are lost.
pub(crate) const LONGEST_BURST: usize = 4;
/// A column that is lost alone has a torque of at least so many standard deviations of its noise, root mean square.
const LEAST_OVER_NOISE: f64 = 10.0;
/// Digits of a torque.
const TORQUE_STEPS: f64 = 1e3;

/// What is read in the place of a reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Way {
    Zero,
    Held,
    Spiked,
    Flipped,
}

impl Way {
    const ALL: [Self; 4] = [Self::Zero, Self::Spiked, Self::Flipped, Self::Held];

    fn label(self) -> &'static str {
        match self {
            Self::Zero => "dropouts-zero",
            Self::Held => "dropouts-held",
            Self::Spiked => "dropouts-spiked",
            Self::Flipped => "dropouts-flipped",
        }
    }

    /// As the catalogue has it.
    fn name(self) -> &'static str {
        match self {
            Self::Zero | Self::Held => "dropouts",
            Self::Spiked | Self::Flipped => "outliers",
        }
    }
}

pub(super) fn draw(number: usize, id: TrialId, random: &mut Random) -> Result<Trial> {
    let way = Way::ALL[number / 2 % Way::ALL.len()];
    let kind = match number % 2 {
        0 => None,
        // payloads, and every other effect in turn
        _ if number % 4 == 1 => Some(effect(0)?),
        _ => Some(effect(number / 4 + 1)?),
    };
    let built = any(kind, random)?;
    let scene = &built.scene;
    let mut logs = built.logs(random);
    let joint = match random.unit() < 0.5 {
        true => Some(loud(scene, &logs[0], random)),
        false => None,
    };
    let columns: Vec<usize> = match joint {
        Some(joint) => vec![joint],
        None => (0..scene.arm.count()).collect(),
    };
    let share = random.uniform(0.03, 0.1);
    let mut off_over_noise: f64 = 0.0;
    for (place, log) in logs.iter_mut().enumerate() {
        let rows = bursts(log.len(), share, random);
        let off = put(way, scene, &columns, &rows, log, random);
        if place == 0 {
            off_over_noise = off;
        }
    }
    let mut planted = built.planted(kind);
    planted.push(Planted {
        name: way.name(),
        joint,
        right: vec!["dropouts", "outliers"],
        law: named!(share, off_over_noise)
            .map(|(name, value)| (name.to_owned(), value))
            .into(),
        ..Planted::default()
    });
    let beside = kind.map_or(String::new(), |kind| format!("+{}", kind.label));
    let tale = Tale {
        label: way.label().to_owned() + &beside,
        planted,
        besides: Besides {
            no_gap_with: kind.is_none().then_some(Said::Dropouts),
            ..Besides::default()
        },
        ..Tale::default()
    };
    tale.trial(id, scene, logs)
}

/// A joint whose torque is clearly above its noise.
fn loud(scene: &Scene, log: &Recording, random: &mut Random) -> usize {
    let all: Vec<usize> = (0..scene.arm.count()).collect();
    let is_loud = |joint: &usize| {
        let torque = log.torque_nm[*joint].as_deref().unwrap_or_default();
        crate::laws::rms(torque) > LEAST_OVER_NOISE * scene.sensors.noise[*joint]
    };
    let loud: Vec<usize> = all.iter().copied().filter(is_loud).collect();
    random.choose(&loud).unwrap_or_default()
}

/// Bursts of rows apart from each other, that are a share of all; neither the first row nor the last.
pub(crate) fn bursts(rows: usize, share: f64, random: &mut Random) -> Vec<Vec<usize>> {
    let wanted = (share * rows as f64) as usize;
    let mut is_taken = vec![false; rows];
    let mut bursts = Vec::new();
    let mut count = 0;
    while count < wanted {
        let length = 1 + random.index(LONGEST_BURST);
        let first = 1 + random.index(rows - length - 1);
        if is_taken[first - 1..=first + length].contains(&true) {
            continue;
        }
        is_taken[first..first + length].fill(true);
        bursts.push((first..first + length).collect());
        count += length;
    }
    bursts
}

/// Puts them into columns of a log, and how far they are off over the noise: root mean square over all rows, worst column.
fn put(
    way: Way,
    scene: &Scene,
    columns: &[usize],
    bursts: &[Vec<usize>],
    log: &mut Recording,
    random: &mut Random,
) -> f64 {
    let mut worst: f64 = 0.0;
    for &joint in columns {
        let range = scene.arm.axes[joint].range;
        let Some(column) = log.torque_nm.get_mut(joint).and_then(Option::as_mut) else {
            continue;
        };
        let sound = column.clone();
        for burst in bursts {
            for &row in burst {
                column[row] = match way {
                    Way::Zero => 0.0,
                    Way::Held => sound[burst[0] - 1],
                    Way::Flipped => -sound[row],
                    Way::Spiked => {
                        let off = random.sign() * range * random.uniform(0.3, 1.0);
                        rounded(sound[row] + off, TORQUE_STEPS)
                    }
                };
            }
        }
        let off = column.iter().zip(&sound).map(|(now, sound)| now - sound);
        let off: Vec<f64> = off.collect();
        worst = worst.max(crate::laws::rms(&off) / scene.sensors.noise[joint]);
    }
    worst
}
