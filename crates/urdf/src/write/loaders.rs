//! What programs that read URDF make of what a file has, and of what it lacks: by name, before it surprises.

use roxmltree::{Document, Node};

use crate::UrdfError;
use crate::robot::prefixes::without_prefixes;
use crate::robot::xml::document;
use crate::words::joined;

/// A program that reads URDF.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loader {
    /// Pinocchio.
    Pinocchio,
    /// Drake.
    Drake,
    /// Isaac Sim and Isaac Lab, through their URDF importer.
    Isaac,
    /// MoveIt 2.
    Moveit,
}

impl Loader {
    /// Its name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pinocchio => "Pinocchio",
            Self::Drake => "Drake",
            Self::Isaac => "Isaac",
            Self::Moveit => "MoveIt",
        }
    }

    /// Whether it simulates bodies, so that what moves needs a mass.
    pub(crate) fn simulates(self) -> bool {
        !matches!(self, Self::Moveit)
    }
}

/// What a loader ignores or takes otherwise of a URDF, a sentence each, with the names of links and joints
/// (docs/guides/put-into-robot.md has the list and its sources).
///
/// ```
/// use haptical_urdf::{Loader, loader_notes};
/// let text = r#"<robot name="lever"> <link name="base"/> <link name="arm"/>
///   <joint name="shoulder" type="revolute"> <parent link="base"/> <child link="arm"/>
///     <limit lower="-1" upper="1" effort="0" velocity="1"/>
///   </joint>
/// </robot>"#;
/// let notes = loader_notes(text, "lever.urdf", Loader::Drake)?;
/// assert!(notes.iter().any(|own| own.contains("no actuator") && own.contains("`shoulder`")));
/// assert!(notes.iter().any(|own| own.contains("no mass") && own.contains("`arm`")));
/// # Ok::<(), haptical_urdf::UrdfError>(())
/// ```
///
/// # Errors
/// [`UrdfError`] where the text is no XML.
pub fn loader_notes(text: &str, file: &str, loader: Loader) -> Result<Vec<String>, UrdfError> {
    let plain = without_prefixes(text);
    let document = document(&plain, file)?;
    let facts = Facts::new(&Description::new(&document));
    let notes = match loader {
        Loader::Pinocchio => facts.for_pinocchio(),
        Loader::Drake => facts.for_drake(),
        Loader::Isaac => facts.for_isaac(),
        Loader::Moveit => facts.for_moveit(),
    };
    let notes = notes.into_iter().filter(|(names, _)| !names.is_empty());
    let notes = notes.map(|(names, what)| {
        let sentence = what.replace('%', &joined(names));
        format!("{}: {sentence}", loader.name())
    });
    Ok(notes.collect())
}

/// Names of links and joints, and a sentence in which `%` stands for them.
type Note<'f> = (&'f [String], &'static str);

/// Names of joints, and of links, of which something is to be said.
struct Facts {
    velocity_0: Vec<String>,
    effort_0: Vec<String>,
    follow: Vec<String>,
    friction: Vec<String>,
    continuous: Vec<String>,
    no_transmission: Vec<String>,
    /// Links.
    massless: Vec<String>,
    /// Links with a number between blanks in their masses.
    padded: Vec<String>,
}

impl Facts {
    fn new(robot: &Description<'_, '_>) -> Self {
        let moving = || robot.joints.iter().copied().filter(moves);
        let number = |node: Option<Node<'_, '_>>, key: &str| -> Option<f64> {
            node?.attribute(key)?.trim().parse().ok()
        };
        let is_0 = |key| move |own: &Node<'_, '_>| number(child(own, "limit"), key) == Some(0.0);
        let follows = |own: &Node<'_, '_>| child(own, "mimic").is_some();
        let rubs = |own: &Node<'_, '_>| {
            number(child(own, "dynamics"), "friction").is_some_and(|own| own != 0.0)
        };
        let driven = moving().filter(|own| !follows(own));
        Self {
            velocity_0: named(moving().filter(is_0("velocity"))),
            effort_0: named(moving().filter(is_0("effort"))),
            follow: named(moving().filter(follows)),
            friction: named(moving().filter(rubs)),
            continuous: named(moving().filter(|own| own.attribute("type") == Some("continuous"))),
            no_transmission: named(driven.filter(|own| !robot.has_transmission(own))),
            massless: robot.massless(),
            padded: named(robot.links.iter().copied().filter(has_padded_masses)),
        }
    }

    fn for_pinocchio(&self) -> Vec<Note<'_>> {
        vec![
            (&self.velocity_0, "velocity 0 is a limit of 0, of %"),
            (&self.effort_0, "effort 0 is a limit of 0, of %"),
            (
                &self.follow,
                "% follow another joint only with `mimic=True`; else each moves by itself",
            ),
            (
                &self.continuous,
                "a continuous joint is two numbers in q, its cosine and its sine: %",
            ),
            (
                &self.massless,
                "% move and have no mass: kinematics stand, accelerations do not",
            ),
            (
                &self.padded,
                "a number with a blank before or behind it is none to its reader, which then leaves out the <inertial> of %",
            ),
        ]
    }

    fn for_drake(&self) -> Vec<Note<'_>> {
        vec![
            (
                &self.no_transmission,
                "% have no <transmission>, and so no actuator",
            ),
            (&self.effort_0, "effort 0 means no actuator: %"),
            (&self.velocity_0, "velocity 0 is a limit of 0, of %"),
            (
                &self.friction,
                "`friction` is ignored, of %; `damping` is read",
            ),
            (
                &self.follow,
                "% follow another joint in a discrete plant alone (time_step above 0)",
            ),
            (
                &self.massless,
                "% move and have no mass: kinematics stand, a simulation fails",
            ),
        ]
    }

    fn for_isaac(&self) -> Vec<Note<'_>> {
        vec![
            (
                &self.massless,
                "% have no mass: the importer makes masses up, of a density or of collision shapes",
            ),
            (
                &self.velocity_0,
                "velocity 0 is a limit of 0, of %: they stand still",
            ),
            (
                &self.effort_0,
                "effort 0 is a limit of 0, of %: they are not driven",
            ),
            (
                &self.friction,
                "`friction` is a coefficient to PhysX, not a torque, of %: set it there",
            ),
            (
                &self.follow,
                "% follow another joint only where the importer parses mimic tags",
            ),
        ]
    }

    fn for_moveit(&self) -> Vec<Note<'_>> {
        vec![
            (
                &self.velocity_0,
                "velocity 0 lets no trajectory be timed: give max_velocity of % in joint_limits.yaml",
            ),
            (
                &self.friction,
                "`friction` and `damping` are not used, of %",
            ),
        ]
    }
}

struct Description<'d, 'i> {
    joints: Vec<Node<'d, 'i>>,
    links: Vec<Node<'d, 'i>>,
    transmissions: Vec<Node<'d, 'i>>,
}

impl<'d, 'i> Description<'d, 'i> {
    fn new(document: &'d Document<'i>) -> Self {
        let children = |tag: &'static str| {
            let root = document.root_element().children();
            root.filter(move |own| own.has_tag_name(tag)).collect()
        };
        Self {
            joints: children("joint"),
            links: children("link"),
            transmissions: children("transmission"),
        }
    }

    fn has_transmission(&self, joint: &Node<'_, '_>) -> bool {
        let name = joint.attribute("name");
        let mut joints = self.transmissions.iter().flat_map(Node::children);
        joints.any(|own| own.has_tag_name("joint") && own.attribute("name") == name)
    }

    /// Links that a joint moves and that carry no mass, neither of their own nor fixed to them.
    fn massless(&self) -> Vec<String> {
        let link_of = |joint: &Node<'_, '_>, end: &str| {
            child(joint, end)
                .and_then(|own| own.attribute("link"))
                .map(str::to_owned)
        };
        let has_mass = |name: &str| {
            let mut links = self.links.iter();
            let link = links.find(|own| own.attribute("name") == Some(name));
            let mass = link.and_then(|own| child(&child(own, "inertial")?, "mass"));
            let mass = mass.and_then(|own| own.attribute("value")?.trim().parse::<f64>().ok());
            mass.is_some_and(|own| own > 0.0)
        };
        let carried = |name: &str| {
            let mut all = vec![name.to_owned()];
            let mut next = 0;
            while next < all.len() && all.len() <= self.links.len() {
                let own = all[next].clone();
                let fixed = self.joints.iter().filter(|joint| !moves(joint));
                let fixed = fixed.filter(|joint| link_of(joint, "parent").as_deref() == Some(&own));
                all.extend(fixed.filter_map(|joint| link_of(joint, "child")));
                next += 1;
            }
            all
        };
        let moved = self.joints.iter().filter(|joint| moves(joint));
        let moved = moved.filter_map(|joint| link_of(joint, "child"));
        moved
            .filter(|name| !carried(name).iter().any(|own| has_mass(own)))
            .map(|name| format!("`{name}`"))
            .collect()
    }
}

fn child<'d, 'i>(node: &Node<'d, 'i>, tag: &str) -> Option<Node<'d, 'i>> {
    node.children().find(|own| own.has_tag_name(tag))
}

/// Whether a number of a link's mass or inertia has a blank before or behind it, as `"0.1 "`.
fn has_padded_masses(link: &Node<'_, '_>) -> bool {
    let inertial = child(link, "inertial").into_iter();
    let mut parts = inertial.flat_map(|own| own.children());
    parts.any(|own| {
        let mut numbers = own.attributes();
        matches!(own.tag_name().name(), "mass" | "inertia")
            && numbers.any(|own| own.value() != own.value().trim())
    })
}

fn moves(joint: &Node<'_, '_>) -> bool {
    joint.attribute("type") != Some("fixed")
}

fn named<'d, 'i: 'd>(joints: impl Iterator<Item = Node<'d, 'i>>) -> Vec<String> {
    joints
        .filter_map(|joint| Some(format!("`{}`", joint.attribute("name")?)))
        .collect()
}
