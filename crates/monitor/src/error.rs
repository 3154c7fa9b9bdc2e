//! The one error type of this crate.

/// Why a monitor cannot be made, or cannot take a row.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MonitorError {
    /// A setting outside what the law is defined for.
    #[error("{what} is {got}, allowed is {allowed}")]
    OutOfRange {
        /// Name of the setting.
        what: &'static str,
        /// The number received.
        got: f64,
        /// The allowed numbers, in words.
        allowed: &'static str,
    },
    /// A row with another number of components than the monitor has.
    #[error("a row has {got} residuals, the monitor has {wanted} components")]
    Width {
        /// Residuals received.
        got: usize,
        /// Components of the monitor.
        wanted: usize,
    },
    /// A quantile that cannot be worked out.
    #[error(transparent)]
    Metrics(#[from] haptical_metrics::MetricsError),
}
