//! Distances of many poses, 28 parameters: derivatives, reduction to a triangle, the whole fit.

use std::hint::black_box;

use anyhow::{Context, Result};
use haptical_batch::{
    DistanceModel, DistanceProblem, PoseBatch, ReducedDistance, Sines, Threads, TileRows, Triangle,
    solve_distances,
};
use haptical_identification::{Method, Settings};
use haptical_linalg::{Matrix, Reduction};
use haptical_model::ParameterId;
use haptical_simulator::simulate;
use xtask_paper::{Paper, Scenario, nominal_device};

use super::{Job, Workload, spread};

/// Poses of one pass.
const POSES: usize = 4096;
/// Poses of the paper's fit.
const FIT_POSES: usize = 200;
/// Free parameters.
const COLUMNS: usize = 28;
const SEED: u64 = 1;

pub(crate) const WORKLOADS: [Workload; 6] = [
    Workload {
        name: "derivatives-cached",
        what: "residuals and 28 derivatives of distances, sines held",
        unit: "pose",
        units: POSES as u64,
        is_long: false,
        prepare: || derivatives(Sines::Cached),
    },
    Workload {
        name: "derivatives-with-sines",
        what: "the same, sines worked out in the pass",
        unit: "pose",
        units: POSES as u64,
        is_long: false,
        prepare: || derivatives(Sines::EachPass),
    },
    Workload {
        name: "pass-cached",
        what: "one pass of a fit: derivatives and their reduction, sines held",
        unit: "pose",
        units: POSES as u64,
        is_long: false,
        prepare: pass,
    },
    Workload {
        name: "reduction-tiles",
        what: "reduction of rows of 28 columns to a triangle, tile by tile",
        unit: "row",
        units: POSES as u64,
        is_long: false,
        prepare: reduction_in_tiles,
    },
    Workload {
        name: "reduction-dense",
        what: "QR of a whole matrix of 200 rows and 28 columns",
        unit: "row",
        units: FIT_POSES as u64,
        is_long: false,
        prepare: dense_reduction,
    },
    Workload {
        name: "fit-200-poses",
        what: "the 28-parameter fit of 200 poses from the nominal values, sines included",
        unit: "pose",
        units: FIT_POSES as u64,
        is_long: false,
        prepare: fit,
    },
];

/// Distances of the paper's simulated device without transmission errors.
struct Distances {
    model: DistanceModel,
    joints: Vec<Vec<f64>>,
    distances_m: Vec<f64>,
    weights: Vec<f64>,
    free: Vec<usize>,
}

impl Distances {
    fn simulate(poses: usize) -> Result<Self> {
        let paper = Paper::load()?;
        let mut scenario = Scenario::paper(nominal_device(None)?, &paper, false)?;
        let nominal = &scenario.nominal;
        for (truth, joint) in scenario.truth.joints.iter_mut().zip(&nominal.joints) {
            truth.transmission_error = joint.transmission_error.clone();
        }
        let recording = simulate(&scenario.truth, &scenario.settings, poses, SEED)?;
        let mut chosen = Vec::new();
        for row in &paper.table3 {
            if let ParameterId::Link { row, parameter } = nominal.parameter(&row.name)? {
                chosen.push((row, parameter));
            }
        }
        let motions = nominal.motions();
        let model = DistanceModel::new(nominal.convention, &nominal.links, &motions, [0.0; 3])?;
        let sd_m = nominal.cable_sd_m(0).context("the cable has no sd")?;
        let joints = nominal.joints.iter().zip(&recording.joint);
        let distances_m = recording.cable_m.first().cloned().flatten();
        Ok(Self {
            free: (0..chosen.len()).collect(),
            model: model.with_parameters(&chosen)?,
            joints: joints
                .map(|(joint, column)| column.iter().map(|angle| angle + joint.home_rad).collect())
                .collect(),
            distances_m: distances_m.context("no distances")?,
            weights: vec![1.0 / sd_m; poses],
        })
    }

    fn batch(&self, sines: Sines) -> Result<PoseBatch> {
        let (motions, weights) = (self.model.motions(), &self.weights);
        Ok(PoseBatch::new(
            motions,
            &self.joints,
            &self.distances_m,
            weights,
            sines,
        )?)
    }
}

fn derivatives(sines: Sines) -> Result<Job> {
    let data = Distances::simulate(POSES)?;
    let (batch, start) = (data.batch(sines)?, data.model.start());
    Ok(Box::new(move || {
        let rows = DistanceProblem::new(&data.model, &batch)?;
        let see = |tile: &TileRows<'_>| {
            black_box(tile.residuals());
        };
        Ok(rows.visit(&start, &data.free, see)?)
    }))
}

fn pass() -> Result<Job> {
    let data = Distances::simulate(POSES)?;
    let (batch, start) = (data.batch(Sines::Cached)?, data.model.start());
    Ok(Box::new(move || {
        let reduced = ReducedDistance::new(&data.model, &batch, Threads::One)?;
        black_box(reduced.reduce(&start, &data.free, Triangle::cost)?);
        Ok(())
    }))
}

/// A matrix without structure, and a right-hand side.
fn matrix(rows: usize) -> (Matrix, Vec<f64>) {
    let entry = |row: usize, column: usize| spread(row * (COLUMNS + 1) + column);
    let matrix = Matrix::from_fn(rows, COLUMNS, entry);
    (matrix, (0..rows).map(|row| entry(row, COLUMNS)).collect())
}

fn reduction_in_tiles() -> Result<Job> {
    let (matrix, residuals) = matrix(POSES);
    Ok(Box::new(move || {
        let columns: Vec<&[f64]> = (0..COLUMNS).map(|column| matrix.column(column)).collect();
        let mut triangle = Triangle::new(COLUMNS);
        triangle.fold_rows(&columns, &residuals)?;
        black_box(triangle);
        Ok(())
    }))
}

fn dense_reduction() -> Result<Job> {
    let (matrix, residuals) = matrix(FIT_POSES);
    Ok(Box::new(move || {
        black_box(Reduction::new(black_box(&matrix), &residuals)?);
        Ok(())
    }))
}

fn fit() -> Result<Job> {
    let data = Distances::simulate(FIT_POSES)?;
    let start = data.model.start();
    let settings = Settings {
        method: Method::GaussNewton,
        cost_tolerance: 1e-10,
        // the cost decides alone
        step_tolerance: 0.0,
        ..Settings::default()
    };
    Ok(Box::new(move || {
        let batch = data.batch(Sines::Cached)?;
        let (model, one) = (&data.model, Threads::One);
        black_box(solve_distances(
            model, &batch, &start, &data.free, &settings, one,
        )?);
        Ok(())
    }))
}
