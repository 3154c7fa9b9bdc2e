//! Laws that several effects share.

mod course;
mod delay;
mod harmonic;
mod step;

pub(crate) use course::{COURSES, course};
pub(crate) use delay::{moved, slope};
pub(crate) use harmonic::{from_polar, polar, waves};
pub use step::under_load;
pub(crate) use step::{instant, row_at, step};
