//! The task of the device: how parameters move the handle, or turn its force, in a region.

use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{
    Device, Evaluation, ForceTransmission, ModelError, ParameterId, handle_force_n,
};

use crate::posture::candidates::{Draws, range};
use crate::{Criterion, DesignError, Information, Limits, Spread};

/// Where the task is done.
#[derive(Debug, Clone, PartialEq)]
pub enum Region {
    /// Wherever the limits of the poses allow.
    Everywhere,
    /// Handle positions within a radius of a point of frame (-1).
    Ball {
        /// Middle \[m\].
        centre_m: [f64; 3],
        /// Radius \[m\].
        radius_m: f64,
    },
    /// Lowest and highest reading of each joint (\[rad\], \[m\] for a prismatic joint).
    Joints(Vec<[f64; 2]>),
}

/// Postures over which a task is averaged.
const POSTURES: usize = 60;
/// Draws of postures, at most: a ball of a tenth of the reach takes about a thousandth of them.
const MOST_DRAWS: usize = 200_000;
/// Condition number of the Jacobian from which a posture says nothing of forces.
const WORST_CONDITION: f64 = 300.0;
/// Share of a parameter's plausible size by which it is moved: small against the curvature, large against
/// rounding.
const STEP: f64 = 1e-3;
/// The redundant joint of a seven-joint arm, locked as in the paper.
const LOCKED: usize = 2;

/// Rows t of the quadratic criterion trace(W C), W = sum of t t^T, one entry for each parameter of the
/// information: what a unit of it does, so that the criterion is a mean square.
///
/// - [`Criterion::A`]: one over the plausible size, for each parameter of the device itself that is among
///   `columns`: the mean square of sd over plausible size.
/// - [`Criterion::TaskPosition`]: derivatives of the handle's position \[m\]: its mean square error.
/// - [`Criterion::TaskForce`]: derivatives of the transverse part of a unit force: the mean square angle
///   \[rad^2\] (docs/equations.md, Force through the transposed Jacobian).
///
/// The last two are means over up to 60 postures in the region. There are no rows for the other criteria.
///
/// # Errors
/// [`DesignError::Task`] for a device without links, a force of one without six or seven joints, or a region
/// that the device does not reach.
pub fn task_rows(
    criterion: Criterion,
    information: &Information,
    columns: &[usize],
    (region, limits): (&Region, &Limits),
    seed: u64,
) -> Result<Vec<Vec<f64>>, DesignError> {
    match criterion {
        Criterion::D | Criterion::O1 => Ok(Vec::new()),
        Criterion::A => Ok(sizes(information, columns)),
        Criterion::TaskPosition => {
            positions(information, &postures(information, region, limits, seed)?)
        }
        Criterion::TaskForce => forces(information, &postures(information, region, limits, seed)?),
    }
}

fn sizes(information: &Information, columns: &[usize]) -> Vec<Vec<f64>> {
    let of_device = |&&column: &&usize| {
        let parameter = information.equipped.parameters[column];
        !matches!(parameter, ParameterId::Surrounding(_))
    };
    let own: Vec<usize> = columns.iter().filter(of_device).copied().collect();
    let share = (own.len().max(1) as f64).sqrt();
    let row = |&column: &usize| {
        let mut row = vec![0.0; information.parameters()];
        row[column] = 1.0 / (information.infos[column].plausible_size * share);
        row
    };
    own.iter().map(row).collect()
}

fn task(message: impl Into<String>) -> DesignError {
    DesignError::Task {
        message: message.into(),
    }
}

/// Postures in the region.
fn postures(
    information: &Information,
    region: &Region,
    limits: &Limits,
    seed: u64,
) -> Result<Vec<Vec<f64>>, DesignError> {
    let device = &information.equipped.device;
    if !device.has_links() {
        return Err(task(
            "the device file has no [[link]], so that there is no handle",
        ));
    }
    let within = region.check(device)?;
    let mut limits = *limits;
    if *region != Region::Everywhere {
        limits.spread = Spread::Uniform;
    }
    // other numbers than those of the candidates
    let mut draws = Draws::new(device, &limits, seed ^ 0x7461_736b)?;
    let mut found = Vec::new();
    for _ in 0..MOST_DRAWS {
        let mut pose = draws.draw();
        if let Some(ranges) = &within {
            squeeze(&mut pose, device, ranges)?;
        }
        if !draws.admits(&pose) {
            continue;
        }
        if let Region::Ball { centre_m, radius_m } = region {
            let handle = draws.evaluation.pose().map(|pose| pose.position_m);
            let far = |handle: Vector3<f64>| (handle - Vector3::from(*centre_m)).norm() > *radius_m;
            if handle.map_or(true, far) {
                continue;
            }
        }
        found.push(pose);
        if found.len() == POSTURES {
            break;
        }
    }
    match found.is_empty() {
        true => Err(task(
            "the device does not reach the region within the limits of the poses: give another region",
        )),
        false => Ok(found),
    }
}

/// Takes a pose between the joint limits to the same share of the region's.
fn squeeze(pose: &mut [f64], device: &Device, ranges: &[[f64; 2]]) -> Result<(), DesignError> {
    for (joint, (reading, [low, high])) in pose.iter_mut().zip(ranges).enumerate() {
        let [lower, upper] = range(&device.joints[joint], joint + 1)?;
        let share = (*reading - lower) / (upper - lower);
        *reading = low + (high - low) * share;
    }
    Ok(())
}

impl Region {
    /// Ranges of the joints where the region is one of joints.
    fn check(&self, device: &Device) -> Result<Option<Vec<[f64; 2]>>, DesignError> {
        match self {
            Self::Everywhere => Ok(None),
            Self::Ball { centre_m, radius_m } => {
                let is_place = centre_m.iter().all(|value| value.is_finite());
                match is_place && *radius_m > 0.0 && radius_m.is_finite() {
                    true => Ok(None),
                    false => Err(task(
                        "the region's radius is not above 0: give x,y,z,r in m",
                    )),
                }
            }
            Self::Joints(ranges) if ranges.len() != device.joints.len() => Err(task(format!(
                "the region gives {} joints and the device has {}: give low:high for each",
                ranges.len(),
                device.joints.len()
            ))),
            Self::Joints(ranges) => {
                for (index, ([low, high], joint)) in ranges.iter().zip(&device.joints).enumerate() {
                    let [lower, upper] = range(joint, index + 1)?;
                    if !(lower <= *low && low <= high && *high <= upper) {
                        return Err(task(format!(
                            "{low}:{high} of joint {} is not within its limits {lower}:{upper}: give a part of them",
                            index + 1
                        )));
                    }
                }
                Ok(Some(ranges.clone()))
            }
        }
    }
}

fn positions(
    information: &Information,
    postures: &[Vec<f64>],
) -> Result<Vec<Vec<f64>>, DesignError> {
    let equipped = &information.equipped;
    let mut evaluation = Evaluation::new(&equipped.device);
    let share = 1.0 / (postures.len() as f64).sqrt();
    let mut rows = Vec::new();
    for (index, posture) in postures.iter().enumerate() {
        evaluation
            .move_to(posture)
            .map_err(DesignError::of_pose(index))?;
        for axis in 0..3 {
            let slope = |parameter: &ParameterId| {
                share * evaluation.pose_derivative(*parameter).linear[axis]
            };
            rows.push(equipped.parameters.iter().map(slope).collect());
        }
    }
    Ok(rows)
}

fn forces(information: &Information, postures: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, DesignError> {
    let equipped = &information.equipped;
    let joints = equipped.device.joints.len();
    if !(6..=7).contains(&joints) {
        return Err(task(format!(
            "the direction of a force needs six joints, or seven of which the third is locked, and the device \
             has {joints}: take task-position"
        )));
    }
    let locked = (joints == 7).then_some(LOCKED);
    let mut free = [0; 6];
    let others = (0..joints).filter(|joint| Some(*joint) != locked);
    free.iter_mut()
        .zip(others)
        .for_each(|(entry, joint)| *entry = joint);
    let mut rows = Vec::new();
    for (index, posture) in postures.iter().enumerate() {
        let mut posture = posture.clone();
        if let Some(locked) = locked {
            posture[locked] = 0.0;
        }
        let mut truth = Evaluation::new(&equipped.device);
        truth
            .move_to(&posture)
            .map_err(DesignError::of_pose(index))?;
        let known = ForceTransmission::new(&truth, &truth, free);
        if known.map_or(f64::INFINITY, |known| known.condition) > WORST_CONDITION {
            continue;
        }
        let mut pair = [Vec::new(), Vec::new()];
        for (parameter, info) in equipped.parameters.iter().zip(&information.infos) {
            let step = STEP * info.plausible_size;
            let force = |sign: f64| -> Result<Vector3<f64>, ModelError> {
                let mut device = equipped.device.clone();
                let value = parameter.value(&device);
                parameter.set(&mut device, value + sign * step);
                let mut controller = Evaluation::new(&device);
                controller.move_to(&posture)?;
                let known = ForceTransmission::new(&truth, &controller, free)?;
                let force = handle_force_n(&known, &truth, &controller, 1.0, 0.0)?;
                Ok(force.unwrap_or_default())
            };
            let (after, before) = (
                force(1.0).map_err(DesignError::of_pose(index))?,
                force(-1.0).map_err(DesignError::of_pose(index))?,
            );
            for (axis, row) in pair.iter_mut().enumerate() {
                row.push((after[axis] - before[axis]) / (2.0 * step));
            }
        }
        rows.extend(pair);
    }
    if rows.is_empty() {
        return Err(task(
            "every posture of the region is nearly singular: give another region",
        ));
    }
    let share = 1.0 / (rows.len() as f64 / 2.0).sqrt();
    rows.iter_mut().flatten().for_each(|entry| *entry *= share);
    Ok(rows)
}
