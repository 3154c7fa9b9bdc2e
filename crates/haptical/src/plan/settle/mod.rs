//! The next recording, chosen: what tells the candidates of an ambiguous or unknown diagnosis apart.

mod gap_file;
mod recorded;
mod text;
mod whole;

use haptical_design::{DesignError, Limits, Motion, Motions, Request, path, pieces};
use haptical_diagnosis::{Odds, Question, Settler};
use haptical_model::Recording;
use serde::Serialize;

use super::flags;
use crate::device::Device;
use crate::diagnose::joined;
use crate::error::Error;
use crate::files::{NewFile, PLAN_FILES, Record, VERSION, sealed_json};
use crate::log::Log;

pub use self::gap_file::GapFile;
use self::recorded::{last_degc, press_n, rate_hz, torques_unknown};
use self::whole::{Found, Told, wholes};

/// Motions to choose from unless said otherwise.
const CANDIDATES: usize = 240;
/// How the next recording is chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct SettleRequest {
    /// Its rows at most; none for as many as the recording so far has. It is longer than that one only as far as odds of 20 : 1
    /// need it.
    pub rows: Option<usize>,
    /// Motions to choose from.
    pub candidates: usize,
    /// Limits of the poses.
    pub limits: Limits,
    /// Seed of the motions.
    pub seed: u64,
    /// Force with which the hand, or a weight, can press on the handle \[N\]; none for what the log shows.
    pub press_n: Option<f64>,
}

impl Default for SettleRequest {
    fn default() -> Self {
        Self {
            rows: None,
            candidates: CANDIDATES,
            limits: Limits::default(),
            seed: 1,
            press_n: None,
        }
    }
}

/// A recording that is chosen, with what to expect of it: the content of plan.json. It prints as the command's answer.
#[derive(Debug, Clone, Serialize)]
pub struct Settled {
    /// Device file.
    pub device: String,
    /// What to record and what it settles, in a sentence or two.
    pub answer: String,
    /// Verdict that it settles.
    pub verdict: String,
    /// Rows to record.
    pub rows: usize,
    /// Its duration \[s\]; none of single postures.
    pub duration_s: Option<f64>,
    /// What is recorded, piece by piece, in words.
    pub pieces: Vec<String>,
    /// The candidates, best first.
    pub candidates: Vec<String>,
    /// Least odds to expect of the true candidate over another one, whichever it is; none where no motion is expected to tell any pair apart.
    pub least_odds: Option<f64>,
    /// The same of as many motions drawn at random.
    pub least_odds_at_random: Option<f64>,
    /// Temperature with which it starts \[degC\]: the device still as warm as at the end of the log, so that what follows the
    /// temperature is told from what follows the time since the start. None where the log has no temperature.
    pub start_degc: Option<f64>,
    /// Odds of every candidate over every other one, should it be true.
    pub odds: Vec<ExpectedOdds>,
    /// Candidates (if true, other) between which no recording with these sensors and motions lets the true one be named.
    pub inseparable: Vec<[String; 2]>,
    /// What is odd about the device and the logs.
    pub warnings: Vec<String>,
    /// How the choice came about.
    pub provenance: Record,
    /// What to move through.
    #[serde(skip)]
    pub motion: Motion,
    #[serde(skip)]
    columns: Vec<String>,
}

/// Odds of a candidate that is true over another one: their geometric mean over recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExpectedOdds {
    /// The candidate that is taken to be true.
    pub if_true: String,
    /// The other one.
    pub over: String,
    /// Odds so far.
    pub before: f64,
    /// Odds of its being named with the recording: never above what the judge of a diagnosis is sure of.
    pub after: f64,
}

/// A chosen motion with what it is expected to tell.
#[derive(Debug, Clone)]
pub struct Chosen {
    /// Through all pieces.
    pub motion: Motion,
    /// The pieces in words.
    pub pieces: Vec<String>,
    /// Of every ordered pair of candidates.
    pub odds: Vec<Odds>,
    /// Pairs that nothing tells apart, by positions among the candidates.
    pub inseparable: Vec<(usize, usize)>,
    /// As many pieces drawn at random, and their odds.
    pub at_random: (Motion, Vec<Odds>),
    /// Temperature with which it starts \[degC\], that of the end of the recording so far; none where none was recorded.
    pub start_degc: Option<f64>,
    /// The candidates that the device has effects for.
    pub question: Question,
}

/// Chooses the next recording of a device whose recording so far leaves `question` open.
///
/// # Errors
/// A device without limits, a recording that fixes nothing, or nothing that a motion could tell apart.
pub fn choose_next(
    device: &Device,
    recording: &Recording,
    question: &Question,
    request: &SettleRequest,
) -> Result<Chosen, Error> {
    let place = &device.source().path;
    let refuse = |error: DesignError| Error::design(&error, place).with_equipment(device);
    let refused = |error| Error::diagnosis(&error, place, place).with_equipment(device);
    let motions = Motions {
        rate_hz: rate_hz(recording),
        count: request.candidates,
        seed: request.seed,
        press_n: press_n(recording, request.press_n),
    };
    let model = &device.model;
    let drawn = pieces(model, &request.limits, &motions).map_err(refuse)?;
    // a piece along which a transmission has no value is none
    let recorded = |piece: Motion| Some((piece.recording(model, recording).ok()?, piece));
    let (recordings, drawn): (Vec<Recording>, Vec<Motion>) =
        drawn.into_iter().filter_map(recorded).unzip();
    let settler = Settler::new(model, recording, question).map_err(refused)?;
    let ranges: Vec<f64> = (model.joints.iter())
        .map(|joint| (joint.upper_rad - joint.lower_rad).clamp(1e-9, std::f64::consts::TAU))
        .collect();
    let through = |chosen: &[usize]| {
        let own: Vec<&Motion> = chosen.iter().map(|piece| &drawn[*piece]).collect();
        path(&own, &ranges, motions.rate_hz)
    };
    let all = settler.pieces(&recordings).map_err(refused)?;
    // as many pieces as fit, the ways between them counted
    let fitting = |rows: usize| {
        let length = |count: usize| through(&(0..count).collect::<Vec<_>>()).len();
        let more = (2..=drawn.len()).take_while(|count| length(*count) <= rows);
        1 + more.count()
    };
    let of_rows = |rows: usize| -> Result<Found, Error> {
        let count = fitting(rows);
        let chosen = settler.choose(&all, count);
        let mut told: Vec<Told> = Vec::new();
        for pieces in wholes(chosen, &all.lasting, drawn.len(), count) {
            let motion = through(&pieces);
            let next = motion.recording(model, recording).map_err(refuse)?;
            let odds = settler.odds(&next).map_err(refused)?;
            told.push(Told {
                pieces,
                motion,
                odds,
            });
        }
        Ok(Found::of(told, &all.of_all))
    };
    let mut most_rows = request.rows.unwrap_or(recording.len());
    if settler.has_drift() {
        most_rows = most_rows.min(recording.len());
    }
    let mut rows = recording.len().clamp(1, most_rows.max(1));
    let mut found = of_rows(rows)?;
    while !found.is_enough() && rows < most_rows {
        rows = (rows + recording.len().max(1)).min(most_rows);
        found = of_rows(rows)?;
    }
    let (best, at_random) = (found.best, found.at_random);
    Ok(Chosen {
        pieces: (best.pieces.iter())
            .map(|piece| drawn[*piece].words.clone())
            .collect(),
        odds: best.odds,
        at_random: (at_random.motion, at_random.odds),
        start_degc: last_degc(recording),
        question: settler.question().clone(),
        motion: best.motion,
        inseparable: found.inseparable,
    })
}

/// Chooses the next recording for a diagnosis that `haptical diagnose` left open; `logs` are those that it was made from.
///
/// # Errors
/// Logs that the diagnosis was not made from, and as [`choose_next`].
pub fn settle(
    device: &Device,
    logs: &[&Log],
    gap: &GapFile,
    request: &SettleRequest,
) -> Result<Settled, Error> {
    settle_as(VERSION, device, logs, gap, request)
}

/// The same under the name of another version, for a result that is made again.
///
/// # Errors
/// As [`settle`].
pub fn settle_as(
    version: &str,
    device: &Device,
    logs: &[&Log],
    gap: &GapFile,
    request: &SettleRequest,
) -> Result<Settled, Error> {
    device.refuse_hands("a plan")?;
    gap.refuse_other_logs(logs)?;
    let recording = joined(logs)?;
    let chosen = choose_next(device, &recording, gap.question(), request)?;
    let mut warnings = device.warnings.clone();
    warnings.extend(logs.iter().flat_map(|log| log.warnings.iter().cloned()));
    warnings.extend(torques_unknown(device, &recording));
    let mut inputs = device.inputs("device");
    inputs.push(gap.input().clone());
    inputs.extend(logs.iter().filter_map(|log| log.input("log")));
    let mut flags: Vec<String> = device.equipment().chain_flags().collect();
    flags.extend(request.rows.map(|rows| format!("--rows={rows}")));
    flags.extend(request.press_n.map(|newtons| format!("--press={newtons}")));
    flags.extend(flags::from_request(&Request {
        candidates: request.candidates,
        seed: request.seed,
        limits: request.limits,
        ..Request::default()
    }));
    let mut provenance = Record::of(version, "plan", inputs, flags);
    provenance.seeds.insert("motions", request.seed);
    Ok(Settled::new(device, gap, chosen, warnings, provenance))
}

impl Settled {
    fn new(
        device: &Device,
        gap: &GapFile,
        chosen: Chosen,
        warnings: Vec<String>,
        provenance: Record,
    ) -> Self {
        let names: Vec<String> = (chosen.question.candidates.iter())
            .map(haptical_diagnosis::Candidate::label)
            .collect();
        let odds = |nats: f64| nats.min(MOST_NATS).exp();
        let least = |all: &[Odds]| Odds::least_nats(all, &chosen.inseparable).map(odds);
        let mut settled = Self {
            device: device.source().label.clone(),
            answer: String::new(),
            verdict: gap.verdict().to_owned(),
            rows: chosen.motion.len(),
            duration_s: (chosen.motion.time_s.as_ref()).and_then(|times| times.last().copied()),
            least_odds: least(&chosen.odds),
            least_odds_at_random: least(&chosen.at_random.1),
            odds: (chosen.odds.iter())
                .map(|own| ExpectedOdds {
                    if_true: names[own.is_true].clone(),
                    over: names[own.other].clone(),
                    before: odds(own.nats_before),
                    after: odds(own.nats_after),
                })
                .collect(),
            start_degc: chosen.start_degc,
            inseparable: (chosen.inseparable.iter())
                .map(|(is_true, other)| [names[*is_true].clone(), names[*other].clone()])
                .collect(),
            candidates: names,
            pieces: chosen.pieces,
            motion: chosen.motion,
            columns: device.joint_columns(),
            warnings,
            provenance,
        };
        settled.answer = text::answer(&settled);
        settled
    }

    /// The files, as they are written: plan.json, and poses.csv with the motion, row by row.
    ///
    /// # Errors
    /// A fault of this library alone.
    pub fn files(&self) -> Result<Vec<NewFile<'static>>, Error> {
        let [json_name, _, _, poses_name] = PLAN_FILES;
        let mut files: Vec<NewFile<'static>> = vec![(poses_name, self.poses_csv()?)];
        let mut sealed = self.clone();
        sealed.provenance = sealed.provenance.with_outputs(&files);
        files.insert(0, (json_name, sealed_json(&sealed)?.into_bytes()));
        Ok(files)
    }

    /// The joints' columns of a log, with times and forces where there are any.
    fn poses_csv(&self) -> Result<Vec<u8>, Error> {
        let joints = self.columns.iter().map(String::as_str);
        let mut columns: Vec<(&str, &Vec<f64>)> = Vec::new();
        columns.extend(self.motion.time_s.iter().map(|times| ("time_s", times)));
        columns.extend(joints.zip(&self.motion.joint));
        columns.extend(FORCES.into_iter().zip(self.motion.force_n.iter().flatten()));
        let mut writer = csv::Writer::from_writer(Vec::new());
        let header = columns.iter().map(|(name, _)| *name);
        writer.write_record(header).map_err(Error::internal)?;
        for row in 0..self.motion.len() {
            // a millionth of a radian, a second or a newton is more than anyone follows
            let cells = columns.iter();
            let cells = cells.map(|(_, column)| format!("{:.6}", column[row]));
            writer.write_record(cells).map_err(Error::internal)?;
        }
        writer.into_inner().map_err(Error::internal)
    }
}

/// Columns of the force on the handle, as in a log.
const FORCES: [&str; 3] = ["fx_n", "fy_n", "fz_n"];
/// Nats of the largest odds that are told: 1e12.
const MOST_NATS: f64 = 27.631_021_115_928_547;

impl std::fmt::Display for Settled {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        text::write(formatter, self)
    }
}
