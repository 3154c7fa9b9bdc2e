//! Flags that several commands share, and what the library is asked for by them.

mod device;
mod hold;
mod method;

pub(crate) use device::DeviceOptions;
pub(crate) use hold::HoldOptions;
