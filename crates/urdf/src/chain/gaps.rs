//! The fixed parts between the moving rows of a path, and the joint whose origin takes up a calibration.

use haptical_model::kinematics::Pose;

use crate::chain::path::{Path, Step};
use crate::robot::Robot;
use haptical_model::rigid::{inverse, then};

/// One of the constant transforms between two rows.
#[derive(Debug, Clone, Copy)]
struct Part {
    pose: Pose,
    /// Whose origin it is; none for the turn of an axis, and for a part of the joint before.
    of: Option<Step>,
}

/// The constant transforms before a row, or behind the last one.
#[derive(Debug, Clone, Default)]
pub(crate) struct Gap {
    parts: Vec<Part>,
}

/// What a gap asks for so that its product is another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Correction {
    /// A joint of the robot, from 0, with another origin.
    Joint(usize, Pose),
    /// A link fixed to the base, at this place in the base's frame, as the base.
    Base(Pose),
    /// A link fixed to the tip, at this place in the tip's frame, as the tip.
    Tip(Pose),
}

/// The gaps of a path: one before each moving row, and the one behind them all.
pub(crate) fn gaps(robot: &Robot, path: &Path) -> (Vec<Gap>, Gap) {
    let mut gaps = Vec::new();
    let mut gap = Gap::default();
    for step in &path.steps {
        let joint = &robot.joints[step.joint];
        let origin = Part {
            pose: step.origin(joint),
            // what no element places takes up no correction
            of: (!joint.is_part).then_some(*step),
        };
        if !joint.moves() {
            gap.parts.push(origin);
            continue;
        }
        let along_z = step.along_z(joint);
        let turn = |pose| Part { pose, of: None };
        let mut next = Gap::default();
        next.parts.push(turn(inverse(&along_z)));
        // upwards the origin is passed behind the motion
        match step.is_upward {
            true => next.parts.push(origin),
            false => gap.parts.push(origin),
        }
        gap.parts.push(turn(along_z));
        gaps.push(std::mem::replace(&mut gap, next));
    }
    (gaps, gap)
}

/// The corrections after which the gaps before the rows have the products `before`, and the one behind them all
/// `handle`: one for each gap, none of them of the same joint. What is fixed to the tip takes up a correction only where
/// no other path leads on over it.
pub(crate) fn corrections(
    robot: &Robot,
    path: &Path,
    before: impl Iterator<Item = Pose>,
    handle: &Pose,
    others: &[Path],
) -> Vec<Correction> {
    let (gaps, last) = gaps(robot, path);
    let mut corrections: Vec<Correction> = gaps
        .iter()
        .zip(before)
        .map(|(gap, wanted)| match gap.taken_up_before_a_row(robot) {
            Some(place) => gap.with(place, &wanted),
            // the added link leads to the base by its inverse, which is before everything
            None => Correction::Base(then(&gap.product(), &inverse(&wanted))),
        })
        .collect();
    let is_shared = |place: &(usize, Step)| others.iter().any(|path| path.steps.contains(&place.1));
    let own = last.taken_up_behind_all(robot);
    corrections.push(match own.filter(|place| !is_shared(place)) {
        Some(place) => last.with(place, handle),
        None => Correction::Tip(then(&inverse(&last.product()), handle)),
    });
    corrections
}

fn product(parts: &[Part]) -> Pose {
    let parts = parts.iter();
    parts.fold(Pose::default(), |product, part| then(&product, &part.pose))
}

impl Gap {
    /// From the frame before the gap to the one behind it.
    pub(crate) fn product(&self) -> Pose {
        product(&self.parts)
    }

    /// The origin of the joint at a place, so that the product is the one wanted.
    fn with(&self, (place, step): (usize, Step), wanted: &Pose) -> Correction {
        let (before, behind) = (
            product(&self.parts[..place]),
            product(&self.parts[place + 1..]),
        );
        let own = then(&then(&inverse(&before), wanted), &inverse(&behind));
        Correction::Joint(
            step.joint,
            match step.is_upward {
                true => inverse(&own),
                false => own,
            },
        )
    }

    /// Origins and their places.
    fn origins(&self) -> impl DoubleEndedIterator<Item = (usize, Step)> {
        let parts = self.parts.iter().enumerate();
        parts.filter_map(|(place, part)| Some((place, part.of?)))
    }

    /// The origin of the row behind, where that is passed downwards: it is in this gap. Otherwise the first origin:
    /// of the row before, which is passed upwards too, or of what is fixed to the base. At the turning point both rows
    /// have theirs in one gap; the one before then stays as it is.
    fn taken_up_before_a_row(&self, robot: &Robot) -> Option<(usize, Step)> {
        let is_behind =
            |(_, step): &(usize, Step)| robot.joints[step.joint].moves() && !step.is_upward;
        self.origins()
            .find(is_behind)
            .or_else(|| self.origins().next())
    }

    /// What is fixed to the tip.
    fn taken_up_behind_all(&self, robot: &Robot) -> Option<(usize, Step)> {
        let last = self.origins().next_back();
        last.filter(|(_, step)| !robot.joints[step.joint].moves())
    }
}
