//! Figures of each channel's residuals: over time, and over the reading that they belong to.

use haptical_calibration::{Calibration, ChannelReport};
use haptical_model::Recording;
use haptical_report::{Block, Figure, Mark, Series};

use crate::error::Error;
use crate::page::{MOST_POINTS, drawn, thinned};
use crate::units::Shown;

/// The horizontal axis of a figure, and the place of each row on it.
struct Axis<'a> {
    label: String,
    title: String,
    at: Box<dyn Fn(usize) -> f64 + 'a>,
}

/// All figures, channel by channel.
pub(super) fn blocks(
    calibration: &Calibration,
    recording: &Recording,
) -> Result<Vec<Block>, Error> {
    let mut blocks = vec![Block::Paragraph(format!(
        "Each point is one residual, model minus measurement; of more than {MOST_POINTS} points of \
         a kind every k-th is drawn. Rows not seen by the fit: {}.",
        calibration.held_out
    ))];
    let mut done: Vec<&str> = Vec::new();
    let fit = calibration.fit_channels.iter();
    for channel in fit.chain(&calibration.held_out_channels) {
        if done.contains(&channel.channel.as_str()) {
            continue;
        }
        done.push(&channel.channel);
        let axes = [Some(over_time(recording)), over_reading(channel, recording)];
        for axis in axes.into_iter().flatten() {
            blocks.extend(figure(calibration, &channel.channel, &axis)?);
        }
    }
    Ok(blocks)
}

/// One figure; none where no residual has a place on the axis.
fn figure(calibration: &Calibration, name: &str, axis: &Axis<'_>) -> Result<Option<Block>, Error> {
    let is_it = |report: &&ChannelReport| report.channel == name;
    let fit = calibration.fit_channels.iter().find(is_it);
    let held_out = calibration.held_out_channels.iter().find(is_it);
    let unit = fit.or(held_out).map_or("", |report| report.unit.as_str());
    let shown = Shown::fine(unit);
    let per_si = shown.per_si;
    // Folds of a short log hold out every row once, so that the fit's rows would be drawn twice.
    let folds = matches!((fit, held_out), (Some(fit), Some(held_out)) if are_folds(fit, held_out));
    let (fit_once, held_out_once) = (fit.filter(|_| !folds), held_out.filter(|_| !folds));
    let all = fit.into_iter().chain(held_out_once);
    let mut before = thinned(all.flat_map(|own| points(own, &own.before, axis, per_si)));
    before.sort_by(|a, b| a.0.total_cmp(&b.0));
    let after = |label: &str, mark, report: Option<&ChannelReport>| {
        let points = report.map(|own| thinned(points(own, &own.after, axis, per_si)));
        Series::new(label, mark, Series::AFTER, points.unwrap_or_default())
    };
    let title = format!("{name}: residual {}", axis.title);
    let mut figure = Figure::new(&title, &axis.label, format!("residual [{}]", shown.name));
    figure.series = vec![
        Series::new("before", Mark::Points, Series::BEFORE, before),
        after("after, rows of the fit", Mark::Rings, fit_once),
        after("after, rows not seen by the fit", Mark::Points, held_out),
    ];
    figure.series.retain(|series| !series.points.is_empty());
    if figure.series.is_empty() {
        return Ok(None);
    }
    let sizes = held_out.or(fit).map(|report| {
        let sizes = [report.rms_before, report.rms_after, report.noise_floor];
        let [before, after, floor] = sizes.map(|size| shown.text(size));
        format!("Root mean square {before} before and {after} after, noise floor {floor}.")
    });
    drawn(&figure, sizes.unwrap_or_default()).map(Some)
}

/// Whether rows that were held out were fitted too, in other folds.
fn are_folds(fit: &ChannelReport, held_out: &ChannelReport) -> bool {
    let first = held_out.rows.first();
    first.is_some_and(|row| fit.rows.contains(row))
}

/// The points of residuals; those without a place on the axis are left out.
fn points<'p>(
    report: &'p ChannelReport,
    residuals: &'p [f64],
    axis: &'p Axis<'_>,
    per_si: f64,
) -> impl Iterator<Item = (f64, f64)> + 'p {
    // A position has three residuals a row, one per axis.
    let width = (residuals.len() / report.rows.len().max(1)).max(1);
    let at = move |index: usize| (axis.at)(report.rows[index / width]);
    let points = residuals.iter().enumerate();
    let points = points.map(move |(index, residual)| (at(index), residual * per_si));
    points.filter(|(x, _)| x.is_finite())
}

/// Over time, or over the row where there is no time or where it starts again with each run.
fn over_time(recording: &Recording) -> Axis<'_> {
    let mut pairs = recording.run.iter().flat_map(|run| run.windows(2));
    let one_run = pairs.all(|pair| pair[0] == pair[1]);
    match &recording.time_s {
        Some(times) if one_run && times.iter().all(|time| time.is_finite()) => Axis {
            label: "time [s]".to_owned(),
            title: "over time".to_owned(),
            at: Box::new(|row| times[row]),
        },
        _ => Axis {
            label: "row of the log [1]".to_owned(),
            title: "over the rows of the log".to_owned(),
            at: Box::new(|row| row as f64 + 1.0),
        },
    }
}

/// Over the joint's own reading, or over the distance; none for positions and orientations.
fn over_reading<'a>(channel: &ChannelReport, recording: &'a Recording) -> Option<Axis<'a>> {
    if let Some(joint) = channel.joint {
        let readings = recording.joint.get(joint - 1)?;
        return Some(Axis {
            label: format!("theta{joint} [{}]", channel.unit),
            title: format!("over the motor-side reading of joint {joint}"),
            at: Box::new(|row| readings[row]),
        });
    }
    let index = match channel.channel.strip_prefix("cable")? {
        "" => 0,
        number => number.parse::<usize>().ok()?.checked_sub(1)?,
    };
    let distances = recording.cable_m.get(index)?.as_ref()?;
    Some(Axis {
        label: "measured distance [m]".to_owned(),
        title: "over the measured distance".to_owned(),
        at: Box::new(|row| distances[row]),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(channel: &str, joint: Option<usize>, rows: &[usize]) -> ChannelReport {
        ChannelReport {
            channel: channel.to_owned(),
            joint,
            unit: "rad".to_owned(),
            readings: rows.len(),
            outside_range: 0,
            rms_before: 1.0,
            sd_before: 1.0,
            rms_after: 1.0,
            rms_fit: None,
            sd_after: 1.0,
            rms_before_good: 1.0,
            rms_after_good: 1.0,
            outliers: 0,
            noise_floor: 1.0,
            reduction_percent: None,
            reduction_percent_good: None,
            hands: Vec::new(),
            before: Vec::new(),
            after: Vec::new(),
            rows: rows.to_vec(),
        }
    }

    fn recording() -> Recording {
        Recording {
            time_s: Some(vec![10.0, 20.0, 30.0]),
            joint: vec![vec![0.1, 0.2, 0.3], vec![1.1, 1.2, 1.3]],
            cable_m: vec![Some(vec![0.5, 0.6, 0.7]), Some(vec![5.0, 6.0, 7.0])],
            ..Recording::default()
        }
    }

    #[test]
    fn points_stand_at_their_rows() {
        let recording = recording();
        let single = report("out2", Some(2), &[0, 2]);
        let at =
            |axis: &Axis<'_>| points(&single, &[1.0, -2.0], axis, 1e3).collect::<Vec<(f64, f64)>>();
        assert_eq!(at(&over_time(&recording)), [(10.0, 1e3), (30.0, -2e3)]);
        let reading = over_reading(&single, &recording).unwrap();
        assert_eq!(at(&reading), [(1.1, 1e3), (1.3, -2e3)]);
        assert_eq!(reading.label, "theta2 [rad]");
        let cable = over_reading(&report("cable2", None, &[]), &recording).unwrap();
        assert_eq!(at(&cable), [(5.0, 1e3), (7.0, -2e3)]);
        assert!(over_reading(&report("position", None, &[]), &recording).is_none());
    }

    #[test]
    fn three_residuals_of_a_position_stand_at_one_row() {
        let recording = recording();
        let position = report("position", None, &[1]);
        let axis = over_time(&recording);
        let points: Vec<_> = points(&position, &[1.0, 2.0, 3.0], &axis, 1.0).collect();
        assert_eq!(points, [(20.0, 1.0), (20.0, 2.0), (20.0, 3.0)]);
    }

    #[test]
    fn as_many_rows_of_another_run_are_no_folds() {
        let rows = |rows: &[usize]| report("out1", Some(1), rows);
        assert!(!are_folds(&rows(&[0, 1]), &rows(&[2, 3])));
        assert!(are_folds(&rows(&[0, 1, 2, 3]), &rows(&[2, 0, 3, 1])));
    }

    #[test]
    fn times_that_start_again_are_no_axis() {
        let restarted = Recording {
            run: Some(vec![1, 2, 2]),
            ..recording()
        };
        assert_eq!((over_time(&restarted).at)(2), 3.0);
    }
}
