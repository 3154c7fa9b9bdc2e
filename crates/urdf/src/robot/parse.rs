//! Reads a URDF: well-formed, a tree, every number checked, every complaint with line and column.

use std::collections::BTreeMap;

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};

use crate::UrdfError;
use crate::numbers::ONE_NUMBER;
use crate::robot::prefixes::without_prefixes;
use crate::robot::xml::{Element, Reader, Result, document, elements};
use crate::robot::{Inertial, Mimic, Robot, RobotJoint, RobotJointType, RobotLink};

/// Reads a URDF; `file` names it in errors.
pub(crate) fn parse(text: &str, file: &str) -> Result<Robot> {
    let plain = without_prefixes(text);
    let document = document(&plain, file)?;
    let reader = Reader {
        document: &document,
        file,
    };
    reader.robot(text)
}

/// What a document is that is no URDF.
fn what_it_is(root: &str) -> &'static str {
    match root {
        "mujoco" => "it looks like MJCF: name it .xml, or give the URDF",
        "sdf" => "it looks like SDF: convert it to URDF",
        "COLLADA" => "it looks like a mesh: give the URDF",
        _ => "give a URDF",
    }
}

impl Reader<'_, '_> {
    fn robot(&self, text: &str) -> Result<Robot> {
        let root = self.document.root_element();
        if root.tag_name().name() != "robot" {
            let found = root.tag_name().name();
            return Err(UrdfError::NotUrdf {
                at: self.position_at(root.range().start),
                found: found.to_owned(),
                advice: what_it_is(found),
            });
        }
        let mut robot = Robot {
            name: root.attribute("name").unwrap_or("robot").to_owned(),
            end: text
                .get(root.range())
                .and_then(|own| own.rfind("</"))
                .map(|offset| root.range().start + offset),
            ..Robot::default()
        };
        let mut by_name = BTreeMap::new();
        for element in elements(root, "link") {
            let link = self.link(element)?;
            let index = robot.links.len();
            if by_name.insert(link.name.clone(), index).is_some() {
                let message = format!("there are two links `{}`: rename one", link.name);
                return Err(self.tree(link.place, message));
            }
            robot.links.push(link);
            self.count("links", robot.links.len(), element.range().start)?;
        }
        let mut names = BTreeMap::new();
        for element in elements(root, "joint") {
            let joint = self.joint(element, &by_name)?;
            let index = robot.joints.len();
            if names.insert(joint.name.clone(), index).is_some() {
                let message = format!("there are two joints `{}`: rename one", joint.name);
                return Err(self.tree(joint.place, message));
            }
            self.attach(&mut robot, &joint, index)?;
            robot.joints.push(joint);
            self.count("joints", robot.joints.len(), element.range().start)?;
        }
        self.no_loops(&robot)?;
        robot.notes.extend(self.said_of_quaternions()?);
        robot.notes.extend(self.questions_of_urdf(&robot));
        Ok(robot)
    }

    fn attach(&self, robot: &mut Robot, joint: &RobotJoint, index: usize) -> Result<()> {
        let child = &mut robot.links[joint.child];
        if let Some(other) = child.parent_joint {
            let message = format!(
                "the link `{}` has two parents, by the joints `{}` and `{}`: a URDF is a tree",
                child.name, robot.joints[other].name, joint.name
            );
            return Err(self.tree(joint.place, message));
        }
        child.parent_joint = Some(index);
        robot.links[joint.parent].child_joints.push(index);
        Ok(())
    }

    /// Every link has at most one parent; so where going up does not end, it is in a loop.
    fn no_loops(&self, robot: &Robot) -> Result<()> {
        let mut reaches_root = vec![false; robot.links.len()];
        for start in 0..robot.links.len() {
            let (mut link, mut steps) = (start, 0);
            while !reaches_root[link] {
                let Some(joint) = robot.links[link].parent_joint else {
                    break;
                };
                link = robot.joints[joint].parent;
                steps += 1;
                if steps > robot.links.len() {
                    let name = &robot.links[link].name;
                    let message =
                        format!("the link `{name}` is below itself: the joints make a loop");
                    return Err(self.tree(robot.links[link].place, message));
                }
            }
            let mut link = start;
            while !reaches_root[link] {
                reaches_root[link] = true;
                match robot.links[link].parent_joint {
                    Some(joint) => link = robot.joints[joint].parent,
                    None => break,
                }
            }
        }
        Ok(())
    }

    fn link(&self, element: Element<'_, '_>) -> Result<RobotLink> {
        let name = self.name(element)?;
        let place = format!("link `{name}`");
        let inertial = match elements(element, "inertial").next() {
            Some(inertial) => self.inertial(inertial, &place)?,
            None => None,
        };
        Ok(RobotLink {
            name,
            place: element.range().start,
            inertial,
            parent_joint: None,
            child_joints: Vec::new(),
        })
    }

    fn inertial(&self, element: Element<'_, '_>, place: &str) -> Result<Option<Inertial>> {
        let Some(node) = elements(element, "mass").next() else {
            return Ok(None);
        };
        let mass_kg = self.one(node, place, "value")?;
        let mass_kg = mass_kg.ok_or_else(|| self.missing(node, place, "mass value"))?;
        self.not_negative_mass(node, place, mass_kg)?;
        let origin = match elements(element, "origin").next() {
            Some(origin) => self.origin(origin, place)?,
            None => Pose::default(),
        };
        let inertia_kgm2 = match elements(element, "inertia").next() {
            Some(node) => Some(self.inertia(node, place)?),
            None => None,
        };
        Ok(Some(Inertial {
            mass_kg,
            centre_m: origin.position_m.into(),
            inertia_kgm2: inertia_kgm2
                .map(|own| origin.rotation * own * origin.rotation.transpose()),
        }))
    }

    fn inertia(&self, node: Element<'_, '_>, place: &str) -> Result<Matrix3<f64>> {
        let one = |key| -> Result<f64> { Ok(self.one(node, place, key)?.unwrap_or(0.0)) };
        let [xx, yy, zz] = [one("ixx")?, one("iyy")?, one("izz")?];
        let [xy, xz, yz] = [one("ixy")?, one("ixz")?, one("iyz")?];
        Ok(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz))
    }

    fn joint(
        &self,
        element: Element<'_, '_>,
        links: &BTreeMap<String, usize>,
    ) -> Result<RobotJoint> {
        let name = self.name(element)?;
        let place = format!("joint `{name}`");
        let joint_type = match self.required(element, &place, "type")? {
            "fixed" => RobotJointType::Fixed,
            "revolute" => RobotJointType::Revolute,
            "continuous" => RobotJointType::Continuous,
            "prismatic" => RobotJointType::Prismatic,
            "floating" | "planar" => RobotJointType::Other("floating or planar"),
            other => {
                let found = format!("\"{other}\"");
                let allowed =
                    "revolute, continuous, prismatic, fixed, floating or planar is expected";
                return Err(self.refuse(element, &place, "the type", &found, allowed));
            }
        };
        let end = |tag: &'static str| {
            let node = elements(element, tag).next();
            let node = node.ok_or_else(|| self.missing(element, &place, tag))?;
            let link = self.required(node, &place, "link")?;
            links.get(link).copied().ok_or_else(|| {
                let message = format!("{place}: there is no link `{link}`, its {tag}");
                self.tree(node.range().start, message)
            })
        };
        let (parent, child) = (end("parent")?, end("child")?);
        let origin_element = elements(element, "origin").next();
        let inside = element
            .children()
            .next()
            .map_or(element.range().start, |first| first.range().start);
        Ok(RobotJoint {
            place: element.range().start,
            inside,
            joint_type,
            parent,
            child,
            origin: match origin_element {
                Some(origin) => self.origin(origin, &place)?,
                None => Pose::default(),
            },
            origin_range: origin_element.map(|origin| origin.range()),
            // a fixed joint often has the axis 0 0 0
            axis: match joint_type {
                RobotJointType::Fixed => [1.0, 0.0, 0.0],
                _ => self.axis(element, &place)?,
            },
            limits: self.limits(element, &place)?,
            armature: None,
            friction: self.friction(element, &place)?,
            effort: self.effort(element, &place)?,
            mimic: self.mimic(element, &place)?,
            placed_by: None,
            is_part: false,
            compliance: 0.0,
            springs: Vec::new(),
            name,
        })
    }

    fn origin(&self, element: Element<'_, '_>, place: &str) -> Result<Pose> {
        let position_m = self.vector(element, place, "xyz")?.unwrap_or([0.0; 3]);
        Ok(Pose {
            position_m: Vector3::from(position_m),
            rotation: self.rotation(element, place)?,
        })
    }

    fn axis(&self, element: Element<'_, '_>, place: &str) -> Result<[f64; 3]> {
        /// Shortest axis that has a direction.
        const SHORTEST: f64 = 1e-6;
        let Some(node) = elements(element, "axis").next() else {
            return Ok([1.0, 0.0, 0.0]);
        };
        let axis = self.vector(node, place, "xyz")?.unwrap_or([1.0, 0.0, 0.0]);
        let length = libm::sqrt(axis.iter().map(|part| part * part).sum());
        if length < SHORTEST {
            let found = format!("{axis:?}");
            return Err(self.refuse(node, place, "the axis", &found, "it must have a direction"));
        }
        Ok(axis.map(|part| part / length))
    }

    fn limits(&self, element: Element<'_, '_>, place: &str) -> Result<Option<(f64, f64)>> {
        let Some(node) = elements(element, "limit").next() else {
            return Ok(None);
        };
        // an absent limit is 0 in the format's definition; both absent are none
        if !node.has_attribute("lower") && !node.has_attribute("upper") {
            return Ok(None);
        }
        // a limit beyond any size is none
        let limit = |key: &'static str| match node.attribute(key) {
            None => Ok(0.0),
            Some(text) => match text.trim().parse::<f64>() {
                Ok(limit) if !limit.is_nan() => Ok(limit),
                _ => Err(self.refuse(node, place, key, &format!("\"{text}\""), ONE_NUMBER)),
            },
        };
        Ok(Some((limit("lower")?, limit("upper")?)))
    }

    /// What `<dynamics>` says of friction.
    fn friction(&self, element: Element<'_, '_>, place: &str) -> Result<[f64; 2]> {
        let Some(node) = elements(element, "dynamics").next() else {
            return Ok([0.0; 2]);
        };
        let one = |key| -> Result<f64> { Ok(self.one(node, place, key)?.unwrap_or(0.0).max(0.0)) };
        Ok([one("friction")?, one("damping")?])
    }

    /// The limit of effort; exporters write 0 where they know none.
    fn effort(&self, element: Element<'_, '_>, place: &str) -> Result<Option<f64>> {
        let node = elements(element, "limit").next();
        let Some((node, text)) = node.and_then(|node| Some((node, node.attribute("effort")?)))
        else {
            return Ok(None);
        };
        match text.trim().parse::<f64>() {
            Ok(effort) if !effort.is_nan() => {
                Ok(Some(effort).filter(|effort| *effort > 0.0 && effort.is_finite()))
            }
            _ => Err(self.refuse(node, place, "effort", &format!("\"{text}\""), ONE_NUMBER)),
        }
    }

    fn mimic(&self, element: Element<'_, '_>, place: &str) -> Result<Option<Mimic>> {
        let Some(node) = elements(element, "mimic").next() else {
            return Ok(None);
        };
        Ok(Some(Mimic {
            joint: self
                .required(node, &format!("the <mimic> of {place}"), "joint")?
                .to_owned(),
            multiplier: self.one(node, place, "multiplier")?.unwrap_or(1.0),
            offset: self.one(node, place, "offset")?.unwrap_or(0.0),
            place: node.range().start,
        }))
    }
}
