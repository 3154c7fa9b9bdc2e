//! Laws that are a function alone: linear, with nothing of their own to report.

use crate::Signal;
use crate::laws::{Input, Law};

/// The error of one number per amplitude; none where an input is missing.
#[derive(Debug)]
pub(crate) struct Linear(pub(crate) fn(Input<'_, '_>) -> Option<Vec<Vec<f64>>>);

/// What the streams show per amplitude, where several numbers are wrong.
#[derive(Debug)]
pub(crate) struct InStreams(pub(crate) fn(Input<'_, '_>) -> Option<Vec<Signal>>);

impl Linear {
    /// An error in proportion to the number itself.
    pub(crate) const PROPORTIONAL: Self = Self(|input| Some(vec![input.reading()?.to_vec()]));
}

impl Law for Linear {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], _: f64) -> Option<Vec<Vec<f64>>> {
        (self.0)(input)
    }
}

impl Law for InStreams {
    fn signals(&self, input: Input<'_, '_>, _: f64) -> Option<Vec<Signal>> {
        (self.0)(input)
    }
}
