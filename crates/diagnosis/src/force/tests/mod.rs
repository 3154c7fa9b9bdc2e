//! The force test on synthetic recordings and against mechanics by another route.

mod absent;
mod arm;
mod carried;
mod found;
mod mechanics;
mod of_device;
