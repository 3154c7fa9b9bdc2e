//! Judgements on a selection: its adequacy, its rivals, what the residuals depend on, earlier models.

pub(crate) mod adequacy;
pub(crate) mod dependence;
pub(crate) mod earlier_model;
pub(crate) mod findings;
pub(crate) mod rivals;
pub(crate) mod second;
pub(crate) mod too_coarse;
pub(crate) mod touched;
pub(crate) mod unlisted;
pub(crate) mod untold_loads;
pub(crate) mod verdict;
pub(crate) mod whiteness;
pub(crate) mod wrong_angles;
