//! A second or further cable: its zero and its scale, with the number of the cable.

use haptical_calibration::Channel;

use crate::laws::{Input, Law};
use crate::signal::Signal;
use crate::{Context, Family, Follows, Hook, Need, Parameter, Shape, Spec};

use super::{scale, stretch, zero_offset};

/// Number of the cable, from 2: `cable2_m`.
const CABLE: Parameter = Parameter::number("cable", 1000.0);

const FURTHER: Spec = Spec {
    hook: Hook::CableSensor,
    needs: &[Need::FurtherCable],
    shape: Shape::Given,
    follows: Follows::Length,
    ..Spec::of(Family::Stated)
};

pub(crate) const ZERO: Spec = Spec {
    name: zero_offset::SPEC.name,
    meaning: zero_offset::SPEC.meaning,
    inspect: zero_offset::SPEC.inspect,
    adds: zero_offset::SPEC.adds,
    source: zero_offset::SPEC.source,
    parameters: &[zero_offset::SPEC.parameters[0], CABLE],
    ..FURTHER
};

/// Among other cables the scale of one is no scale of all lengths.
pub(crate) const SCALE: Spec = Spec {
    name: scale::SPEC.name,
    meaning: scale::SPEC.meaning,
    inspect: scale::SPEC.inspect,
    adds: scale::SPEC.adds,
    source: scale::SPEC.source,
    parameters: &[scale::SPEC.parameters[0], CABLE],
    ..FURTHER
};

pub(crate) const STRETCH: Spec = Spec {
    name: stretch::SPEC.name,
    meaning: stretch::SPEC.meaning,
    inspect: stretch::SPEC.inspect,
    adds: stretch::SPEC.adds,
    source: stretch::SPEC.source,
    parameters: &[stretch::SPEC.parameters[0], CABLE],
    look_alikes: stretch::SPEC.look_alikes,
    ..FURTHER
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
