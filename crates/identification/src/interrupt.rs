//! A request to stop, from another thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::IdentificationError;

/// A request to stop, which a search looks for before every step; clones share it. It is no setting of the numbers: two
/// settings are equal without regard to it.
///
/// ```
/// use haptical_identification::{IdentificationError, Interrupt};
///
/// let interrupt = Interrupt::default();
/// assert_eq!(interrupt.check(), Ok(()));
/// interrupt.clone().request();
/// assert_eq!(interrupt.check(), Err(IdentificationError::Interrupted));
/// ```
#[derive(Debug, Clone, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Asks whoever works with a clone of this one to stop.
    pub fn request(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Refuses to go on once a stop was requested.
    ///
    /// # Errors
    /// [`IdentificationError::Interrupted`].
    pub fn check(&self) -> Result<(), IdentificationError> {
        match self.0.load(Ordering::Relaxed) {
            true => Err(IdentificationError::Interrupted),
            false => Ok(()),
        }
    }
}

impl PartialEq for Interrupt {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
