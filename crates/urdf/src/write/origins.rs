//! Origins of a URDF's joints as a device of it has them.

use haptical_model::Device;
use haptical_model::kinematics::Pose;

use crate::UrdfError;
use crate::chain::gaps::Correction;
use crate::chain::path::BaseAndTip;
use crate::device::ReadChain;
use crate::write::corrected::all_corrections;

/// The chain of a URDF, read once, to ask devices of it for the origins of its joints.
#[derive(Debug)]
pub struct UrdfOrigins {
    read: ReadChain,
    file: String,
}

/// Where a joint of a URDF is.
#[derive(Debug, Clone, PartialEq)]
pub struct JointOrigin {
    /// The joint's name; `base` and `handle` where the URDF has no joint that could say it.
    pub joint: String,
    /// The joint's frame in the frame of its parent link, as `<origin>` gives it.
    pub pose: Pose,
}

impl UrdfOrigins {
    /// Reads the chain between two links; `file` names the text in errors.
    ///
    /// ```
    /// use haptical_urdf::{BaseAndTip, UrdfOrigins, device_from_urdf};
    /// let text = r#"<robot name="lever">
    ///   <link name="base"/> <link name="arm"/> <link name="tool"/>
    ///   <joint name="shoulder" type="continuous">
    ///     <origin xyz="0 0 0.4"/> <parent link="base"/> <child link="arm"/> <axis xyz="0 1 0"/>
    ///   </joint>
    ///   <joint name="flange" type="fixed">
    ///     <origin xyz="0.1 0 0"/> <parent link="arm"/> <child link="tool"/>
    ///   </joint>
    /// </robot>"#;
    /// let ends = BaseAndTip::to("tool");
    /// let mut lever = device_from_urdf(text, "lever.urdf", ends)?.device;
    /// lever.links[1].d_m = 0.002; // along the axis, y
    /// let origins = UrdfOrigins::read(text, "lever.urdf", ends)?.of(&lever)?;
    /// assert_eq!(origins[1].joint, "flange");
    /// assert!((origins[1].pose.position_m.y - 0.002).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`device_from_urdf`](crate::device_from_urdf).
    pub fn read(text: &str, file: &str, ends: BaseAndTip<'_>) -> Result<Self, UrdfError> {
        Ok(Self {
            read: ReadChain::of_urdf(text, file, ends)?,
            file: file.to_owned(),
        })
    }

    /// The origins that [`corrected_urdf`](crate::corrected_urdf) would write for a device of this chain, from the base.
    ///
    /// # Errors
    /// [`UrdfError::Device`] for a device that is not of this URDF.
    pub fn of(&self, device: &Device) -> Result<Vec<JointOrigin>, UrdfError> {
        let all = all_corrections(&self.read, device, (&self.file, "URDF"))?;
        let origins = all.into_iter().map(|(_, correction)| {
            let (joint, pose) = match correction {
                Correction::Joint(joint, pose) => {
                    (self.read.robot.joints[joint].name.clone(), pose)
                }
                Correction::Base(pose) => ("base".to_owned(), pose),
                Correction::Tip(pose) => ("handle".to_owned(), pose),
            };
            JointOrigin { joint, pose }
        });
        Ok(origins.collect())
    }
}
