//! The content of gap.json: the diagnosis with what it was made from.

use haptical_diagnosis::{
    CandidateAnswer, CauseAnswer, Detectable, Diagnosis, Gap, Hint, Invisible, NoiseAnswer, Place,
    Provenance, Untestable, Verdict,
};
use serde::Serialize;

use crate::error::Error;
use crate::files::{Record, sealed_json};

/// A diagnosis, and the names of its files as results give them.
#[derive(Debug)]
pub(super) struct GapFile<'a> {
    pub(super) diagnosis: &'a Diagnosis,
    pub(super) device: String,
    pub(super) log: String,
    /// Second log; none where blocks of the first were held out.
    pub(super) validate: Option<String>,
    /// Model identified earlier; none where it was identified from the log.
    pub(super) model: Option<String>,
    pub(super) record: Record,
}

/// gap.json: every field of the diagnosis that is no picture, and in `provenance` both what the answer
/// rests on and how the file came about.
#[derive(Debug, Serialize)]
struct GapJson<'a> {
    verdict: Verdict,
    gap: &'a Gap,
    r#where: &'a Option<Place>,
    causes: &'a [CauseAnswer],
    unexplained_share: f64,
    probability_unknown: f64,
    untestable: &'a [Untestable],
    invisible: &'a [Invisible],
    detectable: &'a [Detectable],
    noise: &'a [NoiseAnswer],
    candidates: &'a [CandidateAnswer],
    plausibility: &'a [Hint],
    next_experiment: &'a Option<String>,
    warnings: &'a [String],
    held_out: &'a str,
    provenance: GapProvenance<'a>,
    haptical_version: &'a str,
    device: &'a str,
    log: &'a str,
    validate: &'a Option<String>,
    model: &'a Option<String>,
}

#[derive(Debug, Serialize)]
struct GapProvenance<'a> {
    #[serde(flatten)]
    answer: &'a Provenance,
    #[serde(flatten)]
    record: &'a Record,
}

impl GapFile<'_> {
    /// The text of the file.
    pub(super) fn to_json(&self) -> Result<String, Error> {
        // Without `..`, so that a new field of the diagnosis is not forgotten here.
        let Diagnosis {
            verdict,
            gap,
            place,
            causes,
            unexplained_share,
            probability_unknown,
            untestable,
            invisible,
            detectable,
            noise,
            candidates,
            plausibility,
            next_experiment,
            warnings,
            held_out,
            provenance,
            device: _,
            traces: _,
            predictions: _,
        } = self.diagnosis;
        sealed_json(&GapJson {
            verdict: *verdict,
            gap,
            r#where: place,
            causes,
            unexplained_share: *unexplained_share,
            probability_unknown: *probability_unknown,
            untestable,
            invisible,
            detectable,
            noise,
            candidates,
            plausibility,
            next_experiment,
            warnings,
            held_out,
            provenance: GapProvenance {
                answer: provenance,
                record: &self.record,
            },
            haptical_version: &self.record.haptical_version,
            device: &self.device,
            log: &self.log,
            validate: &self.validate,
            model: &self.model,
        })
    }
}
