//! Judgements on a selection: its adequacy, its rivals, what the residuals depend on, earlier models.

mod adequacy;
mod dependence;
mod earlier_model;
mod findings;
mod hedges;
mod rivals;
mod second;
mod too_coarse;
mod touched;
mod verdict;
mod whiteness;
mod wrong_angles;

pub(crate) use self::adequacy::{Adequacy, adequacy, doubt};
pub(crate) use self::dependence::{dependences, largest_dependence};
pub(crate) use self::earlier_model::absorbed::take_absorbed;
pub(crate) use self::earlier_model::{BaseTerm, Difference, difference};
pub(crate) use self::findings::{Findings, Inputs};
pub(crate) use self::hedges::{WEIGH, doubt_of_loads, hedge};
pub(crate) use self::rivals::{follows_time, listed, most_nats, settle, warms_with_time};
pub(crate) use self::second::on_second;
pub(crate) use self::too_coarse::Corrected;
pub(crate) use self::touched::Touched;
pub(crate) use self::verdict::{
    by_torques, contradicted, is_reported, on_unseen, verdict, why_not,
};
pub(crate) use self::whiteness::Tested;
pub(crate) use self::wrong_angles::torque_nm;
