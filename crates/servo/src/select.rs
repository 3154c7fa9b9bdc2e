//! Which laws a joint shows: each is left out in turn, and must be missed on rows that the fit did not see.

use std::ops::Range;

use haptical_linalg::sum_sd;

use crate::fit::{Fit, Problem, Shape, Terms};
use crate::log::Series;
use crate::thresholds::{AS_GOOD, FOLDS, LEAST_DROOP_SHARE, LEAST_SHARE, SURE_SD};

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
}

/// A gain on unseen rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gain {
    pub(crate) squares: f64,
    pub(crate) is_sure: bool,
}

/// What one model leaves less than another on unseen rows; sure by the scatter of the parts, or by their signs.
pub(crate) fn gain(of: &[f64], over: &[f64]) -> Gain {
    let gains: Vec<f64> = over.iter().zip(of).map(|(over, of)| over - of).collect();
    let squares: f64 = gains.iter().sum();
    let sd = sum_sd(&gains);
    let better = gains.iter().filter(|gain| **gain > 0.0).count();
    Gain {
        squares,
        is_sure: squares > 0.0 && (squares > SURE_SD * sd || better + 1 >= gains.len()),
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
            Self::Timing => (terms.delay, terms.lag) = (has, has),
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
    pub(crate) droop_size: f64,
}

/// Chooses laws: the core fitted together, gain and droop where they are missed, then each left out in turn.
pub(crate) fn select(series: &Series) -> Selection {
    let problem = Problem::new(series);
    let chooser = Chooser {
        problem: &problem,
        parts: parts(series.len()).collect(),
    };
    let core = Terms {
        offset: true,
        delay: true,
        lag: true,
        friction: true,
        saturation: true,
        ..Terms::NONE
    };
    let before = chooser.judged(Terms::NONE, Some(Shape::default()));
    let total = before.unseen_squares();
    let mut chosen = chooser.judged(core, None);
    // sines of the joint's own angle follow a gain too, and a known torque follows no gain
    let further = match series.load_nm {
        Some(_) => [Law::Droop, Law::Gain],
        None => [Law::Gain, Law::Droop],
    };
    for law in further {
        if law == Law::Droop && !problem.has_droop() {
            continue;
        }
        let with = chooser.judged(law.set(chosen.terms, true), Some(chosen.fit.shape));
        let found = gain(&with.unseen, &chosen.unseen);
        let is_known = law != Law::Droop || series.load_nm.is_some();
        let least = if is_known { 0.0 } else { LEAST_DROOP_SHARE };
        if is_missed(found, total) && found.squares > least * total {
            chosen = with;
        }
    }
    let mut kept = Vec::new();
    // the laws that are missed least go first, and change what the others are missed by
    loop {
        let laws = Law::ALL.into_iter().filter(|law| law.is_in(chosen.terms));
        let tried: Vec<(Law, Judged)> = laws
            .map(|law| {
                let terms = law.set(chosen.terms, false);
                let near = chooser.judged(terms, Some(chosen.fit.shape));
                (law, near)
            })
            .collect();
        let gains: Vec<(Law, Gain)> = tried
            .iter()
            .map(|(law, without)| (*law, gain(&chosen.unseen, &without.unseen)))
            .collect();
        let spare = gains
            .iter()
            .enumerate()
            .filter(|(_, (_, gain))| !is_missed(*gain, total))
            .min_by(|a, b| a.1.1.squares.total_cmp(&b.1.1.squares));
        match spare {
            Some((index, _)) => {
                let terms = tried[index].0.set(chosen.terms, false);
                let again = chooser.judged(terms, None);
                let near = &tried[index].1;
                chosen = if again.fit.squares < near.fit.squares {
                    again
                } else {
                    near.clone()
                };
            }
            None => {
                kept.extend(gains.iter().map(|(law, gain)| (*law, gain.squares)));
                break;
            }
        }
    }
    let timing = Law::Timing.is_in(chosen.terms);
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
        before: before.unseen,
        kept,
        chosen,
    }
}

fn is_missed(gain: Gain, total: f64) -> bool {
    gain.is_sure && gain.squares > LEAST_SHARE * total
}

struct Chooser<'p, 's> {
    problem: &'p Problem<'s>,
    parts: Vec<Range<usize>>,
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
            .map(|(part, fit)| {
                let residual = &fit.residual[part.clone()];
                residual.iter().map(|value| value * value).sum()
            })
            .collect()
    }
}

/// Contiguous parts of a log of the same number of rows.
pub(crate) fn parts(rows: usize) -> impl Iterator<Item = Range<usize>> {
    (0..FOLDS).map(move |part| part * rows / FOLDS..(part + 1) * rows / FOLDS)
}
