//! Masses of a device in the links of the description that it came from: what a row carries more than the file says is given to the
//! link that its joint moves, and what is fixed to that link stays as it is.

use std::ops::Range;

use haptical_model::dynamics::Inertia;
use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::rigid::{inverse, then, turn};
use haptical_model::{Body, Device, Segments};
use roxmltree::Node;

use crate::UrdfError;
use crate::chain::gravity::gravity_mps2;
use crate::chain::masses::carried;
use crate::device::ReadChain;
use crate::numbers::written;
use crate::rigid::z_to;
use crate::robot::{Inertial, Robot};

/// Digits of a file leave this share of a number.
const SAME: f64 = 1e-12;

/// From this share of it on the direction of gravity is another one.
const TILTED: f64 = 1e-9;

/// A link with another mass.
pub(crate) struct Weighed {
    pub(crate) link: usize,
    /// In the link's frame.
    pub(crate) inertia: Inertia,
}

/// Links whose masses the device has otherwise, and what cannot be put in.
///
/// # Errors
/// A device that is not of this description.
pub(crate) fn weighed(
    read: &ReadChain,
    device: &Device,
    file: &str,
) -> Result<(Vec<Weighed>, Vec<String>), UrdfError> {
    let ReadChain {
        robot, paths, rows, ..
    } = read;
    let was = carried(robot, paths, rows, file).bodies;
    let segments = Segments::of_device(device)?;
    let (mut links, mut said) = (Vec::new(), Vec::new());
    for (index, (row, was)) in rows.rows.iter().zip(&was).enumerate() {
        let now = device.bodies.get(index + 1).copied().flatten();
        let Some(body) = segments.rows.get(index).and_then(|own| own.body) else {
            continue;
        };
        if is_same(now.as_ref(), was.as_ref()) {
            continue;
        }
        let joint = &robot.joints[row.joint];
        let refuse = |why: &str| {
            format!(
                "{file}: the mass of row {} was not put into `{}`: {why}",
                index + 1,
                robot.links[joint.child].name
            )
        };
        if !paths.iter().all(|own| is_rooted(robot, own.base)) {
            said.push(refuse("its chain does not begin at the root"));
            continue;
        }
        let own = body.inertia_kgm2.unwrap_or_else(Matrix3::zeros);
        let now = Inertia::about_centre(body.mass_kg, &body.centre_m, &own);
        let turned = turn(z_to(&joint.axis));
        let to_link = |own: &Inertia, link: &Pose| own.seen_from(&then(&inverse(link), &turned));
        let (link, pose) = own_link(robot, joint.child);
        let stated = robot.links[link].inertial.as_ref().map(inertia_of);
        let inertia = sum(&[
            (to_link(&now, &pose), 1.0),
            (
                to_link(&was.as_ref().map(of_body).unwrap_or_default(), &pose),
                -1.0,
            ),
            (stated.unwrap_or_default(), 1.0),
        ]);
        if inertia.mass_kg > 0.0 && inertia.is_physical() {
            links.push(Weighed { link, inertia });
        } else {
            said.push(refuse(
                "beside what is fixed to that link no body has it; `haptical export` of a new description has it",
            ));
        }
    }
    let tilted = gravity_mps2(robot, &paths[0]).zip(device.gravity_mps2);
    if tilted.is_some_and(|(was, now)| {
        let was = Vector3::from(was);
        (Vector3::from(now) - was).norm() > TILTED * was.norm()
    }) {
        said.push(format!(
            "{file}: the direction of gravity is not put in: it is that of the world, and the mount is tilted; turn the base against it"
        ));
    }
    Ok((links, said))
}

/// Whether nothing that moves is between a link and the root.
fn is_rooted(robot: &Robot, mut link: usize) -> bool {
    while let Some(joint) = robot.links[link].parent_joint {
        if robot.joints[joint].moves() {
            return false;
        }
        link = robot.joints[joint].parent;
    }
    true
}

/// The link with an element of its own that constant parts of joints lead to, and its frame in that of the first.
fn own_link(robot: &Robot, mut link: usize) -> (usize, Pose) {
    let mut pose = Pose::default();
    loop {
        let mut parts = robot.links[link].child_joints.iter();
        match parts.find(|own| robot.joints[**own].is_part && !robot.joints[**own].moves()) {
            Some(own) => {
                let joint = &robot.joints[*own];
                pose = then(&pose, &joint.origin);
                link = joint.child;
            }
            None => return (link, pose),
        }
    }
}

fn is_same(now: Option<&Body>, was: Option<&Body>) -> bool {
    let (Some(now), Some(was)) = (now, was) else {
        return now.is_none() && was.is_none();
    };
    let numbers = |own: &Body| {
        let [x, y, z] = own.centre_of_mass_m;
        let [xx, yy, zz, xy, xz, yz] = own.inertia_kgm2.unwrap_or_default();
        [own.mass_kg, x, y, z, xx, yy, zz, xy, xz, yz]
    };
    let mut pairs = numbers(now).into_iter().zip(numbers(was));
    pairs.all(|(now, was)| (now - was).abs() <= SAME * (1.0 + was.abs()))
}

fn of_body(body: &Body) -> Inertia {
    let [xx, yy, zz, xy, xz, yz] = body.inertia_kgm2.unwrap_or_default();
    let own = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    Inertia::about_centre(body.mass_kg, &Vector3::from(body.centre_of_mass_m), &own)
}

fn inertia_of(own: &Inertial) -> Inertia {
    let about = own.inertia_kgm2.unwrap_or_else(Matrix3::zeros);
    Inertia::about_centre(own.mass_kg, &Vector3::from(own.centre_m), &about)
}

fn sum(parts: &[(Inertia, f64)]) -> Inertia {
    let mut all = [0.0; 10];
    for (own, factor) in parts {
        (all.iter_mut().zip(own.parameters())).for_each(|(into, value)| *into += factor * value);
    }
    Inertia::from_parameters(all)
}

/// Centre, mass and xx, yy, zz, xy, xz, yz about it, as text.
fn texts(own: &Inertia) -> (String, String, [String; 6]) {
    let about = own.about_centre_kgm2();
    let centre: [f64; 3] = own.centre_of_mass_m().unwrap_or_default().into();
    let entries = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
    (
        written(&centre),
        written(&[own.mass_kg]),
        entries.map(|place| written(&[about[place]])),
    )
}

/// `<inertial>` of a URDF.
pub(crate) fn urdf_element(own: &Inertia) -> String {
    let (centre, mass, [xx, yy, zz, xy, xz, yz]) = texts(own);
    format!(
        "<inertial><origin xyz=\"{centre}\" rpy=\"0 0 0\"/><mass value=\"{mass}\"/><inertia ixx=\"{xx}\" ixy=\"{xy}\" \
         ixz=\"{xz}\" iyy=\"{yy}\" iyz=\"{yz}\" izz=\"{zz}\"/></inertial>"
    )
}

/// `<inertial>` of an MJCF.
pub(crate) fn mjcf_element(own: &Inertia) -> String {
    let (centre, mass, entries) = texts(own);
    let entries = entries.join(" ");
    format!("<inertial pos=\"{centre}\" mass=\"{mass}\" fullinertia=\"{entries}\"/>")
}

/// Puts an element into another one, in the place of the one of its name.
pub(crate) fn put(
    text: &str,
    node: Node<'_, '_>,
    tag: &str,
    element: &str,
) -> (Range<usize>, String) {
    let mut children = node.children().filter(Node::is_element);
    if let Some(own) = children.find(|own| own.has_tag_name(tag)) {
        return (own.range(), element.to_owned());
    }
    let whole = &text[node.range()];
    if let Some(head) = whole.strip_suffix("/>") {
        let from = node.range().start + head.trim_end().len();
        let name = node.tag_name().name();
        return (from..node.range().end, format!(">{element}</{name}>"));
    }
    // behind the opening tag, whose attributes may hold a `>`
    let behind = node
        .attributes()
        .map(|own| own.range().end)
        .max()
        .unwrap_or(node.range().start);
    let at = text[behind..]
        .find('>')
        .map_or(behind, |end| behind + end + 1);
    (at..at, element.to_owned())
}
