//! An MJCF (MuJoCo's XML) of a device: a model that can be simulated.

pub(crate) mod dynamics;
mod sections;
pub(crate) mod snippet;
mod weightless;

use std::fmt::Write;

use haptical_model::{Device, JointType, Origin};

use crate::UrdfError;
use crate::numbers::{commented, escaped, written};
use crate::write::effects::{Effects, YieldKind};
use crate::write::mjcf::dynamics::{RowDynamics, row_dynamics};
use crate::write::mjcf::weightless::set_weightless;
use crate::write::names::{joint_names, said_of_renamed};
use crate::write::not_carried::{self, Form, not_carried};
use crate::write::urdf::{FAR, scaled};
use haptical_model::RowBody;
use haptical_model::Segments;

/// Gravity where a device has none \[m/s^2\]: MuJoCo's own. Assumption A152.
pub(crate) const GRAVITY_MPS2: [f64; 3] = [0.0, 0.0, -9.81];
/// Shortest stretch of a link that is drawn as a rod \[m\].
const SHORTEST_DRAWN_M: f64 = 1e-3;

/// A model of a device with all that goes into its file.
struct Model<'d> {
    device: &'d Device,
    segments: Segments,
    names: Vec<String>,
    bodies: Vec<RowBody>,
    rows: Vec<RowDynamics>,
    effects: Effects<'d>,
    step_s: f64,
}

/// An MJCF with a body for each row, joints along z with their ranges, actuators that hold each joint, sensors, and a site
/// `handle`, or one for each hand by its name; and what it leaves out or makes up. Its joint values are those of
/// [`new_urdf`](crate::new_urdf): the readings of a log, 0 at home. Rows that follow another's joint are bound to it by an
/// `<equality>`.
///
/// The file is made to be simulated. Masses, centres and inertias are the device's; where it has none, and for what no
/// device has (armature, damping, gains), plausible ones stand there and a comment beside them says so (docs/assumptions.md,
/// A150 to A152). They and the time step are chosen so that MuJoCo's integrator `implicitfast` is stable
/// (docs/equations.md, A simulated model that stands).
///
/// What a joint yields to its torque is a further hinge along its axis, with its stiffness; so are the effects
/// `capstan-compliance`, `backlash` (a hinge with a range and no spring) and `cross-coupling` (bound to the other joint).
/// `joint-friction` is friction loss and damping; `encoder-latency` and `external-encoder-latency` are delays of sensors.
/// Other effects are listed in a comment, with Python that adds them to the readings where that can be done.
///
/// Sensors are called as a log's columns: `theta1_rad`, `out1_rad`, `torque1_nm`.
///
/// ```
/// use haptical_model::Device;
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
/// let device = Device::load(path.as_ref())?.device;
/// let (text, warnings) = haptical_urdf::new_mjcf(&device)?;
/// assert!(text.contains("<site name=\"handle\"") && text.contains("integrator=\"implicitfast\""));
/// // the device file has masses, but no inertias
/// assert!(warnings.iter().any(|said| said.starts_with("plausible inertia of link1,")));
/// let again = haptical_urdf::device_from_mjcf(&text, "haptic7.xml", haptical_urdf::BaseAndTip::to("handle"))?;
/// assert_eq!(again.device.joints.len(), 7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`UrdfError::Device`] for a device without links, or with numbers beyond what can be simulated.
pub fn new_mjcf(device: &Device) -> Result<(String, Vec<String>), UrdfError> {
    let segments = Segments::of_device(device)?;
    let names = joint_names(device, segments.rows.len());
    let mut bodies = RowBody::of_rows(device, &segments);
    set_weightless(&mut bodies, device, &segments);
    let effects = Effects::new(device);
    let gravity = device.gravity_mps2.unwrap_or(GRAVITY_MPS2);
    let (rows, step_s) = row_dynamics(device, &segments, &bodies, &effects, &gravity);
    let model = Model {
        device,
        segments,
        names,
        bodies,
        rows,
        effects,
        step_s,
    };
    model.check()?;
    Ok((model.text(&gravity), model.warnings()))
}

/// Attributes of a play; `unit` is what 1 is in the file's ranges \[rad\], \[m\].
pub(crate) fn play(width: f64, unit: f64, step_s: f64) -> String {
    let half = 0.5 * width / unit;
    format!(
        " range=\"{}\" solreflimit=\"{} 1\" solimplimit=\"0.999 0.9999 {} 0.5 2\"",
        written(&[-half, half]),
        written(&[2.0 * step_s]),
        written(&[0.1 * width])
    )
}

/// Attributes of an equality as stiff as the time step allows: MuJoCo's own would let a weight pull rows apart.
pub(crate) fn stiff(step_s: f64) -> String {
    format!(
        "solref=\"{} 1\" solimp=\"0.999 0.9999 0.001 0.5 2\"",
        written(&[2.0 * step_s])
    )
}

fn place(origin: &Origin) -> String {
    format!(
        "pos=\"{}\" quat=\"{}\"",
        written(&origin.position_m),
        written(&origin.orientation_wxyz)
    )
}

impl Model<'_> {
    /// Refuses numbers that left the number range.
    fn check(&self) -> Result<(), UrdfError> {
        let bodies = self.bodies.iter();
        let bodies = bodies.map(|own| own.mass_kg + own.centre_m.sum() + own.inertia_kgm2.sum());
        let rows = self.rows.iter().map(|row| {
            let yields = row.yields.iter().map(|own| own.damping + own.armature);
            row.armature + row.damping + row.gains[0] + row.gains[1] + yields.sum::<f64>()
        });
        if bodies.chain(rows).all(f64::is_finite) {
            return Ok(());
        }
        Err(UrdfError::Device {
            device: self.device.name.clone(),
            message: "its lengths, masses or stiffnesses are too large to be simulated".to_owned(),
        })
    }

    fn text(&self, gravity_mps2: &[f64; 3]) -> String {
        let mut text = format!(
            "<mujoco model=\"{}\">\n  <!-- Lengths in m, angles in rad. Joint values are the readings of a log, \
             0 at home. What is marked as plausible is\n       not known of this device: replace it where you know \
             better. -->\n  <compiler angle=\"radian\" autolimits=\"true\"/>\n",
            escaped(&self.device.name)
        );
        if self.device.gravity_mps2.is_none() {
            text.push_str("  <!-- plausible: gravity, z being up -->\n");
        }
        let _ = write!(
            text,
            "  <option timestep=\"{}\" integrator=\"implicitfast\" gravity=\"{}\"/>\n  <default>\n    \
             <geom contype=\"0\" conaffinity=\"0\" group=\"1\" density=\"0\"/>\n  </default>\n  <worldbody>\n",
            written(&[self.step_s]),
            written(gravity_mps2)
        );
        self.sites(0, &mut text);
        self.tree(&mut text);
        text.push_str("  </worldbody>\n");
        self.equalities(&mut text);
        self.tendons(&mut text);
        self.actuators(&mut text);
        self.sensors(&mut text);
        self.keyframe(&mut text);
        text.push_str(&snippet::comment(
            self.device,
            &self.effects.left_out,
            &[],
            &self.with_external_encoders(),
            snippet::BY_SENSORS,
        ));
        text.push_str(&not_carried::comment(&self.not_carried()));
        text.push_str("</mujoco>\n");
        text
    }

    /// Bodies one in another, along the branches of the device.
    fn tree(&self, text: &mut String) {
        let mut open: Vec<usize> = Vec::new();
        for (row, depth) in self.order() {
            while open.len() > depth {
                open.pop();
                let _ = writeln!(text, "{}</body>", "  ".repeat(open.len() + 2));
            }
            self.body(row, depth + 2, text);
            open.push(row);
        }
        for depth in (0..open.len()).rev() {
            let _ = writeln!(text, "{}</body>", "  ".repeat(depth + 2));
        }
    }

    /// Rows (from 0) in the order of their bodies in the file, and how many bodies each is in.
    fn order(&self) -> Vec<(usize, usize)> {
        let rows = self.segments.rows.len();
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); rows + 1];
        for row in 1..=rows {
            children[self.device.parent(row).unwrap_or(0)].push(row);
        }
        let behind = |row: usize, depth| children[row].iter().rev().map(move |own| (*own, depth));
        let mut open: Vec<(usize, usize)> = behind(0, 0).collect();
        let mut order = Vec::new();
        while let Some((row, depth)) = open.pop() {
            order.push((row - 1, depth));
            open.extend(behind(row, depth + 1));
        }
        order
    }

    /// A body with everything in it but the bodies behind it.
    fn body(&self, row: usize, depth: usize, text: &mut String) {
        let (segment, body) = (&self.segments.rows[row], &self.bodies[row]);
        let indent = "  ".repeat(depth);
        let _ = writeln!(
            text,
            "{indent}<body name=\"link{}\" {}>",
            row + 1,
            place(&Origin::from_pose(&segment.origin(self.device)))
        );
        if let Some(what) = body.plausible {
            let _ = writeln!(text, "{indent}  <!-- plausible: {what} -->");
        }
        let centre: [f64; 3] = body.centre_m.into();
        let _ = writeln!(
            text,
            "{indent}  <inertial pos=\"{}\" mass=\"{}\" fullinertia=\"{}\"/>",
            written(&centre),
            written(&[body.mass_kg]),
            written(&body.inertia_entries_kgm2())
        );
        self.joints(row, &format!("{indent}  "), text);
        let reach: [f64; 3] = body.reach_m.into();
        let _ = match body.reach_m.norm() > SHORTEST_DRAWN_M {
            true => writeln!(
                text,
                "{indent}  <geom type=\"capsule\" fromto=\"0 0 0 {}\" size=\"0.01\"/>",
                written(&reach)
            ),
            false => writeln!(text, "{indent}  <geom type=\"sphere\" size=\"0.015\"/>"),
        };
        self.sites(row + 1, text);
    }

    /// A row's joint, and what its drive yields.
    fn joints(&self, row: usize, indent: &str, text: &mut String) {
        let (segment, own) = (&self.segments.rows[row], &self.rows[row]);
        let kind = match segment.drive.motion {
            JointType::Revolute => "hinge",
            JointType::Prismatic => "slide",
        };
        let name = escaped(&self.names[row]);
        let what = match (own.is_armature_known, own.is_damping_known) {
            (true, true) => String::new(),
            (false, true) => format!("{indent}<!-- plausible: armature -->\n"),
            (true, false) => format!("{indent}<!-- plausible: damping -->\n"),
            (false, false) => format!("{indent}<!-- plausible: armature, damping -->\n"),
        };
        let _ = write!(
            text,
            "{what}{indent}<joint name=\"{name}\" type=\"{kind}\" axis=\"0 0 1\""
        );
        if let Some(range) = self.range(row) {
            let _ = write!(text, " range=\"{}\"", written(&range));
        }
        let _ = write!(
            text,
            " armature=\"{}\" damping=\"{}\"",
            written(&[own.armature]),
            written(&[own.damping])
        );
        if own.friction_loss > 0.0 {
            let _ = write!(text, " frictionloss=\"{}\"", written(&[own.friction_loss]));
        }
        text.push_str("/>\n");
        for of in &own.yields {
            let _ = write!(
                text,
                "{indent}<!-- plausible: armature, damping -->\n{indent}<joint name=\"{name}{}\" type=\"{kind}\" \
                 axis=\"0 0 1\"",
                of.of.suffix
            );
            match of.of.kind {
                YieldKind::Spring(stiffness) => {
                    let _ = write!(text, " stiffness=\"{}\"", written(&[stiffness]));
                }
                YieldKind::Play(width) => text.push_str(&play(width, 1.0, self.step_s)),
                YieldKind::Coupling(..) => {}
            }
            let _ = writeln!(
                text,
                " armature=\"{}\" damping=\"{}\"/>",
                written(&[of.armature]),
                written(&[of.damping])
            );
        }
    }

    /// Limits of a row's joint, where it has any and does not follow another one.
    fn range(&self, row: usize) -> Option<[f64; 2]> {
        if self.segments.followed(self.device, row).is_some() {
            return None;
        }
        let [lower, upper] = self.segments.rows[row].limits(self.device);
        let is_limited = lower.is_finite() || upper.is_finite();
        is_limited.then_some([lower.max(-FAR), upper.min(FAR)])
    }

    /// Hands on a row; row 0 is the world.
    fn sites(&self, row: usize, text: &mut String) {
        let mut depth = 2;
        let mut above = row;
        while let Some(parent) = self.device.parent(above) {
            (above, depth) = (parent, depth + 1);
        }
        let indent = "  ".repeat(depth);
        for (hand, handle) in self.segments.handles.iter().enumerate() {
            let own = self.device.hands.get(hand);
            if own.map_or(self.segments.rows.len(), |hand| hand.row) != row {
                continue;
            }
            let name = escaped(own.map_or("handle", |hand| hand.name.as_str()));
            let place = place(&Origin::from_pose(handle));
            let _ = writeln!(text, "{indent}<site name=\"{name}\" {place}/>");
        }
    }

    fn not_carried(&self) -> Vec<String> {
        not_carried(self.device, &self.effects, Form::Mjcf)
    }

    /// What the file makes up or leaves out.
    fn warnings(&self) -> Vec<String> {
        let mut warnings = self.not_carried();
        warnings.extend(said_of_renamed(self.device, &self.names));
        warnings.extend(scaled(self.device));
        let keys = "mass_kg, centre_of_mass_m, inertia_kgm2";
        warnings.extend(RowBody::said_of_plausible(&self.bodies, keys, |_| true));
        if self.device.gravity_mps2.is_none() {
            warnings.push(
                "plausible gravity, z of frame (-1) being up: the device file gives none"
                    .to_owned(),
            );
        }
        warnings.push(
            "plausible armature, damping and gains of the joints: the file marks what is plausible and not known".to_owned(),
        );
        let outside: Vec<String> = (0..self.rows.len())
            .filter(|row| {
                self.start(*row) != 0.0 && self.segments.followed(self.device, *row).is_none()
            })
            .map(|row| format!("`{}`", self.names[row]))
            .collect();
        if !outside.is_empty() {
            warnings.push(format!(
                "the limits of {} exclude 0: begin with the keyframe `start` (mj_resetDataKeyframe), in the middle of their limits",
                outside.join(", ")
            ));
        }
        if self.effects.has_delays() {
            warnings.push(
                "late sensors: MuJoCo has had `delay` and `nsample` since version 3.5".to_owned(),
            );
        }
        let left_out = self.effects.left_out.iter();
        warnings.extend(left_out.map(|own| snippet::said(&commented(&snippet::described(own)))));
        warnings
    }
}
