//! The least-squares problem of a device and a recording: measured channels, residuals, derivatives.

pub(crate) mod added;
mod added_rows;
pub(crate) mod candidates;
pub(crate) mod channel;
pub(crate) mod device_problem;
pub(crate) mod form;
pub(crate) mod gauge;
pub(crate) mod lanes;
pub(crate) mod loads;
pub(crate) mod measurement;
pub(crate) mod mounts;
pub(crate) mod propagated;
pub(crate) mod reduced;
pub(crate) mod residuals;
pub(crate) mod rows;
pub(crate) mod some_rows;
pub(crate) mod tiles;
pub(crate) mod weights;
