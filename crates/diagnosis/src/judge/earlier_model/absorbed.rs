//! What an earlier calibration took up of an effect that it did not have: numbers that move once the effect is in the
//! model (docs/diagnosis.md, "Earlier model").

use haptical_model::{Device, ParameterId};
use nalgebra::{DMatrix, DVector};

use super::groups::earlier_value;
use crate::answer::{AbsorbedAnswer, MovedNumber, ParameterAnswer};
use crate::engine::differences;
use crate::judge::{BaseTerm, Difference};
use crate::select::Selection;
use crate::thresholds::earlier_model::{BEND_SCATTERS, MOVED_SD, OFTEN, SEGMENTS};

/// Takes out of the difference the terms in which the earlier model lies where a calibration beside the same causes,
/// but at other postures, would have bent it. None where there is none.
pub(crate) fn take_absorbed(
    selection: &Selection<'_>,
    model: &Device,
    difference: &mut Difference,
) -> Option<AbsorbedAnswer> {
    let cause = selection.causes().first()?;
    if !difference.terms.iter().any(|term| !term.columns.is_empty()) {
        return None;
    }
    let numbers = Numbers {
        selection,
        model,
        bends: bends(selection)?,
    };
    let found = difference.terms.len();
    let mut taken = 0.0;
    let deviations = &difference.deviations;
    difference.terms.retain(|term| {
        let is_absorbed = numbers.are_bent(term, deviations);
        taken += if is_absorbed { term.explained } else { 0.0 };
        !is_absorbed
    });
    if difference.terms.len() == found {
        return None;
    }
    difference.total = (difference.total - taken).max(0.0);
    let mut scan = selection.first_scan.iter();
    let score = scan.find(|score| score.effect == cause.effect);
    Some(AbsorbedAnswer {
        share: score.map(|score| 1.0 - score.retained.clamp(0.0, 1.0).powi(2)),
        moved: numbers.moved(&difference.deviations),
    })
}

/// What a calibration beside the causes does to one number: at the postures of this recording, and by how much it may
/// be otherwise at others.
#[derive(Debug, Clone, Copy)]
struct Bend {
    mean: f64,
    sd: f64,
}

/// Numbers of the base model: in the earlier model, and refitted with the causes.
struct Numbers<'n, 'e> {
    selection: &'n Selection<'e>,
    model: &'n Device,
    /// Of each free column.
    bends: Vec<Bend>,
}

impl Numbers<'_, '_> {
    /// Earlier value, and value with the causes, of a free column; none where the earlier model has another law there.
    fn values(&self, column: usize) -> Option<[f64; 2]> {
        let engine = self.selection.engine();
        let position = engine.base.free[column];
        let parameter = engine.base.parameters[position];
        let earlier = earlier_value(parameter, self.model, engine.context.device)?;
        Some([earlier, self.selection.refit.model.values[position]])
    }

    /// Whether a calibration beside the causes may have put every number of a term where the earlier model has it.
    fn are_bent(&self, term: &BaseTerm, deviations: &[f64]) -> bool {
        let is_bent = |&column: &usize| {
            self.values(column).is_some_and(|[earlier, value]| {
                let Bend { mean, sd } = self.bends[column];
                (earlier - value - mean).abs() <= BEND_SCATTERS * sd + MOVED_SD * deviations[column]
            })
        };
        !term.columns.is_empty() && term.columns.iter().all(is_bent)
    }

    /// Numbers of device and drives that the causes move away from the earlier model beyond chance, farthest first.
    fn moved(&self, deviations: &[f64]) -> Vec<MovedNumber> {
        let engine = self.selection.engine();
        let (base, device) = (&engine.base, engine.context.device);
        let mut moved = Vec::new();
        for (column, (&position, &sd)) in base.free.iter().zip(deviations).enumerate() {
            let parameter = base.parameters[position];
            let Some([earlier, value]) = self.values(column) else {
                continue;
            };
            let far = (value - earlier).abs() / sd;
            // the place of a rig is no number of the device
            let is_of_rig = matches!(parameter, ParameterId::Surrounding(_));
            if is_of_rig || !far.is_finite() || far < MOVED_SD {
                continue;
            }
            let value = ParameterAnswer::normal(value, sd);
            moved.push((far, MovedNumber::new(parameter, device, earlier, value)));
        }
        moved.sort_by(|a, b| b.0.total_cmp(&a.0));
        moved.into_iter().map(|(_, number)| number).collect()
    }
}

/// By how much least squares without the causes misses each free column's number: a stand-in for the recording that the
/// earlier model was fitted to, which is not known. Each segment of this recording and each of its streams counts more
/// or less often in turn; the squares of what that does add up.
fn bends(selection: &Selection<'_>) -> Option<Vec<Bend>> {
    let parts = parts(selection);
    let norms = norms(selection);
    let bent = |weight: &dyn Fn(usize, usize) -> f64| {
        let mut normal = DMatrix::zeros(norms.len(), norms.len());
        let mut right = DVector::zeros(norms.len());
        for (stream, segments) in parts.iter().enumerate() {
            for (segment, part) in segments.iter().enumerate() {
                normal += &part.normal * weight(stream, segment);
                right += &part.right * weight(stream, segment);
            }
        }
        Some(normal.cholesky()?.solve(&right))
    };
    let mean = bent(&|_, _| 1.0)?;
    let mut squares = DVector::zeros(norms.len());
    let mut add = |is_chosen: &dyn Fn(usize, usize) -> bool| {
        let weighted = |factor: f64| {
            bent(&|stream, segment| match is_chosen(stream, segment) {
                true => factor,
                false => 1.0,
            })
        };
        let (often, seldom) = (weighted(OFTEN)?, weighted(1.0 / OFTEN)?);
        squares += (0.5 * (often - seldom)).map(|half| half * half);
        Some(())
    };
    for chosen in 0..SEGMENTS {
        add(&|_, segment| segment == chosen)?;
    }
    for chosen in 0..parts.len() {
        add(&|stream, _| stream == chosen)?;
    }
    let bend = |(column, norm): (usize, &f64)| Bend {
        mean: mean[column] / norm,
        sd: squares[column].sqrt() / norm,
    };
    Some(norms.iter().enumerate().map(bend).collect())
}

/// Products of the free columns, each of length 1, with each other and with the causes' signal, over one segment of one
/// stream.
#[derive(Debug, Clone)]
struct Part {
    normal: DMatrix<f64>,
    right: DVector<f64>,
}

/// The parts of each stream, by segment.
fn parts(selection: &Selection<'_>) -> Vec<Vec<Part>> {
    let engine = selection.engine();
    let (free, layout) = (engine.free(), &engine.system.layout);
    let (bare, residual) = (&selection.refit.model.bare, &selection.refit.residual);
    let of_causes = differences(bare, residual);
    let signal = layout.compress_rows(&of_causes);
    let norms = norms(selection);
    let count = free.columns();
    let of_range = |entries: std::ops::Range<usize>| {
        let columns = DMatrix::from_fn(entries.len(), count, |entry, column| {
            free.column(column).entry(entries.start + entry) / norms[column]
        });
        let signal = DVector::from_fn(entries.len(), |entry, _| signal[entries.start + entry]);
        Part {
            normal: columns.tr_mul(&columns),
            right: columns.tr_mul(&signal),
        }
    };
    let of_stream = |stream: usize| {
        let entries = layout.range(stream);
        let bound = |segment: usize| entries.start + segment * entries.len() / SEGMENTS;
        (0..SEGMENTS)
            .map(|segment| of_range(bound(segment)..bound(segment + 1)))
            .collect()
    };
    (0..engine.context.streams.len()).map(of_stream).collect()
}

/// Lengths of the free columns.
fn norms(selection: &Selection<'_>) -> Vec<f64> {
    let free = selection.engine().free();
    let norm = |column: usize| {
        let squares: f64 = free
            .column(column)
            .values()
            .iter()
            .map(|value| value * value)
            .sum();
        squares.sqrt().max(f64::MIN_POSITIVE)
    };
    (0..free.columns()).map(norm).collect()
}
