//! The tree of bodies of an MJCF, from the world down: links, sites, masses.

use std::collections::BTreeSet;

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};

use crate::robot::mjcf::classes::{ClassId, Classes};
use crate::robot::mjcf::masses::MassOf;
use crate::robot::mjcf::{Attributes, Mjcf, References};
use crate::robot::xml::{Element, Result, elements};
use crate::robot::{Inertial, PlacedBy, Robot, RobotJoint, RobotJointType, RobotLink};
use crate::words::joined;
use haptical_model::rigid::then;

/// Name of the link that everything hangs on.
const WORLD: &str = "world";
/// Elements that stand for bodies which are not written out.
const NOT_READ: [&str; 5] = ["attach", "replicate", "composite", "flexcomp", "plugin"];

/// An element of a body, and the frame that it is in.
#[derive(Clone, Copy)]
pub(crate) struct Part<'d, 'input> {
    pub(crate) own: Attributes<'d, 'input>,
    /// The frame around it in that of its body.
    pub(crate) frame: Pose,
    /// Class of what has none of its own.
    around: ClassId,
}

/// The tree as it grows.
pub(crate) struct Bodies<'m, 'd, 'input> {
    pub(crate) mjcf: &'m Mjcf<'d, 'input>,
    pub(crate) robot: &'m mut Robot,
    pub(crate) references: References,
    link_names: BTreeSet<String>,
    /// Names that bodies have: a site of the same name is no link.
    body_names: BTreeSet<&'d str>,
    /// Names of bodies and sites in the file: what is made up is none of them.
    stated_links: BTreeSet<&'d str>,
    pub(crate) joint_names: BTreeSet<String>,
    /// Names of joints in the file.
    pub(crate) stated_joints: BTreeSet<&'d str>,
    bodies: usize,
    /// What the file's bodies weigh.
    masses: Vec<MassOf>,
    /// Whether every body is written out.
    is_whole: bool,
    /// Bodies whose weight MuJoCo holds by itself.
    held: Vec<String>,
    /// Whether a joint's drive does not have to hold that weight.
    is_passive: bool,
    /// Bodies whose masses MuJoCo works out from geoms.
    of_geoms: Vec<String>,
    /// Joints with a spring that is no yield of a drive.
    pub(crate) sprung: Vec<String>,
    /// Joints whose spring and damper MuJoCo works out.
    pub(crate) tuned: Vec<String>,
    /// Joints whose damping has further coefficients.
    pub(crate) curved: Vec<String>,
    /// Sites that share a name, or have no place.
    no_ends: Vec<String>,
}

impl<'m, 'd, 'input> Bodies<'m, 'd, 'input> {
    /// Reads them all.
    pub(crate) fn read(mjcf: &'m Mjcf<'d, 'input>, robot: &'m mut Robot) -> Result<References> {
        let mut bodies = Self {
            mjcf,
            robot,
            references: References::new(),
            link_names: BTreeSet::new(),
            body_names: mjcf.stated(&["body"]).chain([WORLD]).collect(),
            stated_links: mjcf.stated(&["body", "site"]).chain([WORLD]).collect(),
            joint_names: BTreeSet::new(),
            stated_joints: mjcf.stated(&["joint", "freejoint"]).collect(),
            bodies: 0,
            masses: Vec::new(),
            is_whole: true,
            held: Vec::new(),
            is_passive: false,
            of_geoms: Vec::new(),
            sprung: Vec::new(),
            tuned: Vec::new(),
            curved: Vec::new(),
            no_ends: Vec::new(),
        };
        let root = mjcf.reader.document.root_element();
        bodies.link(WORLD.to_owned(), root.range().start)?;
        let mut open = Vec::new();
        for node in elements(root, "worldbody") {
            let class = mjcf.named(node, "childclass", Classes::OUTERMOST)?;
            let parts = bodies.parts(node, class)?;
            open.extend(parts.into_iter().map(|part| (part, 0)));
        }
        open.reverse();
        while let Some((part, parent)) = open.pop() {
            match part.own.node.tag_name().name() {
                "site" => bodies.site(&part, parent)?,
                "body" => {
                    let (parts, link) = bodies.body(&part, parent)?;
                    // the last is taken first, but the order of the file is wanted
                    open.extend(parts.into_iter().rev().map(|part| (part, link)));
                }
                _ => {}
            }
        }
        bodies.say_what_is_left_out();
        let (file, is_whole) = (mjcf.reader.file, bodies.is_whole);
        let rules = mjcf.compiler.masses;
        rules.apply(bodies.robot, &bodies.masses, is_whole, file);
        Ok(bodies.references)
    }

    fn say_what_is_left_out(&mut self) {
        let file = self.mjcf.reader.file;
        if !self.of_geoms.is_empty() {
            let names = joined(&self.of_geoms);
            self.robot.notes.push(format!(
                "{file}: no <inertial>, so MuJoCo works out the masses of {names} from their geoms, and here they have none: add \
                 <inertial> elements where masses matter (MuJoCo's numbers are body_mass, body_ipos, body_iquat, body_inertia of \
                 its compiled model)"
            ));
        }
        let weighs = self.robot.stated_gravity_mps2 != Some([0.0; 3]);
        if !self.held.is_empty() && self.is_passive && weighs {
            let names = joined(&self.held);
            self.robot.notes.push(format!(
                "{file}: gravcomp of {names} is left out: torques of a simulator that has it lack gravity's part"
            ));
        }
        let said = self
            .mjcf
            .said_of_joints([&self.sprung, &self.tuned, &self.curved]);
        self.robot.notes.extend(said);
        if !self.no_ends.is_empty() {
            let names = joined(&self.no_ends);
            self.robot.notes.push(format!(
                "{file}: no ends of a chain, because a body or another site has their name, or fromto places them: the sites {names}"
            ));
        }
    }

    /// What is in a body or the world, out of its frames.
    fn parts(
        &mut self,
        body: Element<'d, 'input>,
        around: ClassId,
    ) -> Result<Vec<Part<'d, 'input>>> {
        let mjcf = self.mjcf;
        let children = |node: Element<'d, 'input>, frame: Pose, around: ClassId| {
            let own: Vec<_> = node.children().filter(Element::is_element).collect();
            own.into_iter().rev().map(move |node| (node, frame, around))
        };
        let mut open: Vec<_> = children(body, Pose::default(), around).collect();
        let mut parts = Vec::new();
        while let Some((node, frame, around)) = open.pop() {
            let tag = node.tag_name().name();
            if tag == "frame" {
                let own = Attributes {
                    node,
                    class: around,
                };
                let name = node.attribute("name").unwrap_or("without a name");
                let pose = mjcf.pose(&own, &format!("frame `{name}`"))?;
                let around = mjcf.named(node, "childclass", around)?;
                open.extend(children(node, then(&frame, &pose), around));
                continue;
            }
            if NOT_READ.contains(&tag) {
                self.is_whole = false;
                let at = mjcf.reader.position_at(node.range().start);
                self.robot
                    .notes
                    .push(format!("{at}: <{tag}> is left out, and what it makes"));
                continue;
            }
            let class = match tag {
                "joint" | "site" => mjcf.named(node, "class", around)?,
                _ => around,
            };
            parts.push(Part {
                own: Attributes { node, class },
                frame,
                around,
            });
        }
        Ok(parts)
    }

    /// Adds a body behind its joints; gives its parts and its link.
    fn body(
        &mut self,
        part: &Part<'d, 'input>,
        parent: usize,
    ) -> Result<(Vec<Part<'d, 'input>>, usize)> {
        let node = part.own.node;
        self.bodies += 1;
        let name = match name_of(node) {
            Some(name) => name.to_owned(),
            None => self.free_link(format!("body{}", self.bodies)),
        };
        let place = format!("body `{name}`");
        let pose = then(&part.frame, &self.mjcf.pose(&part.own, &place)?);
        let around = self.mjcf.named(node, "childclass", part.around)?;
        let parts = self.parts(node, around)?;
        let placed_by = PlacedBy {
            place: node.range().start,
            before: part.frame,
            behind: Pose::default(),
        };
        let link = self.behind_joints(&name, &parts, (parent, pose, placed_by))?;
        let gravcomp = self.mjcf.one(&part.own, &place, "gravcomp")?;
        if gravcomp.is_some_and(|own| own != 0.0) {
            self.held.push(format!("`{name}`"));
        }
        let mut joints = parts
            .iter()
            .filter(|own| own.own.node.has_tag_name("joint"));
        self.is_passive |= joints.any(|own| {
            // what the drive gives has gravity's part
            self.mjcf.attribute(&own.own, "actuatorgravcomp") != Some("true")
        });
        let has = |tag: &str| parts.iter().find(|part| part.own.node.has_tag_name(tag));
        let inertial = has("inertial");
        self.masses.push(MassOf {
            link,
            place_m: pose.position_m,
            is_of_geoms: inertial.is_none() && has("geom").is_some(),
        });
        match inertial {
            Some(inertial) => {
                self.robot.links[link].inertial = Some(self.mjcf.inertial(&inertial.own, &place)?);
                self.weightless_between(parent, link);
            }
            None if has("geom").is_some() => self.of_geoms.push(format!("`{name}`")),
            None if self.mjcf.compiler.masses.has_bounds() => self.weightless_between(parent, link),
            None => {}
        }
        Ok((parts, link))
    }

    /// What is between two joints of one body is no body: it weighs nothing.
    fn weightless_between(&mut self, parent: usize, body: usize) {
        let mut link = body;
        while let Some(joint) = self.robot.links[link].parent_joint {
            link = self.robot.joints[joint].parent;
            if link == parent {
                return;
            }
            self.robot.links[link].inertial = Some(Inertial {
                mass_kg: 0.0,
                centre_m: [0.0; 3],
                inertia_kgm2: None,
            });
        }
    }

    /// Adds a site with a name, as a link that a chain may end at.
    fn site(&mut self, part: &Part<'d, 'input>, parent: usize) -> Result<()> {
        let node = part.own.node;
        let Some(name) = name_of(node) else {
            return Ok(());
        };
        let place = format!("site `{name}`");
        let is_line = self.mjcf.attribute(&part.own, "fromto").is_some();
        // bodies and sites may share a name: the body is meant
        if is_line || self.body_names.contains(name) || self.link_names.contains(name) {
            self.no_ends.push(format!("`{name}`"));
            return Ok(());
        }
        let pose = then(&part.frame, &self.mjcf.pose(&part.own, &place)?);
        let placed_by = PlacedBy {
            place: node.range().start,
            before: part.frame,
            behind: Pose::default(),
        };
        self.fixed(name, (parent, pose, Some(placed_by)), node.range().start)?;
        Ok(())
    }

    /// Adds a link fixed to another one.
    pub(crate) fn fixed(
        &mut self,
        name: &str,
        (parent, origin, placed_by): (usize, Pose, Option<PlacedBy>),
        place: usize,
    ) -> Result<usize> {
        let child = self.link(name.to_owned(), place)?;
        self.joint(RobotJoint {
            name: format!("{name} (fixed)"),
            joint_type: RobotJointType::Fixed,
            is_part: placed_by.is_none(),
            ..bare(place, (parent, child), origin, placed_by)
        })?;
        Ok(child)
    }

    /// A made-up name of a link that the file and what is read of it do not have.
    pub(crate) fn free_link(&self, mut name: String) -> String {
        while self.stated_links.contains(name.as_str()) || self.link_names.contains(&name) {
            name.push('_');
        }
        name
    }

    pub(crate) fn link(&mut self, name: String, place: usize) -> Result<usize> {
        if !self.link_names.insert(name.clone()) {
            let name: String = name.chars().take(60).collect();
            let message = format!("there are two bodies `{name}`: rename one");
            return Err(self.mjcf.reader.tree(place, message));
        }
        self.mjcf
            .reader
            .count("bodies and sites", self.robot.links.len() + 1, place)?;
        self.robot.links.push(RobotLink {
            name,
            place,
            inertial: None,
            parent_joint: None,
            child_joints: Vec::new(),
        });
        Ok(self.robot.links.len() - 1)
    }

    /// Adds a joint; gives its number.
    pub(crate) fn joint(&mut self, joint: RobotJoint) -> Result<usize> {
        let index = self.robot.joints.len();
        self.mjcf.reader.count("joints", index + 1, joint.place)?;
        self.robot.links[joint.parent].child_joints.push(index);
        self.robot.links[joint.child].parent_joint = Some(index);
        self.robot.joints.push(joint);
        Ok(index)
    }
}

/// The name of an element; an empty one is none, as for MuJoCo.
pub(crate) fn name_of<'d>(node: Element<'d, '_>) -> Option<&'d str> {
    node.attribute("name").filter(|name| !name.is_empty())
}

/// A joint that is only placed.
pub(crate) fn bare(
    place: usize,
    (parent, child): (usize, usize),
    origin: Pose,
    placed_by: Option<PlacedBy>,
) -> RobotJoint {
    RobotJoint {
        name: String::new(),
        place,
        inside: place,
        joint_type: RobotJointType::Fixed,
        parent,
        child,
        origin,
        origin_range: None,
        axis: [0.0, 0.0, 1.0],
        limits: None,
        armature: None,
        friction: [0.0; 2],
        effort: None,
        mimic: None,
        placed_by,
        is_part: false,
        compliance: 0.0,
        springs: Vec::new(),
    }
}

impl<'d> Mjcf<'d, '_> {
    /// Names that elements of these kinds have.
    fn stated(&self, tags: &'static [&'static str]) -> impl Iterator<Item = &'d str> + use<'d> {
        let all = self.reader.document.descendants();
        let own = all.filter(|node| tags.contains(&node.tag_name().name()));
        own.filter_map(name_of)
    }

    /// The class that an element names.
    fn named(&self, node: Element<'_, '_>, key: &'static str, around: ClassId) -> Result<ClassId> {
        self.classes.named(&self.reader, node, key, around)
    }

    fn inertial(&self, own: &Attributes<'d, '_>, place: &str) -> Result<Inertial> {
        let mass_kg = self.one(own, place, "mass")?;
        let mass_kg = mass_kg.ok_or_else(|| self.reader.missing(own.node, place, "mass"))?;
        self.reader.not_negative_mass(own.node, place, mass_kg)?;
        let pose = self.pose(own, place)?;
        let inertia = match self.some(own, place, "fullinertia")? {
            Some([xx, yy, zz, xy, xz, yz]) => {
                Some(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz))
            }
            None => {
                let diagonal = self.three(own, place, "diaginertia")?;
                diagonal.map(|diagonal| Matrix3::from_diagonal(&Vector3::from(diagonal)))
            }
        };
        Ok(Inertial {
            mass_kg,
            centre_m: pose.position_m.into(),
            inertia_kgm2: inertia.map(|own| pose.rotation * own * pose.rotation.transpose()),
        })
    }
}
