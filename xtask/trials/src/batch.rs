//! A batch in its three acts: seal every truth, fix every answer, open and judge.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, ensure};
use serde::Serialize;
use xtask_blind::{
    Answer, Random, Sealed, Suite, TrialScore, TrueReduction, Truth, judge, judge_refusal, seal,
    sha256_hex, true_reductions, write_moving, write_trial,
};
use xtask_output::Progress;

use super::closing::{Closing, Fit, answer};
use super::subject::Given;
use super::threads::in_parallel;

/// Streams of salts: beyond those of the trials, which are below 2^44.
const SALT_STREAM: u64 = 1 << 60;

/// The trials of a batch and how they are worked on.
#[derive(Debug, Clone)]
pub(crate) struct Batch {
    pub(crate) seed: u64,
    /// Suite and index.
    pub(crate) trials: Vec<(Suite, u64)>,
    /// Threads.
    pub(crate) jobs: usize,
    /// The command that exports corrected devices as C; none where the C is not asked.
    pub(crate) haptical: Option<PathBuf>,
}

/// What may be published before the diagnosis.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) struct Commitment {
    pub(crate) suite: &'static str,
    pub(crate) index: u64,
    pub(crate) commitment: String,
}

/// What may be published before the seals are opened.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) struct Published {
    pub(crate) suite: &'static str,
    pub(crate) index: u64,
    /// SHA-256 of gap.json; absent where there is none.
    pub(crate) answer_sha256: Option<String>,
}

/// An answer, fixed before its truth is opened.
#[derive(Debug)]
pub(crate) struct Fixed {
    /// The answer with the SHA-256 of its gap.json, or why there is none.
    pub(crate) answer: Result<(Answer, String)>,
    /// True reductions of the gap by the answer's predictions.
    pub(crate) reductions: BTreeMap<String, TrueReduction>,
    /// What the corrected device makes of the recording that was kept back, or why nothing; none where there is no such
    /// device or recording.
    pub(crate) closing: Option<Result<Closing>>,
    /// What is said of the effect that was asked for, or why nothing; none where none was.
    pub(crate) fit: Option<Result<Fit>>,
    pub(crate) rows: usize,
    /// Time of the diagnosis on one core \[s\].
    pub(crate) time_s: f64,
}

/// A trial after its truth was opened.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Case {
    pub(crate) suite: &'static str,
    pub(crate) index: u64,
    /// Arguments that run this trial alone, seed included.
    pub(crate) rerun: String,
    pub(crate) commitment: String,
    pub(crate) salt: String,
    /// The text that was committed to.
    pub(crate) truth_json: String,
    /// SHA-256 of gap.json.
    pub(crate) answer_sha256: Option<String>,
    pub(crate) answer: Option<Answer>,
    /// Why there is no answer.
    pub(crate) error: Option<String>,
    /// The same, where that is right.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) refusal: Option<String>,
    pub(crate) score: Option<TrialScore>,
    /// What the corrected device makes of a fresh recording.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) closing: Option<Closing>,
    /// What is said of an effect that is not there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fit: Option<Fit>,
    #[serde(skip)]
    pub(crate) truth: Truth,
    #[serde(skip)]
    pub(crate) rows: usize,
    #[serde(skip)]
    pub(crate) time_s: f64,
}

impl Case {
    /// Arguments that run this trial alone, but for the seed.
    pub(crate) fn arguments(&self) -> String {
        format!("--suite {} --first {} --count 1", self.suite, self.index)
    }
}

/// What there is; why there is not goes where errors go.
fn kept<T>(outcome: Option<Result<T>>, error: &mut Option<String>) -> Option<T> {
    match outcome? {
        Ok(kept) => Some(kept),
        Err(why) => {
            error.get_or_insert(why.to_string());
            None
        }
    }
}

impl Fixed {
    /// SHA-256 of gap.json.
    pub(crate) fn sha256(&self) -> Option<&str> {
        self.answer.as_ref().ok().map(|(_, sha256)| sha256.as_str())
    }
}

impl Batch {
    /// Seals every truth.
    pub(crate) fn seal(&self) -> Result<Vec<Sealed>> {
        self.each("sealing", |number, suite, index| {
            let trial = suite.draw(index, self.seed)?;
            self.sealed(number, &trial.truth)
        })
    }

    /// What `work` makes of the number, the suite and the index of each trial.
    fn each<T: Send>(
        &self,
        what: &str,
        work: impl Fn(usize, Suite, u64) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        let progress = Progress::new(what, self.trials.len());
        let done = in_parallel(self.jobs, self.trials.len(), &progress, |number| {
            let (suite, index) = self.trials[number];
            work(number, suite, index)
        })?;
        done.into_iter().collect()
    }

    pub(crate) fn commitments(&self, sealed: &[Sealed]) -> Vec<Commitment> {
        let pairs = self.trials.iter().zip(sealed);
        let publish = |((suite, index), sealed): (&(Suite, u64), &Sealed)| Commitment {
            suite: suite.name(),
            index: *index,
            commitment: sealed.commitment.clone(),
        };
        pairs.map(publish).collect()
    }

    /// The salt belongs to suite and index, so that a trial that is run alone has the same commitment.
    fn sealed(&self, number: usize, truth: &Truth) -> Result<Sealed> {
        let (suite, index) = self.trials[number];
        let [_, place] = suite.numbers();
        let stream = SALT_STREAM + (place << 40) + index;
        seal(truth, &mut Random::new(self.seed, stream))
    }

    /// Diagnoses every trial.
    pub(crate) fn diagnose(&self, sealed: &[Sealed]) -> Result<Vec<Fixed>> {
        self.each("diagnosing", |number, _, _| {
            self.fixed(number, &sealed[number])
        })
    }

    fn fixed(&self, number: usize, sealed: &Sealed) -> Result<Fixed> {
        let (suite, index) = self.trials[number];
        let trial = suite.draw(index, self.seed)?;
        ensure!(
            self.sealed(number, &trial.truth)? == *sealed,
            "{} {index} is not the trial that was sealed: the generator does not repeat itself",
            suite.name()
        );
        let given = Given::from_trial(suite, &trial)?;
        let answered = given.answer();
        // from here on the answer is what it is
        let mut fixed = Fixed {
            answer: Err(anyhow!("none yet")),
            reductions: BTreeMap::new(),
            closing: None,
            fit: given.fitted(),
            rows: given.log.len(),
            time_s: 0.0,
        };
        fixed.answer = answered.and_then(|answered| {
            fixed.time_s = answered.time_s;
            fixed.reductions = true_reductions(&answered.predictions, &trial.clean2);
            fixed.closing = given.closing(&answered, &trial.clean2, self.haptical.as_deref());
            let gap_json = &answered.gap_json;
            Ok((answer(gap_json)?, sha256_hex(gap_json)))
        });
        Ok(fixed)
    }

    /// What is published of the answers before the seals are opened.
    pub(crate) fn answers(&self, fixed: &[Fixed]) -> Vec<Published> {
        let pairs = self.trials.iter().zip(fixed);
        let publish = |((suite, index), fixed): (&(Suite, u64), &Fixed)| Published {
            suite: suite.name(),
            index: *index,
            answer_sha256: fixed.sha256().map(str::to_owned),
        };
        pairs.map(publish).collect()
    }

    /// Opens the seals and judges the answers.
    pub(crate) fn open(
        &self,
        published: &[Commitment],
        sealed: Vec<Sealed>,
        fixed: Vec<Fixed>,
    ) -> Result<Vec<Case>> {
        let mut cases = Vec::with_capacity(sealed.len());
        for ((commitment, sealed), fixed) in published.iter().zip(sealed).zip(fixed) {
            let Commitment { suite, index, .. } = *commitment;
            let truth = sealed
                .open(&commitment.commitment)
                .with_context(|| format!("{suite} {index}"))?;
            let (answer, answer_sha256, mut error) = match fixed.answer {
                Ok((answer, sha256)) => (Some(answer), Some(sha256), None),
                Err(error) => (None, None, Some(error.to_string())),
            };
            let refused = error.as_ref();
            let refused = refused.and_then(|error| judge_refusal(&truth, error));
            let refusal = refused.as_ref().and_then(|_| error.take());
            // what comes after the answer fails as the answer does
            let closing = kept(fixed.closing, &mut error);
            let fit = kept(fixed.fit, &mut error);
            let score = answer
                .as_ref()
                .map(|answer| judge(&truth, answer, &fixed.reductions))
                .or(refused);
            cases.push(Case {
                suite,
                index,
                rerun: format!(
                    "--suite {suite} --first {index} --count 1 --seed {}",
                    self.seed
                ),
                commitment: sealed.commitment,
                salt: sealed.salt,
                truth_json: sealed.truth_json,
                answer_sha256,
                answer,
                error,
                refusal,
                score,
                closing,
                fit,
                truth,
                rows: fixed.rows,
                time_s: fixed.time_s,
            });
        }
        Ok(cases)
    }

    /// Writes every trial with its truth below `folder`.
    pub(crate) fn dump(&self, folder: &Path) -> Result<()> {
        self.each("writing", |_, suite, index| {
            if suite == Suite::Moving {
                return write_moving(index, self.seed, folder);
            }
            let trial = suite.draw(index, self.seed)?;
            let name = format!("{}-{index:03}-{}", suite.name(), trial.truth.name);
            write_trial(&trial, &folder.join(name), true)
        })
        .map(drop)
    }
}
