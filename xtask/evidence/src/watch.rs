//! False alarms and delays of the watch over simulated days, one row a second, noise with memory included.

use anyhow::{Context, Result, ensure};
use haptical::monitor::{Course, Event, Monitor, Settings};
use haptical_report::{Cell, Table};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use xtask_output::{Output, Progress, cells};
use xtask_paper::rows;

/// Rows of a day at one a second.
const DAY: u32 = 86_400;
/// Correlation of successive rows.
const MEMORIES: [f64; 4] = [0.0, 0.5, 0.9, 0.98];
/// False alarms an hour that are stated.
const PER_HOUR: [f64; 3] = [0.01, 0.1, 1.0];
/// Changes at once.
const CHANGES: [Shifted; 7] = rows! {
    Shifted {rms follows_posture}
    0.25, false;
    0.5, false;
    1.0, false;
    2.0, false;
    1.0, true;
    2.0, true;
    4.0, true;
};
/// Two frequencies of the postures' course, in radians a row.
const COURSE: [f64; 2] = [0.0613, 0.0177];
/// Rate of false alarms that delays are counted at.
const STATED: f64 = 0.01;
/// Row of a day at which the calibration ceases to be true.
const CHANGE: u32 = DAY / 4;

/// A change of the residual.
#[derive(Debug, Clone, Copy)]
struct Shifted {
    /// Root mean square in standard deviations of a row.
    rms: f64,
    /// Whether it follows the posture, as that of a joint's zero or a link does: it is none on average.
    follows_posture: bool,
}

impl Shifted {
    fn at(self, row: u32, day: u64) -> f64 {
        if !self.follows_posture {
            return self.rms;
        }
        self.rms * postures(day, row).iter().sum::<f64>()
    }
}

/// Joints at a row of a day, of which each begins somewhere else in the course.
fn postures(day: u64, row: u32) -> [f64; 2] {
    let begins = 1e3 * day as f64;
    COURSE.map(|rate| (rate * (begins + f64::from(row))).sin())
}

/// AR(1) noise of standard deviation 1.
struct Noise {
    rng: ChaCha8Rng,
    memory: f64,
    last: f64,
}

impl Noise {
    fn new(seed: u64, memory: f64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let last = StandardNormal.sample(&mut rng);
        Self { rng, memory, last }
    }

    fn next(&mut self) -> f64 {
        let shock: f64 = StandardNormal.sample(&mut self.rng);
        self.last = self.memory * self.last + (1.0 - self.memory * self.memory).sqrt() * shock;
        self.last
    }
}

/// What became of a day.
struct Day {
    block_rows: usize,
    reference_h: f64,
    false_alarms: [usize; PER_HOUR.len()],
    found: Vec<Found>,
}

/// What became of a shift.
struct Found {
    /// Rows until the alarm, none by the day's end.
    delay: Option<u32>,
    /// Whether the alarm came before the shift.
    early: bool,
    /// Whether the interval holds the shift, its length, and whether a step was said.
    placed: Option<(bool, f64, bool)>,
}

pub(super) fn section(output: &mut Output, days: usize) -> Result<()> {
    output.section("Watch");
    output.words(format!(
        "{days} simulated days of each noise, one residual a second, each day behind a reference of its own (at least one hour, \
         longer where the noise remembers longer). The noise is AR(1) with the correlation of successive rows. Without a change \
         alarms are counted, the sums starting anew after each; with one, six hours into the day, the time to the alarm at a \
         stated rate of one false alarm in {:.0} h, and whether the 95 % interval of the change holds it. A shift is the \
         same at every posture, or follows the posture (the sum of two sines of 102 and 355 rows), as that of a joint's zero or a link \
         does. Every row counts and no tolerance is given: the default tolerance of `haptical watch` makes alarms rarer and small \
         shifts invisible.",
        1.0 / STATED
    ));
    let columns = "correlation of rows | rows of a block, median | reference, median [h] | hours | stated, one an hour | counted | stated, one in 10 h | \
                   counted | stated, one in 100 h | counted";
    let mut alarms = Table::with_heads("False alarms of the watch", columns);
    let columns = "correlation of rows | shift, root mean square [sd of a row] | follows the posture | days | before the shift | found by the day's end | delay, median [min] | \
                   nine of ten within [min] | interval holds the shift [%] | its median length [min] | said to be a step [%]";
    let mut delays = Table::with_heads("Delays of the watch", columns);
    let (mut is_rare, mut is_placed) = (true, true);
    for memory in MEMORIES {
        let progress = Progress::new(&format!("memory {memory}"), days);
        let all = progress.over(days, |seed| day(seed, memory)).into_iter();
        let all: Vec<Day> = all.collect::<Result<_>>()?;
        let hours = 24.0 * days as f64;
        let mut cells = cells! {
            memory => 2, middle(all.iter().map(|day| day.block_rows as f64), 0.5)? => 0,
            middle(all.iter().map(|day| day.reference_h), 0.5)? => 1, hours => 0,
        };
        for rate in (0..PER_HOUR.len()).rev() {
            let counted: usize = all.iter().map(|day| day.false_alarms[rate]).sum();
            is_rare &= counted as f64 <= PER_HOUR[rate] * hours;
            cells.push(Cell::number(PER_HOUR[rate] * hours, 0));
            cells.push(Cell::number(counted as f64, 0));
        }
        alarms.push(cells)?;
        for (index, shift) in CHANGES.into_iter().enumerate() {
            let found: Vec<&Found> = all.iter().map(|day| &day.found[index]).collect();
            let (cells, holds) = row(memory, shift, &found)?;
            is_placed &= holds;
            delays.push(cells)?;
        }
    }
    output.table("watch-false-alarms", alarms)?;
    output.table("watch-delays", delays)?;
    let text = "no more false alarms than stated, whatever the noise remembers";
    output.verdict(is_rare, text);
    let text = "the 95 % interval of a change holds it on at least 90 % of days wherever half of the days have an alarm";
    output.verdict(is_placed, text);
    Ok(())
}

/// A line of the delays, and whether the intervals hold.
fn row(memory: f64, shift: Shifted, found: &[&Found]) -> Result<(Vec<Cell>, bool)> {
    let early = found.iter().filter(|found| found.early).count();
    let judged: Vec<&&Found> = found.iter().filter(|found| !found.early).collect();
    let minutes = |found: &&&Found| found.delay.map_or(f64::INFINITY, f64::from) / 60.0;
    let minutes = judged.iter().map(minutes);
    let seen = judged.iter().filter(|found| found.delay.is_some()).count();
    let placed: Vec<(bool, f64, bool)> = judged.iter().filter_map(|found| found.placed).collect();
    let percent = |count: usize| 100.0 * count as f64 / placed.len().max(1) as f64;
    let holding = percent(placed.iter().filter(|one| one.0).count());
    let steps = percent(placed.iter().filter(|one| one.2).count());
    let late = |value: f64| match value.is_finite() {
        true => Cell::number(value, 1),
        false => "later".into(),
    };
    let length = match placed.is_empty() {
        true => "none".into(),
        false => Cell::number(middle(placed.iter().map(|one| one.1 / 60.0), 0.5)?, 1),
    };
    let holds = 2 * seen < judged.len() || holding >= 90.0;
    let cells = cells! {
        memory => 2, shift.rms => 2, if shift.follows_posture { "yes" } else { "no" },
        found.len() => 0, early => 0, seen => 0, late(middle(minutes.clone(), 0.5)?),
        late(middle(minutes, 0.9)?), holding => 1, length, steps => 0,
    };
    Ok((cells, holds))
}

/// The order statistic at a share.
fn middle(values: impl Iterator<Item = f64>, share: f64) -> Result<f64> {
    let mut values: Vec<f64> = values.collect();
    ensure!(!values.is_empty(), "no day");
    values.sort_by(f64::total_cmp);
    let place = (share * (values.len() - 1) as f64).ceil() as usize;
    values.get(place).copied().context("no day at this share")
}

fn day(seed: u64, memory: f64) -> Result<Day> {
    let mut noise = Noise::new(seed, memory);
    let mut monitor = Monitor::new(Settings {
        floors: vec![0.0],
        tolerances: vec![0.0],
        reference_rows: 3600,
        miss: 0.05,
    })?;
    let mut rows = 0_u32;
    while monitor.push(0.0, &[noise.next()])? != Some(Event::Referenced) {
        rows += 1;
        ensure!(rows < 30 * DAY, "no reference in 30 days");
    }
    let block_rows = monitor
        .reference()
        .map_or(0, |reference| reference.block_rows);
    let mut false_alarms = [0; PER_HOUR.len()];
    for (count, per_hour) in false_alarms.iter_mut().zip(PER_HOUR) {
        let mut monitor = monitor.clone();
        monitor.set_rows_between_false_alarms(3600.0 / per_hour)?;
        let mut noise = Noise::new(seed ^ 0xA5A5, memory);
        for row in 0..DAY {
            if monitor.push(f64::from(row), &[noise.next()])? == Some(Event::Alarm) {
                *count += 1;
                monitor.resume();
            }
        }
    }
    monitor.set_rows_between_false_alarms(3600.0 / STATED)?;
    let shifts = CHANGES
        .iter()
        .map(|shift| shifted(monitor.clone(), (seed, memory), *shift));
    Ok(Day {
        block_rows,
        reference_h: f64::from(rows) / 3600.0,
        false_alarms,
        found: shifts.collect::<Result<_>>()?,
    })
}

fn shifted(mut monitor: Monitor, (day, memory): (u64, f64), shift: Shifted) -> Result<Found> {
    let mut noise = Noise::new(day ^ 0x5A5A, memory);
    let mut course = Course::default();
    for row in 0..DAY {
        course.push(f64::from(row), postures(day, row).into_iter());
        let moved = if row < CHANGE {
            0.0
        } else {
            shift.at(row, day)
        };
        if monitor.push(f64::from(row), &[noise.next() + moved])? != Some(Event::Alarm) {
            continue;
        }
        let early = row < CHANGE;
        let (change, [from, _, to], _) = monitor
            .change(course.spell_s())
            .context("an alarm without a block")?;
        let holds = (from..=to).contains(&f64::from(CHANGE));
        let is_step = change.shape == haptical::monitor::Shape::Step;
        return Ok(Found {
            delay: (!early).then(|| row - CHANGE),
            early,
            placed: Some((holds, to - from, is_step)),
        });
    }
    Ok(Found {
        delay: None,
        early: false,
        placed: None,
    })
}
