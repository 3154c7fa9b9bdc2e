//! Words, table and pictures of the paper's own gap.

use anyhow::{Context, Result};
use haptical_diagnosis::{Diagnosis, plausible_range};
use haptical_model::Device;
use haptical_report::{Cell, Figure, FigureGrid, Table};
use xtask_output::{Output, cells, or_none};

use super::gap_kinds::{CABLE_NOISE, KINDS, Kind, label};
use super::own_gap::{Errors, Explained, Found, explain};
use crate::monte_carlo::largest_size;
use crate::published::Paper;
use crate::scenario::Scenario;

/// Every so many kinds are tried where a few are enough.
const FEW: usize = 5;
/// Rest at home at both ends of the motion \[s\].
const REST_S: f64 = 2.0;
/// Sizes that the literature reports are this much within the catalogue's limits.
const USUAL: f64 = 10.0;

pub(crate) fn gap_section(
    output: &mut Output,
    scenario: &Scenario,
    paper: &Paper,
    seed: u64,
    every_kind: bool,
) -> Result<()> {
    let percent = paper.text.improvement_full_percent;
    let step = if every_kind { 1 } else { FEW };
    let kinds: Vec<Kind> = KINDS.iter().copied().step_by(step).collect();
    let (clean, all) = explain(scenario, &kinds, percent, seed)?;
    output.section("The paper's own gap");
    output.words(format!(
        "Without unmodelled effects the full calibration takes away {:.2} % of the distance's error on this motion \
         (200 random rows for each step, tested on all); the authors measured {percent} %. Each row adds one effect to the virtual device, at the size at which the same two \
         steps on the same motion reach {percent} %. \"Usual\" is a size that the catalogue's sources report, \
         \"hardly\" one up to ten times beyond, \"no\" one further off (docs/diagnosis.md, Catalogue). What Figure 10 \
         would show is that motion's error after calibration: its mean in the rests at home before and after, its \
         peak, and how much of it goes with the cable's speed. The last columns are what the diagnosis says of the \
         log, its effect withheld.",
        clean.errors.improvement_percent()?
    ));
    let table = table(&clean, &all, &scenario.nominal)?;
    output.terminal_table(&table, &[0, 1, 2, 7]);
    output.table("own_gap", table)?;
    let asked: Vec<&Explained> = all.iter().filter(|one| !one.kind.is_noise()).collect();
    let answered: Vec<(&Kind, &Found)> = asked
        .iter()
        .filter_map(|one| Some((&one.kind, one.found.as_ref()?)))
        .collect();
    let is_right = |(kind, found): &&(&Kind, &Found)| names_it(kind, found);
    let right = answered.iter().filter(is_right).count();
    let text = format!(
        "the diagnosis names {right} of the {} effects that can give {percent} %, from the log alone",
        answered.len()
    );
    output.verdict(right == answered.len(), text);
    output.words(likely(&all, &scenario.nominal));
    let caption = "Figure 10 (b) again with each effect at the size that gives the authors' percentage: error of \
                   the distance after full calibration";
    output.grid("own_gap", caption, &figure(&all)?)
}

/// Whether what was simulated is named at its place, or among the names that the log cannot tell apart.
fn names_it(kind: &Kind, found: &Found) -> bool {
    let named = found.answer.as_ref().ok();
    let named = named.filter(|answer| answer.verdict.has_causes());
    named
        .and_then(|answer| answer.causes.first())
        .is_some_and(|cause| {
            let is_itself = cause.effect == kind.name && cause.joint == kind.joint;
            let mut twins = cause.confusable_with.iter();
            is_itself || twins.any(|twin| *twin == kind.label() || twin == kind.name)
        })
}

/// "usual", "hardly", "no".
fn plausible(kind: &Kind, size: f64, nominal: &Device) -> &'static str {
    let Some([low, high]) = plausible_range(nominal, kind.name, kind.parameter) else {
        return "-";
    };
    if size >= USUAL * low && size <= high / USUAL {
        "usual"
    } else if (low..=high).contains(&size) {
        "hardly"
    } else {
        "no"
    }
}

fn table(clean: &Found, all: &[Explained], nominal: &Device) -> Result<Table> {
    let mut table = Table::with_heads(
        "Effects that would account for the authors' percentage",
        "effect | size that gives it | plausible | at rest before, after [mm] | RMS [mm] | peak [mm] | \
                  with the cable's speed [%] | diagnosis | its size, 95 %",
    );
    let mut row = cells! { "none", "", "" };
    row.extend(effect_on_figure10(clean)?);
    row.extend(cells! { answer(&CABLE_NOISE, clean).0, "" });
    table.push(row)?;
    for one in all {
        let (unit, scale) = one.kind.unit;
        let Some(found) = &one.found else {
            let largest = scale * one.kind.sizes[1];
            let at = match &one.at_largest_percent {
                Ok(percent) => format!("{percent:.2} %"),
                Err(error) => error.clone(),
            };
            let none = format!("none up to {largest:.4} {unit} ({at})");
            table.push(cells! { one.kind.label(), none, "", "", "", "", "", "", "" })?;
            continue;
        };
        let size = format!("{} {unit}", short(scale * found.size));
        let is_usual = plausible(&one.kind, found.size, nominal);
        let mut row = cells! { one.kind.label(), size, is_usual };
        row.extend(effect_on_figure10(found)?);
        let (words, size) = answer(&one.kind, found);
        row.extend(cells! { words, size });
        table.push(row)?;
    }
    Ok(table)
}

/// Means in the rests, RMS, peak and the share that goes with speed, as cells.
fn effect_on_figure10(found: &Found) -> Result<[Cell; 4]> {
    let shown = figure10(&found.errors)?;
    let [before, after] = shown.rest_mm;
    Ok([
        format!("{before:.2}, {after:.2}").into(),
        Cell::number(shown.rms_mm, 2),
        Cell::number(shown.peak_mm, 2),
        Cell::number(100.0 * shown.speed_share, 0),
    ])
}

/// Three significant digits.
fn short(value: f64) -> String {
    let digits = (2.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.digits$}")
}

/// Verdict and size in words.
fn answer(kind: &Kind, found: &Found) -> (String, String) {
    let answer: &Diagnosis = match &found.answer {
        Ok(answer) => answer,
        Err(error) => return (format!("no answer: {error}"), String::new()),
    };
    let mut words = answer.verdict.name().to_owned();
    for (index, cause) in answer.causes.iter().enumerate() {
        words += if index == 0 { ": " } else { "; " };
        words += &label(&cause.effect, cause.joint);
        if !cause.confusable_with.is_empty() {
            words += &format!(" (or {})", cause.confusable_with.join(", "));
        }
    }
    let (unit, scale) = kind.unit;
    let cause = answer.causes.first();
    let cause = cause.filter(|cause| cause.effect == kind.name);
    let size = cause.and_then(|cause| cause.parameters.get(kind.parameter));
    let size = size.map(|size| {
        let [low, high] = size.ci95.map(|end| short(scale * end));
        format!("{} [{low}, {high}] {unit}", short(scale * size.value))
    });
    (words, size.unwrap_or_default())
}

/// What Figure 10 (b) shows of the calibrated device.
struct Shown {
    /// Means in the rests at home.
    rest_mm: [f64; 2],
    rms_mm: f64,
    peak_mm: f64,
    /// Share of its square that goes with the cable's speed.
    speed_share: f64,
}

fn figure10(errors: &Errors) -> Result<Shown> {
    let time_s = errors.recording.time_s.as_ref().context("no time")?;
    let end_s = time_s.last().context("no rows")?;
    let mean_mm = |wanted: &dyn Fn(f64) -> bool| {
        let rows = errors.after_m.iter().zip(time_s);
        let there: Vec<f64> = rows
            .filter(|(_, time_s)| wanted(**time_s))
            .map(|(error, _)| 1e3 * error)
            .collect();
        there.iter().sum::<f64>() / there.len().max(1) as f64
    };
    let cable = errors.recording.cable_m.first().and_then(Option::as_ref);
    let cable = cable.context("no cable")?;
    let middles = 1..cable.len().saturating_sub(1);
    let pairs: Vec<(f64, f64)> = middles
        .map(|row| {
            let speed = (cable[row + 1] - cable[row - 1]) / (time_s[row + 1] - time_s[row - 1]);
            (speed, errors.after_m[row])
        })
        .collect();
    let sum = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
    let cross = sum(&|(speed, error)| speed * error);
    let squares = sum(&|(speed, _)| speed * speed) * sum(&|(_, error)| error * error);
    Ok(Shown {
        rest_mm: [
            mean_mm(&|time_s| time_s < REST_S),
            mean_mm(&|time_s| time_s > end_s - REST_S),
        ],
        rms_mm: 1e3 * haptical_metrics::rms(&errors.after_m)?,
        peak_mm: 1e3 * largest_size(&errors.after_m),
        speed_share: if squares > 0.0 {
            cross * cross / squares
        } else {
            0.0
        },
    })
}

/// Which effects remain possible.
fn likely(all: &[Explained], nominal: &Device) -> String {
    let with = |wanted: &str| -> String {
        let names: Vec<String> = all
            .iter()
            .filter(|one| {
                let found = one.found.as_ref();
                found.is_some_and(|found| plausible(&one.kind, found.size, nominal) == wanted)
            })
            .map(|one| one.kind.label())
            .collect();
        or_none(&names)
    };
    format!(
        "Alone and at a usual size the gap could come from: {}. At a size that is hardly met: {}. Ruled out by their \
         size: {}. Several small effects together could do it as well; the authors' log would tell, a number alone \
         cannot.",
        with("usual"),
        with("hardly"),
        with("no"),
    )
}

/// Errors over time, one panel for each kind.
fn figure(all: &[Explained]) -> Result<FigureGrid> {
    let mut panels = Vec::new();
    for one in all {
        let Some(found) = &one.found else {
            continue;
        };
        let time_s = found.errors.recording.time_s.as_ref().context("no time")?;
        let points = time_s.iter().zip(&found.errors.after_m).step_by(5);
        let points = points.map(|(time_s, error)| (*time_s, 1e3 * error));
        let mut panel = Figure::new(one.kind.label(), "time [s]", "error [mm]");
        panel.legend = false;
        panel.line("after", 0, points.collect());
        panels.push(panel);
    }
    let title = "Error of the distance after full calibration";
    Ok(FigureGrid::new(title, 3, panels))
}
