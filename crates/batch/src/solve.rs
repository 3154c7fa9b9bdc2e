//! The parameters that fit a batch of distances best.

use haptical_identification::{Fit, IdentificationError, Settings, solve};

use crate::{DistanceModel, PoseBatch, ReducedDistance, Threads};

/// Minimises the sum of squared weighted distance residuals (Baser & Konukseven eq. (7)) over `free`,
/// from `start` (m and rad, in the order of [`DistanceModel::parameters`]).
///
/// The search is [`solve`]'s. [`Fit::residuals`] and [`Fit::reduction`] are those of the triangle: the
/// first free.len() + 1 residuals are Q^T r, and the reduction counts the triangle's rows.
///
/// ```
/// use haptical_batch::{DistanceModel, PoseBatch, Sines, Threads, solve_distances};
/// use haptical_identification::Settings;
/// use haptical_kinematics::{Convention, Link, Motion};
/// // a planar arm, 0.3 m and 0.2 m, its anchor at the shoulder: delta^2 = a0^2 + a1^2 + 2 a0 a1 cos q
/// let links = [Link { a_m: 0.29, ..Link::default() }, Link { a_m: 0.21, ..Link::default() }];
/// let motions = [Motion::Fixed, Motion::Revolute];
/// let model = DistanceModel::new(Convention::Standard, &links, &motions, [0.0; 3])?;
/// let q: Vec<f64> = (0..40).map(|index| 0.05 * index as f64).collect();
/// let delta: Vec<f64> = q.iter().map(|q| (0.13 + 0.12 * q.cos()).sqrt()).collect();
/// let poses = PoseBatch::new(&motions, &[q], &delta, &[1e4; 40], Sines::Cached)?;
/// let free = [0, 4, 7]; // a0, a1, theta1
/// let fit = solve_distances(&model, &poses, &model.start(), &free, &Settings::default(), Threads::One)?;
/// assert!((fit.parameters[0] - 0.3).abs() < 1e-9 && (fit.parameters[4] - 0.2).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`solve`]; [`IdentificationError::TooFewRows`] for fewer poses than free parameters.
pub fn solve_distances(
    model: &DistanceModel,
    poses: &PoseBatch,
    start: &[f64],
    free: &[usize],
    settings: &Settings,
    threads: Threads,
) -> Result<Fit, IdentificationError> {
    let problem = ReducedDistance::new(model, poses, threads)?;
    enough(problem.pose_count(), free)?;
    solve(&problem, start, free, settings)
}

/// The outcome of [`solve_distances_warm`].
#[derive(Debug, Clone)]
pub struct WarmFit {
    /// The fit to the subset; none where the subset would be all blocks or too few poses.
    pub subset: Option<Fit>,
    /// The fit to all poses.
    pub fit: Fit,
}

/// Share of the poses per free parameter that a subset must have to be worth a search of its own.
const POSES_PER_PARAMETER: usize = 10;

/// As [`solve_distances`], from the solution for every `every`-th block of 4096 poses.
///
/// # Errors
/// As [`solve_distances`]. Whatever becomes of the search on the subset, the one on all poses follows;
/// it starts at `start` where the subset gave nothing.
pub fn solve_distances_warm(
    model: &DistanceModel,
    poses: &PoseBatch,
    start: &[f64],
    free: &[usize],
    settings: &Settings,
    threads: Threads,
    every: usize,
) -> Result<WarmFit, IdentificationError> {
    let part = ReducedDistance::new(model, poses, threads)?.with_every(every);
    let is_part = part.pose_count() < poses.len();
    let subset = if is_part && part.pose_count() >= POSES_PER_PARAMETER * free.len() {
        solve(&part, start, free, settings).ok()
    } else {
        None
    };
    let from = subset
        .as_ref()
        .filter(|fit| fit.convergence.was_successful());
    let from = from.map_or(start, |fit| &fit.parameters);
    let fit = solve_distances(model, poses, from, free, settings, threads)?;
    Ok(WarmFit { subset, fit })
}

pub(crate) fn enough(rows: usize, free: &[usize]) -> Result<(), IdentificationError> {
    if rows < free.len() {
        return Err(IdentificationError::TooFewRows {
            rows,
            parameters: free.len(),
        });
    }
    Ok(())
}
