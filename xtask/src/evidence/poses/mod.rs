//! Chosen poses against random ones: how few give the accuracy of the paper's 200, by Monte-Carlo.

mod choice;
mod whole;

use anyhow::{Context, Result, bail};
use haptical_design::{Criterion, Spread};
use haptical_metrics::rms;
use haptical_model::{Device, Recording};
use haptical_report::{Cell, Column, Figure, Mark, Series, Table};
use haptical_simulator::{simulate, true_poses};
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use self::choice::{CANDIDATES, Counted, choose, information};
use self::whole::fit_at_once;
use super::rigs::generator;
use crate::output::Output;
use crate::progress::Progress;
use crate::tables::monte_carlo::known_angles;
use crate::tables::paper::Paper;
use crate::tables::pose_error::PoseErrors;
use crate::tables::run::{evaluation_readings, step_one, step_two_on};
use crate::tables::scenario::{Scenario, nominal_device};

/// Poses of the paper's recording.
const RANDOM: usize = 200;
/// Numbers of poses that are tried.
const TRIED: [usize; 10] = [40, 50, 60, 70, 80, 90, 100, 120, 150, 200];
/// Most poses that may be needed: half of the random ones.
const BAR: usize = RANDOM / 2;
/// Ways of choosing that are tried: name, how the candidates are drawn, criterion, what is counted on.
const WAYS: [(&str, Spread, Criterion, Counted); 6] = [
    ("D", Spread::Normal, Criterion::D, Counted::Known),
    (
        "task position",
        Spread::Normal,
        Criterion::TaskPosition,
        Counted::Known,
    ),
    (
        "D, step 1 counted",
        Spread::Normal,
        Criterion::D,
        Counted::StepOne,
    ),
    (
        "task position, step 1 counted",
        Spread::Normal,
        Criterion::TaskPosition,
        Counted::StepOne,
    ),
    ("D, uniform", Spread::Uniform, Criterion::D, Counted::Known),
    (
        "task position, uniform",
        Spread::Uniform,
        Criterion::TaskPosition,
        Counted::Known,
    ),
];

/// Means over the runs of one way of choosing poses.
#[derive(Debug, Clone, Default)]
struct Accuracy {
    /// Handle position at 200 unseen poses, without the unobservable rotation, rms \[m\].
    position_m: f64,
    /// Predicted distances at these poses, rms \[m\].
    distance_m: f64,
    /// The position where step 1 and step 2 are fitted at once.
    whole_position_m: f64,
    /// The position where the transmissions are known exactly.
    known_position_m: f64,
    /// Root mean square error of each row of Table 3 over the runs, at known transmissions.
    errors: Vec<f64>,
}

/// What one run found.
struct Sample {
    position_m: f64,
    distance_m: f64,
    whole_position_m: f64,
    known_position_m: f64,
    errors: Vec<f64>,
}

/// Writes the section.
pub(super) fn section(output: &mut Output, runs: usize) -> Result<()> {
    let paper = Paper::load()?;
    let scenario = Scenario::paper(nominal_device(None)?, &paper, false)?;
    output.section("Chosen poses");
    output.words(format!(
        "The paper's device and its errors of transmissions and links ({runs} runs with other noise and other random \
         poses), step 2 on one cable. Its poses are {RANDOM} random ones, or chosen among {CANDIDATES} at the nominal \
         device alone: the choice knows nothing of the true device. Candidates are drawn as the paper draws poses, normal \
         about home, or uniformly between the joint limits. A choice counts on known transmissions, or on what poses as \
         those of step 1 tell of them; in the latter case, and for uniform candidates, joint 4 stays within two standard \
         deviations, where step 1 has seen it. Errors are \
         those of the handle at {} poses that no fit saw, drawn as the paper does, the rotation that no distance shows \
         taken off. The bar is on step 2 by itself, the transmissions known, for choices that count on them; and on the \
         handle's position in two steps as in the paper for choices that count step 1. There, what step 1 leaves in the \
         transmissions is most of the error: it is not noise that is new in each pose, so a choice that counts on noise \
         alone takes less of it away. In one fit of both steps, as `identify` does unless told otherwise, the cable tells of \
         the transmissions too and 200 random poses give half the error of two steps; poses that stay where step 1 has seen \
         joint 4 leave its polynomial beyond to chance there.",
        scenario.evaluation_poses
    ));
    let progress = Progress::new("poses", 1 + WAYS.len() * TRIED.len() + TRIED.len());
    let random = accuracy(&scenario, &paper, None, RANDOM, runs)?;
    progress.step();
    let mut table = Table::new("Chosen poses", columns());
    push(&mut table, "random", RANDOM, &random, &random)?;
    let mut curves = Vec::new();
    for (name, spread, criterion, counted) in WAYS {
        let mut curve = Vec::new();
        let information = information(&scenario, spread, counted)?;
        for count in TRIED {
            let readings = choose(&information, criterion, count)?;
            let found = accuracy(&scenario, &paper, Some(&readings), count, runs)?;
            push(&mut table, name, count, &found, &random)?;
            curve.push((count, found));
            progress.step();
        }
        curves.push((name, curve));
    }
    let mut by_chance = Vec::new();
    for count in TRIED {
        let found = accuracy(&scenario, &paper, None, count, runs)?;
        if count != RANDOM {
            push(&mut table, "random", count, &found, &random)?;
        }
        by_chance.push((count, found));
        progress.step();
    }
    for ((name, curve), (.., counted)) in curves.iter().zip(WAYS) {
        verdict(output, (name, counted), curve, &random);
    }
    output.figure(
        "chosen-poses",
        CAPTION,
        &figure(&curves, &by_chance, &random),
    )?;
    output.table("chosen-poses", table)
}

const CAPTION: &str = "Error of the handle's position at unseen poses against the number of poses of step 2, the transmissions known.";

fn columns() -> Vec<Column> {
    let columns = [
        ("poses are", ""),
        ("poses", ""),
        ("position", "um"),
        ("over 200 random", ""),
        ("distance", "um"),
        ("over 200 random", ""),
        ("position, one fit", "um"),
        ("over 200 random", ""),
        ("position, transmissions known", "um"),
        ("over 200 random", ""),
        ("parameters, transmissions known, over 200 random", ""),
    ];
    columns.map(|(name, unit)| Column::new(name, unit)).to_vec()
}

/// Geometric mean over the parameters of the rms error over that of the random poses.
fn ratio(found: &Accuracy, random: &Accuracy) -> f64 {
    let logs = found.errors.iter().zip(&random.errors);
    let sum: f64 = logs.map(|(found, random)| (found / random).ln()).sum();
    (sum / found.errors.len() as f64).exp()
}

fn push(
    table: &mut Table,
    name: &str,
    count: usize,
    found: &Accuracy,
    random: &Accuracy,
) -> Result<()> {
    let pair = |of: fn(&Accuracy) -> f64| {
        [
            Cell::number(of(found) * 1e6, 1),
            Cell::number(of(found) / of(random), 3),
        ]
    };
    let mut row: Vec<Cell> = vec![name.into(), Cell::number(count as f64, 0)];
    row.extend(pair(|of| of.position_m));
    row.extend(pair(|of| of.distance_m));
    row.extend(pair(|of| of.whole_position_m));
    row.extend(pair(|of| of.known_position_m));
    row.push(Cell::number(ratio(found, random), 3));
    Ok(table.push(row)?)
}

/// The least number of poses that gives the accuracy of the random ones in each respect.
fn verdict(
    output: &mut Output,
    (name, counted): (&str, Counted),
    curve: &[(usize, Accuracy)],
    random: &Accuracy,
) {
    let least = |is_as_good: &dyn Fn(&Accuracy) -> bool| {
        let found = curve.iter().find(|(_, found)| is_as_good(found));
        found.map(|(count, _)| *count)
    };
    let position = least(&|found| found.known_position_m <= random.known_position_m);
    let parameters = least(&|found| ratio(found, random) <= 1.0);
    let whole = least(&|found| found.whole_position_m <= random.whole_position_m);
    let after = least(&|found| found.position_m <= random.position_m);
    let distance = least(&|found| found.distance_m <= random.distance_m);
    let said = |least: Option<usize>| {
        least.map_or_else(|| "more than 200".to_owned(), |count| count.to_string())
    };
    let (bar, respects) = match counted {
        Counted::Known => ([position, parameters], "by itself"),
        Counted::StepOne => ([after, after], "behind step 1 as in the paper"),
    };
    let is_met = bar
        .iter()
        .all(|count| count.is_some_and(|count| count <= BAR));
    output.verdict(
        is_met,
        format!(
            "{name}, step 2 {respects}, at most {BAR} are asked for: as {RANDOM} random ones do, {} chosen poses give the \
             handle's position in one fit; with known transmissions {} the position and {} the parameters; in two steps {} \
             the position and {} the predicted distances",
            said(whole),
            said(position),
            said(parameters),
            said(after),
            said(distance)
        ),
    );
}

/// Means over runs at given readings of step 2, or at random ones.
fn accuracy(
    scenario: &Scenario,
    paper: &Paper,
    readings: Option<&[Vec<f64>]>,
    count: usize,
    runs: usize,
) -> Result<Accuracy> {
    let mut scenario = scenario.clone();
    scenario.poses = count;
    let samples: Vec<Result<Sample>> = (1..=runs as u64)
        .into_par_iter()
        .map(|seed| {
            sample(&scenario, paper, readings, seed).with_context(|| format!("seed {seed}"))
        })
        .collect();
    let samples: Vec<Sample> = samples.into_iter().collect::<Result<_>>()?;
    let mean =
        |of: &dyn Fn(&Sample) -> f64| samples.iter().map(of).sum::<f64>() / samples.len() as f64;
    let rows = samples.first().map_or(0, |sample| sample.errors.len());
    let root = |row: usize| mean(&|sample: &Sample| sample.errors[row].powi(2)).sqrt();
    Ok(Accuracy {
        position_m: mean(&|sample| sample.position_m),
        distance_m: mean(&|sample| sample.distance_m),
        whole_position_m: mean(&|sample| sample.whole_position_m),
        known_position_m: mean(&|sample| sample.known_position_m),
        errors: (0..rows).map(root).collect(),
    })
}

fn sample(
    scenario: &Scenario,
    paper: &Paper,
    readings: Option<&[Vec<f64>]>,
    seed: u64,
) -> Result<Sample> {
    let mut options = scenario.options();
    options.rules.singular_values = false;
    let truth = &scenario.truth;
    let recording = match readings {
        None => simulate(truth, &scenario.settings, scenario.poses, seed)?,
        Some(readings) => recorded(truth, readings, seed)?,
    };
    let fit = |device: &Device| step_two_on(device, &recording, &options);
    let (compensated, _, step_one_data) = step_one(scenario, seed)?;
    let (found, known) = (fit(&compensated)?, fit(&known_angles(scenario))?);
    let whole = fit_at_once(&scenario.nominal, &step_one_data, &recording, &options)?;
    let unseen = evaluation_readings(scenario, seed)?;
    let errors = |device: &Device| PoseErrors::new(truth, &scenario.nominal, device, &unseen);
    let (with_step_one, alone) = (errors(&found.device)?, errors(&known.device)?);
    let at_once = errors(&whole)?;
    let mut deviations = Vec::new();
    for row in &paper.table3 {
        let estimate = known
            .estimates
            .iter()
            .find(|estimate| estimate.name == row.name);
        let Some(value) = estimate.and_then(|estimate| estimate.value) else {
            bail!("{} was not identified", row.name);
        };
        let nominal = scenario
            .nominal
            .parameter(&row.name)?
            .value(&scenario.nominal);
        deviations.push(value - nominal - row.assigned);
    }
    Ok(Sample {
        position_m: rms(&with_step_one.position_observable_m)?,
        distance_m: rms(&with_step_one.distance_after_m)?,
        whole_position_m: rms(&at_once.position_observable_m)?,
        known_position_m: rms(&alone.position_observable_m)?,
        errors: deviations,
    })
}

/// Cable readings of the true device at given joint readings, with the noise that the device file states.
fn recorded(truth: &Device, readings: &[Vec<f64>], seed: u64) -> Result<Recording> {
    let joints = truth.joints.len();
    let column = |joint: usize| readings.iter().map(|pose| pose[joint]).collect();
    let mut recording = Recording {
        line: (1..=readings.len() as u64).collect(),
        joint: (0..joints).map(column).collect(),
        output: vec![None; joints],
        torque_nm: vec![None; joints],
        ..Recording::default()
    };
    let sd_m = truth
        .cable_sd_m(0)
        .context("the cable has no stated noise")?;
    let mut random = generator(seed, 5);
    let distances = true_poses(truth, &recording)?.into_iter().map(|pose| {
        let error: f64 = StandardNormal.sample(&mut random);
        pose.position_m.norm() + sd_m * error
    });
    recording.cable_m = vec![Some(distances.collect())];
    Ok(recording)
}

fn figure(
    curves: &[(&str, Vec<(usize, Accuracy)>)],
    by_chance: &[(usize, Accuracy)],
    random: &Accuracy,
) -> Figure {
    let points = |curve: &[(usize, Accuracy)]| -> Vec<(f64, f64)> {
        let point =
            |(count, found): &(usize, Accuracy)| (*count as f64, found.known_position_m * 1e6);
        curve.iter().map(point).collect()
    };
    let mut figure = Figure::new(
        "Chosen poses against random ones",
        "poses of step 2",
        "position error at unseen poses [um]",
    );
    figure.series = vec![
        Series::new("random", Mark::Line, 1, points(by_chance)),
        Series::reference("200 random", 6, random.known_position_m * 1e6),
    ];
    for ((name, curve), colour) in curves.iter().zip([0, 2, 3, 4, 5, 7]) {
        figure
            .series
            .push(Series::new(*name, Mark::Line, colour, points(curve)));
    }
    figure
}
