//! Figures of the transmissions: measured error and identified model.

use haptical_calibration::{Calibration, EvidenceEntry};
use haptical_model::Recording;
use haptical_report::{Block, Cell, Figure, Mark, Series, Table};

use crate::error::Error;
use crate::identify::result::Identified;
use crate::identify::transmissions::{TransmissionEntry, form_in_words};
use crate::page::{drawn, thinned};
use crate::units::Shown;

/// Points of a model's curve.
const CURVE_POINTS: usize = 300;

/// One figure for each transmission, with the evidence for its form where forms were weighed.
pub(super) fn blocks(
    result: &Identified,
    calibration: &Calibration,
    recording: &Recording,
) -> Result<Vec<Block>, Error> {
    let mut blocks = Vec::new();
    for entry in &result.transmissions {
        blocks.push(figure(entry, calibration, recording)?);
        if !entry.evidence.is_empty() {
            blocks.push(evidence(entry)?.into());
        }
    }
    Ok(blocks)
}

fn figure(
    entry: &TransmissionEntry,
    calibration: &Calibration,
    recording: &Recording,
) -> Result<Block, Error> {
    let joint = &calibration.device.joints[entry.joint - 1];
    let shown = Shown::fine(joint.unit());
    let measured = measured_error(recording, entry.joint - 1, shown.per_si);
    let [low, high] = entry.range_rad;
    let readings =
        (0..=CURVE_POINTS).map(|step| low + (high - low) * step as f64 / CURVE_POINTS as f64);
    let error = |reading| Some((reading, joint.error_rad(reading).ok()? * shown.per_si));
    let model: Vec<(f64, f64)> = readings.filter_map(error).collect();
    let (number, form) = (entry.joint, form_in_words(entry.terms));
    let mut figure = Figure::new(
        format!("Transmission of joint {number}: {form}"),
        format!("theta{number} [{}]", joint.unit()),
        format!("out{number} - theta{number} [{}]", shown.name),
    );
    figure.series = vec![
        Series::new("measured", Mark::Points, Series::BEFORE, thinned(measured)),
        Series::new("identified", Mark::Line, Series::AFTER, model),
    ];
    figure.series.retain(|series| !series.points.is_empty());
    let caption = format!(
        "External minus motor-side encoder, and the identified error over the readings of the \
         fit, {low:.3} to {high:.3} {}.",
        joint.unit()
    );
    drawn(&figure, caption)
}

/// Output minus reading over the reading, rows without an output left out (joint from 0).
fn measured_error(
    recording: &Recording,
    joint: usize,
    per_si: f64,
) -> impl Iterator<Item = (f64, f64)> {
    let outputs = recording.output[joint].iter().flatten();
    let pairs = recording.joint[joint].iter().zip(outputs);
    let errors = pairs.map(move |(reading, output)| (*reading, (output - reading) * per_si));
    errors.filter(|(_, error)| error.is_finite())
}

fn evidence(entry: &TransmissionEntry) -> Result<Table, Error> {
    let shown = Shown::fine("rad");
    let unit = shown.name;
    let columns =
        format!("form | parameters | rms [{unit}] | leave-one-out rms [{unit}] | AICc | BIC");
    let mut forms: Vec<&EvidenceEntry> = entry.evidence.iter().collect();
    forms.sort_by_key(|form| form.parameters);
    let rows = forms.into_iter().map(|form| {
        vec![
            form_in_words(form.terms).into(),
            Cell::number(form.parameters as f64, 0),
            shown.cell(form.rms),
            shown.cell(form.leave_one_out_rms),
            Cell::number(form.aicc, 1),
            Cell::number(form.bic, 1),
        ]
    });
    let title = format!("Evidence for joint {}", entry.joint);
    let table = Table::with_heads(title, &columns).with_rows(rows)?;
    Ok(table.with_note(format!(
        "Taken: {}. Lower criteria are better (AICc below 100 readings, BIC from there on); of \
         forms within 2 of the best the one with the fewest parameters is taken.",
        form_in_words(entry.terms)
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_measured_error_is_added_to_the_reading() {
        let recording = Recording {
            joint: vec![vec![0.0; 3], vec![0.5, 1.0, 1.5]],
            output: vec![None, Some(vec![0.75, f64::NAN, 1.0])],
            ..Recording::default()
        };
        let points: Vec<_> = measured_error(&recording, 1, 1e3).collect();
        assert_eq!(points, [(0.5, 250.0), (1.5, -500.0)]);
        assert_eq!(measured_error(&recording, 0, 1e3).count(), 0);
    }
}
