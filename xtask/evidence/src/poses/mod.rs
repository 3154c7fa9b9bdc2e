//! Chosen poses against random ones: how few give the accuracy of the paper's 200, by Monte-Carlo.

mod choice;
mod shown;
mod whole;

use anyhow::{Context, Result, bail};
use haptical_design::{Criterion, Spread};
use haptical_metrics::rms;
use haptical_model::{Device, Recording, TransmissionError};
use haptical_report::Table;
use haptical_simulator::{simulate, true_poses};
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use xtask_output::{Output, Progress};
use xtask_paper::{
    Paper, PoseErrors, Scenario, evaluation_readings, known_angles, nominal_device, rows, step_one,
    step_two_on,
};

use self::choice::{CANDIDATES, Counted, choose, information};
use self::shown::{ErrorM, HEADS, figure, push, verdict};
use self::whole::fit_at_once;
use super::rigs::generator;

/// Poses of the paper's recording.
const RANDOM: usize = 200;
/// Numbers of poses that are tried.
const TRIED: [usize; 10] = [40, 50, 60, 70, 80, 90, 100, 120, 150, 200];
/// Fewest poses that are tried where some lie beyond what step 1 sees in every run.
const FEWEST_REACHING: usize = 60;
/// Most poses that may be needed: half of the random ones.
const BAR: usize = RANDOM / 2;
struct Way {
    name: &'static str,
    /// How the candidates are drawn.
    spread: Spread,
    criterion: Criterion,
    counted: Counted,
}

/// Ways of choosing that are tried.
const WAYS: [Way; 8] = rows! {
    Way {name spread criterion counted}
    "D", Spread::Normal, Criterion::D, Counted::Known;
    "task position", Spread::Normal, Criterion::TaskPosition, Counted::Known;
    "D, step 1 counted", Spread::Normal, Criterion::D, Counted::StepOne;
    "task position, step 1 counted", Spread::Normal, Criterion::TaskPosition, Counted::StepOne;
    "D, uniform", Spread::Uniform, Criterion::D, Counted::Known;
    "task position, uniform", Spread::Uniform, Criterion::TaskPosition, Counted::Known;
    "D, uniform, one fit counted", Spread::Uniform, Criterion::D, Counted::OneFit;
    "task position, uniform, one fit counted", Spread::Uniform, Criterion::TaskPosition, Counted::OneFit;
};

/// Errors of one run, or means over the runs of one way of choosing poses.
#[derive(Debug, Clone, Default)]
struct Accuracy {
    /// Handle position at 200 unseen poses where step 1 and step 2 are fitted at once, without the unobservable
    /// rotation, rms \[m\].
    whole_position_m: f64,
    /// The same at those poses at which joint 4 reads what its external encoder has seen: beyond, `identify` leaves
    /// rows out of every figure.
    seen_position_m: f64,
    /// Step 2 by itself; none where poses are chosen beyond what step 1 saw, whose rows it leaves out.
    apart: Option<Apart>,
}

/// What step 2 by itself gives.
#[derive(Debug, Clone, Default)]
struct Apart {
    /// Handle position behind step 1, rms \[m\].
    position_m: f64,
    /// Predicted distances behind step 1, rms \[m\].
    distance_m: f64,
    /// The position where the transmissions are known exactly.
    known_position_m: f64,
    /// Errors of the rows of Table 3 at known transmissions; over several runs their root mean squares.
    errors: Vec<f64>,
}

pub(super) fn section(output: &mut Output, runs: usize) -> Result<()> {
    let paper = Paper::load()?;
    let scenario = Scenario::paper(nominal_device(None)?, &paper, false)?;
    output.section("Chosen poses");
    output.words(format!(
        "The paper's device and its errors of transmissions and links ({runs} runs with other noise and other random \
         poses), step 2 on one cable. Its poses are {RANDOM} random ones, or chosen among {CANDIDATES} at the nominal \
         device alone: the choice knows nothing of the true device. Candidates are drawn as the paper draws poses, normal \
         about home, or uniformly between the joint limits. A choice counts on known transmissions; on what poses as those \
         of step 1 tell of them; or on that and on one fit of both steps. Where it counts on step 1, and for uniform \
         candidates, joint 4 stays within two standard deviations, which step 1 is sure to have seen; for one fit within \
         2.5, which it has usually seen: rows beyond are left out. Errors are \
         those of the handle at {} poses that no fit saw, drawn as the paper does, the rotation that no distance shows \
         taken off. The bar is on step 2 by itself, the transmissions known, for choices that count on them; on the \
         handle's position in two steps as in the paper for choices that count step 1; and on its position in one fit, as \
         `identify` fits unless asked otherwise, for choices that count on that, at poses where joint 4 reads what step 1 \
         has seen (`identify` leaves others out of its figures, and what the polynomial does there is chance). In two \
         steps, what step 1 leaves in the transmissions is most of the error: it is not noise that is new in each pose, so \
         a choice that counts on noise alone takes less of it away. In one fit the cable informs on the transmissions too and \
         200 random poses give half the error of two steps.",
        scenario.evaluation_poses
    ));
    let progress = Progress::new("poses", 1 + (WAYS.len() + 1) * TRIED.len());
    let random = accuracy(&scenario, &paper, None, RANDOM, runs)?;
    progress.step();
    let mut table = Table::with_heads("Chosen poses", HEADS);
    push(&mut table, "random", RANDOM, &random, &random)?;
    let mut curves = Vec::new();
    for way in WAYS {
        let Way { name, counted, .. } = way;
        let mut curve = Vec::new();
        let information = information(&scenario, way.spread, counted)?;
        // step 1 of one run in some hundred sees so little that fewer would not do
        let least = if counted == Counted::OneFit {
            FEWEST_REACHING
        } else {
            0
        };
        for count in TRIED.into_iter().filter(|count| *count >= least) {
            let readings = choose(&information, way.criterion, count)?;
            let found = accuracy(&scenario, &paper, Some((&readings, counted)), count, runs)
                .with_context(|| format!("{name}, {count} poses"))?;
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
    for ((name, curve), way) in curves.iter().zip(WAYS) {
        verdict(output, (name, way.counted), curve, &random);
    }
    let by_chance = ("random", by_chance);
    let known = |found: &Accuracy| Some(found.apart.as_ref()?.known_position_m);
    let pictures: [(&str, &str, ErrorM); 2] = [
        ("chosen-poses", "the transmissions known", known),
        ("chosen-poses-one-fit", "in one fit with step 1", |found| {
            Some(found.seen_position_m)
        }),
    ];
    for (stem, which, error_m) in pictures {
        let title = format!("Chosen poses against random ones, {which}");
        let caption = format!("{CAPTION}, {which}.");
        // those that count step 1 are for two steps
        let ways = curves.iter().zip(WAYS);
        let ways = ways.filter(|(_, way)| way.counted != Counted::StepOne);
        let ways: Vec<_> = ways.map(|(curve, _)| curve).collect();
        let picture = figure(&title, &ways, &by_chance, &random, error_m);
        output.figure(stem, &caption, &picture)?;
    }
    output.table("chosen-poses", table)
}

const CAPTION: &str =
    "Error of the handle's position at unseen poses against the number of poses of step 2";

/// Means over runs at given readings of step 2, or at random ones.
fn accuracy(
    scenario: &Scenario,
    paper: &Paper,
    readings: Option<(&[Vec<f64>], Counted)>,
    count: usize,
    runs: usize,
) -> Result<Accuracy> {
    let mut scenario = scenario.clone();
    scenario.poses = count;
    let samples: Vec<Result<Accuracy>> = (1..=runs as u64)
        .into_par_iter()
        .map(|seed| {
            sample(&scenario, paper, readings, seed).with_context(|| format!("seed {seed}"))
        })
        .collect();
    let samples: Vec<Accuracy> = samples.into_iter().collect::<Result<_>>()?;
    let apart: Option<Vec<Apart>> = samples.iter().map(|sample| sample.apart.clone()).collect();
    Ok(Accuracy {
        whole_position_m: mean(&samples, |sample| sample.whole_position_m),
        seen_position_m: mean(&samples, |sample| sample.seen_position_m),
        apart: apart.map(|runs| {
            let rows = runs.first().map_or(0, |run| run.errors.len());
            let root = |row: usize| mean(&runs, |run| run.errors[row].powi(2)).sqrt();
            Apart {
                position_m: mean(&runs, |run| run.position_m),
                distance_m: mean(&runs, |run| run.distance_m),
                known_position_m: mean(&runs, |run| run.known_position_m),
                errors: (0..rows).map(root).collect(),
            }
        }),
    })
}

fn mean<Run>(runs: &[Run], of: impl Fn(&Run) -> f64) -> f64 {
    runs.iter().map(of).sum::<f64>() / runs.len() as f64
}

fn sample(
    scenario: &Scenario,
    paper: &Paper,
    readings: Option<(&[Vec<f64>], Counted)>,
    seed: u64,
) -> Result<Accuracy> {
    let mut options = scenario.options();
    options.rules.singular_values = false;
    let truth = &scenario.truth;
    let recording = match readings {
        None => simulate(truth, &scenario.settings, scenario.poses, seed)?,
        Some((readings, _)) => recorded(truth, readings, seed)?,
    };
    let (compensated, _, step_one_data) = step_one(scenario, seed)?;
    let unseen = evaluation_readings(scenario, seed)?;
    let errors = |device: &Device| PoseErrors::new(truth, &scenario.nominal, device, &unseen);
    let whole = errors(&fit_at_once(
        &scenario.nominal,
        &step_one_data,
        &recording,
        &options,
    )?)?;
    let is_seen = |row: &usize| {
        let mut joints = compensated.joints.iter().zip(&unseen.joint);
        joints.all(|(joint, readings)| match joint.transmission_error {
            TransmissionError::Chebyshev { range_rad, .. } => {
                (range_rad[0]..=range_rad[1]).contains(&readings[*row])
            }
            _ => true,
        })
    };
    let rows = (0..unseen.len()).filter(is_seen);
    let seen: Vec<f64> = rows.map(|row| whole.position_observable_m[row]).collect();
    let apart = || -> Result<Apart> {
        let fit = |device: &Device| step_two_on(device, &recording, &options);
        let known = fit(&known_angles(scenario))?;
        let mut deviations = Vec::new();
        for row in &paper.table3 {
            let mut estimates = known.estimates.iter();
            let estimate = estimates.find(|estimate| estimate.name == row.name);
            let Some(value) = estimate.and_then(|estimate| estimate.value) else {
                bail!("{} was not identified", row.name);
            };
            let nominal = &scenario.nominal;
            let nominal = nominal.parameter(&row.name)?.value(nominal);
            deviations.push(value - nominal - row.assigned);
        }
        let behind = errors(&fit(&compensated)?.device)?;
        Ok(Apart {
            position_m: rms(&behind.position_observable_m)?,
            distance_m: rms(&behind.distance_after_m)?,
            known_position_m: rms(&errors(&known.device)?.position_observable_m)?,
            errors: deviations,
        })
    };
    let reaches_beyond = readings.is_some_and(|(_, counted)| counted == Counted::OneFit);
    Ok(Accuracy {
        whole_position_m: rms(&whole.position_observable_m)?,
        seen_position_m: rms(&seen)?,
        apart: (!reaches_beyond).then(apart).transpose()?,
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
