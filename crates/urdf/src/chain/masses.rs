//! The masses that a chain carries: of its links, and of the branches that hang off it.

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{Body, GivenInertia};

use crate::chain::path::{Path, passed};
use crate::chain::{Rows, driver};
use crate::numbers::rounded;
use crate::rigid::z_to;
use crate::robot::{Inertial, Robot, RobotJoint, RobotJointType};
use crate::words::joined;
use haptical_model::rigid::{about_z, then, turn};

/// A limit beyond this is none \[rad\] or \[m\].
const LARGEST_LIMIT: f64 = 1e6;

/// Bodies of the rows, and what is said of the branches off them.
#[derive(Debug, Default)]
pub(crate) struct Carried {
    /// Of each row of the chain.
    pub(crate) bodies: Vec<Option<Body>>,
    pub(crate) warnings: Vec<String>,
}

/// What hangs on the chain behind one moving joint.
struct Branch {
    /// The first of its joints that moves.
    joint: usize,
    /// Joints that move, with the positions that they are taken at \[rad\] or \[m\].
    taken: Vec<(usize, f64)>,
    mass_kg: f64,
    /// Whether a row of the chain carries it; the root carries it otherwise, which loads no joint.
    is_load: bool,
}

impl Carried {
    /// No masses at all, where the base moves with respect to the root, and what moves off the chain.
    pub(crate) fn nothing(robot: &Robot, paths: &[Path], rows: &Rows, file: &str) -> Self {
        let beside = joints_beside(robot, paths);
        let names = beside
            .iter()
            .filter(|joint| !rows.drivers.contains(joint))
            .map(|joint| robot.joints[*joint].name.as_str());
        Self {
            bodies: vec![None; rows.rows.len()],
            warnings: said_of_left_out(names, file).into_iter().collect(),
        }
    }
}

/// Sums what each row carries: its link, what is fixed to that, and every branch off the chain as if it
/// were fixed, its joints at 0, or in the middle of their limits where these exclude 0.
///
/// The base is fixed to the root, so that every row is passed downwards.
pub(crate) fn carried(robot: &Robot, paths: &[Path], rows: &Rows, file: &str) -> Carried {
    let mut walk = Walk::new(robot, paths);
    walk.sum(Path::from_root(robot, paths[0].base).base, false);
    let bodies = rows.rows.iter().map(|row| walk.body(row.joint)).collect();
    let mut warnings = said_of_no_body(robot, &walk.of_no_body, file);
    let (loads, light): (Vec<&Branch>, Vec<&Branch>) = walk
        .branches
        .iter()
        .partition(|branch| branch.is_load && branch.mass_kg > 0.0);
    warnings.extend(said_of_loads(robot, &loads, file));
    let names = light
        .iter()
        // what drives a row of the chain is no loss
        .filter(|branch| !rows.drivers.contains(&branch.joint))
        .map(|branch| robot.joints[branch.joint].name.as_str());
    warnings.extend(said_of_left_out(names, file));
    Carried { bodies, warnings }
}

fn said_of_no_body(robot: &Robot, links: &[(usize, &'static str)], file: &str) -> Vec<String> {
    let said = links.iter().map(|(link, why)| {
        format!(
            "{file}: no body has the inertia of link `{}` ({why}): correct it; where a joint carries it, a diagnosis and an export \
             take a plausible one, and `simulate --forward` refuses it",
            robot.links[*link].name
        )
    });
    said.collect()
}

fn said_of_left_out<'n>(names: impl Iterator<Item = &'n str>, file: &str) -> Option<String> {
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    (!names.is_empty()).then(|| {
        format!(
            "{file}: left out, because they move beside the chain: {}",
            joined(&names)
        )
    })
}

/// The joints that move branches against the chain, in the order of the file: those that are met first
/// on the way from the chain.
fn joints_beside(robot: &Robot, paths: &[Path]) -> Vec<usize> {
    let on_path = passed(robot, paths);
    let mut seen = vec![false; robot.links.len()];
    let mut links = vec![paths[0].base];
    let mut beside = Vec::new();
    while let Some(link) = links.pop() {
        seen[link] = true;
        let own = &robot.links[link];
        for &index in own.child_joints.iter().chain(&own.parent_joint) {
            let joint = &robot.joints[index];
            let other = match joint.child == link {
                true => joint.parent,
                false => joint.child,
            };
            if joint.moves() && !on_path[index] {
                beside.push(index);
            } else if !seen[other] {
                links.push(other);
            }
        }
    }
    beside.sort_unstable();
    beside
}

fn said_of_loads(robot: &Robot, loads: &[&Branch], file: &str) -> Option<String> {
    if loads.is_empty() {
        return None;
    }
    let masses = loads.iter().map(|branch| {
        let name = &robot.joints[branch.joint].name;
        format!("{} kg behind `{name}`", rounded(branch.mass_kg))
    });
    let masses: Vec<String> = masses.collect();
    let off_zero = loads.iter().flat_map(|branch| &branch.taken);
    let off_zero = off_zero.filter(|(_, position)| *position != 0.0);
    let off_zero = off_zero.map(|(joint, position)| {
        let joint = &robot.joints[*joint];
        let at = rounded(*position);
        format!("`{}` at {at} {}", joint.name, joint.unit())
    });
    let off_zero: Vec<String> = off_zero.collect();
    let taken = match off_zero.is_empty() {
        true => "their joints at 0".to_owned(),
        false => format!("their joints at 0, but {}", joined(&off_zero)),
    };
    Some(format!(
        "{file}: masses beside the chain count as fixed to it, {taken}: {}; hold these joints there while \
         you record",
        joined(&masses)
    ))
}

/// A link to visit.
struct Visit {
    link: usize,
    /// Its frame in that of the row's link.
    pose: Pose,
    /// Branch that it belongs to.
    branch: Option<usize>,
}

struct Walk<'r> {
    robot: &'r Robot,
    on_path: Vec<bool>,
    branches: Vec<Branch>,
    /// Links that load a joint and whose inertia no body has, and why.
    of_no_body: Vec<(usize, &'static str)>,
}

impl<'r> Walk<'r> {
    fn new(robot: &'r Robot, paths: &[Path]) -> Self {
        Self {
            robot,
            on_path: passed(robot, paths),
            branches: Vec::new(),
            of_no_body: Vec::new(),
        }
    }

    /// Everything with mass behind `start`, in its frame, that no later row of the chain carries.
    fn sum(&mut self, start: usize, is_load: bool) -> Vec<Inertial> {
        let mut parts = Vec::new();
        let mut visits = vec![Visit {
            link: start,
            pose: Pose::default(),
            branch: None,
        }];
        while let Some(Visit { link, pose, branch }) = visits.pop() {
            if let Some(own) = self.robot.links[link].inertial {
                let given = GivenInertia::new(own.inertia_kgm2.as_ref());
                if let GivenInertia::NoBody(why) = given
                    && is_load
                {
                    self.of_no_body.push((link, why));
                }
                let centre = pose.position_m + pose.rotation * Vector3::from(own.centre_m);
                let turned = |inertia| pose.rotation * inertia * pose.rotation.transpose();
                parts.push(Inertial {
                    mass_kg: own.mass_kg,
                    centre_m: centre.into(),
                    inertia_kgm2: own.inertia_kgm2.map(turned),
                });
                if let Some(branch) = branch {
                    self.branches[branch].mass_kg += own.mass_kg;
                }
            }
            let first = visits.len();
            for &child in &self.robot.links[link].child_joints {
                let joint = &self.robot.joints[child];
                if joint.moves() && self.on_path[child] {
                    continue;
                }
                let (mut pose, mut branch) = (then(&pose, &joint.origin), branch);
                if joint.moves() {
                    let position = taken(self.robot, child);
                    pose = then(&pose, &motion(joint, position));
                    let own = branch.unwrap_or_else(|| {
                        self.branches.push(Branch {
                            joint: child,
                            taken: Vec::new(),
                            mass_kg: 0.0,
                            is_load,
                        });
                        self.branches.len() - 1
                    });
                    self.branches[own].taken.push((child, position));
                    branch = Some(own);
                }
                let link = joint.child;
                visits.push(Visit { link, pose, branch });
            }
            // the last is visited first, but the order of the file is wanted
            visits[first..].reverse();
        }
        parts
    }

    /// The body of a row: its centre is in the frame behind the joint's motion, axis along z.
    fn body(&mut self, joint: usize) -> Option<Body> {
        let joint = &self.robot.joints[joint];
        let parts = self.sum(joint.child, true);
        if parts.is_empty() {
            return None;
        }
        let mass_kg: f64 = parts.iter().map(|part| part.mass_kg).sum();
        let moment = parts.iter().fold(Vector3::zeros(), |moment, part| {
            moment + Vector3::from(part.centre_m) * part.mass_kg
        });
        let centre = match mass_kg > 0.0 {
            true => moment / mass_kg,
            false => Vector3::zeros(),
        };
        let to_row = z_to(&joint.axis).transpose();
        let inertia = inertia_about(&centre, &parts);
        let inertia_kgm2 = inertia.map(|own| six(&(to_row * own * to_row.transpose())));
        Some(Body {
            mass_kg,
            centre_of_mass_m: (to_row * centre).into(),
            inertia_kgm2,
        })
    }
}

/// Inertia of all parts about a point \[kg m^2\]; none where that of a part with mass is not given, or that of most of the mass is zero:
/// exporters write zeros where they know nothing. A smaller part whose inertia is given as zero is a point (docs/assumptions.md, A187).
/// A part without mass that has an inertia is a rotor whose mass is counted elsewhere: its inertia counts (A256).
fn inertia_about(centre: &Vector3<f64>, parts: &[Inertial]) -> Option<Matrix3<f64>> {
    let mut total = Matrix3::zeros();
    let (mut extended_kg, mut whole_kg) = (0.0, 0.0);
    for part in parts {
        let own = match part.mass_kg > 0.0 {
            true => part.inertia_kgm2?,
            false => part.inertia_kgm2.unwrap_or_else(Matrix3::zeros),
        };
        whole_kg += part.mass_kg;
        if own != Matrix3::zeros() {
            extended_kg += part.mass_kg;
        }
        let arm = Vector3::from(part.centre_m) - centre;
        let steiner = Matrix3::identity() * arm.norm_squared() - arm * arm.transpose();
        total += own + steiner * part.mass_kg;
    }
    let is_known = match whole_kg > 0.0 {
        true => extended_kg > 0.5 * whole_kg,
        false => total != Matrix3::zeros(),
    };
    is_known.then_some(total)
}

/// A symmetric matrix as xx, yy, zz, xy, xz, yz.
fn six(matrix: &Matrix3<f64>) -> [f64; 6] {
    let mean = |row, column| 0.5 * (matrix[(row, column)] + matrix[(column, row)]);
    let diagonal = [0, 1, 2].map(|axis| matrix[(axis, axis)]);
    let [xx, yy, zz] = diagonal;
    [xx, yy, zz, mean(0, 1), mean(0, 2), mean(1, 2)]
}

/// Where a joint off the chain is taken \[rad\] or \[m\]: where the one that it follows puts it, or at
/// its own rest.
fn taken(robot: &Robot, joint: usize) -> f64 {
    match driver(robot, joint) {
        Ok((driver, multiplier, offset)) => multiplier * rest(&robot.joints[driver]) + offset,
        // nothing of the chain depends on whom it follows
        Err(_) => rest(&robot.joints[joint]),
    }
}

/// 0, or the middle of the limits where they exclude it; the nearer limit where the other is none.
fn rest(joint: &RobotJoint) -> f64 {
    let turns_freely = joint.joint_type == RobotJointType::Continuous;
    let Some((lower, upper)) = joint.limits.filter(|_| !turns_freely) else {
        return 0.0;
    };
    let is_limit = |limit: f64| limit.abs() <= LARGEST_LIMIT;
    match (is_limit(lower), is_limit(upper)) {
        (true, true) if 0.0 < lower && lower <= upper => 0.5 * (lower + upper),
        (true, true) if lower <= upper && upper < 0.0 => 0.5 * (lower + upper),
        (true, false) if upper > lower => lower.max(0.0),
        (false, true) if lower < upper => upper.min(0.0),
        _ => 0.0,
    }
}

fn motion(joint: &RobotJoint, position: f64) -> Pose {
    let axis = Vector3::from(joint.axis);
    match joint.joint_type {
        RobotJointType::Prismatic => Pose {
            position_m: axis * position,
            ..Pose::default()
        },
        RobotJointType::Revolute | RobotJointType::Continuous => {
            let along_z = z_to(&joint.axis);
            turn(along_z * about_z(position) * along_z.transpose())
        }
        RobotJointType::Fixed | RobotJointType::Other(_) => Pose::default(),
    }
}
