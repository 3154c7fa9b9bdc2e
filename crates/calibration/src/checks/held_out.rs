//! Rows that are held out of a fit: whole recordings, contiguous blocks, or folds of a short log.

use std::borrow::Cow;

use haptical_model::{Device, Recording};

use crate::CalibrationError;
use crate::checks::postures::{count, leaks, postures, starts};

/// Rows kept back from the fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HeldOut {
    /// A share of the rows: whole runs where the recording has several, contiguous blocks
    /// otherwise, and whole postures where the device dwells so that blocks would check nothing
    /// (docs/equations.md, "Held-out split").
    Share(f64),
    /// None: the fit sees every row.
    None,
    /// So many folds: fold k holds out the rows k, k + folds, ..., each fitted without its own rows; the device
    /// itself is fitted to all rows. For postures that are not neighbours in time.
    Folds(usize),
}

impl Default for HeldOut {
    fn default() -> Self {
        Self::Share(0.2)
    }
}

/// Row indices of fit and check.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Split {
    /// Rows that the fit sees, ascending.
    pub fit: Vec<usize>,
    /// Rows that it does not see, ascending.
    pub held_out: Vec<usize>,
    /// What was held out, in words.
    pub description: String,
}

impl Split {
    /// Splits so many rows, in words of how many of them are held out.
    fn new(
        rows: usize,
        is_held_out: impl Fn(usize) -> bool,
        words: impl FnOnce(usize) -> String,
    ) -> Self {
        let (held_out, fit): (Vec<usize>, Vec<usize>) =
            (0..rows).partition(|&row| is_held_out(row));
        Self {
            description: words(held_out.len()),
            fit,
            held_out,
        }
    }
}

/// In words: a user wants no check.
pub(crate) const NOTHING: &str = "nothing held out";

/// Below this many rows a block of them is too few to judge by: folds are used instead.
pub(crate) const SHORT_LOG: usize = 100;
/// Folds of a recording, unless a user asks for others.
pub(crate) const FOLDS: usize = 10;
/// Most folds: each is a fit of its own.
const MOST_FOLDS: usize = 100;
/// Blocks that a recording is cut into, more for a share of less than one of them; every k-th is
/// held out.
const BLOCKS: usize = 20;

/// Most rows of a log of postures that is checked by folds: ten fits more must not take long.
const MOST_POSTURES: usize = 2000;

/// Whether a recording is one of separate postures, at which something is touched or an unknown tracker looks,
/// rather than of a motion: neighbours in the log say nothing of each other, so blocks would only waste rows.
/// Where the log has several runs, whole runs are held out all the same.
pub(crate) fn is_of_postures(device: &Device, recording: &Recording) -> bool {
    let touches = recording.contact.is_some() || recording.plane.is_some();
    let is_unknown = |tracker: &haptical_model::Tracker| !tracker.base_known || !tracker.tool_known;
    let has_tools = device.has_tools(recording);
    let tracked = recording.position_m.is_some() || recording.orientation_wxyz.is_some();
    let tracked = tracked && (has_tools || device.tracker.as_ref().is_some_and(is_unknown));
    let runs = recording.run.as_ref();
    let one_run = runs.is_none_or(|runs| runs.iter().all(|run| Some(run) == runs.first()));
    (touches || tracked) && one_run && recording.len() <= MOST_POSTURES
}

/// A recording as rows of it may be held out: without its runs where single runs have numbers, such as a tracker place for each or what is
/// displaced from a run on, which nobody knows of a run that no fit saw. Blocks, postures or folds are held out then, of which each run has
/// some in the fit.
///
/// ```
/// use haptical_calibration::without_own_places;
/// use haptical_model::{Device, Recording};
/// let text = "[[joint]]\n[tracker]\nbase = \"per-run\"\n";
/// let device = Device::from_toml(text, "one.toml")?.device;
/// let recording = Recording { run: Some(vec![1, 2]), joint: vec![vec![0.0, 0.1]], ..Recording::default() };
/// assert!(without_own_places(&device, &recording).run.is_none());
/// # Ok::<(), haptical_model::DeviceFileError>(())
/// ```
pub fn without_own_places<'r>(device: &Device, recording: &'r Recording) -> Cow<'r, Recording> {
    if !device.has_numbers_of_runs() || recording.run.is_none() {
        return Cow::Borrowed(recording);
    }
    Cow::Owned(Recording {
        run: None,
        ..recording.clone()
    })
}

/// Splits a recording.
///
/// # Errors
/// [`CalibrationError::Option`] for a share outside 0 to 0.5.
pub fn split(recording: &Recording, held_out: HeldOut) -> Result<Split, CalibrationError> {
    let rows = recording.len();
    let share = check_share(held_out)?;
    if share == 0.0 {
        return Ok(Split::new(rows, |_| false, |_| NOTHING.to_owned()));
    }
    if let Some(split) = by_runs(recording, share) {
        return Ok(split);
    }
    let blocks = by_blocks(rows, share, &starts(recording));
    let dwelt = postures(recording).filter(|own| leaks(own, &blocks.fit, &blocks.held_out));
    Ok(dwelt.map_or(blocks, |own| by_postures(&own, share)))
}

/// Numbers of the postures of a recording whose folds by row would hold out what the fit sees; folds are made of
/// whole postures then.
pub(crate) fn dwelt(recording: &Recording, folds: usize) -> Option<Vec<usize>> {
    let rows = recording.len();
    let own = postures(recording)?;
    let first = self::folds(rows, folds, None).into_iter().next()?;
    leaks(&own, &first.fit, &first.held_out).then_some(own)
}

/// Whether folds are for a log that dwells: it has no runs to hold out, and is not too long to be fitted so often.
pub(crate) fn is_for_folds(recording: &Recording, held_out: HeldOut) -> bool {
    let HeldOut::Share(share) = held_out else {
        return false;
    };
    share > 0.0 && recording.len() <= MOST_POSTURES && by_runs(recording, share).is_none()
}

/// The share to hold out, if it is one that leaves most rows to the fit.
pub(crate) fn check_share(held_out: HeldOut) -> Result<f64, CalibrationError> {
    match held_out {
        HeldOut::None => Ok(0.0),
        // the fit sees all rows, the folds are fitted at the same time
        HeldOut::Folds(2..=MOST_FOLDS) => Ok(0.0),
        HeldOut::Folds(folds) => Err(CalibrationError::Option {
            name: "folds",
            value: folds.to_string(),
            allowed: "from 2 to 100",
        }),
        HeldOut::Share(share) if (0.0..=0.5).contains(&share) => Ok(share),
        HeldOut::Share(share) => Err(CalibrationError::Option {
            name: "held-out",
            value: share.to_string(),
            allowed: "from 0 to 0.5",
        }),
    }
}

/// Holds out whole runs, the last ones, while they are at most the share (at least one).
fn by_runs(recording: &Recording, share: f64) -> Option<Split> {
    let run = recording.run.as_ref()?;
    let mut order: Vec<i64> = run.clone();
    order.dedup();
    if order.len() < 2 {
        return None;
    }
    let size = |id: i64| run.iter().filter(|&&other| other == id).count();
    let mut chosen = Vec::new();
    let mut total = 0;
    for &id in order.iter().rev() {
        if !chosen.is_empty() && (total + size(id)) as f64 > share * run.len() as f64 {
            break;
        }
        total += size(id);
        chosen.push(id);
    }
    if total * 2 > run.len() {
        return None;
    }
    chosen.sort_unstable();
    let is_held_out = |row: usize| chosen.contains(&run[row]);
    let words = |_| format!("whole runs held out: {chosen:?}");
    Some(Split::new(run.len(), is_held_out, words))
}

/// Holds out blocks spread evenly over the recording, `starts` the first row of each row's posture.
fn by_blocks(rows: usize, share: f64, starts: &[usize]) -> Split {
    let wanted = (1.0 / share).round().max(2.0) as usize;
    let blocks = BLOCKS.max(wanted).min(rows);
    let period = wanted.min(blocks);
    let is_held_out = |row: usize| (starts[row] * blocks / rows) % period == period / 2;
    let count = (0..blocks)
        .filter(|block| block % period == period / 2)
        .count();
    Split::new(rows, is_held_out, |held_out| {
        format!("{count} of {blocks} contiguous blocks held out ({held_out} of {rows} rows)")
    })
}

/// Holds out whole postures, spread evenly over the log.
fn by_postures(own: &[usize], share: f64) -> Split {
    let all = count(own);
    let period = ((1.0 / share).round() as usize).clamp(2, all.max(2));
    let is_held_out = |posture: usize| all > 1 && posture % period == period / 2;
    let held = (0..all).filter(|&posture| is_held_out(posture)).count();
    let rows = own.len();
    Split::new(
        rows,
        |row| is_held_out(own[row]),
        |held_out| format!("{held} of {all} postures held out ({held_out} of {rows} rows)"),
    )
}

/// Folds: fold k holds out the rows k, k + folds, ..., or the postures, where rows are numbered by them.
pub(crate) fn folds(rows: usize, count: usize, postures: Option<&[usize]>) -> Vec<Split> {
    let number = |row: usize| postures.map_or(row, |own| own[row]);
    let count = count.min(postures.map_or(rows, self::count));
    (0..count)
        .map(|fold| {
            let words = |_| format!("fold {} of {count}", fold + 1);
            Split::new(rows, |row| number(row) % count == fold, words)
        })
        .collect()
}
