//! Errors of evaluating a device along a recording.

use haptical_model::ModelError;

/// Why there is nothing that effects could be computed from.
#[derive(Debug, thiserror::Error)]
pub enum ContextError {
    /// The device has no value at a row.
    #[error("line {line} of the log: {source}")]
    Row {
        /// Line of the log.
        line: u64,
        /// Reason.
        source: ModelError,
    },
}
