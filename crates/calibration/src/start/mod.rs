//! Start values of everything around the chain: tracker, touched points and planes.

pub(crate) mod hand_eye;
pub(crate) mod hands;
pub(crate) mod points;
pub(crate) mod prepare;
