//! Small displacements of the handle by links, base and tool, and the loads that cause them.

use haptical_kinematics::nalgebra::{Matrix3, Vector3};
use haptical_kinematics::trigonometry::sine_cosine;
use haptical_kinematics::{Pose, Twist};

use super::at;
use super::drives::waves;
use crate::error::is_bounded;
use crate::{Effect, RuntimeError};

/// Where a chain stands, as the effects of its structure see it.
#[derive(Debug)]
pub(super) struct Stance<'s> {
    /// The handle without them.
    pub(super) pose: Pose,
    /// Jacobian of the link angles.
    pub(super) jacobian: &'s [Twist],
    pub(super) links: &'s [f64],
    /// Frames in front of the rows.
    pub(super) before: &'s [Pose],
    /// Frames behind the rows.
    pub(super) behind: &'s [Pose],
    /// Force of the hand on the handle, frame (-1).
    pub(super) force_n: Vector3<f64>,
    pub(super) temperature_degc: f64,
}

/// A point, or a row with a point, that an effect's link carries along: worked out when the model is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// Row behind whose frame the point is, or in front of whose frame.
    pub(super) row: usize,
    /// Its coordinates there.
    pub(super) local_m: [f64; 3],
    /// Joint that moves the row before, if any.
    pub(super) joint_before: Option<usize>,
}

impl Place {
    pub(super) const NONE: Self = Self {
        row: 0,
        local_m: [0.0; 3],
        joint_before: None,
    };

    #[inline]
    fn within(&self, frames: &[Pose]) -> Option<Vector3<f64>> {
        let frame = frames.get(self.row)?;
        Some(frame.position_m + frame.rotation * Vector3::from(self.local_m))
    }
}

/// Moment \[Nm\] about a place of the hand and of the weights behind a row.
#[inline]
fn moment_nm(
    stance: &Stance<'_>,
    effects: &[Effect],
    places: &[Place],
    from_row: usize,
    about_m: &Vector3<f64>,
) -> Vector3<f64> {
    let arm = stance.pose.position_m - about_m;
    let mut moment_nm = arm.cross(&stance.force_n);
    for (effect, place) in effects.iter().zip(places) {
        if let Effect::Weight { row, force_n, .. } = effect
            && *row >= from_row
            && let Some(place_m) = place.within(stance.behind)
        {
            moment_nm += (place_m - about_m).cross(&Vector3::from(*force_n));
        }
    }
    moment_nm
}

/// What one effect displaces the handle by; none for one of another kind.
#[inline]
fn displacement(
    stance: &Stance<'_>,
    effect: &Effect,
    place: &Place,
    effects: &[Effect],
    places: &[Place],
) -> Result<Option<Twist>, RuntimeError> {
    let position_m = &stance.pose.position_m;
    let turned = |angular: Vector3<f64>, about_m: &Vector3<f64>| Twist {
        linear: angular.cross(&(position_m - about_m)),
        angular,
    };
    let shifted = |linear: Vector3<f64>| Twist {
        linear,
        angular: Vector3::zeros(),
    };
    Ok(match effect {
        Effect::LateralCompliance {
            joint, rad_per_nm, ..
        } => {
            let origin_m = place.within(stance.before);
            origin_m
                .zip(stance.jacobian.get(*joint))
                .map(|(origin_m, twist)| {
                    let moment = moment_nm(stance, effects, places, place.row, &origin_m);
                    let axis = twist.angular;
                    turned((moment - axis * axis.dot(&moment)) * *rad_per_nm, &origin_m)
                })
        }
        Effect::BaseCompliance { rad_per_nm, base_m } => {
            let base_m = Vector3::from(*base_m);
            let moment = moment_nm(stance, effects, places, 0, &base_m);
            Some(turned(moment * *rad_per_nm, &base_m))
        }
        Effect::ToolCompliance { m_per_n } => Some(shifted(stance.force_n * *m_per_n)),
        Effect::AxisWobble {
            joint,
            order,
            cosine_rad: [first_cosine, second_cosine],
            sine_rad: [first_sine, second_sine],
            ..
        } => {
            let own = stance.jacobian.get(*joint);
            let origin_m = place.within(stance.before);
            let (sine, cosine) = waves(*joint, *order, at(stance.links, *joint))?;
            own.zip(origin_m).and_then(|(own, origin_m)| {
                let before = place
                    .joint_before
                    .and_then(|joint| stance.jacobian.get(joint));
                let [first, second] = own.across(before)?;
                let tilt = first * (first_cosine * cosine + first_sine * sine)
                    + second * (second_cosine * cosine + second_sine * sine);
                Some(turned(tilt, &origin_m))
            })
        }
        Effect::ThermalGrowth {
            per_degc,
            reference_degc,
            base_m,
        } => {
            let way = position_m - Vector3::from(*base_m);
            let warming = stance.temperature_degc - reference_degc;
            Some(shifted(way * (per_degc * warming)))
        }
        Effect::ToolChanged { shift_m } => {
            Some(shifted(stance.pose.rotation * Vector3::from(*shift_m)))
        }
        _ => None,
    })
}

/// The handle where the effects of the structure put it: the sum of their displacements, all from the same stance.
#[inline]
pub(super) fn displaced(
    stance: &Stance<'_>,
    effects: &[Effect],
    places: &[Place],
) -> Result<Pose, RuntimeError> {
    let mut sum = Twist::default();
    for (effect, place) in effects.iter().zip(places) {
        if let Some(twist) = displacement(stance, effect, place, effects, places)? {
            sum.linear += twist.linear;
            sum.angular += twist.angular;
        }
    }
    let mut parts = sum.linear.iter().chain(sum.angular.iter());
    if !parts.all(|part| is_bounded(*part)) {
        return Err(RuntimeError::DisplacementOutOfRange);
    }
    Ok(Pose {
        position_m: stance.pose.position_m + sum.linear,
        rotation: rotation_by(&sum.angular) * stance.pose.rotation,
    })
}

/// Squared angle below which three terms of the series are exact.
const SMALL_SQUARE: f64 = 1e-6;

/// The rotation about a vector by its length \[rad\] (Rodrigues).
#[inline]
pub(super) fn rotation_by(vector: &Vector3<f64>) -> Matrix3<f64> {
    let square = vector.norm_squared();
    let (sine, versine) = if square < SMALL_SQUARE {
        (
            1.0 - square / 6.0 * (1.0 - square / 20.0),
            0.5 - square / 24.0 * (1.0 - square / 30.0),
        )
    } else {
        let angle_rad = libm::sqrt(square);
        let (sine, cosine) = sine_cosine(angle_rad);
        (sine / angle_rad, (1.0 - cosine) / square)
    };
    let cross = vector.cross_matrix();
    Matrix3::identity() + cross * sine + cross * cross * versine
}
