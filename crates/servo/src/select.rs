//! Which laws a joint shows: each is left out in turn, and must be missed on rows that the fit did not see.

use std::convert::Infallible;
use std::ops::Range;

use haptical_judge::{
    Backward, Forward, Gain, Less, Needless, Proposal, Proposals, Ruled, Ruling, Without,
    without_needless,
};

use crate::effect::droop;
use crate::fit::{Fit, Problem, Shape, Terms};
use crate::log::Series;
use crate::thresholds::{
    AS_GOOD, FEWEST_SPEAKING, FOLDS, LEAST_DROOP_SHARE, LEAST_SHARE, MOST_FITTED_ROWS,
    MOST_FITTED_S, REFUSED, START_DAMPING, START_LAG_S, STRETCHES_OF_FIT, SURE_SD,
};

/// A model with what it leaves of rows that its fit did not see, part by part.
#[derive(Debug, Clone)]
pub(crate) struct Judged {
    pub(crate) terms: Terms,
    pub(crate) fit: Fit,
    /// Squares on each part, fitted to the others.
    pub(crate) unseen: Vec<f64>,
    /// Fit to all but each part.
    pub(crate) folds: Vec<Fit>,
}

impl Judged {
    pub(crate) fn unseen_squares(&self) -> f64 {
        self.unseen.iter().sum()
    }

    /// Whether its fit, and those to all but each part, have converged.
    pub(crate) fn has_converged(&self) -> bool {
        let mut all = self.folds.iter().chain([&self.fit]);
        all.all(|own| own.has_converged)
    }

    /// Whether it surely leaves more than so many times what another model does.
    pub(crate) fn leaves_more(&self, than: f64, other: &Self) -> bool {
        self.unseen_squares() > than * other.unseen_squares()
            && is_sure(&self.unseen, &other.unseen)
    }
}

/// Laws by name, as a model has them together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Law {
    Offset,
    Timing,
    Friction,
    Saturation,
    Gain,
    Droop,
}

impl Law {
    pub(crate) const ALL: [Self; 6] = [
        Self::Offset,
        Self::Timing,
        Self::Friction,
        Self::Saturation,
        Self::Gain,
        Self::Droop,
    ];

    /// A model with or without this law.
    pub(crate) fn set(self, mut terms: Terms, has: bool) -> Terms {
        match self {
            Self::Offset => terms.offset = has,
            Self::Timing => {
                (terms.delay, terms.lag) = (has, has);
                (terms.inertia, terms.holds) = (false, false);
            }
            Self::Friction => terms.friction = has,
            Self::Saturation => terms.saturation = has,
            Self::Gain => terms.gain = has,
            Self::Droop => terms.droop = has,
        }
        terms
    }

    pub(crate) fn is_in(self, terms: Terms) -> bool {
        self.set(terms, false) != terms
    }
}

/// The laws of a joint.
#[derive(Debug)]
pub(crate) struct Selection {
    pub(crate) chosen: Judged,
    /// Each law that is missed, with what it gains on unseen rows.
    pub(crate) kept: Vec<(Law, f64)>,
    /// Squares of the bare error, part by part.
    pub(crate) before: Vec<f64>,
    /// With a delay alone, and with a lag alone, where there is timing.
    pub(crate) delay_alone: Option<Judged>,
    pub(crate) lag_alone: Option<Judged>,
    /// With a lag that has a mass, and no delay.
    pub(crate) heavy_alone: Option<Judged>,
    pub(crate) droop_size: f64,
    /// Rows that they were fitted to, where those are not all.
    pub(crate) fitted_rows: Option<usize>,
}

/// Chooses laws; of a long log by stretches of it, and what they leave of its other rows is unseen too.
pub(crate) fn select(series: &Series) -> Selection {
    let most = series.rows_of(MOST_FITTED_ROWS, MOST_FITTED_S);
    let Some((some, stretches)) = series.stretches(most, STRETCHES_OF_FIT) else {
        return select_by(&Problem::new(series), series);
    };
    let angles = droop::moving(series);
    let mut found = select_by(&Problem::with_droop(&some, &angles), &some);
    let mut is_fitted = vec![false; series.len()];
    stretches
        .into_iter()
        .for_each(|rows| is_fitted[rows].fill(true));
    let problem = Problem::with_droop(series, &angles);
    // what a fit to the stretches leaves of all rows
    let of_all = |judged: &mut Judged| {
        let predicted = problem.predicted(judged.terms, &judged.fit);
        let residual = series.response.iter().zip(predicted);
        let residual: Vec<f64> = residual.map(|(own, predicted)| own - predicted).collect();
        for (unseen, part) in judged.unseen.iter_mut().zip(parts(series.len())) {
            let others = part.filter(|row| !is_fitted[*row]);
            *unseen += others.map(|row| residual[row].powi(2)).sum::<f64>();
        }
        judged.fit.residual = residual;
    };
    let of_stretches = Problem::with_droop(&some, &angles);
    let chooser = Chooser::new(&of_stretches, &some);
    let without = found.kept.iter().map(|(law, _)| {
        let terms = law.set(found.chosen.terms, false);
        chooser.judged(terms, Some(found.chosen.fit.shape))
    });
    let mut without: Vec<Judged> = without.collect();
    let alone = [
        &mut found.delay_alone,
        &mut found.lag_alone,
        &mut found.heavy_alone,
    ];
    let others = alone.into_iter().flatten().chain(&mut without);
    others.chain([&mut found.chosen]).for_each(of_all);
    for (kept, without) in found.kept.iter_mut().zip(&without) {
        kept.1 = Gain::between(&without.unseen, &found.chosen.unseen).sum;
    }
    let error = |row: usize| series.response[row] - series.command[row];
    let before = parts(series.len()).map(|part| part.map(|row| error(row).powi(2)).sum());
    found.before = before.collect();
    found.fitted_rows = Some(some.scored_rows());
    found
}

/// Chooses laws by all rows: the core fitted together, gain and droop where they are missed, then each left out in turn.
fn select_by(problem: &Problem<'_>, series: &Series) -> Selection {
    let mut chooser = Chooser::new(problem, series);
    let core = Terms {
        offset: true,
        delay: true,
        lag: true,
        friction: true,
        saturation: true,
        ..Terms::NONE
    };
    let before = chooser.judged(Terms::NONE, Some(Shape::default()));
    chooser.total = before.unseen_squares();
    let chosen = chooser.judged(core, None);
    let Ok(chosen) = haptical_judge::select(&mut chooser, chosen);
    let Ok(kept) = without_needless(&mut chooser, chosen, 0);
    let mut chosen = kept.state;
    let mut kept: Vec<_> = laws(&chosen).zip(kept.worth.unwrap_or_default()).collect();
    let timing = Law::Timing.is_in(chosen.terms);
    if let Some(with) = chooser.with_lag_within_limit(&chosen) {
        chosen = with;
    }
    let heavy_alone = timing.then(|| chooser.heavy_alone(&chosen));
    let shape = chosen.fit.shape;
    let both = shape.delay_s + shape.lag_s;
    let alone = |delay: bool| {
        let terms = Terms {
            delay,
            lag: !delay,
            ..chosen.terms
        };
        let start = Shape {
            delay_s: both,
            lag_s: both,
            ..shape
        };
        chooser.judged(terms, Some(start))
    };
    let mut delay_alone = timing.then(|| alone(true));
    let mut lag_alone = timing.then(|| alone(false));
    if let Some(heavy) = (heavy_alone.as_ref())
        .filter(|heavy| heavy.has_converged() && chosen.leaves_more(REFUSED, heavy))
    {
        let Ok(less) = without_needless(&mut chooser, heavy.clone(), 0);
        chosen = less.state;
        kept = laws(&chosen).zip(less.worth.unwrap_or_default()).collect();
    }
    chooser.refit(&mut chosen);
    for own in [&mut delay_alone, &mut lag_alone].into_iter().flatten() {
        if own.unseen_squares() <= AS_GOOD * chosen.unseen_squares() {
            chooser.refit(own);
        }
    }
    Selection {
        droop_size: problem.droop_size(&chosen.fit),
        delay_alone,
        lag_alone,
        heavy_alone,
        before: before.unseen,
        kept,
        chosen,
        fitted_rows: None,
    }
}

fn is_missed(without: &Judged, with: &Judged, total: f64) -> bool {
    let gained = Gain::between(&without.unseen, &with.unseen).sum;
    is_sure(&without.unseen, &with.unseen) && gained > LEAST_SHARE * total
}

/// The one that leaves less on unseen rows.
fn better(one: Judged, other: Judged) -> Judged {
    match other.unseen_squares() < one.unseen_squares() {
        true => other,
        false => one,
    }
}

/// Whether a gain on unseen rows is sure by the scatter of the parts, or by their signs. A part in which a law does nothing, as a limit that
/// no motion there meets, says neither: enough others that all leave far more are sure too.
fn is_sure(without: &[f64], with: &[f64]) -> bool {
    let gain = Gain::between(without, with);
    let pairs = without.iter().zip(with);
    let speaking: Vec<_> = pairs.filter(|(without, with)| without != with).collect();
    let are_all_far = speaking.len() >= FEWEST_SPEAKING
        && (speaking.iter()).all(|(without, with)| **without > REFUSED * **with);
    let by_sign = gain.gaining + 1 >= gain.parts || are_all_far;
    gain.sum > 0.0 && (gain.deviations() > SURE_SD || by_sign)
}

struct Chooser<'p, 's> {
    problem: &'p Problem<'s>,
    parts: Vec<Range<usize>>,
    /// Laws that are still to be tried, the first of them last.
    further: Vec<Law>,
    has_load: bool,
    /// Squares of the bare error.
    total: f64,
}

/// The laws of a model.
fn laws(judged: &Judged) -> impl Iterator<Item = Law> {
    let terms = judged.terms;
    Law::ALL.into_iter().filter(move |law| law.is_in(terms))
}

impl Forward for Chooser<'_, '_> {
    type State = Judged;
    type Further = (Law, Judged);
    type Error = Infallible;

    fn proposals(&mut self, chosen: &Judged) -> Proposals<Self> {
        let has_droop = self.problem.has_droop();
        self.further.retain(|law| *law != Law::Droop || has_droop);
        let law = self.further.pop();
        let with = law.map(|law| {
            let terms = law.set(chosen.terms, true);
            (law, self.judged(terms, Some(chosen.fit.shape)))
        });
        Ok(Proposal::of_best(with, |(_, with)| {
            Gain::between(&chosen.unseen, &with.unseen).sum
        }))
    }

    fn rule(&mut self, chosen: &Judged, best: Proposal<Self::Further>) -> Ruled<Self> {
        let (law, with) = best.further;
        let gain = Gain::between(&chosen.unseen, &with.unseen);
        let is_known = law != Law::Droop || self.has_load;
        let least = if is_known { 0.0 } else { LEAST_DROOP_SHARE };
        Ok(
            match is_missed(chosen, &with, self.total) && gain.sum > least * self.total {
                true => Ruling::Taken(with),
                false => Ruling::Refused,
            },
        )
    }
}

impl Backward for Chooser<'_, '_> {
    type State = Judged;
    type Error = Infallible;

    fn effects(&self, chosen: &Judged) -> usize {
        laws(chosen).count()
    }

    fn without(&mut self, chosen: &Judged, effect: usize) -> Less<Self> {
        let law = laws(chosen).nth(effect);
        let terms = law.map_or(chosen.terms, |law| law.set(chosen.terms, false));
        let state = self.judged(terms, Some(chosen.fit.shape));
        Ok(Without {
            worth: Gain::between(&state.unseen, &chosen.unseen).sum,
            state,
        })
    }
}

impl Needless for Chooser<'_, '_> {
    fn is_needless(
        &mut self,
        chosen: &Judged,
        effect: usize,
        all: &[Without<Judged>],
    ) -> Result<bool, Infallible> {
        Ok(!is_missed(&all[effect].state, chosen, self.total))
    }

    fn refitted(&mut self, near: Judged) -> Result<Judged, Infallible> {
        let again = self.judged(near.terms, None);
        Ok(match again.fit.squares < near.fit.squares {
            true => again,
            false => near,
        })
    }
}

impl<'p, 's> Chooser<'p, 's> {
    fn new(problem: &'p Problem<'s>, series: &Series) -> Self {
        Self {
            problem,
            parts: parts(series.len()).collect(),
            // sines of the joint's own angle follow a gain too, and a known torque follows no gain
            further: match series.load_nm {
                Some(_) => vec![Law::Gain, Law::Droop],
                None => vec![Law::Droop, Law::Gain],
            },
            has_load: series.load_nm.is_some(),
            total: 0.0,
        }
    }
}

impl Chooser<'_, '_> {
    /// A model on unseen rows: what enters linearly is fitted anew without each part, the shape to all rows.
    fn judged(&self, terms: Terms, start: Option<Shape>) -> Judged {
        let fit = self.problem.fit(terms, &None, start);
        let parts = self.parts.iter();
        let folds: Vec<Fit> = parts
            .map(|part| self.problem.evaluate(terms, fit.shape, &Some(part.clone())))
            .collect();
        Judged {
            terms,
            unseen: self.unseen(&folds),
            folds,
            fit,
        }
    }

    /// A limit of the speed with delay and lag, though they close too little of the gap to be causes: without them the limit is too low, as the
    /// joint slows down before it is there.
    fn with_lag_within_limit(&self, chosen: &Judged) -> Option<Judged> {
        if Law::Timing.is_in(chosen.terms) || !Law::Saturation.is_in(chosen.terms) {
            return None;
        }
        let start = Shape {
            delay_s: START_LAG_S,
            lag_s: START_LAG_S,
            ..chosen.fit.shape
        };
        // a delay next to a command that holds is no more than half a row's
        let tried = [(true, false), (false, false), (false, true)].map(|(delay, holds)| {
            let terms = Terms {
                delay,
                lag: true,
                holds,
                ..chosen.terms
            };
            self.judged(terms, Some(start))
        });
        let tried = tried.into_iter().filter(Judged::has_converged);
        let with = tried.reduce(better)?;
        is_sure(&chosen.unseen, &with.unseen).then_some(with)
    }

    /// A model with a mass on its loop in the place of delay and lag, its commands held or not.
    fn heavy_alone(&self, chosen: &Judged) -> Judged {
        let shape = chosen.fit.shape;
        let both = shape.delay_s + shape.lag_s;
        let start = Shape {
            delay_s: 0.0,
            lag_s: both,
            inertia_s: both / (2.0 * START_DAMPING),
            ..shape
        };
        let with = |holds: bool| {
            let terms = Terms {
                delay: false,
                lag: true,
                inertia: true,
                holds,
                ..chosen.terms
            };
            self.judged(terms, Some(start))
        };
        better(with(false), with(true))
    }

    /// The shape is fitted anew without each part too.
    fn refit(&self, judged: &mut Judged) {
        let parts = self.parts.iter();
        let start = Some(judged.fit.shape);
        judged.folds = parts
            .map(|part| (self.problem).fit(judged.terms, &Some(part.clone()), start))
            .collect();
        judged.unseen = self.unseen(&judged.folds);
    }

    fn unseen(&self, folds: &[Fit]) -> Vec<f64> {
        let pairs = self.parts.iter().zip(folds);
        pairs
            .map(|(part, fit)| self.problem.squares(&fit.residual, part))
            .collect()
    }
}

/// Contiguous parts of a log of the same number of rows.
pub(crate) fn parts(rows: usize) -> impl Iterator<Item = Range<usize>> {
    (0..FOLDS).map(move |part| part * rows / FOLDS..(part + 1) * rows / FOLDS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::JointLog;

    /// A joint that follows 70 ms late in 2000 s of 50 rows a second, of which it rests every second 20 s.
    fn long(off_at_rest: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let time_s: Vec<f64> = (0..100_000).map(|row| 0.02 * f64::from(row)).collect();
        let course = |t: f64| {
            let moved_s = 20.0 * (t / 40.0).floor() + t.rem_euclid(40.0).min(20.0);
            0.6 * (1.3 * moved_s).sin() + 0.3 * (2.9 * moved_s).cos()
        };
        let command: Vec<f64> = time_s.iter().map(|t| course(*t)).collect();
        let rests = |t: f64| t.rem_euclid(40.0) > 20.5;
        let off = |t: f64| if rests(t) { off_at_rest } else { 0.0 };
        let response = time_s.iter().map(|t| course(t - 0.07) + off(*t));
        let response = response.collect();
        (time_s, command, response)
    }

    fn selection((time_s, command, response): &(Vec<f64>, Vec<f64>, Vec<f64>)) -> Selection {
        let log = JointLog {
            time_s: Some(time_s),
            command: Some(command),
            response,
            ..JointLog::default()
        };
        select(&Series::new(&log).unwrap())
    }

    #[test]
    fn a_long_log_is_fitted_by_stretches_of_its_motion_and_judged_by_all_of_it() {
        let log = long(0.0);
        let found = selection(&log);
        // sixteen stretches, each without what leads into it
        assert_eq!(found.fitted_rows, Some(MOST_FITTED_ROWS - 16 * 15));
        assert_eq!(found.chosen.fit.residual.len(), log.0.len());
        let late = found.delay_alone.as_ref().unwrap();
        assert!((late.fit.shape.delay_s - 0.07).abs() < 1e-4, "{late:?}");
        let before: f64 = found.before.iter().sum();
        let [(Law::Timing, gained)] = found.kept[..] else {
            panic!("{:?}", found.kept);
        };
        assert!((gained / before - 1.0).abs() < 0.02, "{gained} of {before}");
    }

    /// Most of a log at rest beside its command, and a delay where it moves: each has the share that it has of all rows.
    #[test]
    fn shares_are_those_of_all_rows() {
        let (time_s, command, mut response) = long(0.0);
        response.iter_mut().for_each(|at| *at += 0.2);
        let found = selection(&(time_s, command, response));
        let before: f64 = found.before.iter().sum();
        let share = |law: Law| {
            let mut own = found.kept.iter().filter(|own| own.0 == law);
            own.next().map_or(0.0, |own| own.1 / before)
        };
        assert!(share(Law::Offset) > 0.9, "{:?}", found.kept);
        assert!(share(Law::Timing) < 0.1, "{:?}", found.kept);
    }

    #[test]
    fn what_is_off_beside_the_stretches_is_left() {
        let log = long(0.2);
        let found = selection(&log);
        let squares = 0.2_f64.powi(2) * 0.5 * log.0.len() as f64;
        let left = found.chosen.unseen_squares();
        assert!((left / squares - 1.0).abs() < 0.2, "{left} of {squares}");
    }
}
