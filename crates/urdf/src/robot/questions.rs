//! Questions that the sizes of a description's numbers ask: lengths in millimetres, angles in degrees, masses in grams.

use haptical_model::sizes::{
    angle_question, length_question, limit_question, mass_question, slide_limit_question,
};

use crate::numbers::three;
use crate::robot::xml::{Element, Reader, elements};
use crate::robot::{Robot, RobotJoint, RobotJointType};

/// Most questions that are asked one by one.
const MOST: usize = 8;
/// Hinges' ranges of an MJCF in degrees: within a turn in radians they are probably radians.
const SMALL_DEGREES: f64 = 6.3;
/// From this end on a range in radians is an ordinary one.
const ORDINARY_RAD: f64 = 1.0;

/// Questions in the order of the file.
#[derive(Default)]
struct Questions {
    /// Byte, and what is asked there.
    asked: Vec<(usize, String)>,
}

impl Questions {
    fn ask(&mut self, place: usize, what: &str, question: Option<String>) {
        if let Some(question) = question {
            self.asked.push((place, format!("{what} {question}")));
        }
    }

    /// The first number of three that asks something.
    fn three(
        &mut self,
        node: Element<'_, '_>,
        (key, of): (&str, &str),
        question: fn(f64) -> Option<String>,
    ) {
        let numbers = node.attribute(key).and_then(three);
        let asked = numbers.into_iter().flatten().find_map(question);
        self.ask(node.range().start, &format!("{of}: {key}"), asked);
    }

    fn said(mut self, reader: &Reader<'_, '_>) -> Vec<String> {
        self.asked.sort_by_key(|(place, _)| *place);
        let more = self.asked.len().saturating_sub(MOST);
        let asked = self.asked.iter().take(MOST);
        let said = asked.map(|(place, what)| format!("{}: {what}", reader.position_at(*place)));
        let rest =
            (more > 0).then(|| format!("{}: {more} more numbers of such sizes", reader.file));
        said.chain(rest).collect()
    }
}

impl Reader<'_, '_> {
    /// What the sizes of a URDF's numbers ask.
    pub(crate) fn questions_of_urdf(&self, robot: &Robot) -> Vec<String> {
        let mut questions = Questions::default();
        let root = self.document.root_element();
        let inertials = elements(root, "link").flat_map(|link| elements(link, "inertial"));
        let parts = elements(root, "joint").chain(inertials);
        for origin in parts.flat_map(|part| elements(part, "origin")) {
            let of = said_of(origin.parent_element());
            questions.three(origin, ("xyz", &of), length_question);
            questions.three(origin, ("rpy", &of), angle_question);
        }
        of_robot(&mut questions, robot, "link");
        questions.said(self)
    }

    /// What the sizes of an MJCF's numbers ask.
    pub(crate) fn questions_of_mjcf(&self, robot: &Robot) -> Vec<String> {
        let mut questions = Questions::default();
        let root = self.document.root_element();
        let tags = ["body", "frame", "joint", "site", "inertial"];
        let parts = elements(root, "worldbody").flat_map(|world| world.descendants());
        for node in parts.filter(|node| tags.contains(&node.tag_name().name())) {
            let of = said_of(Some(node));
            questions.three(node, ("pos", &of), length_question);
            if robot.angle_rad == 1.0 {
                questions.three(node, ("euler", &of), angle_question);
                let angle = node.attribute("axisangle");
                let angle = angle.and_then(|text| text.split_ascii_whitespace().nth(3));
                let angle = angle.and_then(|word| word.parse().ok());
                let asked = angle.and_then(angle_question);
                questions.ask(node.range().start, &format!("{of}: the angle"), asked);
            }
        }
        of_robot(&mut questions, robot, "body");
        let mut said = questions.said(self);
        said.extend(self.asked_of_degrees(robot));
        said
    }

    /// Whether ranges that are read in degrees are probably radians.
    fn asked_of_degrees(&self, robot: &Robot) -> Option<String> {
        if robot.angle_rad == 1.0 {
            return None;
        }
        let hinges = robot.joints.iter().filter(|entry| turns(entry));
        let ends = hinges.filter_map(|entry| entry.limits);
        let ends = ends.map(|(lower, upper)| lower.abs().max(upper.abs()) / robot.angle_rad);
        let ends: Vec<f64> = ends.collect();
        let are_small = ends.iter().all(|end| *end <= SMALL_DEGREES);
        let is_ordinary = ends.len() > 1 && ends.iter().any(|end| *end > ORDINARY_RAD);
        (are_small && is_ordinary).then(|| {
            format!(
                "{}: the ranges of all hinges are within {SMALL_DEGREES} degrees; if they are in radians, write <compiler \
                 angle=\"radian\"/>",
                self.file
            )
        })
    }
}

/// A joint, or the link or body that an inertial is of, in words.
fn said_of(node: Option<Element<'_, '_>>) -> String {
    let entry = match node.filter(|entry| entry.tag_name().name() == "inertial") {
        Some(inertial) => inertial.parent_element(),
        None => node,
    };
    let tag = entry.map_or("element", |entry| entry.tag_name().name());
    let name = entry.and_then(|entry| entry.attribute("name"));
    match name {
        Some(name) => format!("{tag} `{name}`"),
        None => format!("a {tag} without a name"),
    }
}

fn turns(joint: &RobotJoint) -> bool {
    matches!(
        joint.joint_type,
        RobotJointType::Revolute | RobotJointType::Continuous
    )
}

/// Limits of joints and masses of links.
fn of_robot(questions: &mut Questions, robot: &Robot, link_word: &str) {
    for joint in &robot.joints {
        let Some((lower, upper)) = joint.limits else {
            continue;
        };
        let question = match joint.joint_type {
            RobotJointType::Revolute => limit_question,
            RobotJointType::Prismatic => slide_limit_question,
            _ => continue,
        };
        for (key, limit) in [("lower limit", lower), ("upper limit", upper)] {
            let what = format!("joint `{}`: the {key}", joint.name);
            questions.ask(joint.place, &what, question(limit));
        }
    }
    for link in &robot.links {
        let entry = link.inertial.as_ref();
        let asked =
            entry.and_then(|entry| mass_question(entry.mass_kg, entry.inertia_kgm2.as_ref()?));
        questions.ask(link.place, &format!("{link_word} `{}`", link.name), asked);
    }
}
