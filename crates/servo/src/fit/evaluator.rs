//! Fits of one model at many shapes: what a shape has in common with the one before is not calculated again.

use crate::effect::{friction, lag, latency, saturation};
use crate::log::mean;

use super::linear::Columns;
use super::{Fit, Held, Problem, Shape, Terms};

/// A model's columns, and what the last shape made of the command.
#[derive(Debug)]
pub(super) struct Evaluator<'p> {
    problem: &'p Problem<'p>,
    terms: Terms,
    columns: Columns<'p>,
    droop_means: Vec<f64>,
    delayed: Stage,
    lagged: Stage,
    limited: Stage,
}

/// The command after one law, and the law's number.
#[derive(Debug, Default)]
struct Stage {
    number: Option<f64>,
    course: Vec<f64>,
}

impl Stage {
    /// Whether it is another number than before, which is kept.
    fn changes_to(&mut self, number: f64) -> bool {
        self.number.replace(number) != Some(number)
    }
}

impl<'p> Evaluator<'p> {
    pub(super) fn new(problem: &'p Problem<'p>, terms: Terms, held: &Held) -> Self {
        let rows = problem.series.len();
        Self {
            problem,
            terms,
            columns: Columns::new(problem.columns(terms), rows, held),
            droop_means: problem.droop.iter().map(|column| mean(column)).collect(),
            delayed: Stage::default(),
            lagged: Stage::default(),
            limited: Stage::default(),
        }
    }

    /// The command as delay, lag and limit let it through.
    pub(super) fn driven(&mut self, shape: Shape) -> &[f64] {
        let series = self.problem.series;
        let time_s = &series.time_s;
        let mut is_new = self.delayed.changes_to(shape.delay_s);
        if is_new {
            let course = &mut self.delayed.course;
            course.resize(series.len(), 0.0);
            for piece in series.pieces() {
                latency::delayed(&series.command, time_s, piece, shape.delay_s, course);
            }
        }
        is_new |= self.lagged.changes_to(shape.lag_s);
        if is_new {
            self.lagged.course.clone_from(&self.delayed.course);
            for piece in series.pieces() {
                lag::lagged(time_s, piece, shape.lag_s, &mut self.lagged.course);
            }
        }
        is_new |= self.limited.changes_to(shape.slowness);
        if is_new {
            self.limited.course.clone_from(&self.lagged.course);
            for piece in series.pieces() {
                saturation::limited(time_s, piece, shape.slowness, &mut self.limited.course);
            }
        }
        &self.limited.course
    }

    /// The fit of the linear numbers, at given numbers of the shape.
    pub(super) fn fit(&mut self, shape: Shape) -> Fit {
        let series = self.problem.series;
        self.driven(shape);
        let input = &self.limited.course;
        let mut offset = match self.terms.offset {
            true => self.columns.mean(|row| series.response[row] - input[row]),
            false => 0.0,
        };
        if !self.terms.friction {
            return self.linear(shape, input);
        }
        let mut followed = Vec::with_capacity(input.len());
        let mut follow = |offset: f64| {
            followed.clone_from(input);
            for piece in series.pieces() {
                let first = series.response[piece.start] - offset;
                friction::followed(piece, shape.half_width, first, &mut followed);
            }
            self.linear(shape, &followed)
        };
        // from where the joint stands, once its offset is known
        let fit = follow(offset);
        let moved = (fit.offset - offset).abs();
        offset = fit.offset;
        if moved < 1e-5 { fit } else { follow(offset) }
    }

    fn linear(&self, shape: Shape, followed: &[f64]) -> Fit {
        let response = &self.problem.series.response;
        let target: Vec<f64> = match self.terms.gain {
            true => response.clone(),
            false => (response.iter().zip(followed))
                .map(|(a, b)| a - b)
                .collect(),
        };
        let (solution, residual) = self.columns.solve(followed, target);
        let mut numbers = solution.iter().copied();
        let mut offset = if self.terms.offset {
            numbers.next().unwrap_or(0.0)
        } else {
            0.0
        };
        let gain = if self.terms.gain {
            numbers.next().unwrap_or(1.0)
        } else {
            1.0
        };
        let droop: Vec<f64> = numbers.collect();
        // at the middle of the motion, where a gain moves nothing
        if self.terms.gain {
            offset += (gain - 1.0) * mean(followed);
        }
        for (mean, coefficient) in self.droop_means.iter().zip(&droop) {
            offset += coefficient * mean;
        }
        Fit {
            shape,
            offset,
            gain,
            droop,
            solution,
            squares: self.columns.squares(&residual),
            residual,
        }
    }
}
