//! Readings for a wanted pose: damped Newton steps over the links' angles, then the inverse of the drives.

use haptical_kinematics::nalgebra::{Matrix3, Vector3};
use haptical_kinematics::{Pose, Twist};

use super::model::Driven;
use super::{CompensatedModel, Effect, EffectState, Inputs, at};
use crate::RuntimeError;
use crate::error::is_bounded;

/// Steps at most.
const STEPS: usize = 100;
/// What may be left of a position \[m\] and of an orientation \[rad\].
const REACHED: f64 = 1e-11;
/// First damping, relative to squared lengths of the order of 1 m, and the smallest and largest.
const DAMPING: f64 = 1e-6;
const LEAST_DAMPING: f64 = 1e-14;
const MOST_DAMPING: f64 = 1e6;
/// `1 + trace` of a turn below which it is half a turn: sines are no axis there.
const HALF_A_TURN: f64 = 1e-8;
/// What a wanted rotation may lack to one.
const ORTHOGONAL: f64 = 1e-6;
/// Longest step of a joint \[rad\], \[m\].
const LONGEST: f64 = 0.5;

/// Way and turn that are left to a pose, frame (-1).
type Gap = [f64; 6];

impl<const JOINTS: usize, const ROWS: usize, const EFFECTS: usize>
    CompensatedModel<JOINTS, ROWS, EFFECTS>
{
    /// Readings at the next sample for which the handle has this pose, from the posture of the present readings:
    /// Levenberg and Marquardt's steps (Nakamura & Hanafusa 1986), a hundred at most, then
    /// [`inverse`](Self::inverse). Of a device with more than six joints the posture near the present one; one with less
    /// than six reaches few poses. `inputs` and `state` as of [`inverse`](Self::inverse).
    ///
    /// # Errors
    /// [`RuntimeError::PoseNotReached`] with what is left; [`RuntimeError::NotReached`]; [`RuntimeError::BeyondLimit`] where
    /// the readings that were found are beyond the device's limits; [`RuntimeError::NotAPose`].
    ///
    /// ```
    /// use haptical_runtime::*;
    /// let arm = Link { a_m: 0.3, ..Link::IDENTITY };
    /// let joint = Joint { motion: Motion::Revolute, home: 0.0, transmission: Transmission::Exact };
    /// let model = Model::new(Convention::Standard, Link::IDENTITY, [arm], [joint])?;
    /// let model = CompensatedModel::new(CoupledModel::of_rows(model), [Effect::None])?;
    /// let mut state = model.start();
    /// let wanted = model.forward(&Inputs::at([0.7]), &mut state)?.state.pose;
    /// let found = model.inverse_pose(&wanted, &Inputs::at([0.2]), &state)?;
    /// assert!((found[0] - 0.7).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn inverse_pose(
        &self,
        pose: &Pose,
        inputs: &Inputs<JOINTS>,
        state: &EffectState<EFFECTS>,
    ) -> Result<[f64; JOINTS], RuntimeError> {
        inputs.check()?;
        if !is_pose(pose) {
            return Err(RuntimeError::NotAPose);
        }
        let mut memory = state.0;
        let mut driven = self.driven(inputs, &mut memory)?;
        let (placed, mut jacobian) = self.placed(inputs, &driven)?;
        let mut gap = gap(pose, &placed);
        let mut damping = DAMPING;
        for _ in 0..STEPS {
            if is_reached(&gap) || damping > MOST_DAMPING {
                break;
            }
            let tried = stepped(&driven, &jacobian, &gap, damping);
            let outcome = tried
                .links
                .iter()
                .all(|link| is_bounded(*link))
                .then(|| self.placed(inputs, &tried));
            if let Some(Ok((placed, there))) = outcome {
                let left = self::gap(pose, &placed);
                if square(&left) < square(&gap) {
                    (driven, jacobian, gap) = (tried, there, left);
                    damping = (damping * 0.1).max(LEAST_DAMPING);
                    continue;
                }
            }
            damping *= 10.0;
        }
        if !is_reached(&gap) {
            let [x, y, z, a, b, c] = gap;
            return Err(RuntimeError::PoseNotReached {
                position_m: libm::sqrt(x * x + y * y + z * z),
                rotation_rad: libm::sqrt(a * a + b * b + c * c),
            });
        }
        let mut outputs = driven.links;
        for effect in &self.effects {
            if let Effect::JointCompliance { joint, rad_per_nm } = *effect {
                super::add(
                    &mut outputs,
                    joint,
                    rad_per_nm * at(&inputs.torque_nm, joint),
                );
            }
        }
        let readings = self.inverse(&outputs, inputs, state)?;
        self.model.check_limits(&readings)?;
        Ok(readings)
    }
}

/// Whether a position is of bounded size and a rotation is one.
fn is_pose(pose: &Pose) -> bool {
    let rotation = &pose.rotation;
    let unit = rotation * rotation.transpose() - Matrix3::identity();
    let is_bounded = pose.position_m.iter().all(|part| is_bounded(*part));
    // NaN is not
    let is_unit = unit.iter().all(|part| part.abs() <= ORTHOGONAL);
    is_bounded && is_unit && rotation.determinant() > 0.0
}

/// Links moved by J^T (J J^T + damping)^-1 gap.
fn stepped<const JOINTS: usize>(
    driven: &Driven<JOINTS>,
    jacobian: &[Twist; JOINTS],
    gap: &Gap,
    damping: f64,
) -> Driven<JOINTS> {
    let rows = jacobian.each_ref().map(rows_of);
    let mut matrix = [[0.0; 6]; 6];
    for (index, row) in matrix.iter_mut().enumerate() {
        for (other, entry) in row.iter_mut().enumerate() {
            for column in &rows {
                *entry += at(column, index) * at(column, other);
            }
            if index == other {
                *entry += damping;
            }
        }
    }
    let weights = solved(matrix, *gap);
    let mut steps = [0.0; JOINTS];
    let mut longest = LONGEST;
    for (step, column) in steps.iter_mut().zip(&rows) {
        *step = column.iter().zip(&weights).map(|(a, b)| a * b).sum();
        longest = longest.max(step.abs());
    }
    let mut moved = *driven;
    for (link, step) in moved.links.iter_mut().zip(&steps) {
        *link += step * (LONGEST / longest);
    }
    moved
}

fn rows_of(twist: &Twist) -> Gap {
    let [[x, y, z]] = twist.linear.data.0;
    let [[a, b, c]] = twist.angular.data.0;
    [x, y, z, a, b, c]
}

/// Solves with a positive definite matrix, by elimination without exchanges.
fn solved(mut matrix: [[f64; 6]; 6], mut right: Gap) -> Gap {
    for pivot in 0..6 {
        let (pivot_row, pivot_right) = (row(&matrix, pivot), at(&right, pivot));
        let rows = matrix.iter_mut().zip(&mut right).skip(pivot + 1);
        for (own, own_right) in rows {
            let factor = at(own, pivot) / at(&pivot_row, pivot);
            for (entry, above) in own.iter_mut().zip(&pivot_row) {
                *entry -= factor * above;
            }
            *own_right -= factor * pivot_right;
        }
    }
    let mut solution = [0.0; 6];
    for index in (0..6).rev() {
        let own = row(&matrix, index);
        let known: f64 = own
            .iter()
            .zip(&solution)
            .skip(index + 1)
            .map(|(a, b)| a * b)
            .sum();
        let value = (at(&right, index) - known) / at(&own, index);
        super::add(&mut solution, index, value);
    }
    solution
}

fn row(matrix: &[[f64; 6]; 6], index: usize) -> Gap {
    matrix.get(index).copied().unwrap_or_default()
}

/// What is left to a wanted pose: the way, and the axis of the turn times `2 sin(angle / 2)`, which grows up to half a turn.
fn gap(wanted: &Pose, placed: &Pose) -> Gap {
    let way = wanted.position_m - placed.position_m;
    let turn = wanted.rotation * placed.rotation.transpose();
    // the axis times twice the sine of the angle
    let twice = Vector3::new(
        turn.m32 - turn.m23,
        turn.m13 - turn.m31,
        turn.m21 - turn.m12,
    );
    // 2 cos(angle / 2), squared
    let square = 1.0 + turn.trace();
    let angular = match square > HALF_A_TURN {
        true => twice / libm::sqrt(square),
        false => axis_of_half_a_turn(&turn) * 2.0,
    };
    rows_of(&Twist {
        linear: way,
        angular,
    })
}

/// The axis of a turn by half a turn, R = 2 a a^T - 1, to either side: the longest column of a a^T.
fn axis_of_half_a_turn(turn: &Matrix3<f64>) -> Vector3<f64> {
    let product = turn + Matrix3::identity();
    let mut longest = Vector3::x();
    let mut square = 0.0;
    for column in product.column_iter() {
        let own = column.norm_squared();
        if own > square {
            (longest, square) = (column.into_owned(), own);
        }
    }
    longest / libm::sqrt(longest.norm_squared())
}

fn square(gap: &Gap) -> f64 {
    gap.iter().map(|part| part * part).sum()
}

fn is_reached(gap: &Gap) -> bool {
    // NaN is not
    gap.iter().all(|part| part.abs() <= REACHED)
}
