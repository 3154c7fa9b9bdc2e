//! A second or further cable: its zero and its scale, with the number of the cable.

use haptical_calibration::Channel;

use crate::laws::{Input, Law};
use crate::signal::Signal;
use crate::{Absorbed, Context, Family, Follows, LawError, Need, Parameter, Shape, Spec};

use super::{scale, stretch, zero_offset};

/// Number of the cable, from 2: `cable2_m`.
const CABLE: Parameter = Parameter::number("cable", 1000.0);

/// What the effect of the first cable is of another one, but for its parameters.
const fn of_further(first: Spec) -> Spec {
    Spec {
        needs: &[Need::FurtherCable],
        family: Family::Stated,
        law_error: LawError::of(Family::Stated),
        shape: Shape::Given,
        follows: Follows::Length,
        absorbed_by: Absorbed::Never,
        ..first
    }
}

pub(crate) const ZERO: Spec = Spec {
    parameters: &[zero_offset::SPEC.parameters[0], CABLE],
    ..of_further(zero_offset::SPEC)
};

/// Among other cables the scale of one is no scale of all lengths.
pub(crate) const SCALE: Spec = Spec {
    parameters: &[scale::SPEC.parameters[0], CABLE],
    ..of_further(scale::SPEC)
};

pub(crate) const STRETCH: Spec = Spec {
    parameters: &[stretch::SPEC.parameters[0], CABLE],
    ..of_further(stretch::SPEC)
};

/// An error of one number of a further cable.
#[derive(Debug)]
pub(crate) struct Further {
    /// From 0; the first cable is 0.
    pub(crate) cable: usize,
    /// What the cable reads more per unit \[m\].
    pub(crate) reads_m: fn(&Context<'_>, usize) -> Option<Vec<f64>>,
}

/// A constant.
pub(crate) fn constant(context: &Context<'_>, _: usize) -> Option<Vec<f64>> {
    Some(vec![1.0; context.rows()])
}

/// In proportion to its length.
pub(crate) fn proportional(context: &Context<'_>, cable: usize) -> Option<Vec<f64>> {
    context.cable_length_m(cable)
}

impl Law for Further {
    fn signals(&self, input: Input<'_, '_>, _: f64) -> Option<Vec<Signal>> {
        let context = input.context;
        let channel = Channel::Cable { index: self.cable };
        let stream = context.streams_of(channel).next()?;
        let parts = vec![(stream, (self.reads_m)(context, self.cable)?)];
        Some(vec![Signal { parts }])
    }

    fn shapes(&self, _: Input<'_, '_>) -> Option<Vec<f64>> {
        Some(vec![(self.cable + 1) as f64])
    }

    fn further_cable(&self) -> Option<usize> {
        Some(self.cable)
    }
}
