//! What effects of the device add to the readings ([`haptical_model::AddedReadings`]).

use haptical_model::{AddedReadings, Device, Recording};

use crate::Channel;

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
        by: own.by,
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
pub(crate) struct Change {
    /// Whether the device has no such effect, or all its numbers are 0, which is exact however bent its law is.
    is_absent: bool,
    by: Vec<f64>,
}

impl Change {
    pub(crate) fn new(device: &Device, own: &AddedReadings) -> Self {
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

    /// What the effect adds to an entry.
    pub(crate) fn at(&self, own: &AddedReadings, entry: usize) -> f64 {
        if self.is_absent {
            return 0.0;
        }
        let slopes = own.slopes.iter().zip(&self.by);
        slopes.fold(own.readings[entry], |sum, (slope, by)| {
            sum + slope[entry] * by
        })
    }
}
