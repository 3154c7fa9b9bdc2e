//! The zero of the cable encoder is set wrong.

use crate::cable::EXIT;
use crate::laws::{Input, Law};
use crate::{Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "cable-zero-offset",
    meaning: "the zero of the measuring cable is not where the device file says",
    inspect: "the reference length of the cable encoder",
    adds: "constant",
    source: "C2",
    parameters: &[Parameter::size("offset_m", 0.0, 0.05)],
    ..EXIT
};

#[derive(Debug)]
pub(crate) struct ZeroOffset;

impl Law for ZeroOffset {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], _: f64) -> Option<Vec<Vec<f64>>> {
        Some(vec![vec![1.0; input.context.rows()]])
    }
}
