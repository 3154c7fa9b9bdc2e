//! Rotations by `quat_xyzw`, which a URDF has from version 1.1 on.

use haptical_model::kinematics::nalgebra::Matrix3;

use crate::numbers::exactly;
use crate::rigid::{from_quaternion, from_rpy};
use crate::robot::xml::{Element, Reader, Result};

/// Attribute with a quaternion, its real part last.
const KEY: &str = "quat_xyzw";
/// The first version whose origins may have it.
const FIRST: (u32, u32) = (1, 1);

/// Major and minor number of `1.1`.
fn numbers(version: &str) -> Option<(u32, u32)> {
    let (major, minor) = version.trim().split_once('.')?;
    Some((major.parse().ok()?, minor.parse().ok()?))
}

impl Reader<'_, '_> {
    /// Whether the URDF's version has quaternions; 1.0 where it says none.
    fn has_quaternions(&self) -> Result<bool> {
        let root = self.document.root_element();
        let Some(version) = root.attribute("version") else {
            return Ok(false);
        };
        let known = numbers(version).ok_or_else(|| {
            let found = format!("\"{version}\"");
            let allowed =
                "two numbers such as 1.1 are expected: they say whether quat_xyzw is read";
            self.refuse(root, "the robot", "the version", &found, allowed)
        })?;
        Ok(known >= FIRST)
    }

    /// The rotation of an `<origin>`: by `rpy` or, from version 1.1 on, by `quat_xyzw`.
    pub(crate) fn rotation(&self, origin: Element<'_, '_>, place: &str) -> Result<Matrix3<f64>> {
        let angles_rad = self.vector(origin, place, "rpy")?;
        let quaternion = origin.attribute(KEY);
        let (Some(text), true) = (quaternion, quaternion.is_some() && self.has_quaternions()?)
        else {
            return Ok(from_rpy(angles_rad.unwrap_or([0.0; 3])));
        };
        if angles_rad.is_some() {
            let message = format!("{place} has both rpy and {KEY}: one rotation is expected");
            return Err(self.tree(origin.range().start, message));
        }
        let refuse = |allowed| self.refuse(origin, place, KEY, &format!("\"{text}\""), allowed);
        let [x, y, z, w] = exactly(text).ok_or_else(|| {
            refuse("four finite numbers of at most 1e6 in size are expected, separated by blanks")
        })?;
        from_quaternion([w, x, y, z]).ok_or_else(|| refuse("one of them must not be 0"))
    }

    /// What is said of quaternions in a version that has none.
    pub(crate) fn said_of_quaternions(&self) -> Result<Option<String>> {
        let is_read = |entry: &Element<'_, '_>| {
            let parent = entry.parent_element();
            entry.has_tag_name("origin")
                && entry.has_attribute(KEY)
                && parent
                    .is_some_and(|entry| ["joint", "inertial"].contains(&entry.tag_name().name()))
        };
        let mut origins = self.document.descendants().filter(is_read);
        let Some(first) = origins.next() else {
            return Ok(None);
        };
        if self.has_quaternions()? {
            return Ok(None);
        }
        let others = match origins.count() {
            0 => String::new(),
            more => format!(", and in {more} more"),
        };
        Ok(Some(format!(
            "{}: {KEY} is ignored in this <origin>{others}, because a URDF has it from version 1.1 on: write version=\"1.1\" \
             in <robot>, or give rpy",
            self.position_at(first.range().start)
        )))
    }
}
