//! Touches of a point at an unknown place: a ball that is put into a socket again and again.

use haptical_model::kinematics::Twist;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{Device, ModelError, ParameterId, Recording, SurroundingParameter};

use super::kind::{Measurement, Posture, subject_of};
use super::touching::Touching;

/// From the touched point c to the handle, or the tool on it, seen from the robot's base, `R_0^T (P - c)`: zero where
/// it is on the point.
///
/// In the base's frame, not in frame (-1), the residuals stay as they are when device and points turn together,
/// however large they are: what no touch can tell stays exactly dependent away from the solution too. In
/// frame (-1) a residual of a centimetre would seem to tell three turns (docs/equations.md, "Touched points").
pub(crate) struct Contact;

/// From the point to the handle, and the base's axes as rows, times the weight.
pub(crate) struct Seen {
    gap_m: Vector3<f64>,
    into_base: Matrix3<f64>,
    point: usize,
    touching: Touching,
}

impl Measurement for Contact {
    const WIDTH: usize = 3;
    const IS_OF_HANDLE: bool = true;
    type Seen = Seen;

    fn has_reading(&self, recording: &Recording, row: usize) -> bool {
        let ids = recording.contact.as_ref();
        ids.is_some_and(|ids| !ids[row].is_empty())
    }

    fn subject(
        &self,
        device: &Device,
        recording: &Recording,
        row: usize,
    ) -> Option<Result<usize, String>> {
        let index = |id: &str| device.surroundings.contact_index(id);
        subject_of(recording.contact.as_ref(), row, index)
    }

    fn stated_sd(&self, device: &Device) -> Option<f64> {
        device.surroundings.contact_sd_m
    }

    fn owns(&self, parameter: SurroundingParameter) -> bool {
        use SurroundingParameter::{Contact, Tool};
        matches!(parameter, Contact { .. } | Tool { .. })
    }

    fn see(&self, at: &Posture<'_>, weight: f64) -> Result<([f64; 3], Seen), ModelError> {
        let point = at.device.surroundings.contacts.get(at.subject);
        let point = Vector3::from(point.map_or([f64::NAN; 3], |point| point.position_m));
        let touching = Touching::new(at)?;
        let gap_m = touching.position_m - point;
        let into_base = at.evaluation.base_pose()?.rotation.transpose() * weight;
        let seen = Seen {
            gap_m,
            into_base,
            point: at.subject,
            touching,
        };
        Ok(((into_base * gap_m).into(), seen))
    }

    fn derivative(&self, seen: &Seen, at: &Posture<'_>, parameter: ParameterId) -> [f64; 3] {
        match parameter {
            ParameterId::Surrounding(SurroundingParameter::Contact { point, axis })
                if point == seen.point =>
            {
                (-seen.into_base.column(axis)).into()
            }
            ParameterId::Surrounding(_) => {
                let own = seen.touching.own(parameter);
                own.map_or([0.0; 3], |linear| (seen.into_base * linear).into())
            }
            ParameterId::Link { row: 0, .. } => {
                self.by_base_twist(seen, &at.evaluation.pose_derivative(parameter))
            }
            _ => self.by_twist(seen, &at.evaluation.pose_derivative(parameter)),
        }
    }

    fn by_twist(&self, seen: &Seen, twist: &Twist) -> [f64; 3] {
        (seen.into_base * seen.touching.carried(twist)).into()
    }

    fn by_base_twist(&self, seen: &Seen, twist: &Twist) -> [f64; 3] {
        let linear = seen.touching.carried(twist);
        (seen.into_base * (linear - twist.angular.cross(&seen.gap_m))).into()
    }

    fn sensitivity_square(&self, at: &Posture<'_>, twist: &Twist) -> Result<f64, ModelError> {
        Ok(Touching::new(at)?.carried(twist).norm_squared() / 3.0)
    }
}
