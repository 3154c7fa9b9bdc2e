//! A candidate as columns: what it adds to the readings of a recording, and how that changes with its numbers.

use haptical_effects::{Context, Effect, Family, Shape, Signal};

use super::hedge::Judged;
use super::question::Candidate;
use crate::engine::{Blocks, difference};

/// A candidate with the effect that it names.
#[derive(Debug, Clone)]
pub(super) struct Hypothesis {
    /// Position in the catalogue.
    effect: usize,
    amplitudes: Vec<f64>,
    shape: f64,
    is_event: bool,
}

/// Columns of a candidate on the blocks of a recording.
pub(super) struct Columns {
    /// What it adds at the size found.
    pub(super) signal: Vec<f64>,
    /// Derivatives by its amplitudes and by the logarithm of its shape.
    pub(super) slopes: Vec<Vec<f64>>,
    /// What it adds more at the end than at the start, where that is most: what a motion there and back leaves behind.
    pub(super) lasting: f64,
}

impl Hypothesis {
    /// The candidate with numbers as they enter its law on the recording of `context`; none where the device has no such
    /// effect, or a number is missing.
    pub(super) fn new(
        effects: &[Box<dyn Effect>],
        candidate: &Candidate,
        context: &Context<'_>,
    ) -> Option<Self> {
        let number = |name: &str| candidate.numbers.get(name).copied();
        let joint = candidate.joint.and_then(|joint| joint.checked_sub(1));
        let is_it = |effect: &dyn Effect| {
            let place = |index: usize| (index + 1) as f64;
            let from = effect.other_joint().map(place);
            let cable = effect.further_cable().map(place);
            let mut names = effect.spec().parameters.iter().map(|own| own.name);
            effect.name() == candidate.effect
                && effect.joint() == joint
                && (from.is_none() || from == number("from_joint"))
                && cable == number("cable")
                && names.all(|name| number(name).is_some_and(f64::is_finite))
        };
        let index = effects.iter().position(|own| is_it(own.as_ref()))?;
        let effect = effects[index].as_ref();
        let spec = effect.spec();
        let values: Vec<f64> = (spec.parameters.iter())
            .map(|own| number(own.name))
            .collect::<Option<_>>()?;
        let further = spec.further.iter();
        let further: Vec<f64> = further
            .map(|own| number(own.name).or(own.default).unwrap_or(f64::NAN))
            .collect();
        // numbers of a cause that is reported without the further ones of its law
        let (amplitudes, shape) = match further.iter().all(|value| value.is_finite()) {
            true => effect.whole(context, &values, &further),
            false => effect.amplitudes(context, &values),
        };
        let is_finite = shape.is_finite() && amplitudes.iter().all(|value| value.is_finite());
        is_finite.then_some(Self {
            effect: index,
            amplitudes,
            shape,
            is_event: spec.shape == Shape::Event,
        })
    }

    /// Numbers that its columns are derivatives by.
    pub(super) fn slopes(&self, effects: &[Box<dyn Effect>]) -> usize {
        let shape = effects[self.effect].spec().shape;
        self.amplitudes.len() + usize::from(shape.is_continuous())
    }

    /// The columns on a recording; zero on another one than it was found in for what happened once, and where the recording
    /// cannot show it.
    pub(super) fn columns(
        &self,
        effects: &[Box<dyn Effect>],
        context: &Context<'_>,
        blocks: &Blocks,
        is_where_found: bool,
    ) -> Columns {
        let effect = effects[self.effect].as_ref();
        let is_absent = self.is_event && !is_where_found;
        if is_absent || effect.untestable(context).is_some() {
            let zero = vec![0.0; blocks.count()];
            return Columns {
                slopes: vec![zero.clone(); self.slopes(effects)],
                signal: zero,
                lasting: 0.0,
            };
        }
        let at = |shape: f64| effect.signal(context, &self.amplitudes, shape);
        let signals = effect.derivative(context, &self.amplitudes, self.shape);
        let mut slopes: Vec<Vec<f64>> = signals.iter().map(|own| blocks.dense(own)).collect();
        if effect.spec().shape.is_continuous() {
            let step = effect.shape_step(context, self.shape);
            let [higher, lower] = [1.0 + step, 1.0 - step].map(|factor| at(self.shape * factor));
            slopes.push(blocks.dense(&difference(&higher, &lower, 2.0 * step)));
        }
        slopes.resize(self.slopes(effects), vec![0.0; blocks.count()]);
        let whole = at(self.shape);
        Columns {
            signal: blocks.dense(&whole),
            slopes,
            lasting: lasting(&whole),
        }
    }

    pub(super) fn effect<'e>(&self, effects: &'e [Box<dyn Effect>]) -> &'e dyn Effect {
        effects[self.effect].as_ref()
    }

    pub(super) fn judged<'e>(
        &self,
        effects: &'e [Box<dyn Effect>],
        look_alikes_are_tried: bool,
    ) -> Judged<'e> {
        let effect = self.effect(effects);
        Judged {
            effect,
            settles: effect.spec().family == Family::Drift && self.shape != 0.0,
            look_alikes_are_tried,
        }
    }

    /// Whether the sensors of a recording show every look-alike of it.
    pub(super) fn are_look_alikes_tried(
        &self,
        effects: &[Box<dyn Effect>],
        context: &Context<'_>,
    ) -> bool {
        let own = self.effect(effects);
        own.spec().look_alikes.iter().all(|name| {
            let mut others = effects.iter();
            others.any(|other| {
                other.name() == *name
                    && other.joint() == own.joint()
                    && other.untestable(context).is_none()
            })
        })
    }
}

/// Change from the first row to the last, in the stream in which it is largest.
fn lasting(signal: &Signal) -> f64 {
    let changes = signal.parts.iter().map(|(_, values)| {
        let ends = values.first().zip(values.last());
        ends.map_or(0.0, |(first, last)| last - first)
    });
    changes.fold(0.0, |most, own| {
        if own.abs() > f64::abs(most) {
            own
        } else {
            most
        }
    })
}
