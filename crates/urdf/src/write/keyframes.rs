//! Keyframes of an MJCF that gets new joints.

use crate::numbers::{number, written};
use crate::robot::RobotJoint;
use crate::write::added_joints::Added;
use crate::write::effects::YieldKind;
use crate::write::patched::{Edit, Patch};

impl Patch<'_, '_, '_> {
    /// Positions and velocities of keyframes with those of the new joints.
    pub(super) fn keyframes(
        &self,
        added: &[Added<'_>],
        drivers: &[&RobotJoint],
    ) -> (Vec<Edit>, Vec<String>) {
        let (mut edits, mut said) = (Vec::new(), Vec::new());
        let keys = self.elements.iter().filter(|own| own.has_tag_name("key"));
        for key in keys.filter(|_| !added.is_empty()) {
            for (name, is_position) in [("qpos", true), ("qvel", false)] {
                let Some(attribute) = key.attribute_node(name) else {
                    continue;
                };
                match self.extended(attribute.value(), is_position, added, drivers) {
                    Some(value) => edits.push((attribute.range_value(), value)),
                    None => said.push(format!(
                        "the keyframe `{}` is as it was, because its {name} is not one number for each of the joints that were \
                         read: complete it, or MuJoCo refuses the file",
                        key.attribute("name").unwrap_or("without a name")
                    )),
                }
            }
        }
        (edits, said)
    }

    fn extended(
        &self,
        value: &str,
        is_position: bool,
        added: &[Added<'_>],
        drivers: &[&RobotJoint],
    ) -> Option<String> {
        let numbers: Option<Vec<f64>> = value.split_ascii_whitespace().map(number).collect();
        let mut rest = numbers?.into_iter();
        let mut parts: Vec<(usize, Vec<f64>)> = Vec::new();
        for own in &self.robot.coordinates {
            let count = if is_position {
                own.positions
            } else {
                own.velocities
            };
            let part: Vec<f64> = rest.by_ref().take(count).collect();
            if part.len() < count {
                return None;
            }
            parts.push((own.place, part));
        }
        if rest.next().is_some() {
            return None;
        }
        let of = |place: usize| parts.iter().find(|own| own.0 == place)?.1.first().copied();
        let mut all = Vec::new();
        for (place, part) in &parts {
            all.extend(part);
            let own = added
                .iter()
                .filter(|own| drivers[own.joint].place == *place);
            for own in own {
                all.push(match own.of.of.kind {
                    YieldKind::Coupling(gain, from) => gain * of(drivers.get(from)?.place)?,
                    _ => 0.0,
                });
            }
        }
        Some(written(&all))
    }
}
