//! Whether what passes for noise is: tests over frequency, time, posture and direction of approach
//! (docs/diagnosis.md, "Noise or structure").

use haptical_metrics::holm_adjusted;

use crate::Result;
use crate::answer::{Asked, Dependence, Located, Over, Whiteness, by_dependence};
use crate::engine::Engine;
use crate::judge::dependences;
use crate::noise::{Peak, surest_peak};
use crate::select::{Covariate, Selection};
use crate::thresholds::chance::FAMILY_WISE_P;

/// Tests of a residual, with what they found.
#[derive(Debug, Default)]
pub(crate) struct Tested {
    pub(crate) answer: Whiteness,
    /// Everything that was asked of the blocks, surest first; probabilities are for all tests together.
    dependence: Vec<Dependence>,
    /// The surest peak, its stream, and its probability for all tests together.
    peak: Option<(usize, Peak, f64)>,
}

impl Tested {
    /// Tests what the base model leaves, no cause taken up.
    pub(crate) fn new(engine: &Engine<'_>) -> Result<Self> {
        let context = &engine.context;
        let mut dependence = dependences(context, &engine.system)?;
        let streams = 0..context.streams.len();
        let peaks: Vec<(usize, Peak)> = streams
            .filter_map(|stream| {
                let residual = &engine.start.residual[stream];
                Some((stream, surest_peak(context, stream, residual)?))
            })
            .collect();
        let mut p: Vec<f64> = dependence.iter().map(|found| found.p_value).collect();
        p.extend(peaks.iter().map(|(_, peak)| peak.p_value));
        if p.is_empty() {
            return Ok(Self::default());
        }
        let adjusted = holm_adjusted(&p)?;
        for (found, p_adjusted) in dependence.iter_mut().zip(&adjusted) {
            found.p_adjusted = *p_adjusted;
        }
        let of_peaks = &adjusted[dependence.len()..];
        let mut over: Vec<Over> = dependence.iter().map(|found| over(found.asked)).collect();
        over.extend(peaks.first().map(|_| Over::Frequency));
        over.sort_unstable();
        over.dedup();
        let peak = peaks
            .into_iter()
            .zip(of_peaks)
            .map(|((stream, peak), p)| (stream, peak, *p))
            .min_by(|a, b| a.2.total_cmp(&b.2));
        let surest = dependence
            .iter()
            .min_by(|a, b| a.p_adjusted.total_cmp(&b.p_adjusted));
        let by_peak = peak.as_ref().map(|(stream, peak, p)| {
            let name = context.streams[*stream].name();
            (*p, format!("a frequency of {:.3} Hz in {name}", peak.hz))
        });
        let by_dependence = surest.map(|found| (found.p_adjusted, found.on.clone()));
        let least = [by_dependence, by_peak];
        let least = least
            .into_iter()
            .flatten()
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let (least_p_adjusted, on) = least.unzip();
        Ok(Self {
            answer: Whiteness {
                tests: p.len(),
                over,
                least_p_adjusted,
                on,
            },
            dependence,
            peak,
        })
    }

    /// Whether any test finds structure, more surely than by chance.
    pub(crate) fn is_structured(&self) -> bool {
        self.answer
            .least_p_adjusted
            .is_some_and(|p| p < FAMILY_WISE_P)
    }

    /// Where the structure is.
    pub(crate) fn located(&self, selection: &Selection<'_>) -> Option<Located> {
        let context = &selection.engine().context;
        let surest = self
            .dependence
            .iter()
            .map(|found| found.p_adjusted)
            .fold(1.0, f64::min);
        let peak = self.peak.as_ref();
        match peak.filter(|(_, _, p)| *p < FAMILY_WISE_P && *p <= surest) {
            None => by_dependence(selection, self.dependence.clone()),
            Some((stream, peak, p)) => {
                let stream = *stream;
                let region = format!(
                    "it oscillates near {:.3} Hz (probability by chance {p:.1e}), with an amplitude of {:.3e} {}",
                    peak.hz, peak.amplitude, context.streams[stream].unit
                );
                let joint = context.streams[stream].joint();
                let located = Located::new(context, stream, joint, Covariate::Time, region)?;
                Some(located.with_dependence(self.dependence.clone()))
            }
        }
    }
}

fn over(asked: Asked) -> Over {
    match asked {
        Asked::Angle | Asked::Torque => Over::Posture,
        Asked::Side | Asked::Approach => Over::Approach,
        Asked::Course => Over::Time,
    }
}
