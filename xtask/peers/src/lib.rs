//! Speed: ours against other libraries, growth with the size of the work, counted instructions.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command talks to its terminal"
)]
#![allow(
    clippy::missing_errors_doc,
    reason = "the errors are texts for a person"
)]

pub mod bench_peers;
pub mod bench_scaling;
pub mod instructions;
pub mod moving;
