//! What to record next.

use crate::answer::{Finding, Verdict};
use crate::effect::{friction, gain, lag, latency, offset, saturation};
use crate::thresholds::ALL_CLOSED;

/// Which motion would tell what this one cannot.
pub(crate) fn next(verdict: Verdict, causes: &[Finding], closed: f64) -> Option<String> {
    if verdict == Verdict::NoGap {
        return None;
    }
    let first = causes.first();
    let rivals = first.map_or(&[][..], |cause| &cause.confusable_with[..]);
    let text = match first.map(|cause| cause.effect) {
        Some(_) if first.is_some_and(|cause| cause.since.is_some()) => {
            "look at what was done to the joint then; the same motion once more says whether it lasts"
        }
        Some(friction::NAME) => {
            "hold a command and push the joint by hand: friction leaves it where it was pushed to, a dead zone lets go at its two \
             edges, and play shows on the link while the reading stands"
        }
        Some(latency::NAME | lag::NAME) if !rivals.is_empty() => {
            "steps of the command of several sizes, recorded as fast as the bus allows: a delay keeps the joint still and then \
             starts it at full speed, a low gain starts it at once and slowly; then once with a higher gain"
        }
        Some(offset::NAME) if !rivals.is_empty() => {
            "rest in postures far apart, with the joint's axis upright and level: an offset stays, a droop follows the weight"
        }
        Some(gain::NAME) if !rivals.is_empty() => {
            "move through a wide range with the joint's axis upright: a factor stays, a droop under gravity does not"
        }
        Some(saturation::NAME) => {
            "the same motion at half the size: a limit of speed is gone then, a lag keeps its time"
        }
        Some(_) if closed > ALL_CLOSED => return None,
        _ => {
            "move this joint alone, slowly through its range and back with rests, then in steps: what is at rest is offset, droop \
             or friction, what moves is lag"
        }
    };
    Some(text.to_owned())
}
