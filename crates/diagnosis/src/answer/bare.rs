//! A diagnosis of which nothing is said but its verdict and causes.

use haptical_model::Device;

use super::{CauseAnswer, Diagnosis, FitRows, Gap, Provenance, Verdict, Whiteness};

impl Diagnosis {
    /// An answer of a verdict, its gap and its causes, with nothing else to say.
    pub(crate) fn of_causes(
        verdict: Verdict,
        gap: Gap,
        causes: Vec<CauseAnswer>,
        device: Device,
        provenance: Provenance,
    ) -> Self {
        Self {
            probability_unknown: match (verdict, causes.first()) {
                (Verdict::NoGap, _) => 0.0,
                (Verdict::Unknown, _) | (_, None) => 1.0,
                (_, Some(first)) => 1.0 - first.class_probability,
            },
            verdict,
            gap,
            place: None,
            causes,
            absorbed: None,
            unexplained_share: 0.0,
            closed_unseen_share: None,
            own_effects_leave: None,
            second: None,
            correction: None,
            correction_refused: None,
            not_in_file: Vec::new(),
            untestable: Vec::new(),
            invisible: Vec::new(),
            detectable: Vec::new(),
            noise: Vec::new(),
            whiteness: Whiteness::default(),
            candidates: Vec::new(),
            plausibility: Vec::new(),
            next_experiment: None,
            warnings: Vec::new(),
            held_out: String::new(),
            provenance,
            device,
            corrected: None,
            fit_rows: FitRows::default(),
            steps: Vec::new(),
            traces: Vec::new(),
            predictions: Vec::new(),
        }
    }
}
