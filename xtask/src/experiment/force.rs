//! Forces of the virtual wall at rest, over poses and seeds: what calibration takes off the transverse ones.

use anyhow::{Context, Result, ensure};
use haptical_metrics::rms;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Evaluation, ForceTransmission, Recording, handle_force_n};
use haptical_report::{Cell, Column, Table};
use rayon::prelude::*;

use crate::progress::Progress;
use crate::tables::monte_carlo::Spread;
use crate::tables::run::{evaluation_readings, step_one, step_two};
use crate::tables::scenario::Scenario;

/// Joint 3 is locked at home, as in the paper.
pub(crate) const FREE: [usize; 6] = [0, 1, 3, 4, 5, 6];
const LOCKED: usize = 2;
/// Wall of 100 N/m moved by 20 mm.
pub(crate) const WALL_FORCE_N: f64 = 2.0;
/// Postures whose Jacobian is worse than this are left out and counted.
const WORST_CONDITION: f64 = 300.0;
/// Poses of the workspace.
const POSES: usize = 100;

/// Controllers that are compared.
pub(crate) const CONTROLLERS: [&str; 3] = ["nominal", "kinematics alone", "full calibration"];

/// Transverse forces of one controller over the poses \[N\].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Transverse {
    pub(crate) rms_n: f64,
    pub(crate) peak_n: f64,
}

/// One seed: every controller on the same poses.
#[derive(Debug, Clone)]
pub(crate) struct Sample {
    pub(crate) controllers: [Transverse; 3],
    /// Poses left out.
    pub(crate) left_out: usize,
}

/// Poses with joint 3 at home.
fn poses(scenario: &Scenario, seed: u64) -> Result<Recording> {
    let mut scenario = scenario.clone();
    scenario.evaluation_poses = POSES;
    let mut recording = evaluation_readings(&scenario, seed.wrapping_add(1 << 40))?;
    recording.joint[LOCKED].fill(0.0);
    Ok(recording)
}

/// The force that the sensor in the true handle measures where the controller wants the wall's, at rest in a
/// loop of gain `gain`; none in a posture that is left out.
pub(crate) fn measured_n(
    truth: &Evaluation<'_>,
    controller: &Evaluation<'_>,
    gain: f64,
) -> Result<Option<Vector3<f64>>> {
    let Ok(transmission) = ForceTransmission::new(truth, controller, FREE) else {
        return Ok(None);
    };
    if transmission.condition > WORST_CONDITION {
        return Ok(None);
    }
    Ok(handle_force_n(
        &transmission,
        truth,
        controller,
        WALL_FORCE_N,
        gain,
    )?)
}

fn transverse(
    truth: &Device,
    controllers: [&Device; 3],
    recording: &Recording,
    gain: f64,
) -> Result<Sample> {
    let mut at_truth = Evaluation::new(truth);
    let mut at: Vec<Evaluation<'_>> = controllers.iter().map(|d| Evaluation::new(d)).collect();
    let mut found: [Vec<f64>; 3] = Default::default();
    let mut left_out = 0;
    let mut readings = vec![0.0; truth.joints.len()];
    for row in 0..recording.len() {
        for (reading, column) in readings.iter_mut().zip(&recording.joint) {
            *reading = column[row];
        }
        at_truth.move_to(&readings)?;
        let mut forces = Vec::new();
        for evaluation in &mut at {
            evaluation.move_to(&readings)?;
            forces.extend(measured_n(&at_truth, evaluation, gain)?);
        }
        if forces.len() < found.len() {
            left_out += 1;
            continue;
        }
        for (all, force) in found.iter_mut().zip(&forces) {
            all.push(force.x.hypot(force.y));
        }
    }
    ensure!(left_out < recording.len(), "every posture is singular");
    let mut result = [Transverse {
        rms_n: 0.0,
        peak_n: 0.0,
    }; 3];
    for (transverse, values) in result.iter_mut().zip(&found) {
        *transverse = Transverse {
            rms_n: rms(values)?,
            peak_n: values.iter().copied().fold(0.0, f64::max),
        };
    }
    Ok(Sample {
        controllers: result,
        left_out,
    })
}

/// Readings of the pose whose transverse force under the nominal controller is nearest to that of all poses
/// (root mean square): a typical one to show.
pub(crate) fn typical_posture(scenario: &Scenario, seed: u64, gain: f64) -> Result<Vec<f64>> {
    let recording = poses(scenario, seed)?;
    let (mut truth, mut controller) = (
        Evaluation::new(&scenario.truth),
        Evaluation::new(&scenario.nominal),
    );
    let mut found: Vec<(Vec<f64>, f64)> = Vec::new();
    for row in 0..recording.len() {
        let readings: Vec<f64> = recording.joint.iter().map(|column| column[row]).collect();
        truth.move_to(&readings)?;
        controller.move_to(&readings)?;
        if let Some(force) = measured_n(&truth, &controller, gain)? {
            found.push((readings, force.x.hypot(force.y)));
        }
    }
    let sizes: Vec<f64> = found.iter().map(|(_, size)| *size).collect();
    let typical = rms(&sizes)?;
    let by_distance = |a: &(Vec<f64>, f64), b: &(Vec<f64>, f64)| {
        (a.1 - typical).abs().total_cmp(&(b.1 - typical).abs())
    };
    let (readings, _) = found
        .into_iter()
        .min_by(by_distance)
        .context("no posture")?;
    Ok(readings)
}

/// One calibration, and the forces of the three controllers.
pub(crate) fn sample(scenario: &Scenario, seed: u64, gain: f64) -> Result<Sample> {
    let (compensated, _, _) = step_one(scenario, seed)?;
    let full = step_two(scenario, &compensated, seed)?.device;
    let alone = step_two(scenario, &scenario.nominal, seed)?.device;
    let controllers = [&scenario.nominal, &alone, &full];
    transverse(&scenario.truth, controllers, &poses(scenario, seed)?, gain)
}

/// Samples of many seeds.
pub(crate) fn samples(
    scenario: &Scenario,
    first_seed: u64,
    seeds: usize,
    gain: f64,
    progress: &Progress,
) -> Vec<Sample> {
    let found: Vec<Option<Sample>> = (0..seeds as u64)
        .into_par_iter()
        .map(|index| {
            let found = sample(scenario, first_seed + index, gain).ok();
            progress.step();
            found
        })
        .collect();
    found.into_iter().flatten().collect()
}

/// One row of the table for each kind of truth and gain.
#[derive(Debug)]
pub(crate) struct Kind {
    pub(crate) name: String,
    pub(crate) samples: Vec<Sample>,
}

impl Kind {
    /// Ratio of the transverse RMS of a controller to that of the nominal one, seed by seed.
    pub(crate) fn ratios(&self, controller: usize) -> Vec<f64> {
        self.samples
            .iter()
            .map(|sample| sample.controllers[controller].rms_n / sample.controllers[0].rms_n)
            .collect()
    }
}

/// Transverse forces before and after.
pub(crate) fn table(kinds: &[Kind]) -> Result<Table> {
    let mut table = Table::new(
        "Transverse force of the virtual wall (2 N along the handle's z)",
        [
            ("truth and loop", ""),
            ("controller", ""),
            ("RMS", "mN"),
            ("95 % of seeds", "mN"),
            ("peak, median", "mN"),
            ("of nominal", "%"),
            ("worst seed", "%"),
            ("poses left out", "of 100"),
        ]
        .map(|(name, unit)| Column::new(name, unit))
        .to_vec(),
    );
    for kind in kinds {
        for (index, controller) in CONTROLLERS.iter().enumerate() {
            let of = |pick: fn(&Transverse) -> f64| -> Vec<f64> {
                let samples = kind.samples.iter();
                samples
                    .map(|sample| 1e3 * pick(&sample.controllers[index]))
                    .collect()
            };
            let (rms_mn, peak_mn) = (of(|t| t.rms_n), of(|t| t.peak_n));
            let (spread, peak) = (Spread::new(&rms_mn)?, Spread::new(&peak_mn)?);
            let ratios = kind.ratios(index);
            let worst = ratios.iter().copied().fold(0.0, f64::max);
            let left_out: usize = kind.samples.iter().map(|sample| sample.left_out).sum();
            table.push(vec![
                kind.name.as_str().into(),
                (*controller).into(),
                Cell::number(spread.median, 2),
                format!("{:.2} to {:.2}", spread.low, spread.high).into(),
                Cell::number(peak.median, 2),
                Cell::number(100.0 * Spread::new(&ratios)?.median, 2),
                Cell::number(100.0 * worst, 2),
                Cell::number(left_out as f64 / kind.samples.len().max(1) as f64, 1),
            ])?;
        }
    }
    Ok(table)
}
