//! A candidate's shape, settled by what the rows show.

use super::scored::{Scored, score};
use super::{Fitted, Frame};
use crate::effect::{Candidate, Finer, MadeAbout};
use crate::thresholds::select::{LINEARISATIONS, SEARCH_STEPS, UNMOVED_NATS};

/// The candidate with the shape that explains most.
pub(crate) fn refined<'c>(frame: &Frame<'_>, fitted: &Fitted, start: Scored<'c>) -> Scored<'c> {
    match start.candidate.finer.clone() {
        // a correction is tried in the whole fit
        Finer::Settled | Finer::Correction(_) => start,
        Finer::About(about) => {
            let mut here = start;
            for _ in 0..LINEARISATIONS {
                let nearer = about_of(&here, &about).and_then(|own| score(frame, fitted, &own));
                let Some(nearer) = nearer.filter(|own| own.nats > here.nats - 1.0) else {
                    break;
                };
                let gain = (nearer.nats - here.nats).abs();
                here = nearer;
                if gain < UNMOVED_NATS {
                    break;
                }
            }
            here
        }
        Finer::Shape { ratio, at } => {
            let centre = start.candidate.shape[0].1;
            let try_at =
                |x: f64| at(centre * ratio.powf(x)).and_then(|own| score(frame, fitted, &own));
            // golden section (Kiefer 1953) over the logarithm
            let golden = 0.618_033_988_749_895;
            let (mut low, mut high) = (-1.0, 1.0);
            let mut best = start;
            let keep = |found: &Option<Scored<'c>>, best: &mut Scored<'c>| {
                if let Some(found) = found
                    && found.nats > best.nats
                {
                    *best = found.clone();
                }
            };
            let nats = |found: &Option<Scored<'c>>| {
                found.as_ref().map_or(f64::NEG_INFINITY, |own| own.nats)
            };
            let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
            let (mut at_a, mut at_b) = (try_at(a), try_at(b));
            for _ in 0..SEARCH_STEPS {
                keep(&at_a, &mut best);
                keep(&at_b, &mut best);
                if nats(&at_a) >= nats(&at_b) {
                    high = b;
                    (b, at_b) = (a, at_a);
                    a = high - golden * (high - low);
                    at_a = try_at(a);
                } else {
                    low = a;
                    (a, at_a) = (b, at_b);
                    b = low + golden * (high - low);
                    at_b = try_at(b);
                }
            }
            best
        }
    }
}

/// The candidate that is linear about where another one was found, by that one's own way of making it.
fn about_of<'c>(found: &Scored<'c>, first: &MadeAbout<'c>) -> Option<Candidate<'c>> {
    match &found.candidate.finer {
        Finer::About(own) => own(&found.coefficients),
        _ => first(&found.coefficients),
    }
}
