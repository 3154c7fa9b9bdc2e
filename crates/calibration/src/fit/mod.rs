//! One fit of chosen parameters, with the judgement of what the data can fix.

pub(crate) mod considered;
pub(crate) mod curvature;
pub(crate) mod free_set;
pub(crate) mod implausible;
pub(crate) mod length_scale;
pub(crate) mod mistakes;
pub(crate) mod multi_start;
pub(crate) mod parameter_fit;
pub(crate) mod profiled;
mod put_on;
pub(crate) mod request;
mod rounds;
pub(crate) mod search;
pub(crate) mod settle;
pub(crate) mod size;
mod trial;
pub(crate) mod wider;
