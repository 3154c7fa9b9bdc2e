//! The fuzz targets of the readers: no panic, and what is accepted is finite and can be written again.
#![allow(clippy::unwrap_used, reason = "a target that cannot go on fails there")]

mod device_file;
mod effects;
mod log;
mod mjcf;
mod rig;
mod urdf;
