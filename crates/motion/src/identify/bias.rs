//! How far the noise of the positions bends least squares: noise of the same size is added once more (simulation extrapolation, Cook
//! and Stefanski 1994, its first step).

use std::rc::Rc;

use haptical_model::Recording;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::MotionError;
use crate::arm::Arm;
use crate::fit::column::Column;
use crate::fit::problem::{Problem, Reading};
use crate::identify::combinations::Combinations;
use crate::identify::estimate::least_squares;
use crate::identify::fit::Settled;
use crate::identify::loaded::Loaded;
use crate::identify::numbers::{Number, columns};
use crate::signal::states::States;
use crate::thresholds::identify::NOISE_DRAWS;

/// Seed of the first; the others follow it.
pub const NOISE_SEED: u64 = 1;

/// What is settled of a fit, and the recording that it is of.
pub(crate) struct Known<'a> {
    pub(crate) arm: &'a Arm,
    pub(crate) recording: &'a Recording,
    pub(crate) reading: Reading,
    pub(crate) numbers: &'a [Number],
    pub(crate) settled: &'a Settled,
    pub(crate) loaded: &'a Loaded,
}

impl Known<'_> {
    /// A recording of the same torques with other positions, as a problem of the same rows, weights and laws.
    pub(crate) fn problem(&self, recording: &Recording) -> Result<Problem, MotionError> {
        let mut problem = Problem::new(self.arm.clone(), recording, self.reading.clone())?;
        problem.reweigh(&self.settled.row_sd);
        if let Some(arm) = &self.loaded.arm {
            problem.carry(arm)?;
        }
        Ok(problem)
    }

    /// Its columns.
    pub(crate) fn columns(&self, problem: &Problem) -> Vec<Rc<Column>> {
        let Settled {
            friction, early_s, ..
        } = self.settled;
        columns(problem, self.numbers, friction, *early_s)
    }
}

/// Change of each base parameter by noise of the size of the positions' own, which is about what that noise has changed already.
pub(crate) fn of_noise(
    known: &Known<'_>,
    base: &Combinations,
    values: &[f64],
    states: &States,
) -> Result<Vec<f64>, MotionError> {
    let mut sum = vec![0.0; values.len()];
    for draw in 0..NOISE_DRAWS {
        let mut random = ChaCha8Rng::seed_from_u64(NOISE_SEED + draw);
        let mut noisy = known.recording.clone();
        let motors = noisy.joint.iter_mut().zip(&states.position_sd);
        let links = (noisy.output.iter_mut().zip(&states.link_noise))
            .filter_map(|(column, noise)| Some((column.as_mut()?, &noise.position_sd)));
        for (column, sd) in motors.chain(links) {
            for value in column {
                let normal: f64 = StandardNormal.sample(&mut random);
                *value += sd * normal;
            }
        }
        let problem = known.problem(&noisy)?;
        let all = known.columns(&problem);
        let target = problem.recorded(known.settled.early_s);
        let rows = problem.states.rows();
        let again = Combinations::new(known.numbers, &all, &target, rows)?;
        // the same combinations: those are of the bodies, not of the noise
        let again = match again.kept() == base.kept() {
            true => least_squares(&again, &all, &target, rows)?,
            false => return Err(MotionError::Fit("noise changes what is fixed".to_owned())),
        };
        for (sum, (value, before)) in sum.iter_mut().zip(again.values.iter().zip(values)) {
            *sum += (value - before) / NOISE_DRAWS as f64;
        }
    }
    Ok(sum)
}
