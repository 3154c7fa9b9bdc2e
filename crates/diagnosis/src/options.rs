//! Options of a diagnosis.

use haptical_calibration::LossChoice;
use haptical_effects::Effect;
use haptical_identification::Interrupt;
use haptical_model::{Device, Recording};

/// The effects of a device, each at every place where it can occur: [`haptical_effects::catalogue`] is one.
pub type Catalogue = fn(&Device) -> Vec<Box<dyn Effect>>;

/// Options of [`crate::diagnose`].
#[derive(Debug, Clone, Default)]
pub struct Options<'a> {
    /// Names of effects to leave out of the catalogue.
    pub without: Vec<String>,
    /// Effects of the caller, tested like those of the catalogue. A name that the catalogue has is confused with it.
    pub own_effects: Option<Catalogue>,
    /// A model identified earlier: what differs from it is part of the gap.
    pub model: Option<&'a Device>,
    /// A second recording of the same device, on which the shrink is measured.
    pub validation: Option<&'a Recording>,
    /// What large residuals cost in the fit of the base model.
    pub loss: LossChoice,
    /// Stops the diagnosis from another thread.
    pub interrupt: Interrupt,
}
