//! Reports, tables and progress of the jobs of the project.
#![allow(clippy::print_stdout, reason = "reports talk to a terminal")]
#![allow(
    clippy::missing_errors_doc,
    reason = "the errors are texts for a person"
)]

mod cells;
mod command;
mod output;
mod page;
mod progress;

pub use cells::Shown;
pub use command::{built_command, cargo, read_json, read_text, root, said};
pub use haptical_report::Cell;
pub use output::{Layout, Output, or_none};
pub use page::put_between;
pub use progress::Progress;
