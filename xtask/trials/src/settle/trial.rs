//! One trial: diagnosed, and where that is ambiguous recorded again along a chosen motion and along others.

use std::collections::BTreeMap;

use anyhow::{Context, Result, bail};
use haptical::design::Motion;
use haptical::{Chosen, Device, SettleRequest, choose_next};
use haptical_diagnosis::{Diagnosis, Odds, Options, Question, Verdict, diagnose};
use haptical_model::Recording;
use xtask_blind::{Again, Led, Suite, Trial, judge};

use crate::closing::answer;
use crate::subject::guarded;

/// Streams of the seeds of further recordings.
const SEED_OF_FURTHER: u64 = 1 << 32;

/// What became of an ambiguous trial.
#[derive(Debug, Clone)]
pub(super) struct Settled {
    pub(super) suite: &'static str,
    pub(super) index: u64,
    pub(super) name: String,
    /// Candidates that were to be told apart.
    pub(super) candidates: Vec<String>,
    /// Least odds that were expected \[nats\]; none where nothing could be told apart.
    pub(super) expected_nats: Option<f64>,
    /// Whether no motion is expected to tell some candidates apart.
    pub(super) has_inseparable: bool,
    pub(super) chosen: Outcome,
    /// Along motions drawn from the same ones.
    pub(super) at_random: Outcome,
    /// Along a motion like that of the first recording.
    pub(super) by_hand: Outcome,
}

/// Of both recordings together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Outcome {
    /// Named, and rightly.
    Settled,
    /// Named, and wrongly: as what.
    Wrong(String),
    /// Not named: the verdict, or why there is none.
    Open(String),
}

/// Draws a trial; none where its diagnosis is not ambiguous.
pub(super) fn settled(suite: Suite, index: u64, seed: u64, rows: usize) -> Result<Option<Settled>> {
    let drawn = suite.draw_again(index, seed)?;
    let (trial, again) = drawn.context("the suite has no device to record again")?;
    let first = match judged(&trial, &[&trial.log]) {
        Ok((diagnosis, _)) if diagnosis.verdict == Verdict::Ambiguous => diagnosis,
        _ => return Ok(None),
    };
    let seed = seed.wrapping_mul(SEED_OF_FURTHER) + index;
    let outcome = |further: Result<Recording>| match further {
        Ok(further) => match judged(&trial, &[&trial.log, &further]) {
            Ok((_, outcome)) => outcome,
            Err(why) => Outcome::Open(format!("error: {why}")),
        },
        Err(why) => Outcome::Open(why.to_string()),
    };
    let question = Question::of(&first);
    let next = question
        .as_ref()
        .context("no two candidates have a size")
        .and_then(|question| chosen(&trial, question, rows));
    let led = |motion: &Motion, warm_degc, seed| led(&again, motion, warm_degc, seed);
    let along = |further: &dyn Fn(&Chosen) -> Result<Recording>| match &next {
        Ok(next) => further(next),
        Err(why) => bail!("{why}"),
    };
    let length = next.as_ref().map_or(rows, |next| next.motion.len());
    let names = |question: &Question| -> Vec<String> {
        let all = question.candidates.iter();
        all.map(haptical_diagnosis::Candidate::label).collect()
    };
    Ok(Some(Settled {
        suite: suite.name(),
        index,
        name: trial.truth.name.clone(),
        candidates: question.as_ref().map_or_else(Vec::new, names),
        expected_nats: next.as_ref().ok().and_then(least_nats),
        has_inseparable: next.as_ref().is_ok_and(|next| !next.inseparable.is_empty()),
        chosen: outcome(along(&|next| led(&next.motion, next.start_degc, seed))),
        at_random: outcome(along(&|next| led(&next.at_random.0, None, seed + 1))),
        by_hand: outcome(again.drawn(length, seed + 2)),
    }))
}

fn least_nats(next: &Chosen) -> Option<f64> {
    Odds::least_nats(&next.odds, &next.inseparable)
}

/// What `plan --settle` chooses.
fn chosen(trial: &Trial, question: &Question, rows: usize) -> Result<Chosen> {
    let request = SettleRequest {
        rows: Some(rows),
        ..SettleRequest::default()
    };
    let device = Device::from_toml(&trial.device_toml, "device.toml")?;
    guarded(|| Ok(choose_next(&device, &trial.log, question, &request)?))
}

fn led(again: &Again, motion: &Motion, warm_degc: Option<f64>, seed: u64) -> Result<Recording> {
    let rate_hz = motion
        .time_s
        .as_ref()
        .map_or(100.0, |times| match times.as_slice() {
            [first, second, ..] => 1.0 / (second - first),
            _ => 100.0,
        });
    let led = Led {
        angle_rad: &motion.joint,
        rate_hz,
        force_n: motion.force_n.as_ref(),
        warm_degc,
    };
    again.led(&led, seed)
}

/// The diagnosis of recordings together, and whether it names the truth.
fn judged(trial: &Trial, logs: &[&Recording]) -> Result<(Diagnosis, Outcome)> {
    let log = Recording::joined(logs)?;
    let options = Options {
        without: trial.without.clone(),
        ..Options::default()
    };
    let diagnosis = guarded(|| Ok(diagnose(&trial.device, &log, &options)?))?;
    let answer = answer(&serde_json::to_string(&diagnosis)?)?;
    let score = judge(&trial.truth, &answer, &BTreeMap::new());
    let outcome = match diagnosis.verdict {
        Verdict::Named if score.right && score.top_right => Outcome::Settled,
        Verdict::Named => Outcome::Wrong(score.answered.clone()),
        other => Outcome::Open(other.name().to_owned()),
    };
    Ok((diagnosis, outcome))
}
