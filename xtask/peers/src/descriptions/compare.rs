//! Haptical's numbers and a peer's: equal, named, or different.

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};

use super::ask::Answer;
use super::findings::{Finding, Part, Row, State, Worst};
use super::ours::{Ours, Torques};
use super::said::{explained, of_all, of_feature, with_any};

/// Largest difference of equal poses \[m\], and of entries of rotations. MuJoCo takes a site that is turned by a few 1e-9 rad as not
/// turned.
const SAME_POSE: f64 = 1e-8;
/// Largest difference of equal torques, as a share of the joint's largest.
const SAME_TORQUE: f64 = 1e-7;
/// A joint's torques count from this share of the largest of all joints on.
const LEAST_SHARE: f64 = 1e-6;
/// Least torque that counts \[N m\], \[N\].
const LEAST_TORQUE: f64 = 1e-9;
/// Forces of a part below this are none \[N m\], \[N\].
const LEAST_FORCE: f64 = 1e-9;

/// What peers were asked, and what haptical has.
#[derive(Debug, Clone)]
pub(crate) struct Check {
    /// Row of the table.
    pub(crate) row: usize,
    pub(crate) part: Part,
    pub(crate) ours: Ours,
    /// Haptical's words.
    pub(crate) said: Vec<String>,
}

/// How far two answers are apart.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Gap {
    pose: f64,
    /// As a share of the joint's largest, with the joint; none where torques were not compared.
    torque: Option<(f64, usize)>,
    /// At rest alone.
    still: Option<f64>,
}

impl Gap {
    pub(crate) fn is_small(&self) -> bool {
        self.has_equal_poses() && self.torque.is_none_or(|(own, _)| own <= SAME_TORQUE)
    }

    pub(crate) fn has_equal_poses(&self) -> bool {
        self.pose <= SAME_POSE
    }

    pub(crate) fn worst(&self) -> Worst {
        Worst {
            pose: Some(self.pose),
            torque: self.torque.map(|(own, _)| own),
        }
    }

    pub(crate) fn words(&self) -> String {
        let torque = match (self.torque, self.still) {
            (Some((own, joint)), Some(still)) => {
                format!(
                    ", torque of joint {} by {own:.1e} (at rest {still:.1e})",
                    joint + 1
                )
            }
            _ => String::new(),
        };
        format!("poses by {:.1e}{torque}", self.pose)
    }
}

/// How far haptical's answers are apart.
pub(crate) fn apart(one: &Ours, other: &Ours) -> Gap {
    let torques = one.torques.as_ref().zip(other.torques.as_ref());
    let own = torques.map(|(_, other)| (other.still.as_slice(), other.moving.as_deref()));
    gap(one, &other.poses, own)
}

/// Torques at rest and in motion.
type Theirs<'t> = (&'t [Vec<f64>], Option<&'t [Vec<f64>]>);

fn gap(ours: &Ours, poses: &[Vec<Pose>], theirs: Option<Theirs<'_>>) -> Gap {
    let pose = match ours.poses.len() == poses.len() {
        true => ours.poses.iter().zip(poses).fold(0.0, |worst, (a, b)| {
            if a.len() != b.len() {
                return f64::INFINITY;
            }
            a.iter().zip(b).fold(worst, larger_of_poses)
        }),
        false => f64::INFINITY,
    };
    let mut gap = Gap {
        pose,
        ..Gap::default()
    };
    let (Some(own), Some((still, moving))) = (&ours.torques, theirs) else {
        return gap;
    };
    let scales = scales(own);
    let at_rest = worst_share(&own.still, still, &scales);
    gap.still = Some(at_rest.0);
    gap.torque = Some(match own.moving.as_deref().zip(moving) {
        Some((own, moving)) => {
            let moved = worst_share(own, moving, &scales);
            if moved.0 > at_rest.0 { moved } else { at_rest }
        }
        None => at_rest,
    });
    gap
}

fn larger_of_poses(worst: f64, (one, other): (&Pose, &Pose)) -> f64 {
    let gap = (one.position_m - other.position_m)
        .amax()
        .max((one.rotation - other.rotation).amax());
    // a number that is none is no equal one
    match gap.is_nan() {
        true => f64::INFINITY,
        false => worst.max(gap),
    }
}

/// Of each joint the largest torque, but not too small a share of all.
fn scales(own: &Torques) -> Vec<f64> {
    let all = own.moving.iter().flatten().chain(&own.still);
    let mut largest: Vec<f64> = Vec::new();
    for torques in all {
        largest.resize(torques.len(), 0.0);
        for (scale, own) in largest.iter_mut().zip(torques) {
            *scale = scale.max(own.abs());
        }
    }
    let of_all = largest.iter().copied().fold(0.0, f64::max);
    let least = (LEAST_SHARE * of_all).max(LEAST_TORQUE);
    largest.into_iter().map(|own| own.max(least)).collect()
}

fn worst_share(ours: &[Vec<f64>], theirs: &[Vec<f64>], scales: &[f64]) -> (f64, usize) {
    let mut worst = (0.0, 0);
    for (own, other) in ours.iter().zip(theirs) {
        for (joint, scale) in scales.iter().enumerate() {
            let pair = own.get(joint).zip(other.get(joint));
            let share = pair.map_or(f64::INFINITY, |(own, other)| (own - other).abs() / scale);
            let share = if share.is_nan() { f64::INFINITY } else { share };
            if share > worst.0 {
                worst = (share, joint);
            }
        }
    }
    worst
}

/// What came of one check with each peer; `row` has what is known of the file already.
pub(crate) fn findings(check: &Check, answers: &[Answer], row: &Row) -> Vec<Finding> {
    let mut all = Vec::new();
    for answer in answers {
        let states = match &answer.refused {
            Some(words) => vec![refused(check, answer, words, row)],
            None => states(check, answer),
        };
        all.extend(states.into_iter().map(|state| Finding {
            part: check.part,
            with: answer.peer.clone(),
            state,
        }));
    }
    all
}

/// A peer that refuses what haptical wrote of a file that it takes is a difference.
fn refused(check: &Check, answer: &Answer, words: &str, row: &Row) -> State {
    let words = format!("{}: {words}", answer.peer);
    let is_known = row.findings.iter().any(|own| {
        own.part == Part::Given
            && own.with == answer.peer
            && matches!(own.state, State::PeerRefused(_))
    });
    match check.part {
        Part::Given => State::PeerRefused(words),
        Part::Corrected if is_known => State::PeerRefused(words),
        part => State::Different(
            Worst::default(),
            format!("{} refused by {words}", part.name()),
        ),
    }
}

fn states(check: &Check, answer: &Answer) -> Vec<State> {
    let mut states = Vec::new();
    let has_masses = check.ours.torques.is_some();
    for feature in &answer.features {
        let is_constraint = feature.kind.starts_with("equality");
        if check.part != Part::Given
            || feature.size <= LEAST_FORCE
            || !(has_masses || is_constraint)
        {
            continue;
        }
        states.push(match of_feature(feature, &check.said) {
            Some(words) => State::Said(words),
            None => {
                let words = format!(
                    "{} ({:.1e}) of {} is not said",
                    feature.kind, feature.size, answer.peer
                );
                State::Different(Worst::default(), words)
            }
        });
    }
    states.extend(unweighed(check));
    let poses = answer
        .poses
        .iter()
        .map(|own| own.iter().map(|own| pose_of(own)));
    let poses: Vec<Vec<Pose>> = poses.map(Iterator::collect).collect();
    let gap = gap(
        &check.ours,
        &poses,
        Some((&answer.still, Some(&answer.moving))),
    );
    states.push(match gap.is_small() {
        true => State::Equal(gap.worst()),
        false => {
            match of_all(&check.said, gap.has_equal_poses()).or_else(|| of_corrected(check, &gap)) {
                Some(words) => State::Said(words),
                None => State::Different(
                    gap.worst(),
                    format!("{} and {}: {}", check.part.name(), answer.peer, gap.words()),
                ),
            }
        }
    });
    states
}

/// What a corrected export says of masses, where torques alone differ.
fn of_corrected(check: &Check, gap: &Gap) -> Option<String> {
    let is_corrected = check.part == Part::Corrected && gap.has_equal_poses();
    is_corrected.then(|| explained(&check.said, check.part))?
}

/// What haptical says of masses that it does not have.
fn unweighed(check: &Check) -> Vec<State> {
    let mut states: Vec<State> = Vec::new();
    if check.part != Part::Given {
        return states;
    }
    if check.ours.torques.is_none()
        && let Some(words) = with_any(&check.said, &["masses and gravity are left out"])
    {
        states.push(State::Said(words));
    }
    states.extend(check.ours.said.iter().cloned().map(State::Said));
    states
}

/// Position and rotation of twelve numbers; not a number where there are fewer.
fn pose_of(numbers: &[f64]) -> Pose {
    let at = |index: usize| numbers.get(index).copied().unwrap_or(f64::NAN);
    Pose {
        position_m: Vector3::new(at(0), at(1), at(2)),
        rotation: Matrix3::from_fn(|row, column| at(3 + 3 * row + column)),
    }
}
