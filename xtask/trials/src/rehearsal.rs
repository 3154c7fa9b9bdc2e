//! A few trials tried beforehand, on all cores: how long the batch will take, and whether answers repeat.

use anyhow::Result;
use xtask_blind::sha256_hex;

use super::batch::{Batch, Fixed};
use super::subject::Given;

const TRIALS: usize = 3;

#[derive(Debug, Clone)]
pub(crate) struct Rehearsal {
    /// Number of the trial in the batch, and the SHA-256 of its gap.json.
    answers: Vec<(usize, Option<String>)>,
    /// Mean time of a trial \[s\].
    mean_s: f64,
}

impl Batch {
    /// Diagnoses the first trial, and others evenly spread over the batch.
    pub(crate) fn rehearse(&self) -> Result<Rehearsal> {
        let mut rehearsal = Rehearsal {
            answers: Vec::new(),
            mean_s: 0.0,
        };
        let step = self.trials.len().div_ceil(TRIALS).max(1);
        for number in (0..self.trials.len()).step_by(step) {
            let (suite, index) = self.trials[number];
            let start = std::time::Instant::now();
            let given = Given::from_trial(suite, &suite.draw(index, self.seed)?)?;
            let answered = given.answer().ok();
            rehearsal.mean_s += start.elapsed().as_secs_f64();
            let sha256 = answered.map(|answered| sha256_hex(&answered.gap_json));
            rehearsal.answers.push((number, sha256));
        }
        rehearsal.mean_s /= rehearsal.answers.len().max(1) as f64;
        Ok(rehearsal)
    }
}

impl Rehearsal {
    /// `1360 trials, about 12 min on 2 threads`.
    pub(crate) fn words(&self, batch: &Batch) -> String {
        let (trials, jobs) = (batch.trials.len(), batch.jobs);
        let time_s = self.mean_s * trials as f64 / jobs.min(trials.max(1)) as f64;
        let time = if time_s < 90.0 {
            format!("{time_s:.0} s")
        } else {
            format!("{:.0} min", time_s / 60.0)
        };
        format!("{trials} trials, about {time} on {jobs} threads")
    }

    /// Whether the batch has the same answers.
    pub(crate) fn agrees(&self, fixed: &[Fixed]) -> bool {
        self.answers.iter().all(|(number, sha256)| {
            let again = fixed.get(*number);
            again.is_some_and(|again| again.sha256() == sha256.as_deref())
        })
    }
}
