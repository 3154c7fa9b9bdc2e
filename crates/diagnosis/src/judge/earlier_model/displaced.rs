//! Test for another place of a sensor: does it explain all that an earlier model gets wrong (docs/diagnosis.md, "Earlier
//! model")?

use std::collections::BTreeMap;

use haptical_effects::{Effect, Family, catalogue};
use nalgebra::DMatrix;

use crate::answer::ParameterAnswer;
use crate::engine::Engine;
use crate::engine::part::dense;
use haptical_effects::device::with_variances;

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
        let context = &engine.context;
        let values = with_variances(self.effect.as_ref(), context, amplitudes, 0.0, covariance);
        let pairs = self.effect.spec().parameters.iter().zip(values);
        pairs
            .map(|(spec, (value, variance))| {
                let sd = variance.max(0.0).sqrt();
                (spec.name.to_owned(), ParameterAnswer::normal(value, sd))
            })
            .collect()
    }
}
