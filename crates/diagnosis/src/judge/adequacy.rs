//! Adequacy: do the causes found account for the gap? If not, the answer is "unknown".

use crate::Result;
use crate::answer::Verdict;
use crate::judge::largest_dependence;
use crate::select::{Selection, Selector, excess, worst_excess};
use crate::thresholds::chance::{FAMILY_WISE_P, OMNIBUS_Z};
use crate::thresholds::rivals::{LEAST_DOUBT, MOST_DOUBT, UNKNOWN, WEAK, WEAK_DOUBT};

/// Whether the causes account for the gap.
#[derive(Debug, Clone)]
pub(crate) struct Adequacy {
    pub(crate) is_adequate: bool,
    /// Largest excess of a stream after the causes, in standard deviations.
    pub(crate) worst: f64,
    /// Share of the structured energy that the causes leave.
    pub(crate) unexplained: f64,
    /// Structured energy before any cause, in squared standard deviations.
    pub(crate) total: f64,
}

/// Compares what the causes leave with noise, and with what their laws may get wrong.
pub(crate) fn adequacy(selection: &Selection<'_>) -> Result<Adequacy> {
    let (total, _) = excess(&selection.before);
    let (left, left_sd) = excess(&selection.after);
    let unexplained = if total > 0.0 {
        ((left - 2.0 * left_sd) / total).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let worst = worst_excess(&selection.after, &selection.engine().noise);
    let causes = selection.causes();
    let explained: f64 = selection.explained.iter().sum();
    let mut allowed = 0.0;
    let mut own = Vec::new();
    let springs = of_springs(selection, total - left);
    for (cause, part) in causes.iter().zip(&selection.explained) {
        let effect = selection.effect(cause);
        allowed += effect.spec().law_error.share * part / explained.max(1e-300);
        let part = match selection.selector.is_spring(cause.effect) {
            true => part.max(springs),
            false => *part,
        };
        own.push(
            selection
                .selector
                .broken_law(&selection.system, effect, cause, part),
        );
    }
    let laws_hold = causes
        .iter()
        .zip(&own)
        .all(|(cause, broken)| Selector::law_is_kept(selection.effect(cause), *broken));
    let small_rest = unexplained <= allowed;
    let is_adequate = laws_hold
        && (worst < OMNIBUS_Z || small_rest)
        && !depends_still(selection, allowed * explained)?;
    Ok(Adequacy {
        is_adequate,
        worst,
        unexplained,
        total,
    })
}

/// What the joints that yield explain together, of what all causes do. One weight loads them all: each explains little
/// beside the others, and what one's law gets wrong follows the torques of its neighbours too.
fn of_springs(selection: &Selection<'_>, together: f64) -> f64 {
    let parts = selection.causes().iter().zip(&selection.explained);
    let others = parts.filter(|(cause, _)| !selection.selector.is_spring(cause.effect));
    together - others.map(|(_, part)| part).sum::<f64>()
}

/// Of single postures, whose noise is known to a third only: whether what the causes leave depends on a joint or
/// on time, more surely than by chance and by more than the squares that the laws may get wrong. Noise does not,
/// whatever its size.
fn depends_still(selection: &Selection<'_>, wrong: f64) -> Result<bool> {
    let context = &selection.engine().context;
    if context.ordered || selection.causes().is_empty() {
        return Ok(false);
    }
    let p = FAMILY_WISE_P;
    Ok(largest_dependence(context, &selection.system, p)? > wrong)
}

impl Adequacy {
    /// Whether causes, or noise where there are none, are all that there is.
    pub(crate) fn accounts_for_the_gap(&self, selection: &Selection<'_>) -> bool {
        match selection.causes().is_empty() {
            true => self.is_noise() && selection.refused.is_none(),
            false => self.is_adequate,
        }
    }

    /// Whether what the causes leave is no more than noise.
    pub(crate) fn is_noise(&self) -> bool {
        self.worst < OMNIBUS_Z
    }

    /// Probability that the cause is none of the catalogue's.
    pub(crate) fn probability_unknown(&self, verdict: Verdict) -> f64 {
        match verdict {
            Verdict::NoGap => 0.0,
            Verdict::Unknown => UNKNOWN,
            Verdict::Named | Verdict::Ambiguous => self.doubt(),
        }
    }

    /// What is left of doubt when everything fits.
    pub(crate) fn doubt(&self) -> f64 {
        doubt(self.total)
    }
}

/// Doubt that no catalogue removes, by the structured energy of a gap: the weaker it is, the more a wrong effect can imitate
/// it.
pub(crate) fn doubt(energy: f64) -> f64 {
    let weak = WEAK_DOUBT * (WEAK / energy.max(WEAK)).sqrt();
    (LEAST_DOUBT + weak).min(MOST_DOUBT)
}
