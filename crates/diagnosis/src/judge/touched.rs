//! Verdicts on single postures at which something is touched.

use haptical_calibration::Channel;
use haptical_effects::Stream;

use crate::Result;
use crate::answer::{Asked, Dependence, Verdict};
use crate::engine::Engine;
use crate::judge::{Findings, dependences};
use crate::noise::is_stated;
use crate::thresholds::chance::FAMILY_WISE_P;
use crate::thresholds::dependence::DEPENDENCE_P;
use crate::thresholds::noise::ROUGHEST_TOUCH_M;

/// Touches of a recording, and what their residuals depend on.
#[derive(Debug, Default)]
pub(crate) struct Touched {
    /// Whether the rows are single postures.
    pub(crate) are_postures: bool,
    /// Of single postures at which nothing is touched: a gap that depends on no joint's angle or torque.
    is_alike: bool,
    /// Of the same: what explains most of it is no function of a posture: the row before it, time, temperature.
    is_by_row: bool,
    /// Asked only where no cause is named.
    pub(crate) dependence: Vec<Dependence>,
    /// Of unstated noise: its size by what the model leaves is more than a touch can have \[m\].
    is_rough: bool,
    noise_is_unknown: bool,
    /// A warning where the noise had to be taken from what the model leaves.
    pub(crate) unstated: Option<String>,
}

impl Touched {
    /// Asks what the residuals depend on, where the verdict names no cause.
    pub(crate) fn new(engine: &Engine<'_>, verdict: Verdict) -> Result<Self> {
        let context = &engine.context;
        if context.ordered {
            return Ok(Self::default());
        }
        let dependences = || dependences(context, &engine.system);
        if !context.streams.iter().any(Stream::is_touch) {
            let dependence = match verdict {
                // external encoders alone: free functions find the place
                Verdict::Unknown if context.device.has_links() => dependences()?,
                _ => Vec::new(),
            };
            let first = dependence
                .first()
                .filter(|found| found.p_adjusted < DEPENDENCE_P);
            return Ok(Self {
                is_alike: !dependence.is_empty() && first.is_none(),
                is_by_row: first
                    .is_some_and(|found| matches!(found.asked, Asked::Course | Asked::Side)),
                dependence,
                ..Self::default()
            });
        }
        let dependence = match verdict {
            Verdict::NoGap | Verdict::Unknown => dependences()?,
            Verdict::Named | Verdict::Ambiguous => Vec::new(),
        };
        let contact = context.streams.iter().filter(|stream| stream.is_touch());
        let unstated = contact
            .map(|stream| stream.channel)
            .find(|channel| !is_stated(context.device, *channel))
            .map(|channel| {
                let section = if channel == Channel::Plane { "plane" } else { "contact" };
                format!(
                    "the rig states no [{section}] sd_m: the noise of touches is taken from what the model \
                     leaves, so only what depends on the posture shows as a gap"
                )
            });
        let noise_is_unknown = engine.is_noise_unknown();
        let mut touched = (0..context.streams.len()).filter(|&s| context.streams[s].is_touch());
        Ok(Self {
            are_postures: true,
            is_rough: noise_is_unknown && touched.any(|s| engine.floor[s] > ROUGHEST_TOUCH_M),
            noise_is_unknown,
            dependence,
            unstated,
            ..Self::default()
        })
    }

    /// Whether what the residuals depend on says where a gap is, rather than what free functions take up: these
    /// find a place for noise too, and one for a drift.
    pub(crate) fn says_where(&self) -> bool {
        self.are_postures || self.is_alike || self.is_by_row
    }

    /// The verdict, where no cause is named: without a stated noise a gap is what depends on the posture more
    /// surely than by chance, or is larger than the noise of any touch.
    /// `has_terms`: the earlier model has a term wrong.
    pub(crate) fn verdict(
        &self,
        findings: &Findings<'_>,
        verdict: Verdict,
        has_terms: bool,
    ) -> Verdict {
        if !findings.selection.causes().is_empty() {
            return verdict;
        }
        let mut dependence = self.dependence.iter();
        let is_structured = dependence.any(|found| found.p_adjusted < FAMILY_WISE_P);
        let is_structured = is_structured || self.is_rough;
        let is_noise = self.noise_is_unknown && findings.adequacy.is_noise();
        match verdict {
            Verdict::NoGap if is_structured => Verdict::Unknown,
            Verdict::Unknown if is_noise && !is_structured && has_terms => Verdict::Named,
            Verdict::Unknown if is_noise && !is_structured => Verdict::NoGap,
            other => other,
        }
    }
}
