//! A calibration that is watched: rows of a log as they come, and whether the device still is what its file says.

mod cause;
mod ceased;
mod follow;
mod growing;
mod intake;
mod kept;
mod lines;
mod motion;
mod page;
mod state;

use std::collections::VecDeque;
use std::path::PathBuf;

use haptical_calibration::{CalibrationError, channels, check_reach};
use haptical_data::{LogShape, read_log_from};
use haptical_model::{Device as Model, Recording};
use haptical_monitor::{Course, Event, Monitor, Phase, Settings};

pub use self::cause::WatchCause;
pub use self::ceased::CeasedChannel;
pub use self::follow::{Fed, Feed};
pub use self::intake::LeftOut;
pub use self::state::{
    ReferenceChannel, WatchAlarm, WatchChannel, WatchReference, WatchState, WatchVerdict,
};

use self::cause::{cause, rows_for_cause};
use self::intake::{Intake, nothing_to_watch};
use self::kept::Kept;
use self::lines::Lines;
use self::motion::{Motion, joint_of};
use crate::device::Device;
use crate::error::Error;
use crate::files::{Overwrite, WriteRule};
use crate::replay::{placed, predicted_residuals};

/// Its name.
pub(crate) const COMMAND: &str = "watch";
/// Rows before a part that its effects are worked out with: a play knows where its joint was.
const CONTEXT_ROWS: usize = 256;
/// Rows that a tracker's place is fitted to at most; of more every k-th is taken.
const MOST_PLACING_ROWS: usize = 2000;
/// Least rows before anything is said of a log.
const LEAST_SETUP_ROWS: usize = 256;
/// Least rows since a change that a diagnosis is asked of at the end.
const LEAST_DIAGNOSED: usize = 100;
/// What the mean residual of a channel may be off, of its stated noise: numbers of a fit are known to a part of the noise, and other
/// postures than those of the reference show that (docs/assumptions.md, A222).
const TOLERANCE: f64 = 0.1;
/// Most of the rows that may be left out of an answer for all.
const MOST_LEFT_OUT: f64 = 0.1;
/// Probability that the reference is off by more than its margins (docs/assumptions.md, A207).
const MISS: f64 = 0.05;
/// Least rows of a reference.
const LEAST_REFERENCE_ROWS: f64 = 512.0;
/// What a watch is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct WatchOptions {
    /// Expected number of false alarms in an hour of rows, at most.
    pub false_alarms_per_hour: f64,
    /// Least length of a reference that the first rows are, and most that is asked of a log that is given as one \[s\].
    pub reference_s: f64,
    /// Rows a second, of a log without times.
    pub rate_hz: Option<f64>,
    /// What the mean residual of a channel may be off without being another, by the channel's name, in its SI unit.
    pub tolerances: Vec<(String, f64)>,
    /// Rows that are kept for a diagnosis.
    pub keep_rows: usize,
    /// Least rows since a change after which its cause is sought; more where they are few seconds.
    pub diagnosed_rows: usize,
    /// Folder for the rows of an alarm and their diagnosis.
    pub out: Option<PathBuf>,
    /// What may be written there.
    pub rule: WriteRule,
}

impl Default for WatchOptions {
    fn default() -> Self {
        Self {
            false_alarms_per_hour: 1e-3,
            reference_s: 600.0,
            rate_hz: None,
            tolerances: Vec::new(),
            keep_rows: 20_000,
            diagnosed_rows: 2000,
            out: None,
            rule: WriteRule::new(COMMAND, Vec::new(), Overwrite::Own),
        }
    }
}

/// Something that happened.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
pub enum WatchEvent {
    /// Something odd about the log, or about how it arrives.
    Note {
        /// In words.
        text: String,
    },
    /// The reference is complete.
    Reference(WatchReference),
    /// The calibration is no longer true.
    Alarm(WatchAlarm),
    /// What the diagnosis says of the rows since.
    Cause(WatchCause),
}

/// One axis of a channel.
#[derive(Debug, Clone, PartialEq)]
struct Component {
    channel: String,
    axis: usize,
    unit: String,
    /// The joint that it sees alone, and how far that moves between two readings of their own.
    joint: Option<(usize, f64)>,
}

/// A watch of one device.
#[derive(Debug)]
pub struct Watch {
    device: Device,
    options: WatchOptions,
    shape: LogShape,
    intake: Intake,
    motion: Motion,
    course: Course,
    ceased: ceased::Ceased,
    kept: Kept,
    file: String,
    /// The device with its tracker placed, from the first rows on.
    model: Option<Model>,
    components: Vec<Component>,
    monitor: Option<Monitor>,
    rows_per_hour: f64,
    is_reference: bool,
    setup_rows: usize,
    first_s: Option<f64>,
    last_s: f64,
    /// Rows that were judged before the present file's first, for times of a log without.
    rows: u64,
    /// First row of each of the last parts, its file and line.
    places: VecDeque<(u64, String, u64)>,
    alarm: Option<WatchAlarm>,
    cause: Option<WatchCause>,
}

/// Parts whose places are kept.
const MOST_PLACES: usize = 4096;

impl Watch {
    /// A watch that has seen no row.
    ///
    /// # Errors
    /// Options that say nothing: a rate or a length that is not above 0.
    pub fn new(device: Device, options: WatchOptions) -> Result<Self, Error> {
        if device.model.has_run_bases() {
            let said = "the tracker stands elsewhere in each run: what it sees of a new run says nothing of the device before its place \
                        is fitted; watch a device whose tracker stays, or identify each run";
            return Err(Error::of_file("per-run", said, &device.source().path));
        }
        let sizes = [
            ("--false-alarms-per-hour", options.false_alarms_per_hour),
            ("--reference-s", options.reference_s),
            ("--rate-hz", options.rate_hz.unwrap_or(1.0)),
        ];
        let tolerances = options.tolerances.iter();
        let tolerances = tolerances.map(|(_, size)| ("--tolerance", *size));
        let mut sizes = sizes.into_iter().chain(tolerances);
        if let Some((flag, size)) = sizes.find(|(_, size)| !(size.is_finite() && *size > 0.0)) {
            let said = format!("{flag} is {size}; give a number above 0");
            return Err(Error::arguments(said));
        }
        Ok(Self {
            shape: LogShape::from(&device.model),
            intake: Intake::default(),
            motion: Motion::default(),
            course: Course::default(),
            ceased: ceased::Ceased::default(),
            kept: Kept::new(options.keep_rows.max(CONTEXT_ROWS)),
            file: String::new(),
            model: None,
            components: Vec::new(),
            monitor: None,
            rows_per_hour: f64::NAN,
            is_reference: false,
            setup_rows: 0,
            first_s: None,
            last_s: f64::NAN,
            rows: 0,
            places: VecDeque::new(),
            alarm: None,
            cause: None,
            device,
            options,
        })
    }

    /// A file begins, or begins anew: its times are its own.
    pub fn begin(&mut self, file: &str) {
        file.clone_into(&mut self.file);
        self.intake.new_file();
    }

    /// Takes the text of whole rows under its header, as a file has it.
    ///
    /// # Errors
    /// A log that is not of this device, or that has nothing to watch. Single rows that are none are left out and counted.
    pub fn text(&mut self, text: &str) -> Result<Vec<WatchEvent>, Error> {
        let mut cutter = lines::Cutter::default();
        let parts = cutter.take(text.as_bytes());
        self.parts(parts, cutter.left_out)
    }

    fn parts(&mut self, parts: Vec<Lines>, left_out: u64) -> Result<Vec<WatchEvent>, Error> {
        self.intake.add_unreadable(left_out);
        let mut events = Vec::new();
        for part in parts {
            self.part(part, &mut events)?;
        }
        Ok(events)
    }

    fn part(&mut self, part: Lines, events: &mut Vec<WatchEvent>) -> Result<(), Error> {
        let (file, shape) = (&self.file, &self.shape);
        let Some(rows) = self.intake.read(part, file, shape, &self.device)? else {
            return Ok(());
        };
        let (recording, header, lines) = (rows.recording, rows.header, rows.lines);
        events.extend(rows.warnings.into_iter().map(WatchEvent::note));
        if self.places.len() == MOST_PLACES {
            self.places.pop_front();
        }
        let line = recording.line.first().copied().unwrap_or_default();
        self.places.push_back((self.rows, self.file.clone(), line));
        let count = recording.len();
        let times = recording.time_s.iter().flatten();
        let first = times.copied().find(|time| time.is_finite());
        self.first_s = self.first_s.or(first);
        let is_remembering = !self.device.model.effects.is_empty();
        if self.model.is_none() {
            self.setup_rows += count;
            self.kept.extend(&header, lines);
            self.rows += count as u64;
            return match self.is_set_up_by(&recording) {
                true => self.set_up(events),
                false => Ok(()),
            };
        }
        let context = match is_remembering && self.kept.header() == header {
            true => self.kept.last(CONTEXT_ROWS),
            false => String::new(),
        };
        self.kept.extend(&header, lines);
        if context.is_empty() {
            return self.judge(&recording, 0, events);
        }
        let before = context.lines().count() - 1;
        let whole = self.kept.last(before + count);
        match read_log_from(whole.as_bytes(), &self.file, &self.shape) {
            Ok(log) => self.judge(&log.recording, before, events),
            // a file that begins anew is no continuation
            Err(_) => self.judge(&recording, 0, events),
        }
    }

    /// Of the device and of what is read.
    fn paths(&self) -> [PathBuf; 2] {
        [self.device.source().path.clone(), PathBuf::from(&self.file)]
    }

    /// Whether there are rows enough to begin with.
    fn is_set_up_by(&self, latest: &Recording) -> bool {
        let span_s = match (&latest.time_s, self.options.rate_hz) {
            (Some(times), _) => {
                let ends = times.last().zip(self.first_s);
                ends.map_or(0.0, |(last, first)| last - first)
            }
            (None, Some(rate_hz)) => self.setup_rows as f64 / rate_hz,
            _ => f64::INFINITY,
        };
        let is_long = span_s >= self.options.reference_s / 10.0 || span_s < 0.0;
        self.setup_rows >= LEAST_SETUP_ROWS
            && (is_long || self.kept.len() >= self.options.keep_rows)
    }

    /// The first rows say what there is to watch, how often it comes, and where the tracker stands.
    fn set_up(&mut self, events: &mut Vec<WatchEvent>) -> Result<(), Error> {
        let [device, file] = self.paths();
        let paths = (device.as_path(), file.as_path());
        let text = self.kept.last(usize::MAX);
        let Ok(read) = read_log_from(text.as_bytes(), &self.file, &self.shape) else {
            // rows of several files whose runs have the same names: the next ones begin
            self.kept = Kept::new(self.options.keep_rows.max(CONTEXT_ROWS));
            (self.setup_rows, self.rows, self.first_s) = (0, 0, None);
            return Ok(());
        };
        let known = &self.device.model;
        let recording = known.without_unknown_orientation(&read.recording);
        let recording = recording.unwrap_or(read.recording);
        let refuse = |error| Error::calibration(&error, paths.0, paths.1);
        check_reach(&self.device.model, &recording).map_err(refuse)?;
        let hours = self.rows_in_an_hour(&recording, paths.1)?;
        self.rows_per_hour = hours;
        let step = recording.len().div_ceil(MOST_PLACING_ROWS).max(1);
        let few: Vec<usize> = (0..recording.len()).step_by(step).collect();
        let (mut model, must_be_placed) = placed(&self.device.model, &recording.select(&few))
            .map_err(|error| match error {
                CalibrationError::NoChannel => nothing_to_watch(&recording, paths.1),
                error => refuse(error).with_equipment(&self.device),
            })?;
        self.model = Some(model.clone());
        if must_be_placed {
            events.push(WatchEvent::note(format!(
                "the device file does not say where the tracker stands or what it sees: both are fitted to the first {} rows \
                 and then held",
                recording.len()
            )));
        }
        let (residuals, unpredicted) = predicted_residuals(&mut model, &recording, paths)?;
        let read = residuals.iter().filter(|own| !own.rows.is_empty());
        let (mut floors, mut tolerances) = (Vec::new(), Vec::new());
        let mut given = self.options.tolerances.clone();
        for own in read {
            let (name, unit) = (own.channel.name(), own.channel.unit(&model).to_owned());
            let tolerance = self.options.tolerances.iter().find(|(of, _)| *of == name);
            given.retain(|(of, _)| *of != name);
            for axis in 0..own.channel.width() {
                floors.push(own.noise_floor);
                let stated = tolerance.map(|(_, size)| *size);
                tolerances.push(stated.unwrap_or(TOLERANCE * own.noise_floor));
                self.components.push(Component {
                    channel: name.clone(),
                    axis,
                    unit: unit.clone(),
                    joint: joint_of(&own.channel, own.noise_floor),
                });
            }
        }
        if floors.is_empty() {
            return Err(nothing_to_watch(&recording, paths.1));
        }
        if let Some((name, _)) = given.first() {
            let names = self.components.iter().map(|own| own.channel.as_str());
            return Err(Error::arguments(format!(
                "--tolerance names `{name}`, and the log has no such channel; the channels are: {}",
                names.collect::<Vec<_>>().join(", ")
            )));
        }
        if !unpredicted.is_empty() {
            let text = format!("not watched: {}", unpredicted.join(", "));
            events.push(WatchEvent::note(text));
        }
        let least = self.least_reference_rows(hours);
        // the first rows of a fast log are no longer kept, and count
        let forgotten = self.setup_rows.saturating_sub(recording.len());
        let settings = Settings {
            floors,
            tolerances,
            reference_rows: (least as usize).saturating_sub(forgotten),
            miss: MISS,
        };
        let mut monitor = Monitor::new(settings).map_err(Error::internal)?;
        let rows = hours / self.options.false_alarms_per_hour;
        let set = monitor.set_rows_between_false_alarms(rows);
        set.map_err(Error::internal)?;
        if self.is_reference {
            monitor.hold_reference();
        }
        self.monitor = Some(monitor);
        self.rows = self.rows.saturating_sub(recording.len() as u64);
        self.judge(&recording, 0, events)
    }

    /// Rows in an hour, by the middle of the times between rows.
    fn rows_in_an_hour(&self, recording: &Recording, file: &std::path::Path) -> Result<f64, Error> {
        if let Some(rate_hz) = self.options.rate_hz {
            return Ok(3600.0 * rate_hz);
        }
        let times = recording.time_s.as_deref().unwrap_or_default();
        let steps = times.windows(2).map(|pair| pair[1] - pair[0]);
        let mut steps: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
        if steps.is_empty() {
            let said = "the log has no times, and a rate of false alarms is one of an hour; add a column t_s, or say how many rows a \
                        second has: --rate-hz";
            return Err(Error::of_file("no-times", said, file));
        }
        let middle = steps.len() / 2;
        let (_, step_s, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
        Ok(3600.0 / *step_s)
    }

    /// Residuals of the rows behind `before` ones that were judged, into the monitor.
    fn judge(
        &mut self,
        recording: &Recording,
        before: usize,
        events: &mut Vec<WatchEvent>,
    ) -> Result<(), Error> {
        let [device, file] = self.paths();
        let Some(model) = &self.model else {
            return Ok(());
        };
        let mut model = model.clone();
        let known = self.device.model.without_unknown_orientation(recording);
        let recording = known.as_ref().unwrap_or(recording);
        let residuals = match predicted_residuals(&mut model, recording, (&device, &file)) {
            Ok((residuals, _)) => residuals,
            // no channel is read: the rows count, and what ceased is said
            Err(_) if channels(&model, recording).is_err() => Vec::new(),
            Err(error) => {
                self.intake.left_out.unreadable += (recording.len() - before) as u64;
                let first = &mut self.intake.left_out.first;
                first.get_or_insert_with(|| error.to_string());
                return Ok(());
            }
        };
        let width = self.components.len();
        let mut values = vec![f64::NAN; width * recording.len()];
        for own in &residuals {
            let name = own.channel.name();
            let Some(start) = self.components.iter().position(|one| one.channel == name) else {
                continue;
            };
            let axes = own.channel.width();
            for (row, reading) in own.rows.iter().zip(own.residuals.chunks_exact(axes)) {
                let at = row * width + start;
                values[at..at + axes].copy_from_slice(reading);
            }
        }
        let nothing = vec![f64::NAN; width];
        let mut joints = Vec::with_capacity(recording.joint.len());
        for (row, values) in values.chunks_exact_mut(width).enumerate().skip(before) {
            self.last_s = self.time_of(recording, row);
            let Some(monitor) = &mut self.monitor else {
                return Ok(());
            };
            joints.clear();
            joints.extend(recording.joint.iter().map(|column| column[row]));
            self.course.push(self.last_s, joints.iter().copied());
            let is_new = self.motion.has_moved(recording, row);
            let event = match is_new {
                true => {
                    self.ceased.take(values, self.last_s);
                    self.motion.thin(&self.components, &joints, values);
                    monitor.push(self.last_s, values)
                }
                false => monitor.push(self.last_s, &nothing),
            };
            let event = event.map_err(Error::internal)?;
            self.rows += 1;
            match event {
                Some(Event::Referenced) => {
                    events.extend(self.reference_entry().map(WatchEvent::Reference));
                    events.extend(self.unread());
                }
                Some(Event::Alarm) => {
                    self.alarm = self.alarm_entry();
                    events.extend(self.alarm.clone().map(WatchEvent::Alarm));
                }
                _ => {}
            }
        }
        if self.rows_since_change() >= rows_for_cause(&self.options, self.rows_per_hour) {
            events.extend(self.seek_cause()?.map(WatchEvent::Cause));
        }
        Ok(())
    }

    fn time_of(&self, recording: &Recording, row: usize) -> f64 {
        let own = recording.time_s.as_ref().map(|times| times[row]);
        let rate_hz = self.options.rate_hz;
        let of_rate = rate_hz.map(|rate_hz| self.rows as f64 / rate_hz);
        own.or(of_rate).unwrap_or(f64::NAN)
    }

    /// Rows since the change, none without an alarm.
    fn rows_since_change(&self) -> u64 {
        let alarm = self.alarm.as_ref();
        alarm.map_or(0, |alarm| self.rows - alarm.sure_row.min(self.rows))
    }

    /// Seeks the cause of an alarm, once.
    fn seek_cause(&mut self) -> Result<Option<WatchCause>, Error> {
        if self.cause.is_some() || self.rows_since_change() < LEAST_DIAGNOSED as u64 {
            return Ok(None);
        }
        // more rows place the change better than those at the alarm did
        self.alarm = self.alarm_entry();
        let Some(alarm) = &self.alarm else {
            return Ok(None);
        };
        if self.rows_since_change() < LEAST_DIAGNOSED as u64 {
            return Ok(None);
        }
        let since = self.kept.since(alarm.sure_row);
        let found = cause(&self.device, since, &self.options)?;
        self.cause = Some(found.clone());
        Ok(Some(found))
    }

    /// What was not yet begun is begun with what there is.
    fn set_up_late(&mut self) -> Result<Vec<WatchEvent>, Error> {
        let mut events = Vec::new();
        if self.model.is_none() && self.setup_rows > 0 {
            self.set_up(&mut events)?;
        }
        Ok(events)
    }

    /// All rows from here on are of the device while its calibration is true, until [`Watch::end_reference`].
    pub fn begin_reference(&mut self) {
        self.is_reference = true;
    }

    /// The rows so far are the reference.
    ///
    /// # Errors
    /// They are too few: fewer than were asked for, or than their noise remembers.
    pub fn end_reference(&mut self) -> Result<Vec<WatchEvent>, Error> {
        let mut events = self.set_up_late()?;
        self.is_reference = false;
        if let Some(monitor) = &mut self.monitor {
            monitor.end_reference().map_err(Error::internal)?;
        }
        let Some(found) = self.reference_entry() else {
            let what = self.not_judged().unwrap_or_default();
            let next = "give a longer log of the device while it was true";
            return Err(Error::bad_input("short-reference", what, &self.file, next));
        };
        events.push(WatchEvent::Reference(found));
        events.extend(self.unread());
        Ok(events)
    }

    /// Nothing more comes: what was not yet begun is begun with what there is, and the cause of an alarm is sought.
    ///
    /// # Errors
    /// As [`Watch::text`].
    pub fn finish(&mut self) -> Result<Vec<WatchEvent>, Error> {
        let mut events = self.set_up_late()?;
        events.extend(self.seek_cause()?.map(WatchEvent::Cause));
        Ok(events)
    }

    /// Whether the reference is complete, enough rows were judged, and an alarm was given.
    pub fn verdict(&self) -> WatchVerdict {
        match self.monitor.as_ref().map(Monitor::phase) {
            None | Some(Phase::Reference) => WatchVerdict::NotJudged,
            Some(Phase::Watching) if self.not_judged().is_some() => WatchVerdict::NotJudged,
            Some(Phase::Watching) => WatchVerdict::True,
            Some(Phase::Alarmed) => WatchVerdict::Untrue,
        }
    }

    /// Whether so many rows are left out that those judged do not speak for all.
    fn lacks_rows(&self) -> bool {
        let left_out = self.intake.left_out.count();
        left_out as f64 > MOST_LEFT_OUT * (self.rows + left_out) as f64
    }

    /// Numbers and lines held: they do not grow with the rows.
    pub fn held(&self) -> usize {
        let numbers = self.monitor.as_ref().map_or(0, Monitor::numbers_held);
        numbers + self.kept.len() + self.places.len()
    }
}
