//! What the jobs of the project print and write.
#![allow(
    clippy::missing_errors_doc,
    reason = "the errors are texts for a person"
)]

mod output;
mod progress;

pub use output::{Layout, Output};
pub use progress::Progress;
