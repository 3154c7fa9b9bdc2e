//! The forces that a hand feels while a controller holds a wall, with and without the calibration.

mod closed_loop;
mod figure12;
mod figures;
mod first_order;
mod laws;
mod other_laws;
mod sample;
mod section;
mod settling;
mod table;

pub(super) use section::force_section;
