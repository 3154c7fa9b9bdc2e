//! Touches of a plane at an unknown place.

use haptical_model::kinematics::Twist;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{
    Device, ModelError, ParameterId, Recording, SurroundingParameter, TouchedPlane,
};

use super::kind::{Measurement, Posture, subject_of};
use super::touching::Touching;

/// Distance of the handle from the plane, `n . P - offset`.
pub(crate) struct Plane;

/// Normal, its slopes by the tilts, the handle's position, and the weight.
pub(crate) struct Seen {
    normal: Vector3<f64>,
    slopes: [Vector3<f64>; 2],
    touching: Touching,
    weight: f64,
    plane: usize,
}

impl Plane {
    fn plane<'e>(at: &Posture<'e>) -> Option<&'e TouchedPlane> {
        at.device.surroundings.planes.get(at.subject)
    }
}

impl Measurement for Plane {
    const IS_OF_HANDLE: bool = true;
    type Seen = Seen;

    fn has_reading(&self, recording: &Recording, row: usize) -> bool {
        let ids = recording.plane.as_ref();
        ids.is_some_and(|ids| !ids[row].is_empty())
    }

    fn subject(
        &self,
        device: &Device,
        recording: &Recording,
        row: usize,
    ) -> Option<Result<usize, String>> {
        let index = |id: &str| device.surroundings.plane_index(id);
        subject_of(recording.plane.as_ref(), row, index)
    }

    fn stated_sd(&self, device: &Device) -> Option<f64> {
        device.surroundings.plane_sd_m
    }

    fn owns(&self, parameter: SurroundingParameter) -> bool {
        use SurroundingParameter::{Plane, Tool};
        matches!(parameter, Plane { .. } | Tool { .. })
    }

    fn see(&self, at: &Posture<'_>, weight: f64) -> Result<([f64; 3], Seen), ModelError> {
        let touching = Touching::new(at)?;
        let plane = Self::plane(at);
        let nothing = Vector3::repeat(f64::NAN);
        let (normal, slopes) =
            plane.map_or((nothing, [nothing; 2]), TouchedPlane::normal_and_slopes);
        let offset_m = plane.map_or(f64::NAN, |plane| plane.offset_m);
        let seen = Seen {
            normal,
            slopes,
            touching,
            weight,
            plane: at.subject,
        };
        let residual = weight * (normal.dot(&touching.position_m) - offset_m);
        Ok(([residual, 0.0, 0.0], seen))
    }

    fn derivative(&self, seen: &Seen, at: &Posture<'_>, parameter: ParameterId) -> [f64; 3] {
        let slope = match parameter {
            ParameterId::Surrounding(SurroundingParameter::Plane { plane, index })
                if plane == seen.plane =>
            {
                match index {
                    2 => -1.0,
                    tilt => seen.slopes[tilt].dot(&seen.touching.position_m),
                }
            }
            ParameterId::Surrounding(_) => {
                let own = seen.touching.own(parameter);
                own.map_or(0.0, |linear| seen.normal.dot(&linear))
            }
            _ => return self.by_twist(seen, &at.evaluation.pose_derivative(parameter)),
        };
        [seen.weight * slope, 0.0, 0.0]
    }

    fn by_twist(&self, seen: &Seen, twist: &Twist) -> [f64; 3] {
        let linear = seen.touching.carried(twist);
        [seen.weight * seen.normal.dot(&linear), 0.0, 0.0]
    }

    fn sensitivity_square(&self, at: &Posture<'_>, twist: &Twist) -> Result<f64, ModelError> {
        let normal = Self::plane(at).map(|plane| plane.normal_and_slopes().0);
        let linear = Touching::new(at)?.carried(twist);
        Ok(normal.map_or(0.0, |normal| normal.dot(&linear).powi(2)))
    }
}
