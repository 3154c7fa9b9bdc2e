//! An error in proportion to the number itself.

use crate::laws::{Input, Law};

/// s x.
#[derive(Debug)]
pub(crate) struct Proportional;

impl Law for Proportional {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], _: f64) -> Option<Vec<Vec<f64>>> {
        Some(vec![input.reading()?.to_vec()])
    }
}
