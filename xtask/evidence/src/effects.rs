//! Coverage of the intervals of effects that are fitted with geometry and drives, and what is said of effects that are not there.

use std::process::Command;

use anyhow::{Context, Result};
use haptical::effects::device::add_effects;
use haptical::{Device, EffectEntry, Identify, Log, identify};
use haptical_calibration::HeldOut;
use haptical_model::{Device as Model, DeviceEffect};
use haptical_report::{Cell, Table};
use haptical_simulator::{
    Effects, Encoders, HandMotion, MotionSettings, Noise, record_motion, simulated_effects,
};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use xtask_output::{Output, Progress, said};
use xtask_paper::rows;

use super::rigs::{Errors, Rig, generator, nominal, true_device, with_noise};

/// An effect with the sizes that are drawn, from smallest to largest, equally likely by their logarithm.
struct Kind {
    name: &'static str,
    /// From 1; none of the whole device.
    joint: Option<usize>,
    /// The number that is counted, first, and others.
    numbers: &'static [(&'static str, [f64; 2])],
}

const KINDS: [Kind; 8] = rows! {
    Kind {name joint numbers}
    "capstan-compliance", Some(2), &[("stiffness_nm_per_rad", [150.0, 1500.0])];
    "joint-compliance", Some(2), &[("stiffness_nm_per_rad", [150.0, 1500.0])];
    "backlash", Some(3), &[("width_rad", [2e-4, 3e-3])];
    "hysteresis", Some(1), &[("amplitude_rad", [2e-4, 2e-3]), ("transition_rad", [0.02, 0.1])];
    "viscous-lag", Some(2), &[("delay_s", [5e-4, 5e-3])];
    "input-drum-harmonic", Some(1),
        &[("amplitude_rad", [1e-4, 1e-3]), ("phase_rad", [0.5, 2.5]), ("order", [2.0, 2.0])];
    "joint-drift", Some(3), &[("rad_per_s", [3e-6, 3e-5])];
    "cable-latency", None, &[("delay_s", [5e-4, 5e-3])];
};

/// Length and rate of a recording.
const SECONDS: f64 = 40.0;
const RATE_HZ: f64 = 25.0;
/// Bounds of the coverage \[%\].
const BAR: [f64; 2] = [93.0, 97.0];
/// Least share of absent effects that are said not to be shown \[%\].
const ABSENT: f64 = 97.0;

/// What became of one device.
struct Outcome {
    /// Whether the interval of the effect's first number holds the truth; none without an interval.
    holds: Option<bool>,
    shown: bool,
    /// Half width over the value.
    relative: f64,
    /// Whether an effect that is not there is said not to be shown.
    absent_is_said: bool,
}

pub(super) fn kinds() -> [&'static str; 8] {
    KINDS.map(|kind| kind.name)
}

const HEADS: &str = "effect | joint | number | devices | failed | shown [%] | covered [%] | median half width [%] | \
                     absent, and said so [%] | commit";
/// Digits of its numbers.
const DIGITS: [usize; 6] = [0, 0, 1, 1, 2, 1];
/// Positions of two of them.
const COVERED: usize = 3;
const SAID: usize = 5;

struct Row {
    numbers: [f64; 6],
    /// Commit whose code the numbers are of.
    commit: String,
}

/// Writes the section; where kinds are named the rows of the others are those of the page `held`.
pub(super) fn section(
    output: &mut Output,
    devices: usize,
    (asked, held): (&[String], &str),
) -> Result<()> {
    output.section("Effects");
    output.words(format!(
        "{devices} simulated devices a row: every number of geometry and drives off by a normal draw of its plausible size, one \
         effect of a drawn size, {SECONDS} s of a hand-guided motion at {RATE_HZ} Hz with forces, and \
         torques whose sensors' scales are off by a normal draw of their `torque_scale_sd`. \
         `identify --with EFFECT@JOINT` starts from the nominal device. Counted is how often the 95 % interval of the effect's \
         first number holds the truth, and, of the same devices without the effect, how often it is said that the log does not \
         show it. `cargo xtask evidence --only effects --kinds NAME,NAME` computes rows again and keeps the others; each \
         names the commit that it was computed with."
    ));
    let commit = commit();
    let mut table = Table::with_heads("Intervals of effects", HEADS);
    let (mut covered, mut said) = (true, Vec::new());
    for kind in &KINDS {
        let is_asked = asked.is_empty() || asked.iter().any(|name| name == kind.name);
        let row = match is_asked {
            true => Row {
                numbers: kind.counted(devices)?,
                commit: commit.clone(),
            },
            false => kind
                .held(held)
                .with_context(|| format!("the page has no row of {}: ask for it too", kind.name))?,
        };
        covered &= (BAR[0]..=BAR[1]).contains(&row.numbers[COVERED]);
        said.push(row.numbers[SAID]);
        let joint = kind.joint.map_or("-".to_owned(), |joint| joint.to_string());
        let numbers = row.numbers.iter().zip(DIGITS);
        let mut cells: Vec<Cell> = vec![kind.name.into(), joint.into(), kind.numbers[0].0.into()];
        cells.extend(numbers.map(|(number, digits)| Cell::number(*number, digits)));
        cells.push(row.commit.into());
        table.push(cells)?;
    }
    output.table("effects", table)?;
    output.verdict(covered, "intervals of effects hold in 93 to 97 %");
    let mean = said.iter().sum::<f64>() / said.len() as f64;
    let text = format!("of effects that are not there {mean:.1} % are said not to be shown");
    output.verdict(mean >= ABSENT, text);
    Ok(())
}

/// Short name of the commit whose code runs; with a plus where the tree is changed.
fn commit() -> String {
    let git = |words: &[&str]| said(Command::new("git").args(words)).unwrap_or_default();
    let changed = git(&["status", "--porcelain", "--", "crates", "xtask"]);
    git(&["rev-parse", "--short=7", "HEAD"]) + if changed.is_empty() { "" } else { "+" }
}

/// Effects as the simulator has them; loops are led by the motor.
fn simulated(effects: &[DeviceEffect]) -> Result<Effects> {
    let mut text = String::new();
    for effect in effects {
        text.push_str(&format!("[[effect]]\nname = \"{}\"\n", effect.name));
        if let Some(joint) = effect.joint {
            text.push_str(&format!("joint = {}\n", joint + 1));
        }
        for (name, value) in &effect.numbers {
            text.push_str(&format!("{name} = {value:?}\n"));
        }
        if ["backlash", "hysteresis"].contains(&effect.name.as_str()) {
            text.push_str("driven_by = \"motor\"\n");
        }
    }
    Ok(Effects::from_toml(&text, "effects")?)
}

impl Kind {
    fn counted(&self, devices: usize) -> Result<[f64; 6]> {
        let nominal = nominal(Rig::Cable, Errors::Gaussian)?;
        let of_seed = |seed| self.device(&nominal, seed);
        let outcomes = Progress::new(self.name, devices).over(devices, of_seed);
        if let Some(Err(error)) = outcomes.iter().find(|outcome| outcome.is_err()) {
            eprintln!("{}: {error:#}", self.name);
        }
        let good: Vec<&Outcome> = outcomes.iter().flatten().collect();
        let share = |count: usize, of: usize| 100.0 * count as f64 / of.max(1) as f64;
        let holds: Vec<bool> = good.iter().filter_map(|own| own.holds).collect();
        let mut widths: Vec<f64> = good.iter().map(|own| own.relative).collect();
        widths.sort_by(f64::total_cmp);
        let shown = good.iter().filter(|own| own.shown).count();
        let said = good.iter().filter(|own| own.absent_is_said).count();
        Ok([
            devices as f64,
            (outcomes.len() - good.len()) as f64,
            share(shown, good.len()),
            share(holds.iter().filter(|holds| **holds).count(), holds.len()),
            100.0 * widths.get(widths.len() / 2).copied().unwrap_or(f64::NAN),
            share(said, good.len()),
        ])
    }

    fn held(&self, page: &str) -> Option<Row> {
        let cells = |line: &str| -> Vec<String> {
            let cells = line.trim_matches('|').split(" | ");
            cells.map(|cell| cell.trim().to_owned()).collect()
        };
        let mut rows = page.lines().map(cells);
        let own = rows.find(|cells| cells.first().is_some_and(|name| name == self.name))?;
        let mut numbers = [0.0; 6];
        for (number, cell) in numbers.iter_mut().zip(own.get(3..9)?) {
            *number = cell.parse().ok()?;
        }
        let commit = own.get(9)?.clone();
        Some(Row { numbers, commit })
    }

    fn device(&self, nominal: &Model, seed: u64) -> Result<Outcome> {
        let mut truth = true_device(nominal, seed);
        let absent = self.fitted(nominal, &truth, seed)?;
        let mut draw = generator(seed, 7);
        let mut numbers = std::collections::BTreeMap::new();
        for (name, [low, high]) in self.numbers {
            let share: f64 = draw.random_range(0.0..1.0);
            numbers.insert((*name).to_owned(), low * (high / low).powf(share));
        }
        let size = numbers[self.numbers[0].0];
        truth.effects.push(DeviceEffect {
            name: self.name.to_owned(),
            joint: self.joint.map(|joint| joint - 1),
            numbers,
            ..DeviceEffect::default()
        });
        let there = self.fitted(nominal, &truth, seed)?;
        let number = there.parameters.get(self.numbers[0].0);
        let interval = number.and_then(|number| number.ci95);
        let holds = interval.map(|[low, high]| {
            low.is_none_or(|low| low <= size) && high.is_none_or(|high| size <= high)
        });
        let relative = match interval {
            Some([Some(low), Some(high)]) => 0.5 * (high - low) / size,
            _ => f64::INFINITY,
        };
        Ok(Outcome {
            holds,
            shown: there.shown,
            relative,
            absent_is_said: !absent.shown,
        })
    }

    /// What an identification says of the effect, of a recording of a device.
    fn fitted(&self, nominal: &Model, truth: &Model, seed: u64) -> Result<EffectEntry> {
        let settings = MotionSettings {
            motion: HandMotion {
                seconds: SECONDS,
                rate_hz: RATE_HZ,
                rests: 1,
                ..HandMotion::default()
            },
            // counts of a device at rest err by the same again and again
            encoders: Encoders::Same(with_noise(Noise::Gaussian)),
            ..MotionSettings::default()
        };
        let mut rigid = truth.clone();
        let own = std::mem::take(&mut rigid.effects);
        // by the simulator's own laws where it has them
        let names = simulated_effects();
        let by_simulator = own.iter().all(|own| names.contains(&own.name.as_str()));
        let mut recording = if by_simulator {
            record_motion(&rigid, &simulated(&own)?, &settings, seed)?
        } else {
            let mut recording = record_motion(&rigid, &Effects::none(), &settings, seed)?;
            add_effects(truth, &mut recording)?;
            recording
        };
        // an interval of a stiffness counts what is not known of the torque sensor's scale
        let mut scales = generator(seed, 8);
        for (joint, column) in nominal.joints.iter().zip(&mut recording.torque_nm) {
            let draw: f64 = StandardNormal.sample(&mut scales);
            let scale = 1.0 + joint.torque_scale_sd * draw;
            for torque_nm in column.iter_mut().flatten() {
                *torque_nm *= scale;
            }
        }
        let device = Device::from_toml(&nominal.to_new_toml()?, "nominal.toml")?;
        let log = Log::from_recording(recording, "simulated", &device)?;
        let word = match self.joint {
            Some(joint) => format!("{}@{joint}", self.name),
            None => self.name.to_owned(),
        };
        let mut request = Identify {
            with: vec![word],
            ..Identify::default()
        };
        request.options.held_out = HeldOut::None;
        // its order is part of its name: the first of the catalogue's
        let found = identify(&device, &log, &request)?;
        let mut entries = found.result.effects.into_iter();
        entries.next().context("nothing is said of the effect")
    }
}
