//! Forces of an MJCF that a device does not have: of springs, tendons, a fluid, and of bodies that are tied. They are named.

use crate::numbers::number;
use crate::robot::Robot;
use crate::robot::mjcf::Mjcf;
use crate::robot::mjcf::classes::Classes;
use crate::robot::xml::{Element, Result, elements};
use crate::words::joined;

/// Attributes of a tendon that make forces.
const OF_TENDONS: [&str; 4] = ["stiffness", "damping", "frictionloss", "armature"];
/// Attributes of an actuator that load its joint by themselves.
const OF_ACTUATORS: [&str; 2] = ["armature", "damping"];

/// Whether any number of a text is not 0.
pub(crate) fn is_some(text: &str) -> bool {
    let mut words = text.split_ascii_whitespace();
    words.any(|word| number(word).is_some_and(|own| own != 0.0))
}

/// Whether any number of a text behind the first is not 0.
pub(crate) fn is_curved(text: &str) -> bool {
    let mut words = text.split_ascii_whitespace().skip(1);
    words.any(is_some)
}

impl<'d, 'input> Mjcf<'d, 'input> {
    /// Names what loads joints and is in no device.
    pub(crate) fn say_what_is_unread(&self, robot: &mut Robot) -> Result<()> {
        let mut said = Vec::new();
        self.fluid(&mut said);
        self.ties(&mut said)?;
        self.loads("tendon", &["tendon"], &OF_TENDONS, "tendons", &mut said)?;
        self.loads(
            "actuator",
            &crate::robot::mjcf::efforts::KINDS,
            &OF_ACTUATORS,
            "actuators",
            &mut said,
        )?;
        robot.notes.extend(said);
        Ok(())
    }

    /// What is said of joints by their names: of springs, of springs and dampers that MuJoCo works out, and of damping by more
    /// than one number.
    pub(crate) fn said_of_joints(&self, [sprung, tuned, curved]: [&[String]; 3]) -> Vec<String> {
        let file = self.reader.file;
        let said = [
            (
                sprung,
                "stiffness of",
                "is left out: torques of a simulator that has it have the part of these springs",
            ),
            (
                tuned,
                "springdamper of",
                "is left out: MuJoCo works out stiffness and damping of it, and its torques have their part",
            ),
            (
                curved,
                "damping of",
                "is its first number alone: torques of a simulator at speed have the part of the others",
            ),
        ];
        let said = said.into_iter().filter(|(names, ..)| !names.is_empty());
        said.map(|(names, what, why)| format!("{file}: {what} {} {why}", joined(names)))
            .collect()
    }

    fn sections(
        &self,
        name: &'static str,
    ) -> impl Iterator<Item = Element<'d, 'input>> + use<'d, 'input> {
        let root = self.reader.document.root_element();
        let parts = elements(root, name).flat_map(|section| section.children());
        parts.filter(Element::is_element)
    }

    fn fluid(&self, said: &mut Vec<String>) {
        let root = self.reader.document.root_element();
        for node in elements(root, "option") {
            let keys = ["density", "viscosity"].into_iter();
            let stated: Vec<&str> = keys
                .filter(|key| node.attribute(*key).is_some_and(is_some))
                .collect();
            if !stated.is_empty() {
                let at = self.reader.position_at(node.range().start);
                let what = stated.join(" and ");
                said.push(format!(
                    "{at}: the {what} of <option> is left out: a simulator's bodies move in a fluid, which loads the joints"
                ));
            }
        }
    }

    /// Equalities of anything but two joints.
    fn ties(&self, said: &mut Vec<String>) -> Result<()> {
        for node in self.sections("equality") {
            let tag = node.tag_name().name();
            let class = self
                .classes
                .named(&self.reader, node, "class", Classes::OUTERMOST)?;
            let stated = node
                .attribute("active")
                .or_else(|| self.classes.stated(class, "equality", "active"));
            if tag == "joint" || stated == Some("false") {
                continue;
            }
            let at = self.reader.position_at(node.range().start);
            said.push(format!(
                "{at}: <{tag}> of <equality> is left out: what it ties is free here, and its forces load no joint"
            ));
        }
        Ok(())
    }

    /// Elements of a section that load joints by themselves.
    fn loads(
        &self,
        section: &'static str,
        tags: &[&str],
        keys: &[&'static str],
        what: &str,
        said: &mut Vec<String>,
    ) -> Result<()> {
        let mut names: Vec<String> = Vec::new();
        let mut found: Vec<&str> = Vec::new();
        for node in self.sections(section) {
            let class = self
                .classes
                .named(&self.reader, node, "class", Classes::OUTERMOST)?;
            let has = |key: &str| {
                let stated = node.attribute(key);
                let stated = stated.or_else(|| self.classes.stated_of(class, tags, key));
                stated.is_some_and(is_some)
            };
            let own: Vec<&str> = keys.iter().copied().filter(|key| has(key)).collect();
            if own.is_empty() {
                continue;
            }
            let name = node.attribute("name").or_else(|| node.attribute("joint"));
            names.push(format!("`{}`", name.unwrap_or("without a name")));
            found.extend(
                own.into_iter()
                    .filter(|key| !found.contains(key))
                    .collect::<Vec<_>>(),
            );
        }
        if !names.is_empty() {
            let (file, found) = (self.reader.file, found.join(", "));
            names.dedup();
            said.push(format!(
                "{file}: {found} of {what} is left out, which loads joints in a simulator: {}",
                joined(&names)
            ));
        }
        Ok(())
    }
}
