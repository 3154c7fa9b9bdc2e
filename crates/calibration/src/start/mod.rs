//! Start values of everything around the chain: tracker, touched points and planes.

pub(crate) mod hand_eye;
pub(crate) mod ids;
pub(crate) mod points;
pub(crate) mod prepare;
pub(crate) mod sights;
pub(crate) mod touches;
