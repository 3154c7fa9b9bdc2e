//! The chains that a URDF or an MJCF offers: where each ends, and how many joints a log of it has.

use crate::UrdfError;
use crate::chain::driver;
use crate::chain::path::Step as Way;
use crate::chain::tip::link;
use crate::robot::{Robot, RobotJointType, read_any};

/// A chain of a URDF from its root or a base.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChainEnd {
    /// Link at which it ends: of several that are fixed to each other, the one with the most fixed joints
    /// before it, counted from where the chain moves last.
    pub tip: String,
    /// Joints that a log has: those that follow another one do not count.
    pub joints: usize,
}

/// All chains of a URDF or an MJCF with a joint that moves, from the root or from the link `base`, in the order in which the
/// file's joints lead to them, downwards first; `file` names it in errors.
///
/// ```
/// let text = r#"<robot name="lever">
///   <link name="base"/> <link name="arm"/> <link name="flange"/> <link name="finger"/>
///   <joint name="shoulder" type="continuous"> <parent link="base"/> <child link="arm"/> </joint>
///   <joint name="end" type="fixed"> <parent link="arm"/> <child link="flange"/> </joint>
///   <joint name="knuckle" type="continuous"> <parent link="flange"/> <child link="finger"/> </joint>
/// </robot>"#;
/// let ends = haptical_urdf::chain_ends(text, "lever.urdf", None)?;
/// let found: Vec<_> = ends.iter().map(|end| (end.tip.as_str(), end.joints)).collect();
/// assert_eq!(found, [("flange", 1), ("finger", 2)]);
/// let ends = haptical_urdf::chain_ends(text, "lever.urdf", Some("finger"))?;
/// let found: Vec<_> = ends.iter().map(|end| (end.tip.as_str(), end.joints)).collect();
/// assert_eq!(found, [("arm", 1), ("base", 2)]);
/// # Ok::<(), haptical_urdf::UrdfError>(())
/// ```
///
/// # Errors
/// [`UrdfError`] with line and column for a text that is no URDF; [`UrdfError::UnknownLink`].
pub fn chain_ends(text: &str, file: &str, base: Option<&str>) -> Result<Vec<ChainEnd>, UrdfError> {
    let robot = read_any(text, file)?;
    let base = base.map(|name| link(&robot, file, name)).transpose()?;
    let is_root = |link: &usize| robot.links[*link].parent_joint.is_none();
    let starts: Vec<usize> = match base {
        Some(base) => vec![base],
        None => (0..robot.links.len()).filter(is_root).collect(),
    };
    let mut walk = Walk {
        robot: &robot,
        uses: vec![0; robot.joints.len()],
        joints: 0,
        ends: Vec::new(),
    };
    starts.into_iter().for_each(|start| walk.from(start));
    let ends = walk.ends.into_iter().map(|end| ChainEnd {
        tip: robot.links[end.link].name.clone(),
        joints: end.joints,
    });
    Ok(ends.collect())
}

/// The farthest link of those behind one moving joint.
struct End {
    link: usize,
    fixed: usize,
    joints: usize,
}

enum Step {
    Into {
        way: Way,
        end: Option<usize>,
        fixed: usize,
    },
    /// Back over a joint with this driver.
    Back { driver: usize },
}

struct Walk<'r> {
    robot: &'r Robot,
    /// How many joints of the path each joint drives.
    uses: Vec<usize>,
    /// Joints that drive one of the path.
    joints: usize,
    ends: Vec<End>,
}

impl Walk<'_> {
    fn from(&mut self, start: usize) {
        let mut steps = Vec::new();
        self.push_ways(start, None, None, 0, &mut steps);
        while let Some(step) = steps.pop() {
            match step {
                Step::Back { driver } => {
                    self.uses[driver] -= 1;
                    self.joints -= usize::from(self.uses[driver] == 0);
                }
                Step::Into { way, end, fixed } => self.step(way, end, fixed, &mut steps),
            }
        }
    }

    fn step(&mut self, way: Way, end: Option<usize>, fixed: usize, steps: &mut Vec<Step>) {
        let index = way.joint;
        let joint = &self.robot.joints[index];
        let link = match way.is_upward {
            true => joint.parent,
            false => joint.child,
        };
        if !joint.moves() {
            let fixed = fixed + 1;
            if let Some(end) = end.and_then(|end| self.ends.get_mut(end))
                && fixed > end.fixed
            {
                (end.link, end.fixed) = (link, fixed);
            }
            self.push_ways(link, Some(index), end, fixed, steps);
            return;
        }
        // no chain leads through a joint that is refused there
        let Ok((driver, _, _)) = driver(self.robot, index) else {
            return;
        };
        if matches!(joint.joint_type, RobotJointType::Other(_)) {
            return;
        }
        self.joints += usize::from(self.uses[driver] == 0);
        self.uses[driver] += 1;
        self.ends.push(End {
            link,
            fixed: 0,
            joints: self.joints,
        });
        steps.push(Step::Back { driver });
        self.push_ways(link, Some(index), Some(self.ends.len() - 1), 0, steps);
    }

    /// The joints on from a link, but the one that led to it; the last is taken first.
    fn push_ways(
        &self,
        link: usize,
        by: Option<usize>,
        end: Option<usize>,
        fixed: usize,
        steps: &mut Vec<Step>,
    ) {
        let link = &self.robot.links[link];
        let up = link.parent_joint.map(Way::up).into_iter();
        let ways = up.chain(link.child_joints.iter().rev().copied().map(Way::down));
        let ways = ways.filter(|way| Some(way.joint) != by);
        steps.extend(ways.map(|way| Step::Into { way, end, fixed }));
    }
}
