//! Distances of many poses, 28 parameters: derivatives, reduction to a triangle, the whole fit.

use std::hint::black_box;

use anyhow::{Context, Result};
use haptical_batch::{DistanceModel, PoseBatch, TileRows};
use haptical_calibration::{DeviceProblem, ReducedProblem};
use haptical_identification::{Method, Settings, TriangleProblem, solve};
use haptical_linalg::{Matrix, Reduction, Triangle};
use haptical_model::ParameterId;
use xtask_blind::rows;

use super::{Job, Workload, spread};
use crate::bench_peers::files::DataSet;

const POSES: usize = 4096;
const FIT_POSES: usize = 200;
const COLUMNS: usize = 28;

pub(crate) const WORKLOADS: [Workload; 5] = rows! {
    Workload {name what unit units is_long prepare}
    "derivatives-cached", "residuals and 28 derivatives of distances, sines held", "pose", POSES as u64, false, derivatives;
    "pass-cached", "one pass of a fit: derivatives and their reduction, sines held", "pose", POSES as u64, false, pass;
    "reduction-tiles", "reduction of rows of 28 columns to a triangle, tile by tile", "row", POSES as u64, false, reduction_in_tiles;
    "reduction-dense", "QR of a whole matrix of 200 rows and 28 columns", "row", FIT_POSES as u64, false, dense_reduction;
    "fit-200-poses", "the 28-parameter fit of a problem of 200 poses from the nominal values, its lanes and sines included", "pose", FIT_POSES as u64, false, fit;
};

fn derivatives() -> Result<Job> {
    let DataSet {
        nominal,
        recording,
        free,
        sd_m,
    } = DataSet::simulate(POSES)?;
    let motions = nominal.motions();
    let chosen: Vec<_> = free
        .iter()
        .filter_map(|id| match *id {
            ParameterId::Link { row, parameter } => Some((row, parameter)),
            _ => None,
        })
        .collect();
    let model = DistanceModel::new(nominal.convention, &nominal.links, &motions, [0.0; 3])?;
    let model = model.with_parameters(&chosen)?;
    let joints = nominal.joints.iter().zip(&recording.joint);
    let joints: Vec<Vec<f64>> = joints
        .map(|(joint, column)| column.iter().map(|angle| angle + joint.home_rad).collect())
        .collect();
    let distances_m = recording.cable_m.first().cloned().flatten();
    let distances_m = distances_m.context("no distances")?;
    let batch = PoseBatch::new(&motions, &joints, &distances_m, &vec![1.0 / sd_m; POSES])?;
    let (start, free): (_, Vec<usize>) = (model.start(), (0..chosen.len()).collect());
    Ok(Box::new(move || {
        let see = |tile: &TileRows<'_>| {
            black_box(tile.residuals());
        };
        Ok(batch.visit(&model, &start, &free, see)?)
    }))
}

/// The problem of a simulated device, kept for as long as the process that counts.
fn problem(poses: usize) -> Result<&'static DeviceProblem<'static>> {
    let data: &'static DataSet = Box::leak(Box::new(DataSet::simulate(poses)?));
    let (device, recording, weights) = (&data.nominal, &data.recording, data.weights());
    let channels = DataSet::channels();
    let problem = DeviceProblem::new(device, recording, &channels, &data.free, &weights)?;
    Ok(Box::leak(Box::new(problem)))
}

fn pass() -> Result<Job> {
    let problem = problem(POSES)?;
    let (reduced, start) = (ReducedProblem::new(problem), problem.start());
    let free: Vec<usize> = (0..start.len()).collect();
    // the lanes hold the sines from the first pass on; elsewhere, as a pass where the last one was is a copy
    let elsewhere: Vec<f64> = start.iter().map(|value| value + 1e-6).collect();
    reduced.reduce_into(&elsewhere, &free, &mut Triangle::default())?;
    Ok(Box::new(move || {
        let mut triangle = Triangle::default();
        reduced.reduce_into(&start, &free, &mut triangle)?;
        black_box(triangle);
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
    let problem = problem(FIT_POSES)?;
    let settings = Settings {
        method: Method::GaussNewton,
        cost_tolerance: 1e-10,
        // the cost decides alone
        step_tolerance: 0.0,
        ..Settings::default()
    };
    Ok(Box::new(move || {
        let (reduced, start) = (ReducedProblem::new(problem), problem.start());
        let free: Vec<usize> = (0..start.len()).collect();
        black_box(solve(&reduced, &start, &free, &settings)?);
        Ok(())
    }))
}
