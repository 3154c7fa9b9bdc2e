//! Industrial arms that are measured posture by posture: what yields under the weights, postures that repeat, a tracker
//! that is set up anew. Nothing here moves: a row is a posture at rest.

mod deviating;
mod device;
mod postures;
mod tracker;
mod yielding;

use anyhow::Result;
use haptical_model::{Device, Recording};

use crate::effects::theta;
use crate::planted::{Planted, Story};
use crate::random::Random;
use crate::rig::geometry::Chain;
use crate::rig::readings::rounded;
use crate::rig::scene::CleanChannels;
use crate::trial::{Trial, TrialId};

use deviating::Deviating;
use device::Arm;
use postures::Postures;
use tracker::Tracker;

/// Names of a joint that yields; without an external encoder they are one.
const OF_JOINTS: [&str; 2] = ["joint-compliance", "capstan-compliance"];
/// What yields by the same weights: near an arm's parallel axes the loads of one joint are nearly multiples of another's.
const SPRINGS: [&str; 4] = [
    "joint-compliance",
    "capstan-compliance",
    "base-compliance",
    "lateral-compliance",
];
/// Names of what yields at or across the foot of an arm.
const OF_BASE: [&str; 2] = ["base-compliance", "lateral-compliance"];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Wrong {
    Nothing,
    Joints,
    JointsAndAcross,
    JointsAndBase,
    /// A joint's angle bends another joint, by a product that no catalogue has.
    Product,
}

/// How an arm is measured.
#[derive(Debug, Clone, Copy)]
struct Plan {
    wrong: Wrong,
    withhold: bool,
    label: &'static str,
    is_repeated: bool,
    runs: usize,
    is_moved: bool,
}

/// Group elasticity: several joints yield, some arms across their axes or at the foot too.
pub(crate) fn elastic(id: TrialId, random: &mut Random) -> Result<Trial> {
    let plan = match id.index % 10 {
        0..=3 => Plan::steady(Wrong::Joints, false, "yielding-joints"),
        4 => Plan::steady(Wrong::JointsAndAcross, false, "yielding-joints-across"),
        5 => Plan::steady(Wrong::JointsAndBase, false, "yielding-joints-and-base"),
        6 | 7 => Plan::steady(Wrong::Nothing, false, "rigid-arm"),
        8 => Plan::steady(Wrong::Joints, true, "yielding-withheld"),
        _ => Plan::steady(Wrong::Product, false, "angle-product"),
    };
    plan.trial(id, random)
}

/// Postures that are recorded two to five times.
pub(crate) fn repeats(id: TrialId, random: &mut Random) -> Result<Trial> {
    let mut plan = match id.index % 8 {
        0..=2 => Plan::steady(Wrong::Nothing, false, "repeats-rigid"),
        3..=5 => Plan::steady(Wrong::Joints, false, "repeats-yielding"),
        6 => Plan::steady(Wrong::Joints, true, "repeats-withheld"),
        _ => Plan::steady(Wrong::Product, false, "repeats-product"),
    };
    plan.is_repeated = true;
    plan.trial(id, random)
}

/// Two runs or more, between which the tracker is set up anew, or is not.
pub(crate) fn moved(id: TrialId, random: &mut Random) -> Result<Trial> {
    let member = id.index % 8;
    let mut plan = match member {
        0..=3 => Plan::steady(Wrong::Nothing, false, "moved"),
        4 => Plan::steady(Wrong::Joints, false, "moved-yielding"),
        5 | 6 => Plan::steady(Wrong::Nothing, false, "several-runs"),
        _ => Plan::steady(Wrong::Nothing, true, "moved-withheld"),
    };
    plan.is_moved = ![5, 6].contains(&member);
    plan.runs = 2 + random.index(3);
    plan.trial(id, random)
}

/// Least and largest root mean square of an effect at the marker over the noise.
const OVER_NOISE: [f64; 2] = [3.0, 30.0];
/// Typical gap at the marker relative to the arm's scale \[m\].
const GAP: f64 = 4e-4;
/// How far a joint is from where it says that it rests, relative to the noise at the marker.
const UNREST: f64 = 0.3;

impl Plan {
    /// One run of postures that do not repeat.
    fn steady(wrong: Wrong, withhold: bool, label: &'static str) -> Self {
        Self {
            wrong,
            withhold,
            label,
            is_repeated: false,
            runs: 1,
            is_moved: false,
        }
    }

    fn trial(self, id: TrialId, random: &mut Random) -> Result<Trial> {
        let arm = Arm::draw(random)?;
        let mut tracker = Tracker::draw(arm.scale_m, random);
        let count = if self.is_repeated {
            random.around(63.0, 10.0)
        } else {
            random.around(135.0, 13.8)
        };
        let mut postures = postures::anywhere(&arm.nominal, count as usize, random);
        if self.is_repeated {
            postures = postures.repeated(random);
        }
        postures = postures.in_runs(self.runs);
        if self.is_moved {
            for _ in 1..self.runs {
                let last = tracker.places[tracker.places.len() - 1];
                tracker.places.push(last.moved(random));
            }
        }
        let mut deviating = Deviating::draw(self.wrong, &arm.truth, random);
        let [least, most] = OVER_NOISE;
        let over_noise = random.around(libm::sqrt(least * most), most / least);
        let gap_m = GAP * arm.scale_m * random.around(1.0, 4.0);
        deviating.scale_to(gap_m, &arm.truth, &tracker, &postures);
        let stated_m = gap_m / over_noise;
        let stated_rad = stated_m / (0.3 * arm.scale_m);
        // a file states another noise than there is, or none; repeats can tell any
        let factor = if self.is_repeated {
            random.around(1.0, 4.0)
        } else {
            random.around(1.0, 1.6)
        };
        tracker.position_sd_m = stated_m * factor;
        tracker.rotation_sd_rad = stated_rad * factor;
        let is_stated = random.unit() < 0.75;
        let [position, rotation] = match (is_stated, tracker.sees_orientation) {
            (true, true) => [stated_m, stated_rad],
            (true, false) => [stated_m, 0.0],
            (false, _) => [0.0, 0.0],
        };
        let device_toml = arm.file(position, rotation);
        let unrest_rad = UNREST * tracker.position_sd_m / arm.scale_m;
        let log = recorded(
            &arm.truth, &deviating, &tracker, &postures, unrest_rad, random,
        );
        let gap = deviating.gap(&arm.truth, &tracker, &postures);
        let story = self.story(&arm, &deviating, &postures);
        let logs = [log, Recording::default()];
        Trial::of(
            device_toml,
            logs,
            CleanChannels::default(),
            story.truth(id, gap),
        )
    }

    fn story(self, arm: &Arm, deviating: &Deviating, postures: &Postures) -> Story {
        let mut planted = Vec::new();
        if self.is_moved {
            planted.push(Planted {
                name: "tracker-moved",
                right: vec!["tracker-moved"],
                ..Planted::default()
            });
        }
        let yields = matches!(
            self.wrong,
            Wrong::Joints | Wrong::JointsAndAcross | Wrong::JointsAndBase
        );
        if yields {
            planted.push(Planted {
                name: OF_JOINTS[0],
                joint: deviating.yielding.foremost(&arm.truth, &postures.angle_rad),
                right: OF_JOINTS.to_vec(),
                law: deviating.yielding.law(),
                ..Planted::default()
            });
        }
        match self.wrong {
            Wrong::JointsAndAcross => planted.push(Planted {
                name: "lateral-compliance",
                right: vec!["lateral-compliance"],
                // across the first axis is what a base yields
                acceptable: vec!["base-compliance"],
                ..Planted::default()
            }),
            Wrong::JointsAndBase => planted.push(Planted {
                name: "base-compliance",
                right: OF_BASE.to_vec(),
                ..Planted::default()
            }),
            Wrong::Product => planted.push(Planted {
                name: "angle-product",
                ..Planted::default()
            }),
            _ => {}
        }
        let without = match (self.withhold, self.is_moved) {
            (false, _) => Vec::new(),
            (true, true) => vec!["tracker-moved"],
            (true, false) => SPRINGS.to_vec(),
        };
        Story {
            label: self.label.to_owned(),
            device: arm.nominal.name.clone(),
            planted,
            without,
            depends_on: match deviating.product {
                Some((on, by, _)) => vec![theta(on), theta(by)],
                None => Vec::new(),
            },
            is_unknown: self.wrong == Wrong::Product,
        }
    }
}

fn recorded(
    device: &Device,
    deviating: &Deviating,
    tracker: &Tracker,
    postures: &Postures,
    unrest_rad: f64,
    random: &mut Random,
) -> Recording {
    let chain = Chain::new(device);
    let joints = device.joints.len();
    let mut handles = Vec::with_capacity(postures.len());
    let mut joint = vec![Vec::with_capacity(postures.len()); joints];
    for posture in &postures.of_row {
        let angle = &postures.angle_rad[*posture];
        let unrest: Vec<f64> = (0..joints).map(|_| unrest_rad * random.normal()).collect();
        handles.push(deviating.handle(device, &chain, angle, &unrest));
        for (column, angle) in joint.iter_mut().zip(angle) {
            column.push(rounded(*angle, 1e7));
        }
    }
    let runs = postures.run.last().copied().unwrap_or(0);
    let mut log = Recording {
        line: (0..postures.len() as u64).map(|row| row + 2).collect(),
        run: (runs > 0).then(|| postures.run.iter().map(|run| *run as i64).collect()),
        joint,
        output: vec![None; joints],
        torque_nm: vec![None; joints],
        ..Recording::default()
    };
    tracker.read(&handles, &postures.run, random, &mut log);
    log
}
