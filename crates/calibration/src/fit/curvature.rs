//! What plausible errors of held parameters do to the fitted ones beyond the first order.

use haptical_identification::{Matrix, Status};
use haptical_model::Recording;

use crate::error::wrap;
use crate::fit::considered::{Held, sensitivity, set_variance};
use crate::problem::device_problem::values_of;
use crate::problem::form::{Prepared, reduce};
use crate::problem::some_rows::some_of_each_kind;
use crate::{CalibrationError, Channel, DeviceProblem, ParameterFit, Weights};

/// Counts the second order of what a fit held: with errors d of the held parameters a fitted one errs by
/// G d + d^T H d / 2.
///
/// A device that may turn about a cable's exit has parameters that no small turn moves and a large one does. H comes
/// from G at the device moved by one deviation of each held parameter to either side, the fitted ones moved with it; with d normal
/// and of covariance S, E (d^T H d / 2)^2 = ((tr HS)^2 + 2 tr (HS)^2) / 4 (Mathai & Provost, *Quadratic Forms in
/// Random Variables*, 1992, section 3.2b). The third order along each
/// single parameter, T d^3 / 6 with E d^6 = 15, is added. What an earlier step fitted is known too well to matter. The scale of an
/// instrument moves the lengths alone, in proportion, and with them G of what is held.
///
/// `recording`, `channels` and `weights` are those of the fit; the noise of step 1 is added before
/// ([`crate::with_step_one_noise`]).
///
/// # Errors
/// [`CalibrationError`] where the device has no value at a row.
pub fn with_curvature(
    mut fit: ParameterFit,
    recording: &Recording,
    channels: &[Channel],
    weights: &Weights,
) -> Result<ParameterFit, CalibrationError> {
    let (columns, deviations) = held_columns(&fit);
    if fit.considered.parameters.is_empty() || fit.fitted.is_empty() || columns.is_empty() {
        return Ok(fit);
    }
    let held = HeldColumns {
        fit: &fit,
        columns: &columns,
        deviations: &deviations,
        scales: moves_by_scale(&fit),
    };
    let few = LEAST_ROWS.max(5 * fit.fitted.len());
    let rows = some_of_each_kind(recording, MOST_ROWS, MOST_ROWS);
    let of_few = some_of_each_kind(recording, few, MOST_ROWS);
    let all: Vec<usize> = (0..columns.len()).collect();
    let selected = |rows: &[usize]| (recording.select(rows), channels, weights);
    // on few rows a parameter may not show at all
    let found = (of_few.len() < rows.len())
        .then(|| held.beyond(&selected(&of_few), &all, None).ok())
        .flatten();
    let asked = found.as_ref().map_or(all, |found| found.that_matter(&fit));
    let beyond = match found {
        Some(found) if asked.is_empty() => found,
        found => held.beyond(&selected(&rows), &asked, found)?,
    };
    let beyond: Vec<f64> = (0..fit.fitted.len())
        .map(|row| beyond.square(row))
        .collect();
    let half_widths = fit.uncertainty.half_widths(fit.noise);
    for (position, (square, &index)) in beyond.iter().zip(&fit.fitted).enumerate() {
        let estimate = &mut fit.estimates[index];
        if let Some(sd) = estimate.standard_deviation {
            let variance = sd * sd + square;
            let by_noise = fit.uncertainty.covariance[(position, position)];
            let added = fit.considered.added(position, variance - by_noise);
            let half_width = half_widths.of_parameter(position, added);
            set_variance(estimate, variance, half_width);
        }
    }
    fit.considered.beyond_first_order = beyond;
    Ok(fit)
}

/// Rows that G is worked out on: it is a ratio of sums over the rows, for which so many do as well as more.
const MOST_ROWS: usize = 1000;
/// Rows of a kind, five a fitted parameter at least, that say what the held parameters add beyond the first order: G is asked for four
/// times for each, and for few of them need it be known better.
const LEAST_ROWS: usize = 200;
/// Share of a fitted parameter's variance below which what few rows say is good enough: they leave a tenth of it open, a two-thousandth
/// of the interval.
const LEAST_SHARE: f64 = 1e-2;

/// Share of its standard deviation by which a fitted parameter may bend unseen.
const HARDLY: f64 = 0.01;

/// What is held, with what fitted it.
struct HeldColumns<'f> {
    fit: &'f ParameterFit,
    columns: &'f [usize],
    deviations: &'f [f64],
    scales: Vec<Vec<f64>>,
}

/// Second and third order of each fitted parameter in what is held.
struct Beyond {
    /// H in deviations of what is held, the scales last, one matrix for each fitted parameter; not symmetric.
    curvature: Vec<Matrix>,
    /// The third order: for each held parameter, of each fitted one.
    third: Vec<Vec<f64>>,
    /// Positions at which the device had no value on one side or the other.
    failed: Vec<usize>,
}

impl HeldColumns<'_> {
    /// Those of some positions of what is held, on some rows; the others' are taken over.
    fn beyond(
        &self,
        (recording, channels, weights): &(Recording, &[Channel], &Weights),
        asked: &[usize],
        known: Option<Beyond>,
    ) -> Result<Beyond, CalibrationError> {
        let (fit, columns, deviations) = (self.fit, self.columns, self.deviations);
        let failed = |source| wrap("second order of what is held", source);
        let problem =
            DeviceProblem::new(&fit.device, recording, channels, &fit.parameters, weights)?;
        let prepared = Prepared::new(&problem)?;
        let at = |values: &[f64]| {
            let reduction = reduce(prepared.searched(), values)?;
            sensitivity(&reduction, &fit.fitted, columns).map(|(sensitivity, _)| sensitivity)
        };
        let here = values_of(&fit.parameters, &fit.device);
        let first = at(&here).map_err(failed)?;
        let count = columns.len();
        let whole = count + self.scales.len();
        let Beyond {
            mut curvature,
            mut third,
            ..
        } = known.unwrap_or_else(|| Beyond {
            curvature: vec![Matrix::zeros(whole, whole); fit.fitted.len()],
            third: vec![vec![0.0; fit.fitted.len()]; count],
            failed: Vec::new(),
        });
        let mut failed_at = Vec::new();
        for (scale, moves) in self.scales.iter().enumerate() {
            let moved_by = |side: f64| {
                let mut moved = here.clone();
                for (change, &index) in moves.iter().zip(&fit.fitted) {
                    moved[index] += side * change;
                }
                at(&moved)
            };
            let (Ok(above), Ok(below)) = (moved_by(1.0), moved_by(-1.0)) else {
                continue;
            };
            for (row, curvature) in curvature.iter_mut().enumerate() {
                for (other, size) in deviations.iter().enumerate() {
                    let slope = (above[(row, other)] - below[(row, other)]) / 2.0 * size;
                    curvature[(count + scale, other)] = slope;
                    curvature[(other, count + scale)] = slope;
                }
            }
        }
        for &position in asked {
            let (column, deviation) = (columns[position], deviations[position]);
            // to a side of the held parameter, the fitted ones following to the first order or the second
            let moved_by = |step: f64, bends: &[f64]| {
                let mut moved = here.clone();
                moved[column] += step;
                for (row, &index) in fit.fitted.iter().enumerate() {
                    let bend = bends.get(row).copied().unwrap_or(0.0);
                    moved[index] += (first[(row, position)] + bend * step / 2.0) * step;
                }
                at(&moved)
            };
            // a device that has no value there has no second order that could be worked out
            let (Ok(above), Ok(below)) = (moved_by(deviation, &[]), moved_by(-deviation, &[]))
            else {
                failed_at.push(position);
                continue;
            };
            let slope =
                |row: usize, other: usize| (above[(row, other)] - below[(row, other)]) / 2.0;
            for (row, curvature) in curvature.iter_mut().enumerate() {
                for (other, size) in deviations.iter().enumerate() {
                    curvature[(position, other)] = slope(row, other) * size;
                }
            }
            let bends = (0..fit.fitted.len()).map(|row| slope(row, position) / deviation);
            let bends: Vec<f64> = bends.collect();
            // where the fitted ones hardly bend, both sides are where they were
            let bends_far = fit.fitted.iter().zip(&bends).any(|(&index, bend)| {
                let sd = fit.estimates[index].standard_deviation;
                let moved = bend * deviation * deviation / 2.0;
                sd.is_none_or(|sd| moved.is_nan() || moved.abs() > HARDLY * sd)
            });
            let sides = match bends_far {
                true => (moved_by(deviation, &bends), moved_by(-deviation, &bends)),
                false => (Ok(above), Ok(below)),
            };
            let (Ok(above), Ok(below)) = sides else {
                failed_at.push(position);
                continue;
            };
            for (row, third) in third[position].iter_mut().enumerate() {
                let here = first[(row, position)];
                let change = above[(row, position)] - 2.0 * here + below[(row, position)];
                *third = FIFTEEN_OVER_36 * (change * deviation).powi(2);
            }
        }
        Ok(Beyond {
            curvature,
            third,
            failed: failed_at,
        })
    }
}

impl Beyond {
    /// Mean square of a fitted parameter's error beyond the first order.
    fn square(&self, row: usize) -> f64 {
        let third = self.third.iter().map(|third| third[row]).sum::<f64>();
        second_order(&self.curvature[row]) + third
    }

    /// Positions of what is held that add something to the variance of a fitted parameter.
    fn that_matter(&self, fit: &ParameterFit) -> Vec<usize> {
        let matters = |position: &usize| {
            fit.fitted.iter().enumerate().any(|(row, &index)| {
                let sd = fit.estimates[index].standard_deviation;
                let second = terms_of(&self.curvature[row], *position);
                let added = second + self.third[*position][row];
                // what is no number, or could not be worked out on few rows, is asked for
                sd.is_some_and(|sd| added.is_nan() || added > LEAST_SHARE * sd * sd)
            })
        };
        let is_asked = |position: &usize| self.failed.contains(position) || matters(position);
        (0..self.third.len()).filter(is_asked).collect()
    }
}

/// Columns of what is held and of what no reading sees, with their standard deviations.
fn held_columns(fit: &ParameterFit) -> (Vec<usize>, Vec<f64>) {
    let considered = &fit.considered;
    let held = (0..considered.parameters.len())
        .filter(|&k| !matches!(considered.held[k], Held::Fitted | Held::Unsupported))
        .map(|k| {
            (
                considered.parameters[k],
                considered.covariance[(k, k)].sqrt(),
            )
        });
    // what no reading sees here one may see at another value of what is held
    let statuses = fit.parameters.iter().zip(&fit.identifiability.statuses);
    let unseen = statuses
        .filter(|(_, status)| **status == Status::Invisible)
        .map(|(&parameter, _)| (parameter, parameter.plausible_size(&fit.device)));
    held.chain(unseen)
        .filter_map(|(parameter, deviation)| {
            let column = fit.parameters.iter().position(|own| *own == parameter)?;
            Some((column, deviation))
        })
        .unzip()
}

/// How each scale of an instrument, or length that stands for the size, moves the fitted parameters by its standard deviation.
fn moves_by_scale(fit: &ParameterFit) -> Vec<Vec<f64>> {
    let considered = &fit.considered;
    let is_scale = |&k: &usize| matches!(considered.held[k], Held::Scale | Held::Size);
    let scales = (0..considered.parameters.len()).filter(is_scale);
    let moves = scales.map(|k| {
        let deviation = considered.covariance[(k, k)].sqrt();
        let rows = 0..fit.fitted.len();
        let moved = rows.map(|row| considered.sensitivity[(row, k)] * deviation);
        moved.collect::<Vec<f64>>()
    });
    moves.collect()
}

/// E d^6 / 36 of a unit normal d.
const FIFTEEN_OVER_36: f64 = 15.0 / 36.0;

/// E (d^T H d / 2)^2 for d of unit covariance; H is the symmetric part of `curvature`.
fn second_order(curvature: &Matrix) -> f64 {
    let count = curvature.rows();
    let trace: f64 = (0..count).map(|k| curvature[(k, k)]).sum();
    let square = |a: usize, b: usize| ((curvature[(a, b)] + curvature[(b, a)]) / 2.0).powi(2);
    let rows = (0..count).map(|a| (0..count).map(|b| square(a, b)).sum::<f64>());
    (trace * trace + 2.0 * rows.sum::<f64>()) / 4.0
}

/// The terms of [`second_order`] that have `k` in them; the square of the trace by its own part.
fn terms_of(curvature: &Matrix, k: usize) -> f64 {
    let square = |a: usize| ((curvature[(a, k)] + curvature[(k, a)]) / 2.0).powi(2);
    let row = (0..curvature.rows()).map(square).sum::<f64>();
    (curvature[(k, k)].powi(2) + 4.0 * row) / 4.0
}
