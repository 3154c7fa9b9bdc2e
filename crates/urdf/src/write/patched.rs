//! An MJCF with the calibrated geometry and the device's friction in place: attributes change, the rest of the text stays.

use std::ops::Range;

use haptical_model::Device;
use haptical_model::Origin;
use haptical_model::kinematics::Pose;

use crate::UrdfError;
use crate::chain::Rows;
use crate::chain::friction::friction as known_friction;
use crate::chain::gaps::Correction;
use crate::chain::path::BaseAndTip;
use crate::device::{ReadChain, armature as armature_of};
use crate::numbers::{escaped, written};
use crate::robot::mjcf::frames::ORIENTATIONS;
use crate::robot::mjcf::include::of_several_files;
use crate::robot::places::has_includes;
use crate::robot::prefixes::without_prefixes;
use crate::robot::xml::{Element, document};
use crate::robot::{PlacedBy, Robot, RobotJoint};
use crate::write::added_joints::NewJoints;
use crate::write::corrected::{all_corrections, replaced, said_of_moved_masses};
use crate::write::effects::Effects;
use crate::write::inertials::{Weighed, mjcf_element, put, weighed};
use crate::write::mjcf::snippet;
use crate::write::not_carried::{self, Form, not_carried};
use haptical_model::rigid::{inverse, then};

/// A corrected MJCF.
#[derive(Debug, Clone, PartialEq)]
pub struct CorrectedMjcf {
    /// The text.
    pub text: String,
    /// Body or site at which the calibrated chain begins.
    pub base: String,
    /// Body or site at which the calibrated chain ends.
    pub tip: String,
    /// Those at which the further chains of a device with several hands end.
    pub further_tips: Vec<String>,
    /// What an MJCF cannot hold by attributes alone, and what was chosen.
    pub warnings: Vec<String>,
}

/// Below this a place is the one that the file has: rounding of two ways to it, in m and as an entry of a rotation.
const SAME: f64 = 1e-12;

pub(crate) type Edit = (Range<usize>, String);

/// The text of an MJCF with `pos` and `quat` of the chain's bodies, and of the site or fixed body at its end, replaced so
/// that its forward kinematics is that of `device`, of every chain where it has several; and with `frictionloss` and `damping`
/// of joints whose friction the device knows, and `armature` where the device has another one, and `inertial` of bodies that carry something else. All other bytes stay as they are; an attribute whose value is right is not
/// touched.
///
/// `device` must have come from this MJCF, this base and this tip. Where the chain ends at a body that moves itself, a site
/// for the handle is added to it, and a warning says so. An orientation that is not a quaternion becomes one. What a joint
/// yields (a spring, a play, a coupling) is a joint of its own: `new_joints` says whether it is put in. The stiffness of a
/// spring that the file has already is an attribute as friction is. What is not in the file is listed, and a comment at its end has
/// Python that adds it to the readings where that can be done.
///
/// ```
/// use haptical_urdf::{BaseAndTip, NewJoints, corrected_mjcf, device_from_mjcf};
/// let text = r#"<mujoco> <!-- kept -->
///   <worldbody>
///     <body name="arm" pos="0 0 0.4"> <joint name="shoulder" axis="0 1 0"/> <site name="tool" pos="0.1 0 0"/> </body>
///   </worldbody>
/// </mujoco>"#;
/// let mut lever = device_from_mjcf(text, "lever.xml", BaseAndTip::to("tool"))?.device;
/// lever.links[1].d_m = 0.002; // along the axis, y
/// let listed = NewJoints::Listed;
/// let corrected = corrected_mjcf(text, "lever.xml", BaseAndTip::to("tool"), &lever, listed)?;
/// assert_eq!(corrected.text, text.replace("0.1 0 0", "0.1 0.002 0"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`UrdfError`] as [`device_from_mjcf`](crate::device_from_mjcf); [`UrdfError::Device`] for a device that is not of this MJCF,
/// or whose correction belongs between two joints of one body.
pub fn corrected_mjcf(
    text: &str,
    file: &str,
    ends: BaseAndTip<'_>,
    device: &Device,
    new_joints: NewJoints,
) -> Result<CorrectedMjcf, UrdfError> {
    if has_includes(text) {
        return Err(of_several_files(file));
    }
    let read = ReadChain::of_mjcf(text, file, ends)?;
    let corrections = all_corrections(&read, device, (file, "MJCF"))?;
    let (weighed, unweighed) = weighed(&read, device, file)?;
    let moved = said_of_moved_masses(&read, device, &corrections, file);
    let ReadChain {
        robot,
        paths,
        rows,
        mut warnings,
    } = read;
    let plain = without_prefixes(text);
    let document = document(&plain, file)?;
    let patch = Patch {
        device,
        robot: &robot,
        elements: document.descendants().filter(Element::is_element).collect(),
    };
    let link = |index: usize| robot.links[index].name.clone();
    let mut base = link(paths[0].base);
    let mut tips: Vec<String> = paths.iter().map(|path| link(path.tip)).collect();
    let mut edits = Vec::new();
    for (path, correction) in corrections {
        let (name, index, what, origin) = match correction {
            Correction::Joint(joint, origin) => {
                edits.extend(patch.place(&robot.joints[joint], &origin)?);
                continue;
            }
            Correction::Base(origin) => (&mut base, paths[path].base, "base", origin),
            Correction::Tip(origin) => (&mut tips[path], paths[path].tip, "handle", origin),
        };
        // where it is already, nothing is added
        if is_same(&origin, &Pose::default()) {
            continue;
        }
        let (edit, site) = patch.site(text, index, what, &origin)?;
        warnings.push(format!(
            "{file}: the body `{name}` moves itself, so the site `{site}` was added to it for the {what}"
        ));
        *name = site;
        edits.push(edit);
    }
    let effects = Effects::new(device);
    for (joint, driver) in rows.drivers.iter().enumerate() {
        let armature = device.joints.get(joint).and_then(|own| own.armature_kgm2);
        let known = armature_of(&robot, &rows, joint);
        let own = &robot.joints[*driver];
        // what the joint's followers have stays as it is
        let armature = armature
            .filter(|wanted| Some(*wanted) != known)
            .map(|wanted| {
                let behind = known.unwrap_or(0.0) - own.armature.unwrap_or(0.0);
                (wanted - behind).max(0.0)
            });
        let friction = effects.friction.get(joint).copied().unwrap_or_default();
        let friction = changed_friction(&robot, &rows, joint, [friction.coulomb, friction.viscous]);
        edits.extend(patch.drive(own, friction, armature));
    }
    warnings.extend(unweighed);
    warnings.extend(moved);
    edits.extend(patch.masses(&weighed, text, file, &mut warnings));
    let mut lost = not_carried(device, &effects, Form::Mjcf);
    lost.extend(late_encoders(&effects));
    warnings.extend(lost.iter().cloned());
    let drivers: Vec<&RobotJoint> = (rows.drivers.iter())
        .map(|driver| &robot.joints[*driver])
        .collect();
    let yields = patch.yields(&effects, &drivers, new_joints)?;
    edits.extend(yields.edits);
    warnings.extend(yields.said);
    warnings.extend(
        effects
            .left_out
            .iter()
            .map(|own| snippet::said(&own.label())),
    );
    let names: Vec<&str> = drivers.iter().map(|own| own.name.as_str()).collect();
    let readings = snippet::by_joints(device, &names);
    let no_outs = vec![false; device.joints.len()];
    let comment = snippet::comment(
        device,
        &effects.left_out,
        &yields.missing,
        &no_outs,
        &readings,
    );
    let comment = comment + &not_carried::comment(&lost);
    edits.extend(patch.at_end(&comment).filter(|_| !comment.is_empty()));
    let mut tips = tips.into_iter();
    Ok(CorrectedMjcf {
        text: replaced(text, join(edits)),
        base,
        tip: tips.next().unwrap_or_default(),
        further_tips: tips.collect(),
        warnings,
    })
}

/// Friction of a joint's own element where the device has another one than the file; what the joint's followers have stays.
fn changed_friction(
    robot: &Robot,
    rows: &Rows,
    joint: usize,
    wanted: [Option<f64>; 2],
) -> [Option<f64>; 2] {
    let known = known_friction(robot, rows, joint);
    let own = robot.joints[rows.drivers[joint]].friction;
    [0, 1].map(|number| {
        let behind = known[number] - own[number];
        let wanted = wanted[number].filter(|wanted| *wanted != known[number]);
        wanted.map(|wanted| (wanted - behind).max(0.0))
    })
}

/// What would need sensors of its own.
fn late_encoders(effects: &Effects<'_>) -> Option<String> {
    effects.has_delays().then(|| {
        "late encoders are attributes of sensors (delay, nsample), which are not put into your file".to_owned()
    })
}

fn is_same(left: &Pose, right: &Pose) -> bool {
    (left.position_m - right.position_m).amax() <= SAME
        && (left.rotation - right.rotation).amax() <= SAME
}

/// A document to be changed.
pub(super) struct Patch<'p, 'd, 'input> {
    pub(super) device: &'p Device,
    pub(super) robot: &'p Robot,
    pub(super) elements: Vec<Element<'d, 'input>>,
}

impl<'d, 'input> Patch<'_, 'd, 'input> {
    pub(super) fn refuse(&self, message: String) -> UrdfError {
        UrdfError::Device {
            device: self.device.name.clone(),
            message,
        }
    }

    /// The element that begins at a byte.
    pub(super) fn element(&self, place: usize) -> Option<Element<'d, 'input>> {
        // in the order of the document
        let found = self
            .elements
            .binary_search_by_key(&place, |own| own.range().start);
        found
            .ok()
            .and_then(|index| self.elements.get(index))
            .copied()
    }

    /// Puts masses into bodies; what is not put in is said.
    fn masses(
        &self,
        weighed: &[Weighed],
        text: &str,
        file: &str,
        said: &mut Vec<String>,
    ) -> Vec<Edit> {
        if !(self.robot.mass_rules.is_empty() || weighed.is_empty()) {
            said.push(format!(
                "{file}: masses are not put in, because {} of <compiler> changes them: take it out, with the masses that MuJoCo \
                 has compiled",
                self.robot.mass_rules.join(", ")
            ));
            return Vec::new();
        }
        let mut edits = Vec::new();
        for own in weighed {
            match self.weigh(own, text) {
                Some(edit) => edits.push(edit),
                None => said.push(format!(
                    "{file}: what `{}` carries is not put in: it is between two joints of one body, which has no masses there",
                    self.robot.links[own.link].name
                )),
            }
        }
        edits
    }

    /// Puts masses into a link's body; none where it is between two joints of one body and has no element of its own.
    fn weigh(&self, own: &Weighed, text: &str) -> Option<Edit> {
        let place = self.robot.links[own.link].place;
        // the links between a body's joints are before its own
        let mut links = self.robot.links.iter();
        let is_own = links.rposition(|link| link.place == place) == Some(own.link);
        let node = self.element(place);
        let node = node.filter(|node| is_own && node.has_tag_name("body"))?;
        Some(put(text, node, "inertial", &mjcf_element(&own.inertia)))
    }

    /// Puts a joint's origin into the element that places it.
    fn place(&self, joint: &RobotJoint, wanted: &Pose) -> Result<Vec<Edit>, UrdfError> {
        if is_same(&joint.origin, wanted) {
            return Ok(Vec::new());
        }
        let found = joint
            .placed_by
            .and_then(|own| Some((own, self.element(own.place)?)));
        let Some((PlacedBy { before, behind, .. }, node)) = found else {
            return Err(self.refuse(format!(
                "the correction before joint `{}` belongs between two joints of one body, where an MJCF has no place for it: \
                 give each joint a body of its own, and calibrate with that file",
                joint.name
            )));
        };
        let own = |origin: &Pose| then(&then(&inverse(&before), origin), &inverse(&behind));
        let (now, then) = (own(&joint.origin), Origin::from_pose(&own(wanted)));
        let mut edits = Vec::new();
        if (now.position_m - own(wanted).position_m).amax() > SAME {
            edits.push(set(node, "pos", "pos", &written(&then.position_m)));
        }
        if (now.rotation - own(wanted).rotation).amax() > SAME {
            let stated = ORIENTATIONS
                .into_iter()
                .find(|key| node.has_attribute(*key));
            let quaternion = written(&then.orientation_wxyz);
            edits.push(set(node, stated.unwrap_or("quat"), "quat", &quaternion));
        }
        Ok(join(edits))
    }

    /// Adds a site to a body; gives its name too.
    fn site(
        &self,
        text: &str,
        link: usize,
        what: &str,
        origin: &Pose,
    ) -> Result<(Edit, String), UrdfError> {
        let own = &self.robot.links[link];
        let mut name = format!("{}_{what}", own.name);
        while self.robot.links.iter().any(|link| link.name == name) {
            name.push('_');
        }
        let end = self.element(own.place).and_then(|node| {
            let range = node.range();
            let end = text.get(range.clone())?.rfind("</")?;
            Some(range.start + end)
        });
        let Some(end) = end else {
            let message = format!(
                "nothing can be added to the body `{}` for the {what}",
                own.name
            );
            return Err(self.refuse(message));
        };
        let origin = Origin::from_pose(origin);
        let site = format!(
            "<site name=\"{}\" pos=\"{}\" quat=\"{}\"/>",
            escaped(&name),
            written(&origin.position_m),
            written(&origin.orientation_wxyz)
        );
        // on a line of its own where the closing tag is
        let before = text.get(..end).unwrap_or_default();
        let indent = before.rsplit('\n').next().unwrap_or_default();
        let addition = match before.contains('\n') && indent.trim().is_empty() {
            true => format!("  {site}\n{indent}"),
            false => site,
        };
        Ok(((end..end, addition), name))
    }

    /// Friction that the device knows, and an armature that is not the file's.
    fn drive(
        &self,
        own: &RobotJoint,
        [coulomb, viscous]: [Option<f64>; 2],
        armature: Option<f64>,
    ) -> Vec<Edit> {
        let Some(node) = self.element(own.place) else {
            return Vec::new();
        };
        let numbers = [
            ("frictionloss", coulomb),
            ("damping", viscous),
            ("armature", armature),
        ];
        let stated = numbers.into_iter();
        let edits =
            stated.filter_map(|(key, number)| Some(set(node, key, key, &written(&[number?]))));
        join(edits.collect())
    }
}

/// Sets an attribute: in the place of the one called `stated`, or behind the element's name.
pub(super) fn set(node: Element<'_, '_>, stated: &str, key: &str, value: &str) -> Edit {
    match node.attribute_node(stated) {
        Some(attribute) if stated == key => (attribute.range_value(), value.to_owned()),
        Some(attribute) => (attribute.range(), format!("{key}=\"{value}\"")),
        None => {
            let start = node.range().start + 1;
            let tag = node
                .document()
                .input_text()
                .get(start..)
                .unwrap_or_default();
            let is_end = |c: char| c.is_ascii_whitespace() || c == '/' || c == '>';
            let at = start + tag.find(is_end).unwrap_or(0);
            (at..at, format!(" {key}=\"{value}\""))
        }
    }
}

/// Insertions at one place in their order, as one.
fn join(edits: Vec<Edit>) -> Vec<Edit> {
    let mut joined: Vec<Edit> = Vec::new();
    for (range, new) in edits {
        match joined
            .iter_mut()
            .find(|(own, _)| range.is_empty() && *own == range)
        {
            Some((_, text)) => text.push_str(&new),
            None => joined.push((range, new)),
        }
    }
    joined
}
