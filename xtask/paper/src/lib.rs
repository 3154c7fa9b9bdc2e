//! The paper again: its simulation (Tables 1 to 3), and its experiment on a virtual device (Tables 4 and 5).
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    clippy::missing_errors_doc,
    reason = "a command talks to its terminal, and its errors are texts for a person"
)]

pub mod experiment;
mod monte_carlo;
mod pose_error;
mod published;
mod run;
mod scenario;
pub mod tables;

pub use experiment::chebyshev;
pub use monte_carlo::{known_angles, with_transmissions_of};
pub use pose_error::PoseErrors;
pub use published::{Paper, Published};
pub use xtask_blind::rows;

pub use run::{evaluation_readings, step_one, step_one_on, step_two_on};
pub use scenario::{Scenario, nominal_device, true_device};
