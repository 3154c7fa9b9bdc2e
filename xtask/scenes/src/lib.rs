//! Golden scenes: devices and logs of every rig and every view, their whole answers against recorded ones, and the laws that answers keep.
#![allow(
    clippy::print_stdout,
    clippy::missing_errors_doc,
    reason = "the jobs of this crate talk to a terminal, and their errors are texts for a person"
)]

mod answer;
mod catalogue;
mod compare;
mod job;
mod laws;
mod noise;
mod printed;
mod record;
mod scene;
mod table;
mod workers;

pub use job::{Arguments, compare_results};
pub use laws::{LawsArguments, laws};
pub use printed::{PrintedArguments, printed_commands};
