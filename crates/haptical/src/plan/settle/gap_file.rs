//! gap.json, as far as a plan reads it.

use std::collections::BTreeMap;

use haptical_diagnosis::{Candidate, Question};
use serde::Deserialize;

use crate::error::Error;
use crate::files::{InputFile, Source};
use crate::log::Log;

/// A diagnosis as `haptical diagnose` writes it: what it leaves open.
#[derive(Debug, Clone)]
pub struct GapFile {
    question: Question,
    verdict: String,
    logs: Vec<InputFile>,
    source: Source,
    input: InputFile,
}

#[derive(Deserialize)]
struct Written {
    verdict: String,
    candidates: Vec<WrittenCandidate>,
    causes: Vec<WrittenCause>,
    provenance: WrittenProvenance,
}

#[derive(Deserialize)]
struct WrittenCandidate {
    effect: String,
    joint: Option<usize>,
    nats_behind: f64,
    #[serde(default)]
    parameters: BTreeMap<String, f64>,
}

#[derive(Deserialize)]
struct WrittenCause {
    effect: String,
    joint: Option<usize>,
    parameters: BTreeMap<String, WrittenNumber>,
}

#[derive(Deserialize)]
struct WrittenNumber {
    value: f64,
}

#[derive(Deserialize)]
struct WrittenProvenance {
    inputs: Vec<InputFile>,
}

impl GapFile {
    /// Reads what a diagnosis leaves open.
    ///
    /// # Errors
    /// A file that is no gap.json, one whose verdict leaves nothing open, or one in which fewer than two candidates have a size.
    pub fn open(source: &Source) -> Result<Self, Error> {
        let text = source.read_text()?;
        let refuse =
            |name, what: String, next: &str| Error::in_file(name, what, &source.path, next);
        let written: Written = serde_json::from_str(&text).map_err(|error| {
            let next = "give the gap.json that `haptical diagnose --out` writes, or its --json";
            refuse(
                "not-a-diagnosis",
                format!("it is no gap.json: {error}"),
                next,
            )
        })?;
        let verdict = written.verdict;
        if !["ambiguous", "unknown"].contains(&verdict.as_str()) {
            let what = format!("its verdict is {verdict}: there is nothing to settle");
            let next = "record what `haptical diagnose` says under \"next\"";
            return Err(refuse("settled", what, next));
        }
        let candidates = written.candidates.into_iter().map(|own| Candidate {
            effect: own.effect,
            joint: own.joint,
            numbers: own.parameters,
            nats_behind: own.nats_behind,
        });
        let beside = written.causes.into_iter().skip(1).map(|own| Candidate {
            effect: own.effect,
            joint: own.joint,
            numbers: (own.parameters.into_iter())
                .map(|(name, number)| (name, number.value))
                .collect(),
            nats_behind: 0.0,
        });
        let Some(question) = Question::new(candidates.collect(), beside.collect()) else {
            let what = format!(
                "its verdict is {verdict}, and fewer than two candidates have a size: no recording can be chosen by them"
            );
            let next = "record what `haptical diagnose` says under \"next\"; a file of an earlier version has no sizes: \
                        diagnose again";
            return Err(refuse("no-candidates", what, next));
        };
        let mut logs = written.provenance.inputs;
        logs.retain(|input| input.flag == "log");
        Ok(Self {
            question,
            verdict,
            logs,
            input: source.input("settle", source.fingerprint_text(&text)),
            source: source.clone(),
        })
    }

    /// Candidates that are to be told apart, and the causes beside them.
    pub fn question(&self) -> &Question {
        &self.question
    }

    /// `ambiguous` or `unknown`.
    pub fn verdict(&self) -> &str {
        &self.verdict
    }

    pub(super) fn input(&self) -> &InputFile {
        &self.input
    }

    /// The odds so far are those of its own logs.
    pub(super) fn refuse_other_logs(&self, logs: &[&Log]) -> Result<(), Error> {
        let given: Vec<InputFile> = logs.iter().filter_map(|log| log.input("log")).collect();
        if given.len() < logs.len() {
            // columns in memory have no file
            return Ok(());
        }
        let hashes = |files: &[InputFile]| {
            let mut hashes: Vec<String> = files.iter().map(|file| file.sha256.clone()).collect();
            hashes.sort_unstable();
            hashes
        };
        if hashes(&given) == hashes(&self.logs) {
            return Ok(());
        }
        let names: Vec<&str> = self.logs.iter().map(|file| file.file.as_str()).collect();
        let what = "it was made from other logs than those of --log";
        let next = format!("give the logs that it was made from: {}", names.join(", "));
        Err(Error::in_file("other-logs", what, &self.source.path, next))
    }
}
