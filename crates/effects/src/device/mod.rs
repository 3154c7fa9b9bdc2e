//! Effects of a device (`[[effect]]`): from names and numbers to laws, and what they add to a recording.

mod added;
mod error;
mod fit;
mod resolve;

pub use added::{attached, bare};
pub use error::DeviceEffectError;
pub use fit::{settle, with_variances};
pub use resolve::{OwnEffect, effects_of, is_law, laws};
