//! Rows of residuals in, blocks judged, an alarm out; memory is bounded whatever comes.

mod since;

use std::collections::VecDeque;

use crate::block::{BASE_ROWS, Blocks, Sums};
use crate::detector::Detector;
use crate::error::MonitorError;
use crate::reference::{LEAST_BLOCKS, Reference};
use crate::unclipped::Unclipped;

/// Most blocks that are kept to say since when.
pub const RING_BLOCKS: usize = 4096;
/// Most rows that the scales are made from; of more every second is left out.
const MOST_SETTLED: usize = 4096;
/// Readings farther from the centre than this many scales count as if they lay there.
const FARTHEST: f64 = 8.0;
/// Least rows that scales are made from.
const LEAST_SETTLED: usize = 128;
/// Share of its floor below which a spread is that of a sensor that stood still: then its floor is a tolerance.
const STILL: f64 = 0.25;
/// Standard deviation of a normal distribution over its median absolute deviation.
const NORMAL_PER_MAD: f64 = 1.482_602_218_505_602;
/// Probability of the interval of a change.
const LEVEL: f64 = 0.95;

/// What a monitor is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Least scale of each component, in its unit: the noise that its sensor has in any case, 0 for none.
    pub floors: Vec<f64>,
    /// What the mean of each component may be off without being another, in its unit.
    pub tolerances: Vec<f64>,
    /// Least rows of the reference.
    pub reference_rows: usize,
    /// Probability that the reference is off by more than its margins.
    pub miss: f64,
}

/// What a monitor is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Rows go into the reference.
    Reference,
    /// Rows are judged.
    Watching,
    /// An alarm was given.
    Alarmed,
}

/// What a row brought about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// The reference is complete.
    Referenced,
    /// A block was judged.
    Block,
    /// The calibration is no longer true.
    Alarm,
}

/// What moved, of one component.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shift {
    /// Component, from 0.
    pub component: usize,
    /// Mean in the reference, in its unit.
    pub mean_before: f64,
    /// Mean since the change.
    pub mean_since: f64,
    /// 95 % half width of the difference.
    pub half_width: f64,
    /// Root mean square about the reference's centre, in the reference.
    pub rms_before: f64,
    /// The same since the change.
    pub rms_since: f64,
    /// Its share of the evidence.
    pub share: f64,
}

/// Where a component stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComponentState {
    /// Mean of the last blocks less that of the reference, in its unit.
    pub shift: f64,
    /// 95 % half width of that.
    pub half_width: f64,
    /// Standard deviation of a row that scales it.
    pub scale: f64,
}

#[derive(Debug, Clone)]
struct Mark {
    row: u64,
    time: f64,
}

/// Judges residuals row by row.
#[derive(Debug, Clone)]
pub struct Monitor {
    settings: Settings,
    rows: u64,
    settled: Vec<f64>,
    stride: usize,
    centres: Vec<f64>,
    scales: Vec<f64>,
    /// Tolerances in scales.
    tolerances: Vec<f64>,
    blocks: Blocks,
    tried: usize,
    /// Rows that a reference needs, as far as the rows so far show it.
    wanted_rows: u64,
    reference: Option<Reference>,
    reference_end: u64,
    detector: Option<Detector>,
    rows_between: f64,
    is_held: bool,
    open: Vec<Sums>,
    open_rows: usize,
    scaled: Vec<f64>,
    judged: Vec<Option<[f64; 2]>>,
    /// Standardised features, `[mean, size]` of each component, NaN for none.
    ring: VecDeque<f64>,
    marks: VecDeque<Mark>,
    unclipped: Unclipped,
    last_time: f64,
    alarmed: bool,
    /// Rows at the alarm.
    alarm_row: Option<u64>,
    clipped: u64,
    blocks_judged: u64,
    most_evidence: f64,
}

impl Monitor {
    /// A monitor of as many components as there are floors.
    ///
    /// # Errors
    /// [`MonitorError::OutOfRange`] for settings outside their ranges.
    pub fn new(settings: Settings) -> Result<Self, MonitorError> {
        let components = settings.floors.len();
        let refuse = |what, got, allowed| Err(MonitorError::OutOfRange { what, got, allowed });
        if components == 0 || settings.tolerances.len() != components {
            return refuse(
                "components",
                components as f64,
                "at least 1, with a tolerance each",
            );
        }
        if !(settings.miss > 0.0 && settings.miss < 1.0) {
            return refuse("miss", settings.miss, "between 0 and 1");
        }
        let sizes = settings.floors.iter().chain(&settings.tolerances);
        if let Some(&got) = sizes
            .into_iter()
            .find(|size| !(size.is_finite() && **size >= 0.0))
        {
            return refuse("a floor or tolerance", got, "at least 0");
        }
        Ok(Self {
            rows: 0,
            settled: Vec::with_capacity(components * MOST_SETTLED),
            stride: 1,
            centres: Vec::new(),
            scales: Vec::new(),
            tolerances: Vec::new(),
            blocks: Blocks::new(components),
            tried: 0,
            wanted_rows: settings.reference_rows as u64,
            reference: None,
            reference_end: 0,
            detector: None,
            rows_between: f64::INFINITY,
            is_held: false,
            open: vec![Sums::default(); components],
            open_rows: 0,
            scaled: vec![f64::NAN; components],
            judged: vec![None; components],
            ring: VecDeque::with_capacity(2 * components * RING_BLOCKS),
            marks: VecDeque::with_capacity(RING_BLOCKS),
            unclipped: Unclipped::new(components, FARTHEST),
            last_time: f64::NAN,
            alarmed: false,
            alarm_row: None,
            clipped: 0,
            blocks_judged: 0,
            most_evidence: 0.0,
            settings,
        })
    }

    /// Mean number of rows between false alarms: rows an hour over false alarms an hour.
    ///
    /// # Errors
    /// [`MonitorError::OutOfRange`] unless it is above 0.
    pub fn set_rows_between_false_alarms(&mut self, rows: f64) -> Result<(), MonitorError> {
        if rows > 0.0 {
            self.rows_between = rows;
            return Ok(());
        }
        Err(MonitorError::OutOfRange {
            what: "rows between false alarms",
            got: rows,
            allowed: "above 0",
        })
    }

    /// Takes the residuals of a row, NaN for none; `time` is any number that says when.
    ///
    /// # Errors
    /// [`MonitorError::Width`] for a row of another width.
    pub fn push(&mut self, time: f64, row: &[f64]) -> Result<Option<Event>, MonitorError> {
        let wanted = self.settings.floors.len();
        if row.len() != wanted {
            let got = row.len();
            return Err(MonitorError::Width { got, wanted });
        }
        self.rows += 1;
        if self.scales.is_empty() {
            self.settle(row);
            return Ok(None);
        }
        self.scale(row);
        if self.reference.is_some() {
            return Ok(self.judge(time));
        }
        if self.blocks.push(&self.scaled) && !self.is_held {
            return self.try_reference();
        }
        Ok(None)
    }

    /// Every row is one of the reference until [`Monitor::end_reference`].
    pub fn hold_reference(&mut self) {
        self.is_held = true;
    }

    /// Completes the reference with the rows so far, if they are enough; rows after this are judged, or complete it.
    ///
    /// # Errors
    /// A quantile that cannot be worked out.
    pub fn end_reference(&mut self) -> Result<Option<Event>, MonitorError> {
        self.is_held = false;
        match self.scales.is_empty() || self.reference.is_some() {
            true => Ok(None),
            false => self.try_reference(),
        }
    }

    fn settle(&mut self, row: &[f64]) {
        if self.rows.is_multiple_of(self.stride as u64) {
            self.settled.extend_from_slice(row);
        }
        let width = row.len();
        if self.settled.len() == width * MOST_SETTLED {
            let kept = self.settled.chunks_exact(2 * width);
            let kept: Vec<f64> = kept.flat_map(|pair| &pair[..width]).copied().collect();
            self.settled.clear();
            self.settled.extend(kept);
            self.stride *= 2;
        }
        let wanted = (self.settings.reference_rows / 10).max(LEAST_SETTLED);
        if self.rows >= wanted as u64 {
            for component in 0..width {
                let own = self.settled.iter().skip(component).step_by(width);
                let own: Vec<f64> = own.copied().filter(|value| value.is_finite()).collect();
                let (centre, spread) = centre_and_spread(own);
                let floor = self.settings.floors[component];
                let scale = spread.max(floor).max(f64::MIN_POSITIVE.sqrt());
                let still = f64::from(u8::from(spread < STILL * floor));
                self.centres.push(centre);
                self.scales.push(scale);
                self.tolerances
                    .push(self.settings.tolerances[component] / scale + still);
            }
            self.settled = Vec::new();
        }
    }

    fn scale(&mut self, row: &[f64]) {
        let own = self.centres.iter().zip(&self.scales);
        let is_judged = self.reference.is_some();
        let scaled = self.scaled.iter_mut().zip(row).zip(own).enumerate();
        for (component, ((scaled, value), (centre, scale))) in scaled {
            let all = (value - centre) / scale;
            self.clipped += u64::from(all.abs() > FARTHEST);
            if is_judged {
                self.unclipped.push(component, all);
            }
            // NaN stays
            *scaled = all.clamp(-FARTHEST, FARTHEST);
        }
    }

    fn try_reference(&mut self) -> Result<Option<Event>, MonitorError> {
        let count = self.blocks.len() * self.blocks.rows / BASE_ROWS;
        let lacking = LEAST_BLOCKS.saturating_sub(count) * BASE_ROWS;
        if lacking > 0 {
            self.wanted_rows = self.wanted_rows.max(self.rows + lacking as u64);
        }
        let is_early = self.rows < self.settings.reference_rows as u64 || lacking > 0;
        // every twentieth part more is soon enough
        if is_early || count < self.tried + self.tried / 20 {
            return Ok(None);
        }
        self.tried = count;
        let width = self.scales.len();
        let found = Reference::of(&self.blocks, width, self.settings.miss, &self.tolerances)?;
        let found = match found {
            Ok(found) => found,
            Err(longer) => {
                self.wanted_rows = (self.rows as f64 * longer).ceil() as u64;
                return Ok(None);
            }
        };
        self.detector = Some(Detector::new(&found));
        self.unclipped.reserve(found.block_rows);
        self.reference = Some(found);
        self.reference_end = self.rows;
        self.blocks = Blocks::new(0);
        Ok(Some(Event::Referenced))
    }

    fn judge(&mut self, time: f64) -> Option<Event> {
        self.last_time = time;
        let (Some(reference), Some(detector)) = (&self.reference, &mut self.detector) else {
            return None;
        };
        if self.open_rows == 0 {
            if self.marks.len() == RING_BLOCKS {
                self.marks.pop_front();
            }
            let row = self.rows;
            self.marks.push_back(Mark { row, time });
        }
        for (sums, value) in self.open.iter_mut().zip(&self.scaled) {
            if value.is_finite() {
                sums.add(*value);
            }
        }
        self.open_rows += 1;
        if self.open_rows < reference.block_rows {
            return None;
        }
        self.open_rows = 0;
        self.unclipped.close_block();
        let width = 2 * self.open.len();
        if self.ring.len() == width * RING_BLOCKS {
            self.ring.drain(..width);
        }
        for (index, sums) in self.open.iter_mut().enumerate() {
            let standard = reference.standardised(index, *sums);
            self.ring.extend(standard.unwrap_or([f64::NAN; 2]));
            self.judged[index] = standard;
            *sums = Sums::default();
        }
        // of a block without a reading nothing is judged
        self.blocks_judged += u64::from(self.judged.iter().any(Option::is_some));
        if self.alarmed {
            return Some(Event::Block);
        }
        detector.push(reference, &self.judged);
        let evidence = detector.evidence();
        self.most_evidence = self.most_evidence.max(evidence);
        self.alarmed = evidence * reference.block_rows as f64 >= self.rows_between;
        self.alarm_row = self.alarmed.then_some(self.rows);
        Some(match self.alarmed {
            true => Event::Alarm,
            false => Event::Block,
        })
    }

    /// Goes on after an alarm, with sums at zero.
    pub fn resume(&mut self) {
        self.alarmed = false;
        self.alarm_row = None;
        if let Some(detector) = &mut self.detector {
            detector.reset();
        }
    }

    /// Blocks after which a shift by one standard deviation of a block is an alarm, of the mean of one component; 0 without a
    /// reference. Fewer say little.
    pub fn least_blocks(&self) -> u64 {
        let (Some(reference), Some(detector)) = (&self.reference, &self.detector) else {
            return 0;
        };
        let wanted = self.rows_between / reference.block_rows as f64;
        detector.blocks_until(wanted)
    }

    /// What the monitor is at.
    pub fn phase(&self) -> Phase {
        match (&self.reference, self.alarmed) {
            (None, _) => Phase::Reference,
            (_, true) => Phase::Alarmed,
            _ => Phase::Watching,
        }
    }

    /// The reference, where it is complete.
    pub fn reference(&self) -> Option<&Reference> {
        self.reference.as_ref()
    }

    /// Evidence over what an alarm needs: 1 is an alarm.
    pub fn evidence(&self) -> f64 {
        match (&self.reference, &self.detector) {
            (Some(reference), Some(detector)) => {
                detector.evidence() * reference.block_rows as f64 / self.rows_between
            }
            _ => 0.0,
        }
    }

    /// Scale of each component, in its unit: a robust standard deviation of a row, at least the floor; none while the first
    /// rows are taken.
    pub fn scales(&self) -> &[f64] {
        &self.scales
    }

    /// Rows that the reference was made from, those of the scales included; 0 while it is not complete.
    pub fn reference_rows(&self) -> u64 {
        self.reference_end
    }

    /// Rows that a reference needs: at least those asked for, and about as many as its noise remembers once that has shown.
    pub fn wanted_reference_rows(&self) -> u64 {
        self.wanted_rows.max(self.rows + 1)
    }

    /// Whether the rows so far were tried as a reference and are none.
    pub fn is_refused(&self) -> bool {
        self.tried > 0 && self.reference.is_none()
    }

    /// Rows taken.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Blocks judged.
    pub fn blocks_judged(&self) -> u64 {
        self.blocks_judged
    }

    /// Readings that counted as less than they were.
    pub fn clipped(&self) -> u64 {
        self.clipped
    }

    /// Numbers held, of whatever kind: it does not grow with the rows.
    pub fn numbers_held(&self) -> usize {
        let blocks = (self.blocks.len() + 1) * self.scales.len() * 3;
        let kept = self.settled.capacity() + self.ring.capacity() + 2 * self.marks.capacity();
        kept + self.unclipped.numbers_held() + blocks
    }
}

/// Median, and the median distance from it as the standard deviation of a normal distribution; zeros of nothing.
fn centre_and_spread(mut values: Vec<f64>) -> (f64, f64) {
    if values.is_empty() {
        return (0.0, 0.0);
    }
    let centre = median(&mut values);
    let mut far: Vec<f64> = values.iter().map(|value| (value - centre).abs()).collect();
    (centre, NORMAL_PER_MAD * median(&mut far))
}

/// The middle one of numbers, of which there is one at least.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
