//! Reads a URDF: well-formed, a tree, every number checked, every complaint with line and column.

use std::collections::BTreeMap;

use haptical_model::Position;
use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::Vector3;
use roxmltree::{Document, Node, ParsingOptions, TextPos};

use crate::UrdfError;
use crate::numbers::{ONE_NUMBER, THREE_NUMBERS, number, three};
use crate::rigid::from_rpy;
use crate::robot::limits::{place_of, too_many};
use crate::robot::{Mimic, Robot, RobotJoint, RobotJointType, RobotLink};

type Result<T> = std::result::Result<T, UrdfError>;

/// Most nodes of a document: a humanoid with its meshes and materials has some ten thousand.
const MOST_NODES: u32 = 1_000_000;
/// Most links, and most joints.
const MOST_PARTS: usize = 4096;

/// A document and its name, for positions.
struct Reader<'d, 'input> {
    document: &'d Document<'input>,
    file: &'d str,
}

type Element<'d, 'input> = Node<'d, 'input>;

/// Reads a URDF; `file` names it in errors.
pub(crate) fn parse(text: &str, file: &str) -> Result<Robot> {
    if let Some((byte, message)) = too_many(text) {
        return Err(UrdfError::Xml {
            at: place_of(text, file, byte),
            message,
        });
    }
    let options = ParsingOptions {
        allow_dtd: false,
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, options).map_err(|error| UrdfError::Xml {
        at: position(file, error.pos()),
        message: error.to_string(),
    })?;
    let reader = Reader {
        document: &document,
        file,
    };
    reader.robot(text)
}

fn position(file: &str, at: TextPos) -> Box<Position> {
    Box::new(Position {
        file: file.to_owned(),
        line: at.row as usize,
        column: at.col as usize,
    })
}

/// What a document is that is no URDF.
fn what_it_is(root: &str) -> &'static str {
    match root {
        "mujoco" => "it looks like MJCF: give the URDF",
        "sdf" => "it looks like SDF: convert it to URDF",
        "COLLADA" => "it looks like a mesh: give the URDF",
        _ => "give a URDF",
    }
}

impl<'d, 'input> Reader<'d, 'input> {
    fn position_at(&self, byte: usize) -> Box<Position> {
        position(self.file, self.document.text_pos_at(byte))
    }

    fn tree(&self, byte: usize, message: String) -> UrdfError {
        let at = self.position_at(byte);
        UrdfError::Tree { at, message }
    }

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
            self.count("links", robot.links.len(), element)?;
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
            self.count("joints", robot.joints.len(), element)?;
        }
        self.no_loops(&robot)?;
        Ok(robot)
    }

    fn count(&self, what: &str, found: usize, element: Element<'_, '_>) -> Result<()> {
        if found <= MOST_PARTS {
            return Ok(());
        }
        let message = format!("more than {MOST_PARTS} {what}, the most that are read");
        Err(self.tree(element.range().start, message))
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

    fn name(&self, element: Element<'_, '_>) -> Result<String> {
        let kind = element.tag_name().name();
        let name = self.required(element, &format!("a <{kind}>"), "name")?;
        Ok(name.to_owned())
    }

    fn link(&self, element: Element<'_, '_>) -> Result<RobotLink> {
        let name = self.name(element)?;
        let place = format!("link `{name}`");
        let mut mass = None;
        if let Some(inertial) = elements(element, "inertial").next()
            && let Some(node) = elements(inertial, "mass").next()
        {
            let mass_kg = self.one(node, &place, "value")?;
            let mass_kg = mass_kg.ok_or_else(|| self.missing(node, &place, "mass value"))?;
            if mass_kg < 0.0 {
                let found = mass_kg.to_string();
                return Err(self.refuse(
                    node,
                    &place,
                    "the mass",
                    &found,
                    "a mass is not negative",
                ));
            }
            let centre_m = match elements(inertial, "origin").next() {
                Some(origin) => self.vector(origin, &place, "xyz")?.unwrap_or([0.0; 3]),
                None => [0.0; 3],
            };
            mass = Some((mass_kg, centre_m));
        }
        Ok(RobotLink {
            name,
            place: element.range().start,
            mass,
            parent_joint: None,
            child_joints: Vec::new(),
        })
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
            "floating" | "planar" => RobotJointType::Other,
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
            mimic: self.mimic(element, &place)?,
            name,
        })
    }

    fn origin(&self, element: Element<'_, '_>, place: &str) -> Result<Pose> {
        let position_m = self.vector(element, place, "xyz")?.unwrap_or([0.0; 3]);
        let angles_rad = self.vector(element, place, "rpy")?.unwrap_or([0.0; 3]);
        Ok(Pose {
            position_m: Vector3::from(position_m),
            rotation: from_rpy(angles_rad),
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

    fn required<'n>(
        &self,
        element: Element<'n, '_>,
        place: &str,
        key: &'static str,
    ) -> Result<&'n str> {
        let value = element.attribute(key);
        value.ok_or_else(|| self.missing(element, place, key))
    }

    fn missing(&self, element: Element<'_, '_>, place: &str, what: &'static str) -> UrdfError {
        UrdfError::Missing {
            at: self.position_at(element.range().start),
            place: place.to_owned(),
            what,
        }
    }

    fn refuse(
        &self,
        element: Element<'_, '_>,
        place: &str,
        what: &'static str,
        found: &str,
        allowed: &str,
    ) -> UrdfError {
        let allowed = if found.contains("${") {
            "this is xacro: expand it first (`xacro file.xacro > file.urdf`)"
        } else {
            allowed
        };
        UrdfError::Value {
            at: self.position_at(element.range().start),
            place: place.to_owned(),
            what,
            // whoever wrote a megabyte need not read it again
            found: found.chars().take(60).collect(),
            allowed: allowed.to_owned(),
        }
    }

    fn one(&self, element: Element<'_, '_>, place: &str, key: &'static str) -> Result<Option<f64>> {
        let Some(text) = element.attribute(key) else {
            return Ok(None);
        };
        let refuse = || self.refuse(element, place, key, &format!("\"{text}\""), ONE_NUMBER);
        number(text).map(Some).ok_or_else(refuse)
    }

    fn vector(
        &self,
        element: Element<'_, '_>,
        place: &str,
        key: &'static str,
    ) -> Result<Option<[f64; 3]>> {
        let Some(text) = element.attribute(key) else {
            return Ok(None);
        };
        let refuse = || self.refuse(element, place, key, &format!("\"{text}\""), THREE_NUMBERS);
        three(text).map(Some).ok_or_else(refuse)
    }
}

/// Child elements of one name.
fn elements<'d, 'input>(
    node: Node<'d, 'input>,
    name: &'static str,
) -> impl Iterator<Item = Node<'d, 'input>> {
    node.children()
        .filter(move |child| child.is_element() && child.tag_name().name() == name)
}
