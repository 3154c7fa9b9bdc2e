//! The problem of a device reduced channel by channel to triangles, and these to one.

use std::cell::{OnceCell, RefCell};
use std::ops::Range;

use haptical_identification::{IdentificationError, Matrix, Problem, Triangle, TriangleProblem};
use haptical_linalg::LinalgError;

use crate::problem::gauge::Gauge;
use crate::problem::lanes::all_rows::{ChannelTriangle, Lanes, merge_parts};
use crate::problem::lanes::plan::seen_columns;
use crate::problem::rows::PartRoom;
use crate::{Channel, DeviceProblem};

/// A [`DeviceProblem`] whose derivative matrix is never held.
///
/// The derivative matrix of the joint problem is block diagonal in the external encoders' rows and
/// full in the distances' (docs/equations.md, "Joint problem"). For channel b, with J_b its
/// derivatives (only of the k_b parameters that it can see) and r_b its residuals, `[J_b r_b]` is
/// reduced in portions to a triangle `[F_b q_b]` of k_b + 1 rows with
///
/// ```text
/// [F_b q_b]^T [F_b q_b] = [J_b r_b]^T [J_b r_b]
/// ```
///
/// by orthogonal transformations, never by normal equations. `[R q]` of this problem is what they make of all the
/// channels' triangles, one below the other: a pass gives cost and triangle, so a search evaluates each trial once
/// and takes its step from the triangle as it is.
///
/// Outputs of transmissions that equation (1) or a polynomial describes, and distances of a chain, are worked
/// out and reduced in lanes, in parallel; everything else row by row.
#[derive(Debug)]
pub struct ReducedProblem<'p> {
    problem: &'p DeviceProblem<'p>,
    /// Unit of the touches.
    gauge: Option<Gauge>,
    /// Made when first asked for; none where the problem has no form in lanes.
    lanes: OnceCell<Option<Lanes>>,
    /// Values at which the triangles of all channels by all parameters were last made, and these: a fit asks for them, and for those of
    /// some parameters, where its search ended.
    last: RefCell<Option<(Vec<f64>, Vec<ChannelTriangle>)>>,
}

/// Some successive rows of one channel, as [`ReducedProblem::visit`] hands them over.
#[derive(Debug, Clone, Copy)]
pub struct ChannelRows<'r> {
    /// Channel.
    pub channel: Channel,
    /// First residual of the problem (see [`DeviceProblem::layout`]).
    pub first: usize,
    /// Position within the free parameters of each column; the others' derivatives are zero.
    pub columns: &'r [usize],
    /// Derivatives of the weighted residuals, column by column.
    pub derivatives: &'r [&'r [f64]],
    /// Weighted residuals.
    pub residuals: &'r [f64],
}

impl<'p> ReducedProblem<'p> {
    /// The reduced form of a problem.
    pub fn new(problem: &'p DeviceProblem<'p>) -> Self {
        Self::with_gauge(problem, None)
    }

    /// The same with touches in this unit.
    pub(crate) fn with_gauge(problem: &'p DeviceProblem<'p>, gauge: Option<Gauge>) -> Self {
        Self {
            problem,
            gauge,
            lanes: OnceCell::new(),
            last: RefCell::new(None),
        }
    }

    pub(crate) fn lanes(&self) -> Option<&Lanes> {
        self.lanes.get_or_init(|| Lanes::new(self.problem)).as_ref()
    }

    /// Each channel's triangle, as rows with a column for each free parameter.
    pub(crate) fn by_channel(
        &self,
        parameters: &[f64],
        free: &[usize],
    ) -> Result<Vec<(Channel, Matrix)>, IdentificationError> {
        let channels = self.problem.channels();
        let triangles = self.triangles(parameters, free)?;
        let rows = triangles.iter().map(|channel| channel.spread(free.len()));
        Ok(channels.zip(rows).collect())
    }

    /// Every channel's triangle by the free parameters: what it was where all parameters were last free at the same values, or made anew.
    fn triangles(
        &self,
        parameters: &[f64],
        free: &[usize],
    ) -> Result<Vec<ChannelTriangle>, IdentificationError> {
        let is_of_all = free.iter().copied().eq(0..self.problem.parameter_count());
        if let Some((at, all)) = &*self.last.borrow()
            && at == parameters
        {
            let chosen = |channel: &ChannelTriangle| match is_of_all {
                true => Ok(channel.clone()),
                false => channel.of_some(free),
            };
            return Ok(all.iter().map(chosen).collect::<Result<_, LinalgError>>()?);
        }
        let made = self.make(parameters, free)?;
        if is_of_all {
            self.last.replace(Some((parameters.to_vec(), made.clone())));
        }
        Ok(made)
    }

    /// Every channel's triangle, in lanes or row by row: what the lanes refuse is refused there with its line of the log.
    fn make(
        &self,
        parameters: &[f64],
        free: &[usize],
    ) -> Result<Vec<ChannelTriangle>, IdentificationError> {
        let lanes = self.lanes();
        if let Some(triangles) =
            lanes.and_then(|lanes| lanes.reduce(self.problem, parameters, free))
        {
            return Ok(triangles);
        }
        let scale = match self.gauge {
            Some(gauge) => Some(gauge.at(self.problem, parameters, true)?),
            None => None,
        };
        let mut columns = seen_columns(self.problem, free);
        if scale.is_some() {
            // the mobility is one of all touches
            let channels = self.problem.channels().zip(&mut columns);
            for (_, columns) in channels.filter(|(channel, _)| channel.is_touch()) {
                *columns = (0..free.len()).collect();
            }
        }
        let new = || -> Vec<Triangle> {
            let counts = columns.iter().map(Vec::len);
            counts.map(Triangle::new).collect()
        };
        let problem = self.problem;
        let fold = |triangles: &mut Vec<Triangle>, rows: &Range<usize>, room: &PartRoom| {
            let places = problem.places(rows).zip(&columns).zip(problem.channels());
            for (triangle, (((whole, own), columns), channel)) in triangles.iter_mut().zip(places) {
                let entries = |column: &usize| {
                    let matrix = room.derivatives.as_ref();
                    matrix.map_or(&[][..], |matrix| &matrix.column(*column)[own.clone()])
                };
                let derivatives: Vec<&[f64]> = columns.iter().map(entries).collect();
                let residuals = &room.residuals[own.clone()];
                let names = columns.iter().map(|&column| free[column]);
                let names = names.chain([problem.parameter_count()]);
                let all = derivatives.iter().copied().chain([residuals]);
                for (values, column) in all.zip(names) {
                    all_finite(values, whole.start, column)?;
                }
                match scale.as_ref().filter(|_| channel.is_touch()) {
                    None => triangle.fold_rows(&derivatives, residuals)?,
                    Some(scale) => {
                        let mut residuals = residuals.to_vec();
                        scale.scale(&mut residuals);
                        let names = columns.iter().map(|&column| free[column]);
                        let scaled = derivatives.iter().zip(names).map(|(column, parameter)| {
                            let mut column = column.to_vec();
                            scale.scale_column(&mut column, &residuals, parameter);
                            column
                        });
                        let scaled: Vec<Vec<f64>> = scaled.collect();
                        let scaled: Vec<&[f64]> = scaled.iter().map(Vec::as_slice).collect();
                        triangle.fold_rows(&scaled, &residuals)?;
                    }
                }
            }
            Ok(())
        };
        let parts = problem.fold_parts(parameters, free, new, fold)?;
        let channels = columns.into_iter().zip(merge_parts(parts)?);
        let finish = |(columns, triangle): (Vec<usize>, Triangle)| ChannelTriangle {
            of: (0..columns.len()).collect(),
            columns,
            triangle,
        };
        Ok(channels.map(finish).collect())
    }

    /// Hands all rows over, some at a time, each channel's in order, without a matrix of all of them.
    ///
    /// # Errors
    /// [`IdentificationError::Evaluation`] where the problem has no form in lanes or a number is refused there, which
    /// [`Problem::evaluate`] of the [`DeviceProblem`] names; rows before it may have been visited.
    pub fn visit(
        &self,
        parameters: &[f64],
        free: &[usize],
        mut visit: impl FnMut(&ChannelRows<'_>),
    ) -> Result<(), IdentificationError> {
        let channels: Vec<Channel> = self.problem.channels().collect();
        let visited = self.lanes().and_then(|lanes| {
            lanes.visit(self.problem, parameters, free, |rows| {
                let all = rows.of.iter().map(|&own| rows.derivatives[own]);
                visit(&ChannelRows {
                    channel: channels[rows.channel],
                    first: rows.first,
                    columns: rows.columns,
                    derivatives: &all.collect::<Vec<&[f64]>>(),
                    residuals: rows.residuals,
                });
            })
        });
        visited.ok_or_else(|| IdentificationError::Evaluation {
            reason: "the problem has no form in lanes, or a number is refused there".to_owned(),
        })
    }

    /// Weighted residuals, row by row.
    pub(crate) fn residuals(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
    ) -> Result<(), IdentificationError> {
        let problem = self.problem;
        let visited = self.lanes().and_then(|lanes| {
            lanes.visit(problem, parameters, &[], |rows| {
                residuals[rows.first..][..rows.residuals.len()].copy_from_slice(rows.residuals);
            })
        });
        match visited {
            Some(()) => Ok(()),
            None => problem.evaluate(parameters, residuals, None),
        }
    }
}

impl ChannelTriangle {
    /// The triangle of all parameters as one of some of them, ascending or not.
    fn of_some(&self, free: &[usize]) -> Result<Self, LinalgError> {
        let seen = |(position, index): (usize, &usize)| {
            let place = self.columns.iter().position(|column| column == index)?;
            Some((position, self.of[place]))
        };
        let (columns, from): (Vec<usize>, Vec<usize>) =
            free.iter().enumerate().filter_map(seen).unzip();
        let rows = self.triangle.as_rows();
        // a column that stands for several parameters is one of the triangle
        let mut distinct: Vec<usize> = from.clone();
        distinct.sort_unstable();
        distinct.dedup();
        let chosen: Vec<&[f64]> = distinct.iter().map(|&column| rows.column(column)).collect();
        let mut triangle = Triangle::new(distinct.len());
        triangle.fold_rows(&chosen, rows.column(rows.columns() - 1))?;
        let of = from
            .iter()
            .map(|column| distinct.partition_point(|other| other < column));
        Ok(Self {
            of: of.collect(),
            columns,
            triangle,
        })
    }

    /// Its rows with a column for each of the free parameters.
    fn spread(&self, free: usize) -> Matrix {
        let rows = self.triangle.as_rows();
        let mut matrix = Matrix::zeros(rows.rows(), free);
        for (&column, &of) in self.columns.iter().zip(&self.of) {
            matrix.column_mut(column).copy_from_slice(rows.column(of));
        }
        matrix
    }
}

/// Refuses a column that has an entry without a value; it begins at row `first`.
fn all_finite(values: &[f64], first: usize, column: usize) -> Result<(), IdentificationError> {
    // some at a time without a way out between them, so that they are looked at in lanes
    let is_finite = |part: &[f64]| part.iter().fold(true, |all, x| all & x.is_finite());
    if values.chunks(64).all(is_finite) {
        return Ok(());
    }
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(row) => Err(IdentificationError::NotFinite {
            row: first + row,
            column,
            value: values[row],
        }),
    }
}

impl TriangleProblem for ReducedProblem<'_> {
    fn columns(&self) -> usize {
        self.problem.parameter_count()
    }

    fn rows(&self) -> usize {
        self.problem.residual_count()
    }

    fn reduce_into(
        &self,
        parameters: &[f64],
        free: &[usize],
        into: &mut Triangle,
    ) -> Result<(), IdentificationError> {
        *into = total(self.triangles(parameters, free)?, free.len())?;
        Ok(())
    }
}

/// One triangle of all channels.
fn total(mut channels: Vec<ChannelTriangle>, free: usize) -> Result<Triangle, LinalgError> {
    // a channel that sees all parameters, each by a column of its own and in their order, has the total's columns: the others are
    // folded into it
    let is_widest = |channel: &ChannelTriangle| channel.of.iter().copied().eq(0..free);
    let mut total = match channels.iter().position(is_widest) {
        Some(widest) => channels.swap_remove(widest).triangle,
        None => Triangle::new(free),
    };
    let zeros = vec![0.0; free + 1];
    for channel in &channels {
        let rows = channel.triangle.as_rows();
        let mut columns = vec![&zeros[..rows.rows()]; free];
        for (&of, &column) in channel.of.iter().zip(&channel.columns) {
            columns[column] = rows.column(of);
        }
        total.fold_rows(&columns, rows.column(rows.columns() - 1))?;
    }
    Ok(total)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An angle and a constant have one column, a length another: without the angle the constant is behind the length.
    #[test]
    fn a_shared_column_keeps_its_parameter() {
        let (turn, length): (&[f64], &[f64]) = (&[1.0, 2.0, 0.5], &[0.3, -1.0, 4.0]);
        let mut triangle = Triangle::new(2);
        triangle
            .fold_rows(&[turn, length], &[1.0, 1.0, 2.0])
            .unwrap();
        let all = ChannelTriangle {
            columns: vec![0, 1, 2],
            of: vec![0, 1, 0],
            triangle,
        };
        for (free, columns) in [([1, 2], [length, turn]), ([2, 1], [turn, length])] {
            let some = total(vec![all.of_some(&free).unwrap()], 2).unwrap();
            for (place, column) in columns.into_iter().enumerate() {
                let norm = |entries: &[f64]| entries.iter().map(|x| x * x).sum::<f64>();
                let apart = norm(some.column(place)) - norm(column);
                assert!(apart.abs() < 1e-12, "{free:?} {place}: {apart}");
            }
        }
    }
}
