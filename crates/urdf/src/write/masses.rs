//! Masses that a device has other than its description: what a row carries more goes to the link behind the row's joint.

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::rigid::{inverse, turn};
use haptical_model::{Body, Device};

use crate::chain::gravity::gravity_mps2;
use crate::chain::masses::carried;
use crate::device::ReadChain;
use crate::numbers::written;
use crate::rigid::z_to;
use crate::robot::xml::Element;
use crate::robot::{Inertial, RobotJointType};
use crate::write::corrected::indent_at;
use crate::write::patched::Edit;

/// Below this share two numbers of a body are one.
const SAME: f64 = 1e-9;

/// Mass, first moment and inertia about the frame's origin: they add up.
#[derive(Debug, Clone, Copy)]
struct Moments {
    mass_kg: f64,
    first_kgm: Vector3<f64>,
    about_origin_kgm2: Matrix3<f64>,
}

impl Moments {
    fn new(mass_kg: f64, centre_m: Vector3<f64>, about_centre_kgm2: Matrix3<f64>) -> Self {
        Self {
            mass_kg,
            first_kgm: centre_m * mass_kg,
            about_origin_kgm2: about_centre_kgm2 + steiner(&centre_m) * mass_kg,
        }
    }

    fn of_body(body: &Body) -> Self {
        let [xx, yy, zz, xy, xz, yz] = body.inertia_kgm2.unwrap_or([0.0; 6]);
        Self::new(
            body.mass_kg,
            Vector3::from(body.centre_of_mass_m),
            Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        )
    }

    fn plus(&self, other: &Self, factor: f64) -> Self {
        Self {
            mass_kg: self.mass_kg + factor * other.mass_kg,
            first_kgm: self.first_kgm + other.first_kgm * factor,
            about_origin_kgm2: self.about_origin_kgm2 + other.about_origin_kgm2 * factor,
        }
    }

    /// The same, which may have no mass, in a frame in which its own has a pose.
    fn seen_from(&self, pose: &Pose) -> Self {
        let (rotation, p) = (&pose.rotation, &pose.position_m);
        let first = rotation * self.first_kgm;
        // the integral of |p + r|^2 1 - (p + r)(p + r)^T
        let outer = p * (first + p * (0.5 * self.mass_kg)).transpose();
        let shift = Matrix3::from_diagonal_element(2.0 * outer.trace()) - outer - outer.transpose();
        Self {
            mass_kg: self.mass_kg,
            first_kgm: first + p * self.mass_kg,
            about_origin_kgm2: rotation * self.about_origin_kgm2 * rotation.transpose() + shift,
        }
    }

    fn inertial(&self) -> Option<Inertial> {
        if self.mass_kg <= 0.0 {
            return None;
        }
        let centre_m = self.first_kgm / self.mass_kg;
        let about_centre = self.about_origin_kgm2 - steiner(&centre_m) * self.mass_kg;
        Some(Inertial {
            mass_kg: self.mass_kg,
            centre_m: centre_m.into(),
            inertia_kgm2: Some((about_centre + about_centre.transpose()) * 0.5),
        })
    }
}

/// Inertia of 1 kg at a point.
fn steiner(at_m: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_diagonal_element(at_m.norm_squared()) - at_m * at_m.transpose()
}

/// What links carry in the corrected description, and what could not be put in.
pub(crate) fn new_inertials(
    read: &ReadChain,
    device: &Device,
    file: &str,
) -> (Vec<(usize, Inertial)>, Vec<String>) {
    let (robot, paths, rows) = (&read.robot, &read.paths, &read.rows);
    let Some(gravity) = gravity_mps2(robot, &paths[0]) else {
        return Default::default();
    };
    let mut warnings = Vec::new();
    let before = carried(robot, paths, rows, file).bodies;
    let mut found = Vec::new();
    for (index, row) in rows.rows.iter().enumerate() {
        let now = device.bodies.get(index + 1).copied().flatten();
        let was = before.get(index).copied().flatten();
        let Some(now) = now.filter(|now| !was.is_some_and(|was| is_same(now, &was))) else {
            continue;
        };
        let joint = &robot.joints[row.joint];
        let mut more = Moments::of_body(&now);
        if let Some(was) = &was {
            more = more.plus(&Moments::of_body(was), -1.0);
        }
        // from the row, its axis along z, to the frame of the joint's link, and on to the body's
        more = more.seen_from(&turn(z_to(&joint.axis)));
        let mut link = joint.child;
        while let Some(part) = (robot.links[link].child_joints.iter())
            .map(|own| &robot.joints[*own])
            .find(|own| own.is_part && own.joint_type == RobotJointType::Fixed)
        {
            more = more.seen_from(&inverse(&part.origin));
            link = part.child;
        }
        let own = robot.links[link].inertial.map_or_else(
            || Moments::new(0.0, Vector3::zeros(), Matrix3::zeros()),
            |own| {
                Moments::new(
                    own.mass_kg,
                    Vector3::from(own.centre_m),
                    own.inertia_kgm2.unwrap_or_else(Matrix3::zeros),
                )
            },
        );
        match own.plus(&more, 1.0).inertial() {
            Some(inertial) => found.push((link, inertial)),
            None => warnings.push(format!(
                "{file}: the link `{}` would have no mass left: its mass stays as it is",
                robot.links[link].name
            )),
        }
    }
    let is_tilted = device.gravity_mps2.is_some_and(|own| {
        let off = Vector3::from(own) - Vector3::from(gravity);
        off.norm() > SAME * Vector3::from(gravity).norm()
    });
    if is_tilted {
        warnings.push(format!(
            "{file}: the direction of gravity is not put in: it is that of the world, and the mount is tilted; turn the base against it"
        ));
    }
    (found, warnings)
}

fn is_same(now: &Body, was: &Body) -> bool {
    let near = |a: &[f64], b: &[f64]| {
        let size = a
            .iter()
            .chain(b)
            .fold(0.0_f64, |most, own| most.max(own.abs()));
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME * size)
    };
    near(&[now.mass_kg], &[was.mass_kg])
        && near(&now.centre_of_mass_m, &was.centre_of_mass_m)
        && match (now.inertia_kgm2, was.inertia_kgm2) {
            (Some(now), Some(was)) => near(&now, &was),
            (now, _) => now.is_none(),
        }
}

/// Puts an inertial into a link of a URDF or a body of an MJCF; none where the element is another's.
pub(crate) fn edit(text: &str, node: Element<'_, '_>, inertial: &Inertial, is_mjcf: bool) -> Edit {
    let element = match is_mjcf {
        true => of_mjcf(inertial),
        false => of_urdf(inertial),
    };
    if let Some(own) = node.children().find(|own| own.has_tag_name("inertial")) {
        return (own.range(), element);
    }
    let range = node.range();
    let whole = text.get(range.clone()).unwrap_or_default();
    // behind the opening tag, or in the place of the end of an element without content
    let children = node.first_child().map(|own| own.range().start);
    match children {
        Some(inside) => {
            let indent = indent_at(text, inside);
            (inside..inside, format!("{indent}{element}"))
        }
        None if whole.ends_with("/>") => (
            range.end - 2..range.end,
            format!(">{element}</{}>", node.tag_name().name()),
        ),
        None => {
            let inside = range.start + whole.rfind("</").unwrap_or(whole.len());
            (inside..inside, element)
        }
    }
}

fn entries(inertial: &Inertial) -> [f64; 6] {
    let own = inertial.inertia_kgm2.unwrap_or_else(Matrix3::zeros);
    [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|place| own[place])
}

fn of_urdf(inertial: &Inertial) -> String {
    let [xx, yy, zz, xy, xz, yz] = entries(inertial).map(|own| written(&[own]));
    format!(
        "<inertial> <origin xyz=\"{}\" rpy=\"0 0 0\"/> <mass value=\"{}\"/> <inertia ixx=\"{xx}\" ixy=\"{xy}\" ixz=\"{xz}\" iyy=\"{yy}\" \
         iyz=\"{yz}\" izz=\"{zz}\"/> </inertial>",
        written(&inertial.centre_m),
        written(&[inertial.mass_kg])
    )
}

fn of_mjcf(inertial: &Inertial) -> String {
    format!(
        "<inertial pos=\"{}\" mass=\"{}\" fullinertia=\"{}\"/>",
        written(&inertial.centre_m),
        written(&[inertial.mass_kg]),
        written(&entries(inertial))
    )
}
