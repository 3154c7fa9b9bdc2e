//! A candidate's shape, settled by what the rows show.

use haptical_linalg::golden_section;

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
            let mut best = start;
            // over the logarithm
            golden_section([-1.0, 1.0], SEARCH_STEPS, |x| {
                let found = at(centre * ratio.powf(x)).and_then(|own| score(frame, fitted, &own));
                let Some(found) = found else {
                    return f64::NEG_INFINITY;
                };
                let nats = found.nats;
                if nats > best.nats {
                    best = found;
                }
                nats
            });
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
