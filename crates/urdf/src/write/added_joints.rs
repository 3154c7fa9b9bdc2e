//! Joints that an MJCF does not have: springs, plays and couplings between its motors and links, with all that follows.

use haptical_model::JointType;

use crate::UrdfError;
use crate::numbers::{escaped, number, written};
use crate::robot::RobotJoint;
use crate::write::effects::{Effects, Yield, YieldKind};
use crate::write::mjcf::dynamics::{RowYield, needed, row_dynamics};
use crate::write::mjcf::snippet::MissingJoint;
use crate::write::mjcf::{GRAVITY_MPS2, play, stiff};
use crate::write::patched::{Edit, Patch, set};
use haptical_model::RowBody;
use haptical_model::Segments;

/// What becomes of springs, plays and couplings, which are joints that a file does not have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NewJoints {
    /// They are listed, and every joint keeps its place in `qpos`.
    #[default]
    Listed,
    /// They are put in behind their joints, and into keyframes: joints behind them have later places in `qpos`.
    PutIn,
}

/// Armature per that of a model whose time step is chosen for it: between a play and a spring it else shivers at the file's own
/// time step (assumption A151).
const STEADY: f64 = 10.0;
/// Time step up to which a file's own is taken as short \[s\].
const SHORT_S: f64 = 1e-3;

/// What is done about springs, plays and couplings.
pub(super) struct Yields {
    pub(super) edits: Vec<Edit>,
    pub(super) said: Vec<String>,
    /// What is not put in.
    pub(super) missing: Vec<MissingJoint>,
}

/// A joint to be put in.
pub(super) struct Added<'y> {
    /// Its number in the device.
    pub(super) joint: usize,
    pub(super) name: String,
    pub(super) of: &'y RowYield,
}

impl Patch<'_, '_, '_> {
    /// Springs, plays and couplings of all joints: what changes in the file, and what is said of them.
    pub(super) fn yields(
        &self,
        effects: &Effects<'_>,
        drivers: &[&RobotJoint],
        new_joints: NewJoints,
    ) -> Result<Yields, UrdfError> {
        let (mut edits, mut said, mut missing) = (Vec::new(), Vec::new(), Vec::new());
        for (joint, driver) in drivers.iter().enumerate() {
            if let Some((place, stiffness)) = only_spring(effects, joint, driver)
                && !has(driver, stiffness)
                && let Some(node) = self.element(place)
            {
                edits.push(set(node, "stiffness", "stiffness", &written(&[stiffness])));
            }
        }
        let is_missing = |joint: usize, kind: YieldKind| match kind {
            YieldKind::Spring(stiffness) => {
                let driver = drivers[joint];
                !has(driver, stiffness) && only_spring(effects, joint, driver).is_none()
            }
            _ => true,
        };
        let is_put = |joint: usize, kind: YieldKind| {
            new_joints == NewJoints::PutIn
                && is_missing(joint, kind)
                && drivers[joint].springs.is_empty()
                && self.can_bind(kind, drivers)
        };
        let mut is_any_put = false;
        for (joint, yields) in effects.yields.iter().enumerate() {
            for own in yields.iter().filter(|own| is_missing(joint, own.kind)) {
                if is_put(joint, own.kind) {
                    is_any_put = true;
                    continue;
                }
                let name = &drivers[joint].name;
                said.push(format!(
                    "joint `{name}`: its `{name}{}` ({}) is a joint of its own, which is not put into your file: --new-joints puts \
                     it in where no spring is there yet, and joints behind it then have later places in qpos",
                    own.suffix,
                    own.kind.words()
                ));
                missing.push(MissingJoint {
                    what: format!("{name}{}: {}", own.suffix, own.kind.words()),
                    python: self.python(joint, name, own),
                });
            }
        }
        if is_any_put {
            let (put, told) = self.put_in(effects, drivers, is_put)?;
            edits.extend(put);
            said.extend(told);
        }
        Ok(Yields {
            edits,
            said,
            missing,
        })
    }

    /// Python that adds to the readings what a joint that is not there does to them, at rest.
    fn python(&self, joint: usize, name: &str, own: &Yield) -> String {
        let device = self.device;
        let column = |what: &str, joint: usize| {
            let unit = device.joints.get(joint).map_or("rad", |own| own.unit());
            format!("r[\"{what}{}_{unit}\"]", joint + 1)
        };
        let (theta, out) = (column("theta", joint), column("out", joint));
        let behind = match own.is_before_encoder {
            true => out.clone(),
            false => column("link", joint),
        };
        // what another one of the joint has moved already
        let key = out.trim_start_matches("r[").trim_end_matches(']');
        let before = format!("r.get({key}, {theta})");
        match own.kind {
            // the drive's torque goes through the spring
            YieldKind::Spring(stiffness) => format!(
                "{behind} = {before} - data.joint({name:?}).qfrc_actuator[0] / {}",
                written(&[stiffness])
            ),
            YieldKind::Coupling(gain, from) => format!(
                "{behind} = {before} + {} * {}",
                written(&[gain]),
                column("theta", from)
            ),
            YieldKind::Play(width) => format!(
                "# {behind} is within {} of {before}: which end, the load says",
                written(&[0.5 * width])
            ),
        }
    }

    /// Whether a joint that another one moves can be bound to it: an equality counts from where both are in the file.
    fn can_bind(&self, kind: YieldKind, drivers: &[&RobotJoint]) -> bool {
        let YieldKind::Coupling(_, from) = kind else {
            return true;
        };
        let source = drivers.get(from).and_then(|own| self.element(own.place));
        source.is_some_and(|own| {
            own.attribute("ref")
                .is_none_or(|text| number(text) == Some(0.0))
        })
    }

    /// What puts the yields in that are wanted.
    fn put_in(
        &self,
        effects: &Effects<'_>,
        drivers: &[&RobotJoint],
        wanted: impl Fn(usize, YieldKind) -> bool,
    ) -> Result<(Vec<Edit>, Vec<String>), UrdfError> {
        let device = self.device;
        let segments = Segments::of_device(device)?;
        let bodies = RowBody::of_rows(device, &segments);
        let gravity = device.gravity_mps2.unwrap_or(GRAVITY_MPS2);
        let (rows, serves_s) = row_dynamics(device, &segments, &bodies, effects, &gravity);
        let mut added = Vec::new();
        for (joint, driver) in drivers.iter().enumerate() {
            let row = device
                .own_row(joint)
                .and_then(|row| rows.get(row.checked_sub(1)?));
            for of in row.map_or(&[][..], |row| &row.yields) {
                if wanted(joint, of.of.kind) {
                    let name = self.free_name(&format!("{}{}", driver.name, of.of.suffix));
                    added.push(Added { joint, name, of });
                }
            }
        }
        let is_number = |own: &Added<'_>| (own.of.damping + own.of.armature).is_finite();
        if !added.iter().all(is_number) {
            return Err(self.refuse(
                "its lengths, masses or stiffnesses are too large to be simulated".to_owned(),
            ));
        }
        let mut edits = Vec::new();
        for (joint, driver) in drivers.iter().enumerate() {
            let own: Vec<&Added<'_>> = added.iter().filter(|own| own.joint == joint).collect();
            edits.extend(self.behind(driver, &own));
        }
        edits.extend(self.bonds(&added, drivers));
        let (keys, mut said) = self.keyframes(&added, drivers);
        edits.extend(keys);
        said.extend(added.iter().map(|own| {
            format!(
                "the joint `{}` was put in behind `{}`, with plausible damping and armature: later joints have later places in \
                 qpos",
                own.name, drivers[own.joint].name
            )
        }));
        if serves_s < SHORT_S.min(self.robot.step_s) {
            said.push(format!(
                "a time step of {serves_s} s follows the stiffest of the new springs, and the file's is {} s: shorten it",
                self.robot.step_s
            ));
        }
        Ok((edits, said))
    }

    fn free_name(&self, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        let is_taken = |name: &str| {
            let mut all = self.elements.iter().filter(|own| own.has_tag_name("joint"));
            all.any(|own| own.attribute("name") == Some(name))
        };
        while is_taken(&name) {
            name.push('_');
        }
        name
    }

    /// Elements behind a joint's own.
    fn behind(&self, driver: &RobotJoint, added: &[&Added<'_>]) -> Option<Edit> {
        let node = self.element(driver.place).filter(|_| !added.is_empty())?;
        let text = node.document().input_text();
        let (start, end) = (node.range().start, node.range().end);
        let before = text.get(..start)?;
        let indent = before.rsplit('\n').next().unwrap_or_default();
        let gap = match before.contains('\n') && indent.trim().is_empty() {
            true => format!("\n{indent}"),
            false => " ".to_owned(),
        };
        let mut elements = String::new();
        for own in added {
            elements.push_str(&gap);
            elements.push_str(&format!("<joint name=\"{}\"", escaped(&own.name)));
            // where and along what, as its class or its own attributes say
            for key in ["class", "type", "pos", "axis"] {
                if let Some(value) = node.attribute(key) {
                    elements.push_str(&format!(" {key}=\"{}\"", escaped(value)));
                }
            }
            elements.push_str(&self.dynamics(own));
        }
        Some((end..end, elements))
    }

    /// Attributes that a class may have otherwise, and the end of the element.
    fn dynamics(&self, own: &Added<'_>) -> String {
        let slides = self.device.joints[own.joint].joint_type == JointType::Prismatic;
        let unit = if slides { 1.0 } else { self.robot.angle_rad };
        let (mut stiffness, damping) = (0.0, own.of.damping);
        let mut armature = STEADY * own.of.armature;
        let mut limits = "limited=\"false\"".to_owned();
        match own.of.of.kind {
            YieldKind::Spring(of) => {
                stiffness = of;
                armature = armature.max(STEADY * needed(self.robot.step_s, of, damping));
            }
            YieldKind::Play(width) => {
                limits = format!("limited=\"true\"{}", play(width, unit, self.robot.step_s));
            }
            YieldKind::Coupling(..) => {}
        }
        format!(
            " ref=\"0\" springref=\"0\" frictionloss=\"0\" {limits} stiffness=\"{}\" damping=\"{}\" armature=\"{}\"/>",
            written(&[stiffness]),
            written(&[damping]),
            written(&[armature])
        )
    }

    /// An `<equality>` for the joints that another one moves.
    fn bonds(&self, added: &[Added<'_>], drivers: &[&RobotJoint]) -> Option<Edit> {
        let mut bonds = String::new();
        for own in added {
            if let YieldKind::Coupling(gain, from) = own.of.of.kind {
                bonds.push_str(&format!(
                    "    <joint joint1=\"{}\" joint2=\"{}\" polycoef=\"0 {} 0 0 0\" {}/>\n",
                    escaped(&own.name),
                    escaped(&drivers.get(from)?.name),
                    written(&[gain]),
                    stiff(self.robot.step_s)
                ));
            }
        }
        let section = format!("  <equality>\n{bonds}  </equality>\n");
        self.at_end(&section).filter(|_| !bonds.is_empty())
    }

    /// An addition before the closing tag of the file.
    pub(super) fn at_end(&self, addition: &str) -> Option<Edit> {
        let root = self.elements.first()?;
        let text = root.document().input_text();
        let range = root.range();
        let end = range.start + text.get(range.clone())?.rfind("</")?;
        Some((end..end, addition.to_owned()))
    }
}

/// The stiffness of the one spring that a joint has in the file, where it is to have one and no other motion.
fn only_spring(effects: &Effects<'_>, joint: usize, driver: &RobotJoint) -> Option<(usize, f64)> {
    match (
        effects.yields.get(joint)?.as_slice(),
        driver.springs.as_slice(),
    ) {
        ([own], [place]) => match own.kind {
            YieldKind::Spring(stiffness) => Some((*place, stiffness)),
            _ => None,
        },
        _ => None,
    }
}

/// Whether the springs that a joint has in the file are as stiff.
fn has(driver: &RobotJoint, stiffness: f64) -> bool {
    (driver.compliance * stiffness - 1.0).abs() < 1e-9
}
