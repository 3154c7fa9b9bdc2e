//! Options of a diagnosis.

use haptical_model::{Device, Recording};

/// Options of [`crate::diagnose`].
#[derive(Debug, Clone, Default)]
pub struct Options<'a> {
    /// Names of effects to leave out of the catalogue.
    pub without: Vec<String>,
    /// A model identified earlier: what differs from it is part of the gap.
    pub model: Option<&'a Device>,
    /// A second recording of the same device, on which the shrink is measured.
    pub validation: Option<&'a Recording>,
}
