//! Which terms a motion shows: one after the other, each where it explains most, a delay that all encoders share among them.

use std::convert::Infallible;

use haptical_judge::{
    Backward, Forward, InPlace, Less, Other, Others, Proposal, Proposals, Ruled, Ruling, Without,
    rivals, select,
};

use super::fit::{Fitted, fit};
use super::rows::JointRows;
use super::terms::Term;
use crate::effect::delay::ENCODER_LATENCY;
use crate::effect::joint_compliance;
use crate::thresholds::between::{
    FINER_STEP, FINER_STEPS, FLIGHT_SHARES, HARDENING_SHARES, LEAST_NATS, MOST_FLIGHT, MOST_TERMS,
};

/// What was found.
pub(super) struct Chosen {
    /// Each joint's offsets alone, with shapes that were taken; and with everything.
    pub(super) bare: Vec<Fitted>,
    pub(super) fitted: Vec<Fitted>,
    /// Delay of all encoders with its standard deviation, where one does for all.
    pub(super) shared_s: Option<(f64, f64)>,
    pub(super) tried: usize,
    /// What each joint's terms explain beside the others \[nats\], as in `fitted`; for each a rival in its place, and how far that is behind.
    pub(super) nats: Vec<Vec<f64>>,
    pub(super) rivals: Vec<Vec<Vec<Rival>>>,
}

/// Another term in the place of one.
pub(super) type Rival = haptical_judge::Rival<Kind, ()>;

/// A term, whatever its shape.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kind(pub(super) Term);

impl PartialEq for Kind {
    fn eq(&self, other: &Self) -> bool {
        self.0.is_like(other.0)
    }
}

/// A further term, or a delay of all joints.
#[derive(Debug, Clone, Copy)]
enum Further {
    At(usize, Term),
    DelayOfAll,
}

#[derive(Clone)]
struct State {
    fitted: Vec<Fitted>,
    is_shared: bool,
    /// Terms that were taken, a delay of all joints as one.
    taken: usize,
}

impl State {
    /// Logarithm of the likelihood, numbers allowed for (Schwarz 1978).
    fn score(&self, rows: &[JointRows]) -> f64 {
        let own = self.fitted.iter().zip(rows);
        let score: f64 = own
            .map(|(own, rows)| own.log_likelihood - penalty(rows, &own.terms))
            .sum();
        if !self.is_shared {
            return score;
        }
        // one number in the place of each joint's own
        let back: f64 = rows.iter().map(|own| penalty(own, &[Term::Delay])).sum();
        let most = rows
            .iter()
            .map(|own| penalty(own, &[Term::Delay]))
            .fold(0.0, f64::max);
        score - 0.5 * disagreement(&self.fitted) + back - most
    }

    fn with(&self, rows: &[JointRows], further: Further) -> Option<Self> {
        let mut next = self.clone();
        next.taken += 1;
        match further {
            Further::At(at, term) => {
                let mut terms = next.fitted[at].terms.clone();
                // a play has a spring of its own, and one that hardens is the spring
                let is_more = matches!(term, Term::Play { .. } | Term::Hardening { .. });
                let is_spring = |own: &Term| own.name() == Term::Spring.name();
                terms.retain(|own| !(is_more && is_spring(own)));
                terms.push(term);
                next.fitted[at] = fit(&rows[at], &terms, &|_| true);
            }
            Further::DelayOfAll => {
                for (own, rows) in next.fitted.iter_mut().zip(rows) {
                    if own.delay_s().is_none() {
                        let mut terms = own.terms.clone();
                        terms.push(Term::Delay);
                        *own = fit(rows, &terms, &|_| true);
                    }
                }
                next.is_shared = true;
            }
        }
        let mut pairs = next.fitted.iter().zip(rows);
        pairs
            .all(|(own, rows)| own.is_possible(rows))
            .then_some(next)
    }
}

fn penalty(rows: &JointRows, terms: &[Term]) -> f64 {
    let numbers: usize = terms.iter().map(|own| own.numbers()).sum();
    let handicap: f64 = terms.iter().map(|own| own.handicap()).sum();
    handicap + 0.5 * numbers as f64 * (rows.count() as f64).ln()
}

/// The delay that all joints share, by their weights, with its standard deviation.
pub(super) fn shared(fitted: &[Fitted]) -> Option<(f64, f64)> {
    let own = fitted.iter().filter_map(Fitted::delay_s);
    let (sum, weight) = own.fold((0.0, 0.0), |(sum, weight), (delay_s, sd)| {
        let own = 1.0 / (sd * sd).max(1e-300);
        (sum + own * delay_s, weight + own)
    });
    (weight > 0.0).then(|| (sum / weight, weight.sqrt().recip()))
}

/// Squared deviations of the joints' own delays from the shared one, in standard deviations.
fn disagreement(fitted: &[Fitted]) -> f64 {
    let Some((shared_s, _)) = shared(fitted) else {
        return 0.0;
    };
    let own = fitted.iter().filter_map(Fitted::delay_s);
    own.map(|(delay_s, sd)| ((delay_s - shared_s) / sd.max(1e-300)).powi(2))
        .sum()
}

/// Chooses; `without`: names that are left out.
pub(super) fn choose(rows: &[JointRows], without: &[String]) -> Chosen {
    let is_left_out = |term: Term| {
        let has = |name: &str| without.iter().any(|own| own == name);
        let twin = match term {
            Term::Delay => ENCODER_LATENCY.name,
            Term::Spring | Term::Hardening { .. } => joint_compliance::EFFECT.name,
            Term::Play { .. } | Term::Shape => "",
        };
        has(term.name()) || has(twin)
    };
    let mut all = Vec::new();
    for (at, own) in rows.iter().enumerate() {
        all.extend([Term::Delay, Term::Spring, Term::Shape].map(|term| (at, term)));
        let hardening = HARDENING_SHARES.map(|share| Term::Hardening {
            share,
            load_nm: own.load_rms,
        });
        let hardening = hardening.into_iter().filter(|_| own.load_rms > 0.0);
        all.extend(hardening.map(|term| (at, term)));
        let plays = FLIGHT_SHARES.map(|share| Term::Play {
            flight_nm: share * own.load_rms,
            yields: !is_left_out(Term::Spring),
        });
        let is_told = |term: &Term| {
            let share = term
                .flight(own)
                .map_or(1.0, |own| own.iter().sum::<f64>() / own.len().max(1) as f64);
            own.load_rms > 0.0 && share < MOST_FLIGHT
        };
        all.extend(plays.into_iter().filter(is_told).map(|term| (at, term)));
    }
    all.retain(|own| !is_left_out(own.1));
    let start = State {
        fitted: rows.iter().map(|own| fit(own, &[], &|_| true)).collect(),
        is_shared: false,
        taken: 0,
    };
    let has_delays = !is_left_out(Term::Delay) && rows.len() > 1;
    let mut search = Search {
        rows,
        all,
        has_delays,
    };
    let Ok(mut state) = select(&mut search, start);
    for (own, rows) in state.fitted.iter_mut().zip(rows) {
        if own.hardening().is_some() {
            *own = refined(rows, own);
        }
    }
    search.chosen(state)
}

/// A fit with a spring that hardens, its share settled between those that are tried. The standard deviation of its stiffness counts
/// all shares by their likelihoods.
fn refined(rows: &JointRows, fitted: &Fitted) -> Fitted {
    let with = |factor: f64| {
        let of = |own: &Term| match *own {
            Term::Hardening { share, load_nm } => Term::Hardening {
                share: factor * share,
                load_nm,
            },
            other => other,
        };
        let terms: Vec<Term> = fitted.terms.iter().map(of).collect();
        fit(rows, &terms, &|_| true)
    };
    let all = (-FINER_STEPS..=FINER_STEPS).map(|k| with(FINER_STEP.powi(k)));
    let all: Vec<Fitted> = all.filter(|own| own.is_possible(rows)).collect();
    let best = (all.iter()).max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood));
    let Some((best, (at, _))) = best.and_then(|own| Some((own, own.hardening()?))) else {
        return fitted.clone();
    };
    let mut best = best.clone();
    // anywhere within a step of the grid, which moves the coefficient by about as much as all steps together over their number
    let ends = all.first().zip(all.last());
    let range = ends.map_or(0.0, |(a, b)| b.coefficients[at] - a.coefficients[at]);
    let of_step = range / all.len() as f64;
    let (mut weights, mut square) = (0.0, 0.0);
    for own in &all {
        let weight = (own.log_likelihood - best.log_likelihood).exp();
        weights += weight;
        square += weight * (own.coefficients[at] - best.coefficients[at]).powi(2);
    }
    best.covariance[(at, at)] += square / weights + of_step.powi(2) / 12.0;
    best
}

/// The search of terms for a motion.
struct Search<'r> {
    rows: &'r [JointRows],
    /// Terms, and the joints that they may be at.
    all: Vec<(usize, Term)>,
    has_delays: bool,
}

impl Search<'_> {
    /// A model with other terms at a joint.
    fn with(&self, whole: &State, at: usize, terms: &[Term]) -> State {
        let mut there = whole.clone();
        there.fitted[at] = fit(&self.rows[at], terms, &|_| true);
        let with_delay = there.fitted.iter().filter(|own| own.delay_s().is_some());
        there.is_shared &= with_delay.count() > 1;
        there
    }
}

/// The joint of each effect of a model, and its place among that joint's terms.
fn places(state: &State) -> impl Iterator<Item = [usize; 2]> {
    let joints = state.fitted.iter().enumerate();
    joints.flat_map(|(at, own)| (0..own.terms.len()).map(move |place| [at, place]))
}

/// The joint of an effect, and the terms of that joint but for it.
fn others(state: &State, effect: usize) -> (usize, Vec<Term>) {
    let [at, place] = places(state).nth(effect).unwrap_or_default();
    let mut terms = state.fitted[at].terms.clone();
    terms.remove(place);
    (at, terms)
}

impl Forward for Search<'_> {
    type State = State;
    type Further = State;
    type Error = Infallible;

    fn proposals(&mut self, state: &State) -> Proposals<Self> {
        if state.taken >= MOST_TERMS {
            return Ok(Vec::new());
        }
        let has = |(at, term): &(usize, Term)| {
            let own = &state.fitted[*at];
            let has_more = own.of(Term::PLAY).is_some() || own.hardening().is_some();
            let is_spring = term.name() == Term::Spring.name();
            own.of(*term).is_some() || (is_spring && has_more)
        };
        let open = self.all.iter().filter(|own| !has(own));
        let further = open.map(|own| Further::At(own.0, own.1));
        let of_all = (self.has_delays && !state.is_shared).then_some(Further::DelayOfAll);
        let before = state.score(self.rows);
        let next = further.chain(of_all);
        let next = next.filter_map(|further| state.with(self.rows, further));
        Ok(next
            .map(|further| Proposal {
                merit: further.score(self.rows) - before,
                further,
            })
            .collect())
    }

    fn rule(&mut self, _: &State, best: Proposal<State>) -> Ruled<Self> {
        Ok(match best.merit > LEAST_NATS {
            true => Ruling::Taken(best.further),
            false => Ruling::Ended,
        })
    }
}

impl Backward for Search<'_> {
    type State = State;
    type Error = Infallible;

    fn effects(&self, state: &State) -> usize {
        places(state).count()
    }

    fn without(&mut self, state: &State, effect: usize) -> Less<Self> {
        let (at, terms) = others(state, effect);
        let mut less = self.with(state, at, &terms);
        if !less.fitted[at].is_possible(&self.rows[at]) {
            // nature does not allow the other terms without it
            less = self.with(state, at, &[]);
        }
        Ok(Without {
            worth: state.score(self.rows) - less.score(self.rows),
            state: less,
        })
    }
}

impl InPlace for Search<'_> {
    type Name = Kind;
    type Fit = ();

    fn in_place(&mut self, without: &State, whole: &State, effect: usize) -> Others<Self> {
        let (at, kept) = others(whole, effect);
        let less = without.score(self.rows);
        let taken = &whole.fitted[at].terms;
        let is_open = |(other, rival): &&(usize, Term)| {
            *other == at && !taken.iter().any(|taken| taken.name() == rival.name())
        };
        let open = self.all.iter().filter(is_open);
        let there = open.map(|(_, rival)| {
            let terms = [kept.as_slice(), &[*rival]].concat();
            (Kind(*rival), self.with(whole, at, &terms))
        });
        let possible = there.filter(|(_, there)| there.fitted[at].is_possible(&self.rows[at]));
        Ok(possible
            .map(|(name, there)| Other {
                name,
                merit: there.score(self.rows) - less,
                fit: (),
            })
            .collect())
    }
}

impl Search<'_> {
    /// What each term is worth, and what would do in its place.
    fn chosen(mut self, state: State) -> Chosen {
        let (mut nats, mut found) = (Vec::new(), Vec::new());
        let mut effect = 0;
        for own in &state.fitted {
            let (mut of_joint, mut others) = (Vec::new(), Vec::new());
            for _ in &own.terms {
                let Ok(without) = self.without(&state, effect);
                let Ok(near) = rivals(&mut self, &state, effect, &without, 1.0);
                of_joint.push(without.worth);
                others.push(near);
                effect += 1;
            }
            nats.push(of_joint);
            found.push(others);
        }
        let rows = self.rows;
        let bare = (rows.iter().zip(&state.fitted)).map(|(rows, own)| {
            let shapes: Vec<Term> = own
                .terms
                .iter()
                .filter(|own| **own == Term::Shape)
                .copied()
                .collect();
            fit(rows, &shapes, &|_| true)
        });
        Chosen {
            bare: bare.collect(),
            shared_s: shared(&state.fitted).filter(|_| state.is_shared),
            fitted: state.fitted,
            tried: self.all.len(),
            nats,
            rivals: found,
        }
    }
}
