//! Ours against other libraries, in speed and on public descriptions; growth with the size of the work, counted instructions.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    clippy::missing_errors_doc,
    reason = "a command talks to its terminal, and its errors are texts for a person"
)]

pub mod bench_peers;
pub mod bench_scaling;
pub mod descriptions;
pub mod instructions;
pub mod moving;
pub mod whole;
