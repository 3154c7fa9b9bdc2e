//! A device from a chain of a URDF or an MJCF.

use std::path::Path as FilePath;

use haptical_model::kinematics::{Convention, Link};
use haptical_model::{
    Device, Hand, Joint, JointCompliance, JointType, Origin, Surroundings, Tracker, read_text_file,
};

use haptical_model::sizes::LARGEST_LIMIT_RAD;

use crate::UrdfError;
use crate::chain::friction::frictions;
use crate::chain::gravity::{gravity_mps2, said_of_no_gravity};
use crate::chain::masses::{Carried, carried};
use crate::chain::path::{BaseAndTip, Path};
use crate::chain::tip::choose;
use crate::chain::{Rows, numbering, rows};
use crate::robot::mjcf::include::with_includes;
use crate::robot::places::place_of;
use crate::robot::{Robot, RobotJoint, mjcf, parse};

/// Largest file \[MiB\]: a humanoid's has some hundred kilobytes.
const LARGEST_MEBIBYTES: u64 = 8;
/// Most joints of a chain, as of a device file.
const MOST_JOINTS: usize = 256;

/// A device from a URDF or an MJCF.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfDevice {
    /// The device.
    pub device: Device,
    /// Link at which its chain begins: frame (-1).
    pub base: String,
    /// Link at which its chain ends: its handle, or the first of its hands.
    pub tip: String,
    /// What was chosen or left out.
    pub warnings: Vec<String>,
}

/// Reads a URDF or an MJCF as text: at most 8 MiB of UTF-8, with what an MJCF includes.
///
/// `<include file="..."/>` is read from the folder of the main file, else from that of the file that includes it, and from no
/// other folder. Errors name the file that they are in.
///
/// ```
/// use haptical_urdf::{BaseAndTip, device_from_mjcf, read_urdf_text};
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("arm.xml");
/// std::fs::write(&path, "<mujoco><worldbody><include file=\"lever.xml\"/></worldbody></mujoco>")?;
/// let lever = path.with_file_name("lever.xml");
/// std::fs::write(&lever, "<mujoco><body name=\"lever\"><joint name=\"shoulder\"/></body></mujoco>")?;
/// let device = device_from_mjcf(&read_urdf_text(&path)?, "arm.xml", BaseAndTip::to("lever"))?.device;
/// assert_eq!(device.joints[0].name, "shoulder");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`UrdfError::File`]; [`UrdfError`] with the place of an `<include>` that is refused, or of a fault in what it includes.
pub fn read_urdf_text(path: &FilePath) -> Result<String, UrdfError> {
    let text = read_text_file(path, LARGEST_MEBIBYTES)?;
    with_includes(text, path, LARGEST_MEBIBYTES)
}

/// The chain of a URDF between two links as a device; `file` names it in errors.
///
/// Frame (-1) is the base, which is the root link where none is named. Joint i of the chain, counted from the
/// base, becomes row i behind the constant origin
/// `T(xyz) R(rpy) R(axis -> z)`, its own six numbers 0; `R(axis -> z)^-1` and fixed joints are part of the
/// next origin, the last one being the handle's. So every row is general: its six numbers, to first order
/// the local coordinates of a product of exponentials, may be identified whichever way the axes are
/// ([`Link`]). Home is 0 everywhere. Joints that follow another one (`<mimic>`)
/// are rows that its joint drives, and no joints of a log. A limit of effort above 0 is the joint's largest torque. Masses are those of the links, with all that
/// hangs on them off the chain: such a branch, a hand or another arm, counts as fixed, its joints at 0, or
/// in the middle of their limits where these exclude 0; a warning says so.
///
/// From a base that is not above the tip the chain runs up the tree to the last link above both, then down. A
/// joint that is passed upwards moves about its axis turned round, in its child's frame, and is followed by
/// the inverse of its origin: `(T R M(axis, q))^-1 = M(-axis, q) (T R)^-1`. Its name, reading and limits
/// stay as they are. Gravity, (0, 0, -9.81) m/s^2 in the root's frame, is turned into the base's. A base
/// that moves with respect to the root has no fixed direction of gravity: such a device has neither masses
/// nor gravity, and a warning says so.
///
/// With further tips ([`BaseAndTip::further_tips`]) the device is the tree of the chains to all of them: a joint that
/// several chains pass is one row, and each tip a hand with the name of its link. Its rows are in the modified
/// convention, whose numbers come before the motion: each branch then has a place of its own on the row that it hangs on.
///
/// Without a tip the chain with the most moving joints is taken; joints that follow one of another branch
/// (fingers) do not count.
///
/// ```
/// let text = r#"<robot name="lever">
///   <link name="base"/> <link name="arm"/> <link name="tool"/>
///   <joint name="shoulder" type="revolute">
///     <origin xyz="0 0 0.4"/> <parent link="base"/> <child link="arm"/> <axis xyz="0 1 0"/>
///     <limit lower="-1" upper="1" effort="10" velocity="1"/>
///   </joint>
///   <joint name="flange" type="fixed">
///     <origin xyz="0.1 0 0"/> <parent link="arm"/> <child link="tool"/>
///   </joint>
/// </robot>"#;
/// let lever = haptical_urdf::device_from_urdf(text, "lever.urdf", haptical_urdf::BaseAndTip::default())?;
/// assert_eq!((lever.tip.as_str(), lever.device.joints[0].name.as_str()), ("tool", "shoulder"));
/// let pose = haptical_model::DeviceChain::new(&lever.device).pose(&[0.5])?;
/// assert!((pose.position_m.z - (0.4 - 0.1 * 0.5_f64.sin())).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`UrdfError`] with line and column, or with what there is to choose from.
pub fn device_from_urdf(
    text: &str,
    file: &str,
    ends: BaseAndTip<'_>,
) -> Result<UrdfDevice, UrdfError> {
    device_of(ReadChain::of_urdf(text, file, ends)?, file)
}

/// The chain of an MJCF (MuJoCo's XML) between two bodies or sites as a device; `file` names it in errors.
///
/// As [`device_from_urdf`], with bodies in the place of links: frame (-1) is the world, or the body that is named. A site
/// with a name is a place that a chain may end at. A body without joints is fixed to its parent. A hinge or slide with
/// `ref` moves by its value less `ref`. What several joints of one body do is done in the order of the file. A hinge or
/// slide that is bound to another one by an `<equality>` of the first degree follows it. A second hinge along the first
/// one's axis, without an actuator, is what the drive yields: its stiffness is the joint's compliance, a play is left out.
/// `armature` is that of the joint, with those of the joints that follow it; the largest torque is the smaller of what its
/// `actuatorfrcrange` and its actuators' `forcerange`, times their `gear`, allow.
///
/// Gravity is that of `<option>`. Masses are those of `<inertial>`; those that MuJoCo works out from geoms are left out,
/// and a warning says so.
///
/// ```
/// let text = r#"<mujoco model="lever">
///   <compiler angle="radian"/>
///   <worldbody>
///     <body name="arm" pos="0 0 0.4">
///       <joint name="shoulder" axis="0 1 0" range="-1 1"/>
///       <site name="tool" pos="0.1 0 0"/>
///     </body>
///   </worldbody>
/// </mujoco>"#;
/// let lever = haptical_urdf::device_from_mjcf(text, "lever.xml", haptical_urdf::BaseAndTip::default())?;
/// assert_eq!((lever.tip.as_str(), lever.device.joints[0].name.as_str()), ("tool", "shoulder"));
/// let pose = haptical_model::DeviceChain::new(&lever.device).pose(&[0.5])?;
/// assert!((pose.position_m.z - (0.4 - 0.1 * 0.5_f64.sin())).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`UrdfError`] with line and column, or with what there is to choose from.
pub fn device_from_mjcf(
    text: &str,
    file: &str,
    ends: BaseAndTip<'_>,
) -> Result<UrdfDevice, UrdfError> {
    device_of(ReadChain::of_mjcf(text, file, ends)?, file)
}
fn device_of(read: ReadChain, file: &str) -> Result<UrdfDevice, UrdfError> {
    let ReadChain {
        robot,
        paths,
        rows,
        mut warnings,
    } = read;
    let path = &paths[0];
    if rows.rows.len() > MOST_JOINTS {
        return Err(UrdfError::Chain {
            file: file.to_owned(),
            message: format!(
                "the chain to `{}` has {} moving joints; at most {MOST_JOINTS} are read",
                robot.links[path.tip].name,
                rows.rows.len()
            ),
        });
    }
    warnings.extend(numbering(&robot, &rows, file));
    let gravity_mps2 = gravity_mps2(&robot, path);
    let carried = match gravity_mps2 {
        Some(_) => carried(&robot, &paths, &rows, file),
        None => Carried::nothing(&robot, &paths, &rows, file),
    };
    if gravity_mps2.is_none() {
        warnings.extend(said_of_no_gravity(&robot, path, file));
    }
    warnings.extend(carried.warnings);
    let mut origins = vec![Some(Origin::IDENTITY)];
    origins.extend(
        rows.rows
            .iter()
            .map(|row| Some(Origin::from_pose(&row.origin))),
    );
    let hands = hands(&robot, &paths, &rows);
    // each hand has its own place, and the device none
    let only = rows.ends.first().filter(|_| hands.is_empty());
    origins.push(only.map(|end| Origin::from_pose(&end.handle)));
    let joints = rows.drivers.iter().enumerate().map(|(number, driver)| {
        let (joint, warning) = device_joint(&robot.joints[*driver], file);
        warnings.extend(warning);
        Joint {
            armature_kgm2: armature(&robot, &rows, number),
            ..joint
        }
    });
    let joints: Vec<Joint> = joints.collect();
    let drives: Vec<_> = rows.rows.iter().map(|row| row.drive).collect();
    let is_plain = drives.iter().enumerate().all(|(index, drive)| {
        drive.joint == index
            && drive.motion == joints[index].joint_type
            && drive.multiplier == 1.0
            && drive.offset == 0.0
    });
    let mut bodies = vec![None];
    bodies.extend(carried.bodies);
    let links = vec![Link::default(); rows.rows.len() + 1];
    // numbers before a row's motion: each branch has its own place on the row that it hangs on
    let convention = match hands.is_empty() {
        true => Convention::Standard,
        false => Convention::Modified,
    };
    let yields: Vec<JointCompliance> = rows
        .drivers
        .iter()
        .map(|driver| JointCompliance {
            rad_per_nm: robot.joints[*driver].compliance,
            fit: false,
        })
        .collect();
    let device = Device {
        name: robot.name.clone(),
        origins,
        parents: parents(&rows),
        hands,
        drives: if is_plain { Vec::new() } else { drives },
        bodies,
        // nobody measures in the base's frame by luck
        tracker: Some(Tracker::default()),
        gravity_mps2,
        effects: frictions(&robot, &rows),
        surroundings: Surroundings {
            compliance: match yields.iter().any(|own| own.rad_per_nm != 0.0) {
                true => yields,
                false => Vec::new(),
            },
            ..Surroundings::default()
        },
        ..Device::new(convention, links, joints)
    };
    Ok(UrdfDevice {
        device,
        base: robot.links[path.base].name.clone(),
        tip: robot.links[path.tip].name.clone(),
        warnings,
    })
}

/// The hands of a device with several tips: each is called as its link.
pub(crate) fn hands(robot: &Robot, paths: &[Path], rows: &Rows) -> Vec<Hand> {
    if paths.len() < 2 {
        return Vec::new();
    }
    let ends = paths.iter().zip(&rows.ends);
    let hands = ends.map(|(path, end)| Hand {
        name: robot.links[path.tip].name.clone(),
        row: end.rows.last().map_or(0, |row| row + 1),
        handle: Some(Origin::from_pose(&end.handle)),
    });
    hands.collect()
}

/// The row that each row hangs on, as a device has them.
pub(crate) fn parents(rows: &Rows) -> Vec<usize> {
    let behind = rows
        .rows
        .iter()
        .map(|row| row.behind.map_or(0, |row| row + 1));
    let parents: Vec<usize> = behind.collect();
    match parents.iter().copied().eq(0..parents.len()) {
        true => Vec::new(),
        false => parents,
    }
}

/// A URDF with its chains.
#[derive(Debug)]
pub(crate) struct ReadChain {
    pub(crate) robot: Robot,
    /// One for each tip, from one base.
    pub(crate) paths: Vec<Path>,
    pub(crate) rows: Rows,
    pub(crate) warnings: Vec<String>,
}

impl ReadChain {
    pub(crate) fn of_urdf(text: &str, file: &str, ends: BaseAndTip<'_>) -> Result<Self, UrdfError> {
        Self::new(parse::parse(text, file)?, text, file, ends)
    }

    pub(crate) fn of_mjcf(text: &str, file: &str, ends: BaseAndTip<'_>) -> Result<Self, UrdfError> {
        Self::new(mjcf::parse(text, file)?, text, file, ends)
    }

    fn new(
        mut robot: Robot,
        text: &str,
        file: &str,
        ends: BaseAndTip<'_>,
    ) -> Result<Self, UrdfError> {
        let mut warnings = std::mem::take(&mut robot.notes);
        let (paths, warning) = choose(&robot, file, ends)?;
        let rows = rows(&robot, &paths, &|byte| place_of(text, file, byte))?;
        warnings.extend(warning);
        Ok(Self {
            robot,
            paths,
            rows,
            warnings,
        })
    }
}

/// A joint and what is odd about its limits.
fn device_joint(joint: &RobotJoint, file: &str) -> (Joint, Option<String>) {
    let joint_type = match joint.joint_type {
        crate::robot::RobotJointType::Prismatic => JointType::Prismatic,
        _ => JointType::Revolute,
    };
    let is_continuous = joint.joint_type == crate::robot::RobotJointType::Continuous;
    let (mut lower, mut upper) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut warning = None;
    if let Some(limits) = joint.limits.filter(|_| !is_continuous) {
        if limits.0 < limits.1 {
            let largest = match joint_type {
                JointType::Revolute => LARGEST_LIMIT_RAD,
                JointType::Prismatic => 1e6,
            };
            lower = if limits.0 < -largest { lower } else { limits.0 };
            upper = if limits.1 > largest { upper } else { limits.1 };
        } else {
            warning = Some(format!(
                "{file}: joint `{}` has the limits {} to {}, between which nothing is: it is taken as \
                 without limits",
                joint.name, limits.0, limits.1
            ));
        }
    }
    let joint = Joint {
        name: joint.name.clone(),
        has_numeric_name: joint.name.parse::<f64>().is_ok(),
        joint_type,
        lower_rad: lower,
        upper_rad: upper,
        torque_limit_nm: joint.effort,
        ..Joint::default()
    };
    (joint, warning)
}

/// Armature of one of the device's joints: the file's, with those of the rows that follow it, seen at the joint.
pub(crate) fn armature(robot: &Robot, rows: &Rows, number: usize) -> Option<f64> {
    let own = rows.rows.iter().filter(|row| row.drive.joint == number);
    let own = own.filter_map(|row| {
        let armature = robot.joints[row.joint].armature?;
        Some(row.drive.multiplier * row.drive.multiplier * armature)
    });
    own.reduce(|sum, armature| sum + armature)
}
