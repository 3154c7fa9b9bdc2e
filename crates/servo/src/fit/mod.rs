//! One fit of a servo's laws to a joint: numbers that enter linearly in closed form, the others by a search.

mod evaluator;
pub(crate) mod linear;
pub(crate) mod search;

use std::ops::Range;

use haptical_linalg::{Information, dot};

use crate::effect::{droop, friction, offset};
use crate::log::Series;
use crate::noise::rounding;
use crate::thresholds::{
    FASTER, LEAST_FALL, MOST_LAG_S, ROUGH_FALL, ROUGH_ROWS, ROUGH_S, ROUGH_STRETCHES, SPEED_S,
};

use self::evaluator::Evaluator;
use self::search::AXES;

/// Which laws a model has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Terms {
    pub(crate) offset: bool,
    pub(crate) delay: bool,
    pub(crate) lag: bool,
    /// The lag has a mass.
    pub(crate) inertia: bool,
    /// Its commands hold from row to row.
    pub(crate) holds: bool,
    pub(crate) friction: bool,
    pub(crate) saturation: bool,
    pub(crate) gain: bool,
    pub(crate) droop: bool,
}

impl Terms {
    /// The command itself.
    pub(crate) const NONE: Self = Self {
        offset: false,
        delay: false,
        lag: false,
        inertia: false,
        holds: false,
        friction: false,
        saturation: false,
        gain: false,
        droop: false,
    };
}

/// Numbers that do not enter linearly.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Shape {
    pub(crate) delay_s: f64,
    pub(crate) lag_s: f64,
    /// One over the natural frequency of a mass on the loop; 0 without one.
    pub(crate) inertia_s: f64,
    /// Half the width of the band in which the joint rests.
    pub(crate) half_width: f64,
    /// One over the largest speed; 0 without a limit.
    pub(crate) slowness: f64,
}

/// A fitted model.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fit {
    pub(crate) shape: Shape,
    /// Mean distance of the joint from what it follows.
    pub(crate) offset: f64,
    pub(crate) gain: f64,
    /// Coefficients of the droop's columns.
    pub(crate) droop: Vec<f64>,
    /// All numbers that enter linearly, in the order of the columns.
    solution: Vec<f64>,
    /// Sum of the squares on the rows of the fit.
    pub(crate) squares: f64,
    /// On all rows.
    pub(crate) residual: Vec<f64>,
    /// Whether a further search for the shape would lower the squares by less than `LEAST_FALL` variances of the noise.
    pub(crate) has_converged: bool,
}

/// A joint and its laws, ready to be fitted.
#[derive(Debug)]
pub(crate) struct Problem<'s> {
    series: &'s Series,
    ones: Vec<f64>,
    /// Angles that the droop depends on, the joint's own first.
    angles: Vec<bool>,
    droop: Vec<Vec<f64>>,
}

/// Rows that a fit leaves out.
pub(crate) type Held = Option<Range<usize>>;

impl<'s> Problem<'s> {
    pub(crate) fn new(series: &'s Series) -> Self {
        Self::with_droop(series, &droop::moving(series))
    }

    /// With a droop that depends on these angles, the joint's own first.
    pub(crate) fn with_droop(series: &'s Series, angles: &[bool]) -> Self {
        Self {
            ones: offset::column(series.len()),
            droop: droop::columns(series, angles),
            angles: angles.to_vec(),
            series,
        }
    }

    /// What a fit to another log of the joint predicts of this one; the joint starts where it stands.
    pub(crate) fn predicted(&self, terms: Terms, fit: &Fit) -> Vec<f64> {
        let series = self.series;
        let followed = self.followed(terms, fit);
        let columns = self.columns(terms);
        let mut predicted = match terms.gain {
            true => vec![0.0; series.len()],
            false => followed.clone(),
        };
        for (column, coefficient) in columns.iter().zip(&fit.solution) {
            for (sum, value) in predicted.iter_mut().zip(column.unwrap_or(&followed)) {
                *sum += coefficient * value;
            }
        }
        predicted
    }

    /// What a fit's joint follows here.
    fn followed(&self, terms: Terms, fit: &Fit) -> Vec<f64> {
        let series = self.series;
        let mut evaluator = Evaluator::new(self, terms, &None);
        let mut followed = evaluator.driven(fit.shape).to_vec();
        for piece in series.pieces() {
            let first = series.response[piece.start] - fit.offset;
            friction::followed(piece, fit.shape.half_width, first, &mut followed);
        }
        followed
    }

    /// How well these rows determine predictions of others, by the numbers that enter linearly.
    pub(crate) fn information(&self, terms: Terms, fit: &Fit) -> Information {
        let followed = self.followed(terms, fit);
        let columns = self.columns(terms);
        let column = |index: usize| columns[index].unwrap_or(&followed);
        Information::new(columns.len(), |a, b| dot(column(a), column(b)))
    }

    /// Rows of which that of another log determines the prediction (A245).
    pub(crate) fn determined(
        &self,
        (terms, fit): (Terms, &Fit),
        information: &Information,
    ) -> Vec<bool> {
        let followed = self.followed(terms, fit);
        let columns = self.columns(terms);
        let column = |index: usize| columns[index].unwrap_or(&followed);
        let rows = 0..self.series.len();
        rows.map(|row| information.determines(|index| column(index)[row]))
            .collect()
    }

    /// Columns that enter linearly, in the order of their numbers; `None` is what is followed.
    fn columns(&self, terms: Terms) -> Vec<Option<&[f64]>> {
        let mut columns: Vec<Option<&[f64]>> = Vec::new();
        columns.extend(terms.offset.then_some(Some(self.ones.as_slice())));
        columns.extend(terms.gain.then_some(None));
        let free = terms.droop.then_some(&self.droop).into_iter().flatten();
        columns.extend(free.map(|column| Some(column.as_slice())));
        columns
    }

    /// Whether anything moves that gravity's torque could depend on.
    pub(crate) fn has_droop(&self) -> bool {
        !self.droop.is_empty()
    }

    /// Fits a model, from several starts or from one.
    pub(crate) fn fit(&self, terms: Terms, held: &Held, start: Option<Shape>) -> Fit {
        let series = self.series;
        let errors = (series.response.iter()).zip(&series.command);
        let mut errors: Vec<f64> = errors
            .map(|(response, command)| response - command)
            .collect();
        errors.sort_unstable_by(f64::total_cmp);
        let wide = errors[errors.len() * 9 / 10] - errors[errors.len() / 10];
        // the speed of a servo that crosses the motion in a quarter of a second
        let quick = 4.0 * crate::log::range(&series.command).max(1e-6);
        let near = [0.01, 0.01, 0.05 * wide, 0.2 / quick, 0.005];
        let far = [0.03, 0.03, 0.15 * wide, 0.5 / quick, 0.01];
        let range = crate::log::range(&series.command);
        let most = [
            MOST_LAG_S,
            MOST_LAG_S,
            0.5 * range,
            20.0 / quick,
            MOST_LAG_S,
        ];
        let starts = match start {
            Some(shape) => return self.lowest((terms, held), &[shape], (near, most), LEAST_FALL),
            None => self.starts(terms, wide),
        };
        let few = series.stretches(series.rows_of(ROUGH_ROWS, ROUGH_S), ROUGH_STRETCHES);
        if let Some((few, _)) = few.filter(|_| held.is_none()) {
            let rough = Problem::with_droop(&few, &self.angles);
            let start = rough.lowest((terms, &None), &starts, (far, most), ROUGH_FALL);
            return self.lowest((terms, held), &[start.shape], (near, most), LEAST_FALL);
        }
        self.lowest((terms, held), &starts, (far, most), LEAST_FALL)
    }

    /// Shapes that a search of nothing known begins with.
    fn starts(&self, terms: Terms, wide: f64) -> Vec<Shape> {
        let at = |delay_s, lag_s, share: f64| Shape {
            delay_s,
            lag_s,
            inertia_s: 0.0,
            half_width: share * wide,
            slowness: 0.0,
        };
        let mut starts = vec![
            at(0.04, 0.03, 0.05),
            at(0.02, 0.1, 0.3),
            at(0.1, 0.01, 0.45),
        ];
        // a joint that is always at its limit is far from any of these
        let limited = terms.saturation.then(|| self.slower_than_command());
        starts.extend(limited.flatten().map(|slowness| Shape {
            slowness,
            ..at(0.005, 0.005, 0.0)
        }));
        starts
    }

    /// The lowest fit that searches from some shapes find; `steps`: the first ones, and how far from zero.
    fn lowest(
        &self,
        (terms, held): (Terms, &Held),
        starts: &[Shape],
        (steps, most): ([f64; AXES], [f64; AXES]),
        least_fall: f64,
    ) -> Fit {
        let series = self.series;
        let free = [
            terms.delay,
            terms.lag,
            terms.friction,
            terms.saturation,
            terms.inertia,
        ];
        let limits = search::Limits {
            free,
            steps,
            most,
            rows: (series.scored_rows() - held.as_ref().map_or(0, ExactSizeIterator::len)) as f64,
            least_variance: rounding(series).powi(2),
            least_fall,
        };
        let mut evaluator = Evaluator::new(self, terms, held);
        let mut squares = |at: [f64; AXES]| evaluator.fit(shape_of(at, terms)).squares;
        let found = starts
            .iter()
            .map(|start| {
                let at = [
                    start.delay_s,
                    start.lag_s,
                    start.half_width,
                    start.slowness,
                    start.inertia_s,
                ];
                search::compass(at, &limits, &mut squares)
            })
            .min_by(|a, b| a.value.total_cmp(&b.value));
        let found = found.unwrap_or(search::Lowest {
            at: [0.0; AXES],
            value: f64::INFINITY,
            has_converged: false,
        });
        Fit {
            has_converged: found.has_converged,
            ..evaluator.fit(shape_of(found.at, terms))
        }
    }

    /// One over the speed that the joint hardly exceeds, where its command does by far.
    fn slower_than_command(&self) -> Option<f64> {
        // over a time in which noise is no speed
        let apart = ((SPEED_S / self.series.step_s).round() as usize).max(1);
        let fast = |column: &[f64]| {
            let of_piece = |piece: Range<usize>| {
                let rows = (piece.start + apart).min(piece.end)..piece.end;
                rows.map(|row| {
                    let time_s = self.series.time_s[row] - self.series.time_s[row - apart];
                    ((column[row] - column[row - apart]) / time_s).abs()
                })
            };
            let mut speeds: Vec<f64> = self.series.pieces().flat_map(of_piece).collect();
            speeds.sort_unstable_by(f64::total_cmp);
            speeds.get(speeds.len() * 99 / 100).copied()
        };
        let (response, command) = (fast(&self.series.response)?, fast(&self.series.command)?);
        (response > 0.0 && command > FASTER * response).then(|| 1.0 / response)
    }

    /// The fit of the linear numbers, at given numbers of the shape.
    pub(crate) fn evaluate(&self, terms: Terms, shape: Shape, held: &Held) -> Fit {
        Evaluator::new(self, terms, held).fit(shape)
    }

    /// Squares of a residual on the rows of a part that a fit counts.
    pub(crate) fn squares(&self, residual: &[f64], part: &Range<usize>) -> f64 {
        let scored = self.series.scored.iter();
        let own = scored.flat_map(|own| own.start.max(part.start)..own.end.min(part.end));
        own.map(|row| residual[row] * residual[row]).sum()
    }

    /// How far the droop moves the joint \[rad\]: the standard deviation of its course.
    pub(crate) fn droop_size(&self, fit: &Fit) -> f64 {
        let rows = self.series.len();
        let mut course = vec![0.0; rows];
        for (column, coefficient) in self.droop.iter().zip(&fit.droop) {
            for (sum, value) in course.iter_mut().zip(column) {
                *sum += coefficient * value;
            }
        }
        let middle = crate::log::mean(&course);
        crate::log::rms(&course.iter().map(|at| at - middle).collect::<Vec<_>>())
    }
}

fn shape_of([delay_s, lag_s, half_width, slowness, inertia_s]: [f64; AXES], terms: Terms) -> Shape {
    let only = |is_free: bool, value: f64| if is_free { value } else { 0.0 };
    Shape {
        delay_s: only(terms.delay, delay_s),
        lag_s: only(terms.lag, lag_s),
        half_width: only(terms.friction, half_width),
        slowness: only(terms.saturation, slowness),
        inertia_s: only(terms.inertia, inertia_s),
    }
}
