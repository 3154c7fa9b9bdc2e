//! Test for another place of a sensor: does it explain all that an earlier model gets wrong (docs/diagnosis.md, "Earlier
//! model")?

use std::collections::BTreeMap;

use haptical_effects::{Effect, Family, catalogue};
use nalgebra::{DMatrix, DVector};

use crate::answer::ParameterAnswer;
use crate::engine::Engine;
use crate::engine::part::dense;

/// A sensor that is elsewhere throughout the recording.
#[derive(Debug)]
pub(crate) struct Displaced {
    pub(crate) effect: Box<dyn Effect>,
    /// Whitened columns of its amplitudes.
    pub(crate) columns: Vec<Vec<f64>>,
}

/// Every sensor whose place the recording shows. An effect that places differ from a run on does so from the first.
pub(crate) fn displaced(engine: &Engine<'_>) -> Vec<Displaced> {
    let context = &engine.context;
    let places = catalogue(context.device).into_iter();
    let places = places.filter(|effect| effect.spec().family == Family::Place);
    let with_columns = places.map(|effect| {
        let nothing = vec![0.0; effect.spec().amplitudes];
        let signals = effect.derivative(context, &nothing, 0.0);
        let columns = signals.iter().map(|signal| dense(&engine.whole, signal));
        Displaced {
            columns: columns.collect(),
            effect,
        }
    });
    let is_shown = |column: &Vec<f64>| column.iter().any(|entry| *entry != 0.0);
    with_columns
        .filter(|displaced| displaced.columns.iter().all(is_shown))
        .collect()
}

impl Displaced {
    /// Its reported numbers with intervals, by the delta method.
    pub(crate) fn parameters(
        &self,
        engine: &Engine<'_>,
        amplitudes: &[f64],
        covariance: &DMatrix<f64>,
    ) -> BTreeMap<String, ParameterAnswer> {
        let values = |amplitudes: &[f64]| self.effect.values(&engine.context, amplitudes, 0.0);
        let here = values(amplitudes);
        let slopes: Vec<Vec<f64>> = (0..amplitudes.len())
            .map(|index| {
                let step = 1e-3 * covariance[(index, index)].max(0.0).sqrt().max(1e-300);
                let mut moved = amplitudes.to_vec();
                moved[index] += step;
                let there = values(&moved).into_iter().zip(&here);
                there.map(|(there, here)| (there - here) / step).collect()
            })
            .collect();
        let specs = self.effect.spec().parameters.iter().enumerate();
        specs
            .map(|(position, spec)| {
                let slope = DVector::from_fn(amplitudes.len(), |index, _| slopes[index][position]);
                let half = 1.96 * (slope.transpose() * covariance * &slope)[0].max(0.0).sqrt();
                let value = here[position];
                let ci95 = [value - half, value + half];
                (spec.name.to_owned(), ParameterAnswer { value, ci95 })
            })
            .collect()
    }
}
