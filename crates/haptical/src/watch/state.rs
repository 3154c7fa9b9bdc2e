//! Where a watch stands, as numbers for programs and as lines for people.

use chrono::DateTime;
use haptical_monitor::Monitor;
use serde::Serialize;

use super::intake::LeftOut;
use super::{CeasedChannel, LEAST_REFERENCE_ROWS, TOLERANCE, Watch, WatchCause, WatchEvent};
use crate::units::Shown;

/// Seconds since 1970 from which on a time is taken for one of the calendar: 2001.
const CALENDAR_S: f64 = 1e9;
/// Blocks that the present shift of a channel is a mean of.
const RECENT_BLOCKS: usize = 32;
/// Least length of a log that is given as the reference \[s\], and its least rows.
const LEAST_GIVEN_S: f64 = 60.0;
const LEAST_GIVEN_ROWS: f64 = 16.0 / (TOLERANCE * TOLERANCE);
/// Components that an alarm names.
const NAMED: usize = 3;

/// What is said of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum WatchVerdict {
    /// The reference is not complete, or the rows behind it say too little.
    NotJudged,
    /// No alarm was given.
    True,
    /// An alarm was given.
    Untrue,
}

/// What the rows are compared with.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WatchReference {
    /// Rows that it was made from, the first ones for the scales included.
    pub rows: u64,
    /// Rows of a block.
    pub block_rows: usize,
    /// Seconds of a block.
    pub block_s: f64,
    /// Expected number of false alarms in an hour, at most.
    pub false_alarms_per_hour: f64,
    /// Axis by axis.
    pub channels: Vec<ReferenceChannel>,
}

/// One axis of a channel in the reference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReferenceChannel {
    /// `out2`, `cable`, `position.x`.
    pub channel: String,
    /// SI unit.
    pub unit: String,
    /// Robust standard deviation of a residual.
    pub sd: f64,
    /// Standard deviation of the mean of a block, memory included.
    pub block_sd: f64,
    /// What its mean may be off without counting: what the reference itself does not know, and the tolerance.
    pub margin: f64,
}

/// A calibration that is no longer true.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WatchAlarm {
    /// Time of the row at which it was seen.
    pub seen_s: f64,
    /// Since when: the first row that is another.
    pub since_s: f64,
    /// 95 % interval of that.
    pub since_ci95_s: [f64; 2],
    /// Whether it may be longer ago than what is kept.
    pub may_be_older: bool,
    /// Number of that row, and its file and line.
    pub row: u64,
    /// Number of the first row that is another for sure: a cause is sought from there on.
    pub sure_row: u64,
    /// File.
    pub file: String,
    /// Line, about.
    pub line: u64,
    /// `step` or `ramp`.
    pub shape: &'static str,
    /// Probability of the shape.
    pub shape_probability: f64,
    /// What moved most.
    pub channels: Vec<WatchChannel>,
}

/// What moved, of one axis of a channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WatchChannel {
    /// `out2`, `cable`, `position.x`.
    pub channel: String,
    /// SI unit.
    pub unit: String,
    /// Mean of prediction minus measurement less that of the reference.
    pub shift: f64,
    /// 95 % interval of that.
    pub shift_ci95: [f64; 2],
    /// Root mean square about the reference's centre, in the reference and since; none of a present state.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rms: Option<[f64; 2]>,
    /// Share of the evidence; none of a present state.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
}

/// Where a watch stands.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WatchState {
    /// What is said.
    pub verdict: WatchVerdict,
    /// Device that is watched.
    pub device: String,
    /// Rows taken.
    pub rows: u64,
    /// Time of the last one.
    pub last_s: Option<f64>,
    /// Evidence over what an alarm needs; 1 is an alarm.
    pub evidence: f64,
    /// Blocks judged.
    pub blocks: u64,
    /// Readings beyond eight scales, which count as eight.
    pub wild_readings: u64,
    /// Lines and rows that were left out.
    pub left_out: LeftOut,
    /// Channels that were read and no longer are, though the arm moves.
    pub ceased: Vec<CeasedChannel>,
    /// Present shifts, axis by axis.
    pub channels: Vec<WatchChannel>,
    /// The reference, where it is complete.
    pub reference: Option<WatchReference>,
    /// Why there is no answer yet.
    pub not_judged: Option<String>,
    /// The alarm, where there is one.
    pub alarm: Option<WatchAlarm>,
    /// Its cause, where one was sought.
    pub cause: Option<WatchCause>,
}

impl Watch {
    /// Where it stands.
    pub fn state(&self) -> WatchState {
        let monitor = self.monitor.as_ref();
        let present = (0..self.components.len()).filter_map(|index| {
            let own = monitor?.state(index, RECENT_BLOCKS)?;
            Some(self.shifted(index, own.shift, own.half_width))
        });
        WatchState {
            verdict: self.verdict(),
            device: self.device.source().label.clone(),
            rows: self.rows,
            last_s: self.last_s.is_finite().then_some(self.last_s),
            evidence: monitor.map_or(0.0, Monitor::evidence).min(1e6),
            blocks: monitor.map_or(0, Monitor::blocks_judged),
            wild_readings: monitor.map_or(0, Monitor::clipped),
            left_out: self.intake.left_out.clone(),
            ceased: self.ceased(),
            channels: present.collect(),
            reference: self.reference_entry(),
            not_judged: match self.verdict() {
                WatchVerdict::NotJudged => self.not_judged(),
                _ => None,
            },
            alarm: self.alarm.clone(),
            cause: self.cause.clone(),
        }
    }

    /// A component whose mean moved by so much.
    fn shifted(&self, index: usize, shift: f64, half_width: f64) -> WatchChannel {
        WatchChannel {
            channel: self.name(index),
            unit: self.components[index].unit.clone(),
            shift,
            shift_ci95: [shift - half_width, shift + half_width],
            rms: None,
            share: None,
        }
    }

    /// Channels that were not read at as many postures as a reference needs at least.
    fn ceased(&self) -> Vec<CeasedChannel> {
        let components = self.ceased.components(LEAST_REFERENCE_ROWS as u64);
        let all = components.map(|(index, last_read_s)| CeasedChannel {
            channel: self.components[index].channel.clone(),
            last_read_s,
        });
        let mut all: Vec<CeasedChannel> = all.collect();
        all.dedup_by(|later, own| later.channel == own.channel);
        all
    }

    /// Whether no channel is read any more.
    pub(super) fn is_blind(&self) -> bool {
        let ceased = self.ceased.components(LEAST_REFERENCE_ROWS as u64);
        ceased.count() == self.components.len()
    }

    /// Least rows of a reference: as long as was asked for, of a log that is given as one a minute and so many rows that an error is within the
    /// tolerance which follows the posture and does not show (docs/assumptions.md, A288).
    pub(super) fn least_reference_rows(&self, rows_per_hour: f64) -> f64 {
        let asked = self.options.reference_s / 3600.0 * rows_per_hour;
        let given = (LEAST_GIVEN_S / 3600.0 * rows_per_hour).max(LEAST_GIVEN_ROWS);
        let least = match self.is_reference {
            true => given.min(asked),
            false => asked,
        };
        least.max(LEAST_REFERENCE_ROWS).ceil()
    }

    /// Why there is no answer yet; nothing where there is one.
    pub(super) fn not_judged(&self) -> Option<String> {
        let monitor = self.monitor.as_ref();
        let wanted = monitor.map_or(LEAST_REFERENCE_ROWS as u64, Monitor::wanted_reference_rows);
        let Some(judging) = monitor.filter(|own| own.reference().is_some()) else {
            let too_few = format!(
                "nothing was judged: {} rows are too few for a reference, which needs {wanted}",
                self.rows
            );
            // without a monitor the rate of the rows is unknown
            let at_least = match monitor {
                Some(_) => {
                    let seconds = (wanted as f64 / self.rows_per_hour * 3600.0).ceil();
                    format!("{too_few}: record at least {seconds:.0} s")
                }
                None => too_few,
            };
            return Some(match monitor.is_some_and(Monitor::is_refused) {
                false => at_least,
                true => format!(
                    "{at_least}, about, as their noise remembers long; or say with --tolerance what a channel may be off"
                ),
            });
        };
        let (blocks, wanted) = (judging.blocks_judged(), judging.least_blocks());
        if blocks < wanted {
            let rows = judging.rows() - judging.reference_rows();
            let length = judging.reference().map_or(0, |own| own.block_rows) as u64;
            let needed = wanted * length;
            return Some(match rows < needed {
                true => format!(
                    "nothing was judged: {rows} rows behind the reference are too few, {needed} are needed"
                ),
                false => format!(
                    "nothing was judged: the arm moved in too few of the {rows} rows behind the reference; a rest says as much as one row"
                ),
            });
        }
        if self.lacks_rows() {
            let (left_out, count) = (&self.intake.left_out, self.intake.left_out.count());
            let first = left_out.first.as_ref().map(|first| format!(": {first}"));
            return Some(format!(
                "{count} rows of {} are left out, too many to answer for all{}",
                self.rows + count,
                first.unwrap_or_default()
            ));
        }
        let text = "no channel is read any more, though the arm moves";
        self.is_blind().then(|| text.to_owned())
    }

    /// Says which channels had too few readings in the reference to be judged.
    pub(super) fn unread(&self) -> Option<WatchEvent> {
        let reference = self.monitor.as_ref()?.reference()?;
        let features = reference.features.iter().enumerate();
        let unread = features.filter(|(_, own)| own.is_none());
        let names: Vec<String> = unread.map(|(index, _)| self.name(index)).collect();
        let text = format!(
            "not judged: {}; the reference has too few readings between which the joint moved",
            names.join(", ")
        );
        (!names.is_empty()).then(|| WatchEvent::note(text))
    }

    fn name(&self, index: usize) -> String {
        let own = &self.components[index];
        let mut all = self.components.iter();
        match all.any(|other| other.channel == own.channel && other.axis > 0) {
            true => format!("{}.{}", own.channel, ["x", "y", "z"][own.axis.min(2)]),
            false => own.channel.clone(),
        }
    }

    pub(super) fn reference_entry(&self) -> Option<WatchReference> {
        let monitor = self.monitor.as_ref()?;
        let reference = monitor.reference()?;
        let features = reference.features.iter().enumerate();
        let channels = features.filter_map(|(index, features)| {
            let [mean, _] = features.as_ref()?;
            let scale = monitor.scales()[index];
            Some(ReferenceChannel {
                channel: self.name(index),
                unit: self.components[index].unit.clone(),
                sd: scale,
                block_sd: scale * mean.sd,
                margin: scale * mean.sd * mean.margin,
            })
        });
        Some(WatchReference {
            rows: monitor.reference_rows(),
            block_rows: reference.block_rows,
            block_s: reference.block_rows as f64 / self.rows_per_hour * 3600.0,
            false_alarms_per_hour: self.options.false_alarms_per_hour,
            channels: channels.collect(),
        })
    }

    pub(super) fn alarm_entry(&self) -> Option<WatchAlarm> {
        let monitor = self.monitor.as_ref()?;
        let (change, [from, since, to], row) = monitor.change(self.course.spell_s())?;
        let place = self.places.iter().rev().find(|(first, _, _)| *first < row);
        let (file, line) = match place {
            Some((first, file, line)) => (file.clone(), line + (row - first).saturating_sub(1)),
            None => (self.file.clone(), 0),
        };
        let (first_whole, sure_row) = monitor.whole_since(&change);
        let shifts = monitor.shifts(first_whole);
        let channels = shifts.into_iter().take(NAMED).map(|own| {
            let shift = own.mean_since - own.mean_before;
            WatchChannel {
                rms: Some([own.rms_before, own.rms_since]),
                share: Some(own.share),
                ..self.shifted(own.component, shift, own.half_width)
            }
        });
        let earlier = self.alarm.as_ref();
        let seen_s = earlier.map_or(self.last_s, |alarm| alarm.seen_s);
        Some(WatchAlarm {
            seen_s,
            since_s: since,
            since_ci95_s: [from, to.min(seen_s).max(since)],
            may_be_older: change.may_be_older,
            row,
            sure_row,
            file,
            line,
            shape: match change.shape {
                haptical_monitor::Shape::Step => "step",
                haptical_monitor::Shape::Ramp => "ramp",
            },
            shape_probability: change.shape_probability,
            channels: channels.collect(),
        })
    }
}

impl WatchState {
    /// One line.
    pub fn line(&self) -> String {
        let at = self.last_s.map(|last_s| format!("{}  ", when(last_s)));
        let verdict = match self.verdict {
            WatchVerdict::NotJudged if self.reference.is_some() => "not judged".to_owned(),
            WatchVerdict::NotJudged => "reference".to_owned(),
            WatchVerdict::True => "true".to_owned(),
            WatchVerdict::Untrue => {
                let since = self.alarm.as_ref().map(|alarm| when(alarm.since_s));
                format!("NOT TRUE since {}", since.unwrap_or_default())
            }
        };
        let at = at.unwrap_or_default();
        let mut text = format!("{at}{verdict}  {} rows", self.rows);
        if self.verdict == WatchVerdict::True {
            text += &format!("  evidence {:.1e} of an alarm's", self.evidence);
        }
        let largest = self.channels.iter().max_by(|a, b| {
            let size = |own: &WatchChannel| {
                own.shift.abs() / (own.shift_ci95[1] - own.shift).max(f64::MIN_POSITIVE)
            };
            size(a).total_cmp(&size(b))
        });
        if let Some(own) = largest {
            text += &format!("  {} {}", own.channel, shift_text(own));
        }
        let left_out = self.left_out.count();
        if left_out > 0 {
            text += &format!("  {left_out} lines left out");
        }
        for own in &self.ceased {
            text += &format!("  no {} since {}", own.channel, when(own.last_read_s));
        }
        text
    }

    /// Why there is no answer, as the beginning of a sentence.
    pub(super) fn why_not_judged(&self) -> String {
        let why = self.not_judged.as_deref().unwrap_or("there are no rows");
        match why.strip_prefix("nothing was judged") {
            Some(rest) => format!("Nothing was judged{rest}"),
            None => format!("Not judged: {why}"),
        }
    }

    /// The last words: what was judged, and the answer.
    pub fn summary(&self) -> String {
        let mut text = String::new();
        if let Some(reference) = &self.reference {
            text += &WatchEvent::Reference(reference.clone()).line();
            text.push('\n');
        }
        let reference = self.reference.as_ref();
        let hours = reference.map(|own| own.block_s * self.blocks as f64 / 3600.0);
        text += &match self.verdict {
            WatchVerdict::NotJudged => format!(
                "{}.{}\n",
                self.why_not_judged(),
                match self.reference.is_some() {
                    true => "",
                    false => " Give --reference a log of the device while it was true, or go on.",
                }
            ),
            WatchVerdict::True => format!(
                "The calibration is true: no alarm in {:.2} h behind the reference.\n",
                hours.unwrap_or_default()
            ),
            WatchVerdict::Untrue => {
                let alarm = self.alarm.clone().map(WatchEvent::Alarm);
                alarm.map_or_else(String::new, |alarm| alarm.line() + "\n")
            }
        };
        if let Some(cause) = &self.cause {
            text += &(WatchEvent::Cause(cause.clone()).line() + "\n");
        }
        for own in &self.ceased {
            text += &(own.line() + "\n");
        }
        if self.left_out.count() > 0 {
            let first = self.left_out.first.as_ref();
            let first = first.map(|first| format!("; the first: {first}"));
            text += &format!(
                "Left out: {} lines that are no rows, {} rows out of order{}.\n",
                self.left_out.unreadable,
                self.left_out.out_of_order,
                first.unwrap_or_default()
            );
        }
        text
    }
}

impl WatchEvent {
    pub(super) fn note(text: String) -> Self {
        Self::Note { text }
    }

    /// For people.
    pub fn line(&self) -> String {
        match self {
            Self::Note { text } => format!("note: {text}"),
            Self::Reference(own) => {
                let channels = own.channels.iter().map(|channel| {
                    let shown = Shown::fine(&channel.unit);
                    let (sd, margin) = (shown.text(channel.sd), shown.text(channel.margin));
                    format!("{} {sd}, counts beyond {margin}", channel.channel)
                });
                format!(
                    "Reference of {} rows: blocks of {} rows ({:.3} s), one false alarm in {:.0} h at most. {}.",
                    own.rows,
                    own.block_rows,
                    own.block_s,
                    own.false_alarms_per_hour.recip(),
                    channels.collect::<Vec<_>>().join("; ")
                )
            }
            Self::Alarm(own) => {
                let older = if own.may_be_older { " or earlier" } else { "" };
                let counts = |own: &&WatchChannel| own.share.is_some_and(|share| share >= 0.05);
                let moved = own.channels.iter().filter(counts).map(|channel| {
                    let shown = Shown::fine(&channel.unit);
                    let rms = channel.rms.map_or_else(String::new, |[before, since]| {
                        format!(", rms {} to {}", shown.text(before), shown.text(since))
                    });
                    format!("{}: mean {}{rms}", channel.channel, shift_text(channel))
                });
                format!(
                    "The calibration is NOT TRUE since {} [{}{older}, {}] ({}, line {}), a {} with probability {:.2}. {}.",
                    when(own.since_s),
                    when(own.since_ci95_s[0]),
                    when(own.since_ci95_s[1]),
                    own.file,
                    own.line,
                    own.shape,
                    own.shape_probability,
                    moved.collect::<Vec<_>>().join("; ")
                )
            }
            Self::Cause(own) => {
                let written = own.written.iter();
                let written: Vec<String> = written.map(|path| path.display().to_string()).collect();
                let written = match written.is_empty() {
                    true => String::new(),
                    false => format!("\nwritten  {}", written.join("  ")),
                };
                format!("Cause, from {} rows: {}{written}", own.rows, own.answer)
            }
        }
    }
}

fn shift_text(own: &WatchChannel) -> String {
    let shown = Shown::fine(&own.unit);
    let half = own.shift_ci95[1] - own.shift;
    format!(
        "{:+.3} ± {:.3} {}",
        own.shift * shown.per_si,
        half * shown.per_si,
        shown.name
    )
}

/// A time of a log: a date where it counts from 1970, else seconds.
pub(super) fn when(time_s: f64) -> String {
    let is_of_calendar = (CALENDAR_S..1e11).contains(&time_s);
    let date = DateTime::from_timestamp(time_s.floor() as i64, 0).filter(|_| is_of_calendar);
    date.map_or_else(
        || format!("t = {time_s:.1} s"),
        |date| date.format("%Y-%m-%d %H:%M:%S UTC").to_string(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `date -u -d @...` of GNU.
    #[test]
    fn times_of_the_calendar_are_dates() {
        assert_eq!(when(1_709_210_096.7), "2024-02-29 12:34:56 UTC");
        assert_eq!(when(1_000_000_000.0), "2001-09-09 01:46:40 UTC");
        assert_eq!(when(4_102_444_799.0), "2099-12-31 23:59:59 UTC");
        assert_eq!(when(12.25), "t = 12.2 s");
        assert_eq!(when(f64::NAN), "t = NaN s");
    }
}
