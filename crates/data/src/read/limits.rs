//! Readings against the limits of their joint: degrees or counts taken for radians, readings outside.

use std::f64::consts::{PI, TAU};

use haptical_model::Recording;

use crate::column::Role;
use crate::error::{DataError, Fault};
use crate::read::order::cell_of;
use crate::shape::{JointShape, LogShape};

/// Share of a joint's range by which readings may lie outside it: limits are often rounded.
const SLACK: f64 = 0.1;
/// Share of the readings left out at either end, so that a few outliers decide nothing.
const TRIMMED: f64 = 0.025;

/// Radians of sixteen turns: whole numbers below may be rounded angles.
const SIXTEEN_TURNS: f64 = 100.0;

/// Refuses joint columns in degrees or counts; returns warnings about readings outside the limits.
pub(crate) fn check(
    recording: &Recording,
    columns: &[(String, Role)],
    file: &str,
    shape: &LogShape,
) -> Result<Vec<String>, DataError> {
    let mut warnings = Vec::new();
    for (joint, device) in shape.joints.iter().enumerate() {
        let motor_side = recording
            .joint
            .get(joint)
            .map(|column| (Role::Joint(joint), column));
        let output = recording.output.get(joint).and_then(Option::as_ref);
        for (role, readings) in motor_side
            .into_iter()
            .chain(output.map(|o| (Role::Output(joint), o)))
        {
            if !device.prismatic && are_counts(readings, device) {
                let (min, max) = range(readings);
                let first = readings
                    .iter()
                    .position(|value| value.abs() > SIXTEEN_TURNS);
                let line = recording.line[first.unwrap_or(0)];
                return Err(
                    cell_of(columns, role, file, line).error(Fault::LooksLikeCounts {
                        min,
                        max,
                        lower_rad: device.lower,
                        upper_rad: device.upper,
                    }),
                );
            }
            let Some(outside) = Outside::find(readings, device) else {
                continue;
            };
            let at = cell_of(columns, role, file, recording.line[outside.farthest]);
            let (min, max) = outside.range;
            let (lower, upper) = (device.lower, device.upper);
            if !device.prismatic && looks_like_degrees(readings, device) {
                return Err(at.error(Fault::LooksLikeDegrees {
                    min,
                    max,
                    lower_rad: lower,
                    upper_rad: upper,
                    within_a_turn: (min - lower).min(upper - max) >= -(1.0 + SLACK) * TAU,
                }));
            }
            let name = role.name(shape);
            warnings.push(format!(
                "{at}: {} readings of `{name}` lie outside the device's limits {lower} to {upper} \
                 {unit} by more than 10 % of that range, the farthest is {}; {}check the zero and \
                 the limits of joint `{}`",
                outside.count,
                readings[outside.farthest],
                if outside.is_whole_turns && !device.prismatic {
                    "less whole turns (2 pi) they would lie inside: take those off, or "
                } else {
                    ""
                },
                device.name,
                unit = device.unit(),
            ));
        }
    }
    Ok(warnings)
}

/// Readings outside a joint's limits by more than the slack.
struct Outside {
    count: usize,
    /// Row of the reading with the largest magnitude among them.
    farthest: usize,
    /// Smallest and largest of all readings.
    range: (f64, f64),
    /// Whether each of them less whole turns would lie within the limits.
    is_whole_turns: bool,
}

impl Outside {
    /// None if there are no such readings, or no finite limits.
    fn find(readings: &[f64], device: &JointShape) -> Option<Self> {
        let span = device.upper - device.lower;
        if !span.is_finite() || span <= 0.0 {
            return None;
        }
        let allowed = device.lower - SLACK * span..=device.upper + SLACK * span;
        let present = || {
            readings
                .iter()
                .enumerate()
                .filter(|(_, value)| !value.is_nan())
        };
        let outside = || present().filter(|(_, value)| !allowed.contains(*value));
        // Reversed, because of equal ones the last is taken and the first is to be named.
        let (farthest, _) = outside()
            .rev()
            .max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))?;
        let range = range(readings);
        let is_whole_turn = |(_, value): (usize, &f64)| {
            let turns = ((value - 0.5 * (device.lower + device.upper)) / TAU).round();
            turns != 0.0 && (device.lower..=device.upper).contains(&(value - turns * TAU))
        };
        Some(Self {
            is_whole_turns: outside().all(is_whole_turn),
            count: outside().count(),
            farthest,
            range,
        })
    }
}

/// Whether readings that cannot be radians of this joint would fit it as degrees.
///
/// With the joint's limits `lower..upper`, `L = max(|lower|, |upper|)` and the readings' trimmed
/// range `a..b`, `M = max(|a|, |b|)`, all of:
/// - far outside: `M > 2 L` and `M > 1.2 pi`;
/// - no zero offset explains it: `b - a` exceeds the joint's range with its slack, or the farthest
///   reading lies more than two turns beyond `L` (a zero is off by a turn at most);
/// - they fit as degrees: `M pi / 180 <= 1.1 L`.
///
/// A joint with limits of several turns is judged by those limits: readings of 18 with limits of
/// +-6 pi are three turns, readings of 1000 are degrees. A joint without limits is not judged.
fn looks_like_degrees(readings: &[f64], device: &JointShape) -> bool {
    let limit = device.lower.abs().max(device.upper.abs());
    let span = device.upper - device.lower;
    let (low, high) = trimmed_range(readings);
    let largest = low.abs().max(high.abs());
    let far_outside = largest > (2.0 * limit).max(1.2 * PI);
    let no_offset = high - low > (1.0 + 2.0 * SLACK) * span || largest > limit + 4.0 * PI;
    let fits = largest.to_radians() <= (1.0 + SLACK) * limit;
    far_outside && no_offset && fits
}

/// Whether readings are an encoder's counts: whole numbers beyond what the joint's limits are in degrees. A joint without limits
/// is not judged.
fn are_counts(readings: &[f64], device: &JointShape) -> bool {
    let (low, high) = trimmed_range(readings);
    let largest = low.abs().max(high.abs());
    let limit = device.lower.abs().max(device.upper.abs());
    // a zero is off by some turns at most
    let no_offset = high - low > (1.0 + 2.0 * SLACK) * (device.upper - device.lower);
    let is_whole = |value: &f64| value.is_nan() || value.fract() == 0.0;
    no_offset
        && largest > SIXTEEN_TURNS
        && largest.to_radians() > (1.0 + SLACK) * limit
        && readings.iter().all(is_whole)
}

/// Smallest and largest reading.
fn range(readings: &[f64]) -> (f64, f64) {
    let present = readings.iter().filter(|value| !value.is_nan());
    present.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), &value| {
        (min.min(value), max.max(value))
    })
}

/// Range of the readings without the outermost 2.5 % at either end (none of fewer than 40).
fn trimmed_range(readings: &[f64]) -> (f64, f64) {
    let mut kept: Vec<f64> = readings
        .iter()
        .copied()
        .filter(|value| !value.is_nan())
        .collect();
    let last = kept.len().saturating_sub(1);
    let n_trimmed = (TRIMMED * kept.len() as f64).floor() as usize;
    if kept.is_empty() {
        return (0.0, 0.0);
    }
    let mut at = |place: usize| *kept.select_nth_unstable_by(place, f64::total_cmp).1;
    (at(n_trimmed), at(last - n_trimmed))
}
