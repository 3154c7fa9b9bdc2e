//! Device files in TOML: reading, checking, writing.

pub(crate) mod device;
pub(crate) mod joint;
pub(crate) mod reader;
pub(crate) mod rig;
pub(crate) mod row;
pub(crate) mod sensors;
pub(crate) mod surroundings;
pub(crate) mod syntax;
pub(crate) mod text;
pub(crate) mod write;
