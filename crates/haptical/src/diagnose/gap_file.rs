//! The content of gap.json: the diagnosis with what it was made from.

use haptical_diagnosis::{Diagnosis, Provenance};
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

/// gap.json: the diagnosis, and in `provenance` both what the answer rests on and how the file came about.
#[derive(Debug, Serialize)]
struct GapJson<'a> {
    #[serde(flatten)]
    diagnosis: &'a Diagnosis,
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
        sealed_json(&GapJson {
            diagnosis: self.diagnosis,
            provenance: GapProvenance {
                answer: &self.diagnosis.provenance,
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
