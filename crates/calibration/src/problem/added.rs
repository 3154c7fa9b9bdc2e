//! What effects of the device add to the readings ([`haptical_model::AddedReadings`]).

use std::ops::Range;

use haptical_identification::Matrix;
use haptical_model::{AddedReadings, Device, ParameterId, Recording};

use crate::{Channel, DeviceProblem};

/// What effects add to a channel, of the rows with a reading.
pub(crate) fn added_to(
    recording: &Recording,
    channel: Channel,
    rows: &[usize],
) -> Vec<AddedReadings> {
    if recording.added.is_empty() {
        return Vec::new();
    }
    let name = channel.name();
    let own = recording.added.iter().filter(|own| own.channel == name);
    let taken = |values: &Vec<f64>| rows.iter().map(|&row| values[row]).collect();
    own.map(|own| AddedReadings {
        effect: own.effect,
        channel: name.clone(),
        axis: own.axis,
        readings: taken(&own.readings),
        at: own.at.clone(),
        slopes: own.slopes.iter().map(taken).collect(),
    })
    .collect()
}

/// What effects add to the readings of a channel with one axis at every row of a recording; none without effects on it.
pub(crate) fn added_readings(
    device: &Device,
    recording: &Recording,
    channel: Channel,
) -> Option<Vec<f64>> {
    let rows: Vec<usize> = (0..recording.len()).collect();
    let own = added_to(recording, channel, &rows);
    if own.is_empty() {
        return None;
    }
    let mut sum = vec![0.0; rows.len()];
    for own in &own {
        let change = Change::new(device, own);
        for (row, sum) in sum.iter_mut().enumerate() {
            *sum += change.at(own, row);
        }
    }
    Some(sum)
}

/// How far the numbers of an effect are from where its readings were worked out.
struct Change {
    /// Whether the device has no such effect, or all its numbers are 0, which is exact however bent its law is.
    is_absent: bool,
    by: Vec<f64>,
}

impl Change {
    fn new(device: &Device, own: &AddedReadings) -> Self {
        let Some(effect) = device.effects.get(own.effect) else {
            return Self {
                is_absent: true,
                by: Vec::new(),
            };
        };
        let values: Vec<f64> = effect.fitted.iter().map(|own| own.value).collect();
        Self {
            is_absent: !values.is_empty() && values.iter().all(|value| *value == 0.0),
            by: values
                .iter()
                .zip(&own.at)
                .map(|(now, at)| now - at)
                .collect(),
        }
    }

    fn at(&self, own: &AddedReadings, entry: usize) -> f64 {
        if self.is_absent {
            return 0.0;
        }
        let slopes = own.slopes.iter().zip(&self.by);
        slopes.fold(own.readings[entry], |sum, (slope, by)| {
            sum + slope[entry] * by
        })
    }
}

impl DeviceProblem<'_> {
    /// Adds what effects do to the residuals of some rows, and their derivatives.
    pub(crate) fn add_effects(
        &self,
        device: &Device,
        rows: &Range<usize>,
        firsts: &[usize],
        residuals: &mut [f64],
        jacobian: &mut Option<(&[usize], &mut Matrix)>,
    ) {
        let is_of_effect =
            |&&parameter: &&usize| matches!(self.parameters[parameter], ParameterId::Effect { .. });
        for (block, &first) in self.blocks.iter().zip(firsts) {
            let begin = block.rows.partition_point(|&row| row < rows.start);
            let end = block.rows.partition_point(|&row| row < rows.end);
            let width = block.channel.width();
            if let Some((free, matrix)) = jacobian.as_mut() {
                let columns = free.iter().enumerate();
                for (column, _) in columns.filter(|(_, parameter)| is_of_effect(parameter)) {
                    matrix.column_mut(column)[first..first + (end - begin) * width].fill(0.0);
                }
            }
            for own in &block.added {
                let change = Change::new(device, own);
                let place = |entry: usize| first + (entry - begin) * width + own.axis;
                for entry in begin..end {
                    residuals[place(entry)] += block.weights[entry] * change.at(own, entry);
                }
                let Some((free, matrix)) = jacobian.as_mut() else {
                    continue;
                };
                for (column, &parameter) in free.iter().enumerate() {
                    let ParameterId::Effect { effect, number } = self.parameters[parameter] else {
                        continue;
                    };
                    let slope = own.slopes.get(number).filter(|_| effect == own.effect);
                    let Some(slope) = slope else { continue };
                    let into = matrix.column_mut(column);
                    for entry in begin..end {
                        into[place(entry)] += block.weights[entry] * slope[entry];
                    }
                }
            }
        }
    }
}
