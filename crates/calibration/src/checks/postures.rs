//! Rows at one posture: a device that dwells gives many, which are no posture more than one.

use std::borrow::Cow;
use std::cmp::Ordering;
use std::collections::BTreeSet;

use haptical_model::Recording;
use haptical_model::kinematics::nalgebra::DMatrix;

use crate::checks::sufficiency::extremes;

/// Part of a joint's range in the log within which two readings are at one posture.
const SAME: f64 = 0.003;
/// Most postures that are distinguished; a log of more hardly dwells. One joint's slow sweep has more, 1/[`SAME`].
const MOST: usize = 300;
/// Rows that are looked at first: where they are at more postures than half of their number, nothing dwells.
const LOOKED_AT: usize = 1000;

/// Number of the posture of each row, from 0 in the order of the log; none where the device does not dwell.
///
/// A row belongs to the first posture, in the order of the log, whose readings all lie within [`SAME`] of the
/// joints' ranges of its own. Where successive rows name different tools or hands at the very same readings, such as three
/// reflectors one after the other, these are one posture however many there are: what they share has the same errors there.
pub(crate) fn postures(recording: &Recording) -> Option<Vec<usize>> {
    dwelling(recording).or_else(|| sharing(recording))
}

/// Number of the posture of each row where successive rows of several tools or hands share their readings.
fn sharing(recording: &Recording) -> Option<Vec<usize>> {
    let (tools, hands) = (recording.tool.as_ref(), recording.hand.as_ref());
    if tools.is_none() && hands.is_none() {
        return None;
    }
    let differs =
        |ids: Option<&Vec<String>>, row: usize| ids.is_some_and(|ids| ids[row - 1] != ids[row]);
    let follows = |row: usize| row > 0 && is_same_reading(recording, row - 1, row);
    let shares = |row: usize| follows(row) && (differs(tools, row) || differs(hands, row));
    if !(0..recording.len()).any(shares) {
        return None;
    }
    let mut posture = 0;
    let numbers: Vec<usize> = (0..recording.len())
        .map(|row| {
            posture += usize::from(row > 0 && !follows(row));
            posture
        })
        .collect();
    (posture > 0).then_some(numbers)
}

/// The first row of each row's posture, as several tools or hands share it; the row itself elsewhere.
pub(crate) fn starts(recording: &Recording) -> Vec<usize> {
    let mut starts: Vec<usize> = (0..recording.len()).collect();
    let numbers = sharing(recording).unwrap_or_default();
    for row in 1..numbers.len() {
        if numbers[row] == numbers[row - 1] {
            starts[row] = starts[row - 1];
        }
    }
    starts
}

/// Whether the joints read the same at two rows, bit by bit.
fn is_same_reading(recording: &Recording, a: usize, b: usize) -> bool {
    let mut columns = recording.joint.iter();
    columns.all(|column| column[a].to_bits() == column[b].to_bits())
}

fn dwelling(recording: &Recording) -> Option<Vec<usize>> {
    let tolerance: Vec<f64> = recording
        .joint
        .iter()
        .map(|column| {
            let [low, high] = extremes(column);
            SAME * (high - low)
        })
        .collect();
    let rows = recording.len();
    let step = rows.div_ceil(LOOKED_AT).max(1);
    let some: Vec<usize> = (0..rows).step_by(step).collect();
    let (found, _) = numbered(recording, &tolerance, &some, MOST)?;
    if 2 * found > some.len() {
        return None;
    }
    let all: Vec<usize> = (0..rows).collect();
    let (found, numbers) = numbered(recording, &tolerance, &all, MOST)?;
    // one posture has no neighbour to check it by
    (found > 1).then_some(numbers)
}

fn numbered(
    recording: &Recording,
    tolerance: &[f64],
    rows: &[usize],
    most: usize,
) -> Option<(usize, Vec<usize>)> {
    let columns = || recording.joint.iter().zip(tolerance);
    let hands = recording.hand.as_ref();
    let is_same = |a: usize, b: usize| {
        // two hands that are seen at one posture are no dwelling
        let is_of_one_hand = hands.is_none_or(|hands| hands[a] == hands[b]);
        is_of_one_hand
            && columns().all(|(column, tolerance)| (column[a] - column[b]).abs() <= *tolerance)
    };
    let mut firsts: Vec<usize> = Vec::new();
    let mut numbers = Vec::with_capacity(rows.len());
    for &row in rows {
        // the last one first: a device that dwells stays there
        let last = numbers.last().copied();
        let known = last
            .filter(|&number: &usize| is_same(firsts[number], row))
            .or_else(|| firsts.iter().position(|&first| is_same(first, row)));
        let number = match known {
            Some(number) => number,
            None if firsts.len() == most => return None,
            None => {
                firsts.push(row);
                firsts.len() - 1
            }
        };
        numbers.push(number);
    }
    Some((firsts.len(), numbers))
}

/// Whether more than half of the held-out rows are at postures that the fit sees too: they check nothing.
pub(crate) fn leaks(postures: &[usize], fit: &[usize], held_out: &[usize]) -> bool {
    let seen: BTreeSet<usize> = fit.iter().map(|&row| postures[row]).collect();
    let known = held_out
        .iter()
        .filter(|row| seen.contains(&postures[**row]));
    2 * known.count() > held_out.len()
}

/// How many postures there are.
pub(crate) fn count(postures: &[usize]) -> usize {
    postures.iter().max().map_or(0, |last| last + 1)
}

/// Part of a joint's movement below which it only follows the others', as a variance.
const FOLLOWS: f64 = 1e-3;

/// What is said of a log whose moving joints do not move independently of each other.
///
/// The smallest eigenvalues of the correlation matrix of the joints' readings are the variances of the combinations
/// that hardly move, each joint in units of its own.
pub(crate) fn narrow(recording: &Recording) -> Option<String> {
    let rows = recording.len() as f64;
    let moving: Vec<Vec<f64>> = recording
        .joint
        .iter()
        .filter_map(|column| {
            let mean = column.iter().sum::<f64>() / rows;
            let square: f64 = column.iter().map(|value| (value - mean).powi(2)).sum();
            let size = square.sqrt();
            let largest = column
                .iter()
                .fold(0.0_f64, |most, value| most.max(value.abs()));
            (size > 1e-6 * largest * rows.sqrt())
                .then(|| column.iter().map(|value| (value - mean) / size).collect())
        })
        .collect();
    let count = moving.len();
    if count < 2 {
        return None;
    }
    let correlation = DMatrix::from_fn(count, count, |a, b| {
        let pairs = moving[a].iter().zip(&moving[b]);
        pairs.map(|(a, b)| a * b).sum::<f64>()
    });
    let values = correlation.symmetric_eigenvalues();
    let free = values.iter().filter(|value| **value > FOLLOWS).count();
    (free < count).then(|| {
        format!(
            "the {count} joints that move do so in {free} independent directions: what other postures would tell is \
             held, and the figures hold for postures on the way of this log; record poses in which every joint \
             stands at many angles whatever the others do"
        )
    })
}

/// What is said of a log that dwells at few postures; nothing where the rows of each are of different tools.
pub(crate) fn of_dwelling(recording: &Recording, own: &[usize]) -> Option<String> {
    let mut seen = BTreeSet::new();
    let id = |ids: &Option<Vec<String>>, row: usize| ids.as_ref().map(|ids| ids[row].clone());
    let subject = |row: usize| (own[row], id(&recording.tool, row), id(&recording.hand, row));
    let repeats = (0..recording.len()).any(|row| !seen.insert(subject(row)));
    repeats.then(|| format!(
        "the {} rows are at {} different postures: rows at one posture tell its noise, not more of the \
         geometry; record more postures rather than more rows",
        recording.len(),
        count(own)
    ))
}

/// A recording without the rows that repeat an earlier one in every reading, and what a user should know of it.
///
/// Two readings of noise never agree in every digit: such rows are copies of a file's lines, or a device at rest
/// whose sensors all count steps. Either way the second one says nothing that the first did not, and a fit that
/// counts both states intervals that are too narrow. Times, runs, temperatures and further columns may differ.
///
/// ```
/// use haptical_calibration::without_copies;
/// use haptical_model::Recording;
/// let twice = Recording {
///     line: vec![2, 3, 4],
///     joint: vec![vec![0.1, 0.2, 0.1]],
///     ..Recording::default()
/// };
/// let (once, warning) = without_copies(&twice);
/// assert_eq!(once.line, [2, 3]);
/// assert!(warning.unwrap().contains("line 4"));
/// ```
pub fn without_copies(recording: &Recording) -> (Cow<'_, Recording>, Option<String>) {
    let kept = distinct_rows(recording);
    // of a log in which nothing moves the fit says so itself
    if kept.len() == recording.len() || kept.len() < 2 {
        return (Cow::Borrowed(recording), None);
    }
    let copies = recording.len() - kept.len();
    let first = (0..recording.len()).find(|row| kept.binary_search(row).is_err());
    let line = first.and_then(|row| recording.line.get(row)).copied();
    let warning = format!(
        "{copies} of {} rows repeat an earlier row in every reading{}: they count once, as noise never repeats; \
         leave out copied lines, or record more postures where the device stood still",
        recording.len(),
        line.map_or(String::new(), |line| format!(", the first at line {line}"))
    );
    (Cow::Owned(recording.select(&kept)), Some(warning))
}

/// Rows, ascending, of which no earlier one has the same readings.
pub fn distinct_rows(recording: &Recording) -> Vec<usize> {
    let columns: Vec<&Vec<f64>> = recording
        .joint
        .iter()
        .chain(recording.output.iter().flatten())
        .chain(recording.cable_m.iter().flatten())
        .chain(recording.position_m.iter().flatten())
        .chain(recording.orientation_wxyz.iter().flatten())
        .chain(recording.torque_nm.iter().flatten())
        .chain(recording.force_n.iter().flatten())
        .collect();
    let texts: Vec<&Vec<String>> = recording
        .contact
        .iter()
        .chain(recording.plane.iter())
        .chain(recording.tool.iter())
        .chain(recording.hand.iter())
        .collect();
    let compare = |a: usize, b: usize| {
        let bits = |column: &&Vec<f64>| column[a].to_bits().cmp(&column[b].to_bits());
        let numbers = columns.iter().map(bits);
        let texts = texts.iter().map(|column| column[a].cmp(&column[b]));
        let differs = numbers.chain(texts).find(|order| order.is_ne());
        differs.unwrap_or(Ordering::Equal)
    };
    let mut rows: Vec<usize> = (0..recording.len()).collect();
    // stable: of equal rows the first of the log stays
    rows.sort_by(|&a, &b| compare(a, b));
    rows.dedup_by(|later, first| compare(*later, *first).is_eq());
    rows.sort_unstable();
    rows
}
