//! The chains that a URDF offers: where each ends, and how many joints a log of it has.

use crate::UrdfError;
use crate::chain::driver;
use crate::parse::parse;
use crate::robot::{Robot, RobotJointType};

/// A chain of a URDF from its root.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChainEnd {
    /// Link at which it ends: of several that are fixed to each other, the one with the most fixed joints
    /// before it.
    pub tip: String,
    /// Joints that a log has: those that follow another one do not count.
    pub joints: usize,
}

/// All chains of a URDF with a joint that moves, in the order in which the file's joints lead to them; `file`
/// names it in errors.
///
/// ```
/// let text = r#"<robot name="lever">
///   <link name="base"/> <link name="arm"/> <link name="flange"/> <link name="finger"/>
///   <joint name="shoulder" type="continuous"> <parent link="base"/> <child link="arm"/> </joint>
///   <joint name="end" type="fixed"> <parent link="arm"/> <child link="flange"/> </joint>
///   <joint name="knuckle" type="continuous"> <parent link="flange"/> <child link="finger"/> </joint>
/// </robot>"#;
/// let ends = haptical_urdf::chain_ends(text, "lever.urdf")?;
/// let told: Vec<_> = ends.iter().map(|end| (end.tip.as_str(), end.joints)).collect();
/// assert_eq!(told, [("flange", 1), ("finger", 2)]);
/// # Ok::<(), haptical_urdf::UrdfError>(())
/// ```
///
/// # Errors
/// [`UrdfError`] with line and column for a text that is no URDF.
pub fn chain_ends(text: &str, file: &str) -> Result<Vec<ChainEnd>, UrdfError> {
    let robot = parse(text, file)?;
    let roots = (0..robot.links.len()).filter(|link| robot.links[*link].parent_joint.is_none());
    let mut walk = Walk {
        robot: &robot,
        uses: vec![0; robot.joints.len()],
        joints: 0,
        ends: Vec::new(),
    };
    roots.for_each(|root| walk.from(root));
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
        joint: usize,
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
    fn from(&mut self, root: usize) {
        let mut steps = Vec::new();
        self.push_children(root, None, 0, &mut steps);
        while let Some(step) = steps.pop() {
            match step {
                Step::Back { driver } => {
                    self.uses[driver] -= 1;
                    self.joints -= usize::from(self.uses[driver] == 0);
                }
                Step::Into { joint, end, fixed } => self.step(joint, end, fixed, &mut steps),
            }
        }
    }

    fn step(&mut self, index: usize, end: Option<usize>, fixed: usize, steps: &mut Vec<Step>) {
        let joint = &self.robot.joints[index];
        let link = joint.child;
        if !joint.moves() {
            let fixed = fixed + 1;
            if let Some(end) = end.and_then(|end| self.ends.get_mut(end))
                && fixed > end.fixed
            {
                (end.link, end.fixed) = (link, fixed);
            }
            self.push_children(link, end, fixed, steps);
            return;
        }
        // no chain leads through a joint that is refused there
        let Ok((driver, _, _)) = driver(self.robot, index) else {
            return;
        };
        if joint.joint_type == RobotJointType::Other {
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
        self.push_children(link, Some(self.ends.len() - 1), 0, steps);
    }

    fn push_children(&self, link: usize, end: Option<usize>, fixed: usize, steps: &mut Vec<Step>) {
        let children = self.robot.links[link].child_joints.iter().rev();
        steps.extend(children.map(|&joint| Step::Into { joint, end, fixed }));
    }
}
