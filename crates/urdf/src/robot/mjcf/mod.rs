//! Reads an MJCF, MuJoCo's XML: bodies as links, hinges and slides as joints, every complaint with line and column.

mod bodies;
mod bonds;
mod classes;
mod compiler;
mod efforts;
pub(crate) mod frames;
pub(crate) mod include;
mod joints;
mod masses;
mod unread;

use std::collections::{BTreeMap, BTreeSet};

use crate::UrdfError;
use crate::robot::Robot;
use crate::robot::mjcf::bodies::Bodies;
use crate::robot::mjcf::classes::{ClassId, Classes};
use crate::robot::mjcf::compiler::Compiler;
use crate::robot::mjcf::efforts::{Efforts, efforts};
use crate::robot::mjcf::include::refuse_includes;
use crate::robot::prefixes::without_prefixes;
use crate::robot::xml::{Element, Reader, Result, document, elements};

/// An MJCF with what its elements depend on.
pub(crate) struct Mjcf<'d, 'input> {
    pub(crate) reader: Reader<'d, 'input>,
    classes: Classes<'d>,
    compiler: Compiler,
    /// Joints that an actuator moves.
    actuated: BTreeSet<&'d str>,
    /// Joints that an equality binds to another one.
    bound: BTreeSet<&'d str>,
    /// What their actuators give.
    efforts: Efforts<'d>,
}

/// An element with the class whose defaults it has.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Attributes<'d, 'input> {
    pub(crate) node: Element<'d, 'input>,
    pub(crate) class: ClassId,
}

/// Reads an MJCF; `file` names it in errors.
pub(crate) fn parse(text: &str, file: &str) -> Result<Robot> {
    let plain = without_prefixes(text);
    let document = document(&plain, file)?;
    let reader = Reader {
        document: &document,
        file,
    };
    let root = document.root_element();
    if root.tag_name().name() != "mujoco" {
        let found = root.tag_name().name();
        return Err(UrdfError::NotMjcf {
            at: reader.position_at(root.range().start),
            found: found.to_owned(),
            advice: what_it_is(found),
        });
    }
    let mut robot = Robot {
        name: root.attribute("model").unwrap_or("robot").to_owned(),
        ..Robot::default()
    };
    refuse_includes(&reader)?;
    let classes = Classes::read(&reader)?;
    let compiler = Compiler::read(&reader, &mut robot)?;
    let mjcf = Mjcf {
        efforts: efforts(&reader, &classes, compiler.has_automatic_limits)?,
        reader,
        classes,
        compiler,
        actuated: names(root, "actuator", &["joint", "jointinparent"]),
        bound: names(root, "equality", &["joint1"]),
    };
    let references = Bodies::read(&mjcf, &mut robot)?;
    mjcf.bind(&mut robot, &references)?;
    mjcf.say_what_is_unread(&mut robot)?;
    let questions = mjcf.reader.questions_of_mjcf(&robot);
    robot.notes.extend(questions);
    Ok(robot)
}

/// Where each joint is in the initial configuration \[rad\] or \[m\], by its name.
pub(crate) type References = BTreeMap<String, f64>;

/// Names that attributes of a section's elements give.
fn names<'d>(
    root: Element<'d, '_>,
    section: &'static str,
    keys: &[&'static str],
) -> BTreeSet<&'d str> {
    let parts = elements(root, section).flat_map(|section| section.children());
    let named = parts.flat_map(|part| keys.iter().filter_map(move |key| part.attribute(*key)));
    named.collect()
}

/// What a document is that is no MJCF.
fn what_it_is(root: &str) -> &'static str {
    match root {
        "robot" => "it looks like URDF: name it .urdf",
        "sdf" => "it looks like SDF: convert it to URDF",
        _ => "give an MJCF, or a URDF with a name that ends in .urdf",
    }
}

impl<'d> Mjcf<'d, '_> {
    /// An attribute of an element, or what its class has.
    pub(crate) fn attribute(&self, own: &Attributes<'d, '_>, key: &str) -> Option<&'d str> {
        let tag = own.node.tag_name().name();
        let stated = own.node.attribute(key);
        stated.or_else(|| self.classes.stated(own.class, tag, key))
    }

    /// One number of an attribute.
    fn one(&self, own: &Attributes<'d, '_>, place: &str, key: &'static str) -> Result<Option<f64>> {
        Ok(self.some(own, place, key)?.map(|[number]: [f64; 1]| number))
    }
}
