//! Coverage of 95 % intervals where the noise has memory, drifts or is larger in a part of a range.

mod noise;

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use haptical_calibration::{
    CalibrationMethod, Channel, FittedDevice, ParameterFit, fit_device, with_curvature,
    with_ordered_noise, with_step_one_noise,
};
use haptical_metrics::median;
use haptical_model::{Device, Recording};
use haptical_report::{Cell, Table};
use xtask_output::{Output, Progress, cells};
use xtask_paper::rows;

use super::held::{Held, Interval, Kind, intervals};
use super::rigs::{Errors, Rig, estimated, nominal, true_device};
use noise::{Condition, Motion, record};

const CONDITIONS: [Condition; 9] = rows! {
    Condition {name correlation drift_sd uneven}
    "white", 0.0, 0.0, 1.0;
    "memory 0.5", 0.5, 0.0, 1.0;
    "memory 0.8", 0.8, 0.0, 1.0;
    "memory 0.95", 0.95, 0.0, 1.0;
    "drift of 2 sd", 0.0, 2.0, 1.0;
    "drift of 3 sd", 0.0, 3.0, 1.0;
    "12 times larger in a range", 0.0, 0.0, 12.0;
    "12 times larger in a range, memory 0.8", 0.8, 0.0, 12.0;
    "all: 12 times, memory 0.8, drift of 3 sd", 0.8, 3.0, 12.0;
};

/// Bounds of the pooled coverage \[%\] by rows.
const BARS: [(usize, [f64; 2]); 2] = [(300, [90.0, 99.0]), (2000, [92.0, 98.0])];
/// Most that the median half width may grow where the noise is white.
const WHITE_GROWTH: f64 = 1.05;

/// One cell of the table.
struct Trial {
    condition: Condition,
    motion: Motion,
    rows: usize,
    rig: Rig,
    method: CalibrationMethod,
}

/// What became of one device.
struct Outcome {
    /// Whether the intervals of independent noise held the truth.
    usual: Vec<bool>,
    kinds: Vec<Kind>,
    /// Names of the others, and whether they did.
    each: Vec<(String, bool)>,
    /// Half widths of parameters over those of independent noise.
    widths: Vec<f64>,
    said: bool,
}

pub(super) fn section(output: &mut Output, devices: usize) -> Result<()> {
    output.section("Noise with memory");
    output.words(format!(
        "{devices} simulated devices a row, as in the trials of white noise: every number off by a normal draw of its plausible \
         size. Each external encoder, the cable or each axis of the tracker has noise of its own, of the stated standard \
         deviation: AR(1) with the correlation of successive rows, a line over the log, noise that is larger beyond a \
         random angle of a joint. Smooth motions are sums of two to four sines of one to three periods over the log; \
         random postures differ from row to row while the noise remembers. Counted is how often the 95 % interval of a \
         parameter holds the truth: before, with the covariance of independent noise, and with the one that follows from \
         the noise. `said` is the share of devices whose result says that the noise is not independent and of one size. \
         White noise is said to be so where a line in time is fitted besides, which a quarter of the channels gets."
    ));
    let columns = "noise | motion | poses | rig | devices | failed | covered before [%] | covered [%] | fixed alone [%] | in a combination [%] | combinations [%] | worst parameter \
                   [%] | of | median half width over before | said [%] | within the bar";
    let mut table = Table::with_heads(
        "Coverage of 95 % intervals where the noise has memory",
        columns,
    );
    let (mut good, mut narrow) = (true, true);
    for (rows, bar) in BARS {
        for motion in [Motion::Smooth, Motion::Random] {
            for (rig, method) in [
                (Rig::Cable, CalibrationMethod::TwoStep),
                (Rig::Cable, CalibrationMethod::Joint),
                (Rig::Tracker, CalibrationMethod::TwoStep),
            ] {
                for condition in CONDITIONS {
                    let trial = Trial {
                        condition,
                        motion,
                        rows,
                        rig,
                        method,
                    };
                    let row = Row::new(&trial.run(devices)?)?;
                    let is_within = (bar[0]..=bar[1]).contains(&row.covered);
                    good &= is_within;
                    if condition.name == "white" {
                        narrow &= row.growth <= WHITE_GROWTH;
                    }
                    table.push(row.cells(&trial, devices, is_within))?;
                }
            }
        }
    }
    output.table("noise-memory", table)?;
    let text = "intervals hold in 92 to 98 % at 2000 poses and 90 to 99 % at 300 where noise has memory, drifts or is uneven";
    output.verdict(good, text);
    let text = "white noise: the median half width grows by at most 5 %";
    output.verdict(narrow, text);
    Ok(())
}

struct Row {
    before: f64,
    covered: f64,
    /// Of parameters fixed alone, of those fixed in a combination, of combinations.
    by_kind: [f64; 3],
    worst: (String, f64),
    growth: f64,
    said: f64,
    failed: usize,
}

impl Row {
    fn new(outcomes: &[Result<Outcome>]) -> Result<Self> {
        let good: Vec<&Outcome> = outcomes.iter().flatten().collect();
        let mut by_name: BTreeMap<&str, Held> = BTreeMap::new();
        for (name, holds) in good.iter().flat_map(|outcome| &outcome.each) {
            by_name.entry(name).or_default().count(*holds);
        }
        let percent = |holds: &[bool]| {
            100.0 * holds.iter().filter(|holds| **holds).count() as f64 / holds.len() as f64
        };
        let usual: Vec<bool> = good.iter().flat_map(|own| own.usual.clone()).collect();
        let own = good
            .iter()
            .flat_map(|own| own.each.iter().map(|(_, holds)| *holds));
        let own: Vec<bool> = own.collect();
        let kinds = good.iter().flat_map(|own| &own.kinds);
        let of_kind = |wanted: Kind| {
            let own = kinds.clone().zip(&own).filter(|(kind, _)| **kind == wanted);
            own.map(|(_, holds)| *holds).collect::<Vec<bool>>()
        };
        let by_kind =
            [Kind::Alone, Kind::Member, Kind::Combination].map(|kind| percent(&of_kind(kind)));
        let widths: Vec<f64> = good.iter().flat_map(|own| own.widths.clone()).collect();
        let often = by_name.iter().filter(|(_, own)| own.is_often(good.len()));
        let worst = often.min_by(|a, b| a.1.percent().total_cmp(&b.1.percent()));
        let (name, worst) = worst.context("no interval at all")?;
        Ok(Self {
            by_kind,
            before: percent(&usual),
            covered: percent(&own),
            worst: ((*name).to_owned(), worst.percent()),
            growth: median(&widths)?,
            said: 100.0 * good.iter().filter(|outcome| outcome.said).count() as f64
                / good.len() as f64,
            failed: outcomes.len() - good.len(),
        })
    }

    fn cells(&self, trial: &Trial, devices: usize, is_within: bool) -> Vec<Cell> {
        let motion = match trial.motion {
            Motion::Smooth => "smooth",
            Motion::Random => "random postures",
        };
        let rig = match (trial.rig, trial.method) {
            (Rig::Cable, CalibrationMethod::TwoStep) => "cable, two steps",
            (Rig::Cable, CalibrationMethod::Joint) => "cable, joint",
            (Rig::Tracker, _) => "tracker, two steps",
        };
        let of_kind = |share: f64| match share.is_finite() {
            true => format!("{share:.1}"),
            false => "none".to_owned(),
        };
        cells! {
            trial.condition.name, motion, trial.rows => 0, rig, devices => 0, self.failed => 0,
            self.before => 1, self.covered => 1, of_kind(self.by_kind[0]), of_kind(self.by_kind[1]),
            of_kind(self.by_kind[2]), self.worst.1 => 1, self.worst.0.clone(), self.growth => 2,
            self.said => 0, if is_within { "yes" } else { "no" },
        }
    }
}

impl Trial {
    fn run(&self, devices: usize) -> Result<Vec<Result<Outcome>>> {
        let nominal = nominal(self.rig, Errors::Gaussian)?;
        let progress = Progress::new(self.condition.name, devices);
        Ok(progress.over(devices, |seed| self.device(&nominal, seed)))
    }

    fn device(&self, nominal: &Device, seed: u64) -> Result<Outcome> {
        let truth = true_device(nominal, seed);
        let seen = record(
            &truth,
            (self.rig, self.motion),
            self.condition,
            self.rows,
            seed,
        )?;
        let fitted = fit_device(nominal, &seen, &estimated(self.method))?;
        let usual = self.finish(fitted.clone(), &seen, true)?;
        let own = with_ordered_noise(fitted, &seen, self.method)?;
        let own = self.finish(own, &seen, false)?;
        let (before, after) = (of_fits(&usual, &truth)?, of_fits(&own, &truth)?);
        let holds = |interval: &Interval| interval.error_over_half_width.abs() <= 1.0;
        // what is a combination may be another by another covariance
        let by_name: BTreeMap<&str, &Interval> = (before.iter())
            .filter(|interval| interval.kind != Kind::Combination)
            .map(|interval| (interval.name.as_str(), interval))
            .collect();
        let width = |own: &Interval| {
            let usual = by_name.get(own.name.as_str())?;
            (own.kind != Kind::Combination).then(|| own.half_width / usual.half_width)
        };
        Ok(Outcome {
            usual: before.iter().map(holds).collect(),
            kinds: after.iter().map(|own| own.kind).collect(),
            widths: after.iter().filter_map(width).collect(),
            each: after.iter().map(|own| (own.label(), holds(own))).collect(),
            said: own.iter().any(|fit| !fit.channel_noise.is_empty()),
        })
    }

    /// The fits whose parameters a user reads, with all that widens their intervals.
    fn finish(
        &self,
        fitted: FittedDevice,
        seen: &Recording,
        is_usual: bool,
    ) -> Result<Vec<ParameterFit>> {
        let whole = fitted.whole.context("no kinematic fit")?;
        let (steps, weights) = (&fitted.transmissions, &fitted.weights);
        let channels = haptical_calibration::channels(&fitted.device, seen)?;
        if self.method == CalibrationMethod::Joint {
            return Ok(vec![with_curvature(whole, seen, &channels, weights)?]);
        }
        let distant: Vec<Channel> = channels
            .into_iter()
            .filter(|channel| !matches!(channel, Channel::Output { .. }))
            .collect();
        let fit = match is_usual {
            true => with_step_one_noise(whole, steps, seen, &distant, weights)?,
            false => whole,
        };
        let fit = with_curvature(fit, seen, &distant, weights)?;
        let steps = fitted.transmissions.into_iter().filter_map(|step| step.fit);
        Ok(std::iter::once(fit).chain(steps).collect())
    }
}

fn of_fits(fits: &[ParameterFit], truth: &Device) -> Result<Vec<Interval>> {
    let mut all = Vec::new();
    for fit in fits {
        all.extend(intervals(fit, truth)?);
    }
    Ok(all)
}
