//! Fits of one model at many shapes: what a shape has in common with the one before is not calculated again.

use crate::effect::{friction, lag, latency, saturation, second_order};
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

/// The command after one law, and the law's numbers.
#[derive(Debug, Default)]
struct Stage {
    number: Option<[f64; 2]>,
    course: Vec<f64>,
}

impl Stage {
    /// Whether they are other numbers than before, which are kept.
    fn changes_to(&mut self, number: [f64; 2]) -> bool {
        self.number.replace(number) != Some(number)
    }
}

impl<'p> Evaluator<'p> {
    pub(super) fn new(problem: &'p Problem<'p>, terms: Terms, held: &Held) -> Self {
        Self {
            problem,
            terms,
            columns: Columns::new(problem.columns(terms), &problem.series.scored, held),
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
        let mut is_new = self.delayed.changes_to([shape.delay_s, 0.0]);
        if is_new {
            let course = &mut self.delayed.course;
            course.resize(series.len(), 0.0);
            for piece in series.pieces() {
                latency::delayed(&series.command, time_s, piece, shape.delay_s, course);
            }
        }
        is_new |= self.lagged.changes_to([shape.lag_s, shape.inertia_s]);
        let holds = self.terms.holds;
        // a limit without a mass is one of the speed that the lag asks for
        let has_mass = shape.inertia_s > 0.0;
        let lag_within_s = if has_mass { 0.0 } else { shape.lag_s };
        if is_new {
            let course = &mut self.lagged.course;
            course.clone_from(&self.delayed.course);
            let answer = second_order::Answer {
                lag_s: shape.lag_s,
                inertia_s: shape.inertia_s,
                holds,
            };
            for piece in series.pieces() {
                match has_mass {
                    true => answer.followed(time_s, piece, course),
                    false => lag::lagged(time_s, piece, (shape.lag_s, holds), course),
                }
            }
        }
        is_new |= self.limited.changes_to([shape.slowness, lag_within_s]);
        if is_new {
            let is_within = shape.slowness > 0.0 && !has_mass;
            let course = &mut self.limited.course;
            course.clone_from(match is_within {
                true => &self.delayed.course,
                false => &self.lagged.course,
            });
            let numbers = (lag_within_s, shape.slowness, holds && is_within);
            for piece in series.pieces() {
                saturation::limited(time_s, piece, numbers, course);
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
            has_converged: true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::JointLog;
    use crate::log::Series;

    /// A joint that follows sines late and rests 0.3 rad beside them, with rows that jump in between.
    fn series() -> Series {
        let time_s: Vec<f64> = (0..600).map(|row| 0.02 * f64::from(row)).collect();
        let course = |t: &f64| 0.6 * (1.3 * t).sin() + 0.3 * (2.9 * t).cos();
        let command: Vec<f64> = time_s.iter().map(course).collect();
        let mut response: Vec<f64> = time_s.iter().map(|t| course(&(t - 0.07)) + 0.3).collect();
        response[200..300].iter_mut().for_each(|at| *at += 0.5);
        let log = JointLog {
            time_s: Some(&time_s),
            command: Some(&command),
            response: &response,
            ..JointLog::default()
        };
        Series::new(&log).unwrap()
    }

    const TERMS: Terms = Terms {
        offset: true,
        delay: true,
        lag: true,
        friction: true,
        saturation: true,
        ..Terms::NONE
    };

    #[test]
    fn a_shape_after_another_is_fitted_as_it_is_alone() {
        let series = series();
        let problem = Problem::new(&series);
        let mut shape = Shape {
            delay_s: 0.04,
            lag_s: 0.03,
            half_width: 0.05,
            slowness: 0.8,
            inertia_s: 0.0,
        };
        let mut evaluator = Evaluator::new(&problem, TERMS, &None);
        evaluator.fit(shape);
        let changes: [fn(&mut Shape); 5] = [
            |shape| shape.delay_s = 0.06,
            |shape| shape.lag_s = 0.05,
            |shape| shape.slowness = 0.9,
            |shape| shape.half_width = 0.08,
            |shape| shape.delay_s = 0.02,
        ];
        for change in changes {
            let before = evaluator.fit(shape).residual;
            change(&mut shape);
            let after = evaluator.fit(shape);
            assert_ne!(after.residual, before, "{shape:?}");
            assert_eq!(after, problem.evaluate(TERMS, shape, &None), "{shape:?}");
        }
    }

    #[test]
    fn rows_that_are_held_out_have_no_part_in_a_fit() {
        let series = series();
        let problem = Problem::new(&series);
        let offset = Terms {
            offset: true,
            ..Terms::NONE
        };
        let fit = problem.evaluate(offset, Shape::default(), &Some(200..300));
        let seen = (0..600).filter(|row| !(200..300).contains(row));
        let errors: Vec<f64> = seen
            .map(|row| series.response[row] - series.command[row])
            .collect();
        assert!((fit.offset - mean(&errors)).abs() < 1e-7, "{}", fit.offset);
        let squares: f64 = errors.iter().map(|at| (at - fit.offset).powi(2)).sum();
        assert!((fit.squares / squares - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_joint_starts_where_it_stands_beside_its_offset() {
        let series = series();
        let problem = Problem::new(&series);
        let shape = Shape {
            half_width: 0.2,
            ..Shape::default()
        };
        let terms = Terms {
            offset: true,
            friction: true,
            ..Terms::NONE
        };
        let mut evaluator = Evaluator::new(&problem, terms, &None);
        let first = evaluator
            .columns
            .mean(|row| series.response[row] - series.command[row]);
        let follow = |offset: f64| {
            let mut followed = series.command.clone();
            let start = series.response[0] - offset;
            friction::followed(0..series.len(), shape.half_width, start, &mut followed);
            evaluator.linear(shape, &followed)
        };
        let once = follow(first);
        let twice = follow(once.offset);
        assert!((once.offset - first).abs() > 1e-5 && once != twice);
        assert_eq!(evaluator.fit(shape), twice);
    }
}
