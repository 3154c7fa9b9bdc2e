//! What the judge of a diagnosis makes of evidence: names that stay uncertain however much is recorded.

use haptical_effects::{Context, Effect, Family};

use super::gram::Told;
use crate::judge::{doubt, follows_time, most_nats};
use crate::thresholds::fit::WINDOW_S;
use crate::thresholds::rivals::{LOOK_ALIKE, SETTLING, STEADY};

/// When rows were recorded since the start of their run \[s\], and how warm it was \[K\]; empty where either is not known.
#[derive(Debug, Clone, Default)]
pub(super) struct Courses {
    elapsed_s: Vec<f64>,
    warming_k: Vec<f64>,
}

impl Courses {
    pub(super) fn of(context: &Context<'_>) -> Self {
        match (context.elapsed_s(), &context.warming_k) {
            (Some(elapsed_s), Some(warming_k)) => Self {
                elapsed_s,
                warming_k: warming_k.clone(),
            },
            _ => Self::default(),
        }
    }

    /// One recording after the other.
    pub(super) fn extend(&mut self, other: &Self) {
        self.elapsed_s.extend_from_slice(&other.elapsed_s);
        self.warming_k.extend_from_slice(&other.warming_k);
    }

    pub(super) fn warming(&self) -> Warming {
        match self.elapsed_s.is_empty() {
            true => Warming::Unknown,
            false if follows_time(&self.warming_k, &self.elapsed_s) => Warming::FollowsTime,
            false => Warming::OfItsOwn,
        }
    }
}

/// The course of the temperature over all recordings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Warming {
    Unknown,
    /// It is a settling function of time.
    FollowsTime,
    OfItsOwn,
}

/// Number of windows in which the judge compares what is left with noise: of a motion a quarter of a second each.
pub(super) fn windows(context: &Context<'_>) -> f64 {
    let rows = context.rows() as f64;
    let per_stream = match context.recording.time_s.is_some() && context.ordered {
        true => rows * context.step_s() / WINDOW_S,
        false => rows,
    };
    per_stream * context.streams.len() as f64
}

/// A candidate as the judge sees it.
#[derive(Debug)]
pub(super) struct Judged<'e> {
    pub(super) effect: &'e dyn Effect,
    /// Whether it is a drift that settles.
    pub(super) settles: bool,
    /// Whether every look-alike of a drift can be tested with these sensors.
    pub(super) look_alikes_are_tried: bool,
}

impl Judged<'_> {
    /// Log-odds of its being named rather than `other`, if it is true and its raw log-odds are `nats`; `told` is what all
    /// recordings tell, `windows` their number.
    pub(super) fn nats(&self, other: &Self, nats: f64, told: Told, warming: Warming) -> f64 {
        let share = told.imitated();
        let follows_time = warming == Warming::FollowsTime;
        let most = most_nats(self.effect, other.effect, share, follows_time);
        let nats = nats.min(most.unwrap_or(f64::INFINITY));
        let sure = (1.0 - doubt(2.0 * told.whole)) * self.sureness(other, share, warming);
        // of its probability, p = sure / (1 + exp(-nats)), the log-odds
        let wrong = 1.0 + (-nats).exp() - sure;
        sure.ln() - wrong.ln()
    }

    /// Share of its probability that a drift keeps (docs/assumptions.md, A62).
    fn sureness(&self, other: &Self, share: f64, warming: Warming) -> f64 {
        let spec = self.effect.spec();
        if spec.family != Family::Drift {
            return 1.0;
        }
        let is_alike = other.effect.joint() == self.effect.joint()
            && spec.look_alikes.contains(&other.effect.name())
            && share > LOOK_ALIKE;
        let is_seen_again = self.look_alikes_are_tried && !is_alike && warming == Warming::OfItsOwn;
        match is_seen_again {
            true => 1.0,
            false if self.settles => SETTLING,
            false if !spec.look_alikes.is_empty() => STEADY,
            false => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use haptical_effects::catalogue;
    use haptical_model::Device;

    use super::*;

    /// Where axes intersect, an axis that wobbles and a cable routed over a joint look alike but for what their laws get
    /// wrong: more rows of the same do not tell them apart, another motion does.
    #[test]
    fn what_laws_leave_open_no_evidence_decides() {
        let two = "[[joint]]\ntransmission = \"direct\"\ntransmission_ratio = 1.0\n".repeat(2);
        let device = Device::from_toml(&two, "two.toml").unwrap().device;
        let all = catalogue(&device);
        let judged = |name: &str| Judged {
            effect: all.iter().find(|own| own.name() == name).unwrap().as_ref(),
            settles: false,
            look_alikes_are_tried: true,
        };
        let (wobble, coupling) = (judged("axis-wobble"), judged("cross-coupling"));
        let nats = |distance: f64| {
            let told = Told {
                distance,
                whole: 1e5,
            };
            wobble.nats(&coupling, distance, told, Warming::OfItsOwn)
        };
        assert!(nats(1e3) < 3.3, "{}", nats(1e3));
        assert!(nats(1e4) > 4.0, "{}", nats(1e4));
    }
}
