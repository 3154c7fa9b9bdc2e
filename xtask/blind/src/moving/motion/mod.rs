//! How an arm moves: its bodies and drives, its controller, the course that it is told.

pub(crate) mod control;
pub(crate) mod course;
pub(crate) mod log;
pub(crate) mod plant;
pub(crate) mod rigid;
pub(crate) mod run;
pub(crate) mod specimen;
