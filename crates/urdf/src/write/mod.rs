//! Robot descriptions of a device: a corrected URDF or MJCF, a new one.

pub(crate) mod added_joints;
pub(crate) mod corrected;
pub(crate) mod effects;
pub(crate) mod inertials;
pub(crate) mod keyframes;
pub(crate) mod kinematics_yaml;
pub(crate) mod loaders;
pub(crate) mod mjcf;
pub(crate) mod names;
pub(crate) mod not_carried;
pub(crate) mod origins;
pub(crate) mod patched;
pub(crate) mod ros2_control;
pub(crate) mod urdf;
