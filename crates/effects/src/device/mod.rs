//! Effects of a device (`[[effect]]`): from names and numbers to laws, and what they add to a recording.

mod added;
mod bare;
mod entry;
mod error;
mod fit;
mod handle;
mod posture;
mod resolve;
mod simulated;

pub use added::{attached, attached_at};
pub use bare::bare;
pub use entry::entry;
pub use error::DeviceEffectError;
pub use fit::{settle, with_variances};
pub use handle::handle_moved_m;
pub use posture::PostureEffects;
pub use resolve::{OwnEffect, PLACES, effects_of, is_law, laws};
pub use simulated::{add_effects, shown_by_effects};
