//! The number of a shape, settled in the whole fit, and how well it is known.

use super::scored::score;
use super::{Fitted, Frame, State, columns_of};
use crate::effect::{Candidate, Finer};
use crate::thresholds::select::{PARABOLA_SDS, PARABOLAS, SHAPE_STEPS, UNMOVED_SDS};

/// The number of a pick's shape that leaves least beside the base model and the other picks, all fitted anew, and the standard deviation
/// of its logarithm: by the second difference of what is left, of which half a nat is one standard deviation (Wilks 1938). Numbers of the
/// base model that were at a limit while the pick was sought are free to leave it here.
pub(super) fn settled<'c>(
    frame: &Frame<'_>,
    state: State<'c>,
    index: usize,
    misfit: f64,
) -> (State<'c>, f64) {
    let own = &state.taken[index];
    let Some(&(_, value)) = own.shape.first() else {
        return (state, 0.0);
    };
    if let Some(sd) = own.shape_sd {
        return (state, sd / value.abs().max(1e-300));
    }
    let Finer::Shape { at, .. } = own.finer.clone() else {
        return (state, 0.0);
    };
    let mut others = state.taken.clone();
    others.remove(index);
    let others = frame.fitted(&columns_of(&others), state.early_s);
    let mut sd = alone(frame, &others, own, misfit);
    let mut best = state;
    // how far the number would still go, where the search ends before it converges
    let mut further = 0.0;
    for _ in 0..PARABOLAS {
        let step = PARABOLA_SDS * sd;
        let value = best.taken[index].shape[0].1;
        let moved =
            |by: f64| at(value * by.exp()).and_then(|own| replaced(frame, &best, index, own));
        let (Some(below), Some(above)) = (moved(-step), moved(step)) else {
            break;
        };
        let excess = [&below, &best, &above].map(|own| own.fitted.excess);
        let Some((by, width)) = vertex(excess, step) else {
            break;
        };
        sd = width * misfit.sqrt();
        let nearer = moved(by).filter(|own| own.fitted.excess < excess[1]);
        let Some(nearer) = nearer else {
            further = 0.0;
            break;
        };
        best = nearer;
        further = by.abs();
        if further < UNMOVED_SDS * sd {
            further = 0.0;
            break;
        }
    }
    (best, f64::hypot(sd, further))
}

/// Where the parabola through three sizes at -step, 0 and step is lowest, no farther than a step, and how far from there it rises by a half;
/// none of one that is open below.
fn vertex([below, here, above]: [f64; 3], step: f64) -> Option<(f64, f64)> {
    let second = below - 2.0 * here + above;
    let by = (0.5 * (below - above) / second).clamp(-1.0, 1.0) * step;
    (second > 0.0).then(|| (by, step / second.sqrt()))
}

/// The state with another candidate in the place of a pick; none where its coefficients are not those of such an effect.
fn replaced<'c>(
    frame: &Frame<'_>,
    state: &State<'c>,
    index: usize,
    own: Candidate<'c>,
) -> Option<State<'c>> {
    let mut taken = state.taken.clone();
    let count = own.columns.len();
    taken[index] = own;
    let first: usize = taken[..index].iter().map(|own| own.columns.len()).sum();
    let fitted = frame.fitted(&columns_of(&taken), state.early_s);
    let is_possible = taken[index].is_possible(&fitted.effects()[first..first + count]);
    is_possible.then_some(State {
        taken,
        fitted,
        early_s: state.early_s,
    })
}

/// By how fast what is explained beside the other picks' fit falls beside the shape that explains most.
fn alone(frame: &Frame<'_>, others: &Fitted, own: &Candidate<'_>, misfit: f64) -> f64 {
    let Finer::Shape { at, .. } = &own.finer else {
        return 0.0;
    };
    let value = own.shape[0].1;
    let nats = |factor: f64| {
        let scored = at(value * factor).and_then(|own| score(frame, others, &own));
        scored.map_or(f64::NEG_INFINITY, |own| own.nats)
    };
    let here = nats(1.0);
    let mut drops = SHAPE_STEPS.iter().map(|step| {
        let beside = [nats(step.exp()), nats((-step).exp())];
        (step, here - beside[0].max(beside[1]))
    });
    let (step, drop) = drops
        .find(|(_, drop)| *drop > misfit)
        .unwrap_or((&1.0, misfit));
    step * (misfit / (2.0 * drop)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vertex_is_where_a_parabola_is_lowest() {
        // half of ((x - 0.3) / 0.7)^2
        let parabola = |x: f64| 0.5 * ((x - 0.3) / 0.7_f64).powi(2);
        let (by, width) = vertex([-0.5, 0.0, 0.5].map(parabola), 0.5).unwrap();
        assert!((by - 0.3).abs() < 1e-12 && (width - 0.7).abs() < 1e-12);
        let (by, _) = vertex([-0.2, 0.0, 0.2].map(parabola), 0.2).unwrap();
        assert!((by - 0.2).abs() < 1e-12, "no farther than a step: {by}");
        assert!(vertex([0.0, 1.0, 0.0], 0.5).is_none());
        assert!(vertex([0.0, 0.0, 0.0], 0.5).is_none());
    }
}
