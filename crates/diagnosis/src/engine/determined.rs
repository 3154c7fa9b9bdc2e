//! Where a fit determines what its model predicts of rows that it did not see.

use haptical_calibration::is_in_range;
use haptical_effects::{Effect, Signal};
use haptical_linalg::{Information, dot};
use haptical_model::{Device, Recording};

use crate::engine::{Cause, Engine, Part};
use crate::thresholds::recording::{ERROR_OF_GAP, MOST_LEVERAGE};

/// A fit: its engine, the rows that it saw, and its causes.
pub(crate) struct Fit<'f, 'a> {
    pub(crate) engine: &'f Engine<'a>,
    pub(crate) part: &'f Part,
    pub(crate) effects: &'f [Box<dyn Effect>],
    /// Each cause as it was fitted, and as it is where it predicts.
    pub(crate) causes: Vec<(&'f Cause, &'f Cause)>,
}

impl Fit<'_, '_> {
    /// Variance of the prediction of a reading of `there` by the error of the fit, over that of noise, by stream and row; `there` is
    /// the same engine or one of another recording. None of a reading that is not `asked`, or that the rows of the fit do not determine
    /// (A245, A276).
    fn leverages(
        &self,
        there: &Engine<'_>,
        asked: &dyn Fn(usize, usize) -> bool,
    ) -> Vec<Vec<Option<f64>>> {
        let (here, context) = (self.engine, &self.engine.context);
        let free = &here.base.free;
        let mut columns: Vec<Vec<f64>> = (0..self.part.free.columns())
            .map(|column| self.part.free.dense(column))
            .collect();
        let mut signals: Vec<Signal> = Vec::new();
        for (fitted, predicting) in &self.causes {
            let own = fitted.derivative(self.effects, context);
            columns.extend(own.iter().map(|signal| self.part.blocks.dense(signal)));
            signals.extend(predicting.derivative(self.effects, &there.context));
        }
        let stiffness = here.base.stiffness();
        let information = Information::new(columns.len(), |a, b| {
            let known = stiffness.get(a).filter(|_| a == b);
            dot(&columns[a], &columns[b]) + known.map_or(0.0, |own| own * own)
        });
        let streams = 0..there.context.streams.len();
        let of_stream = |stream: usize| {
            let mut slopes: Vec<Vec<f64>> = Vec::with_capacity(columns.len());
            let rows = 0..there.usable[stream].len();
            // without parameters there are no columns of them
            for &parameter in free.iter().take(self.part.free.columns()) {
                let derivative = there.derivatives.as_ref().and_then(|derivatives| {
                    there.problem.derivative(derivatives, stream, parameter)
                });
                slopes
                    .push(derivative.map_or_else(Vec::new, |own| rows.clone().map(own).collect()));
            }
            for signal in &signals {
                let own = signal.parts.iter().find(|(other, _)| *other == stream);
                slopes.push(own.map_or_else(Vec::new, |(_, values)| values.clone()));
            }
            let noise = here.floor[stream].max(1e-300);
            let most = MOST_LEVERAGE.max(ERROR_OF_GAP * here.gap_over_noise(stream));
            let leverage = |row: usize| {
                let entry = |column: usize| slopes[column].get(row).map_or(0.0, |own| own / noise);
                let leverage = asked(stream, row).then(|| information.leverage(entry));
                // not so of what is no number
                leverage.filter(|own| *own <= most)
            };
            rows.clone().map(leverage).collect()
        };
        streams.map(of_stream).collect()
    }
}

/// Which readings that a fit did not see are predicted, and what is said of the others.
pub(crate) struct Predicted {
    /// The leverage of a reading that is predicted.
    by_stream: Vec<Vec<Option<f64>>>,
    pub(crate) warnings: Vec<String>,
}

impl Predicted {
    /// Of the `asked` readings those within the ranges of the polynomials of `device`, which are those of the rows of the fit, and
    /// where its rows determine the prediction; `fit` is none of a fit that has no columns there.
    pub(crate) fn new(
        there: &Engine<'_>,
        (device, recording): (&Device, &Recording),
        fit: Option<&Fit<'_, '_>>,
        asked: &dyn Fn(usize, usize) -> bool,
    ) -> Self {
        let streams = &there.context.streams;
        let in_range = |stream: usize, row: usize| {
            asked(stream, row) && is_in_range(device, recording, streams[stream].channel, row)
        };
        let leverages = fit.map(|fit| fit.leverages(there, &in_range));
        let mut warnings = Vec::new();
        let mut by_stream = Vec::new();
        for (stream, own) in streams.iter().enumerate() {
            let rows: Vec<Option<f64>> = match &leverages {
                Some(leverages) => leverages[stream].clone(),
                None => (0..recording.len())
                    .map(|row| in_range(stream, row).then_some(0.0))
                    .collect(),
            };
            let all = (0..rows.len()).filter(|row| asked(stream, *row)).count();
            let left_out = all - rows.iter().flatten().count();
            if left_out > 0 {
                warnings.push(format!(
                    "{}: {left_out} of {all} readings that the fit did not see are not predicted and left out: the rows that it saw \
                     do not cover their angles, or hardly show what the prediction depends on",
                    own.name()
                ));
            }
            by_stream.push(rows);
        }
        Self {
            by_stream,
            warnings,
        }
    }

    /// The leverage of a reading that is predicted: none of another one, 0 of a model that was not fitted here.
    pub(crate) fn leverage(&self, stream: usize, row: usize) -> Option<f64> {
        self.by_stream[stream][row]
    }

    pub(crate) fn has(&self, stream: usize, row: usize) -> bool {
        self.leverage(stream, row).is_some()
    }
}
