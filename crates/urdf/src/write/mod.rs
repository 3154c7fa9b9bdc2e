//! Robot descriptions of a device: a corrected URDF, a new URDF, MJCF.

pub(crate) mod corrected;
pub(crate) mod mjcf;
pub(crate) mod segments;
pub(crate) mod urdf;
