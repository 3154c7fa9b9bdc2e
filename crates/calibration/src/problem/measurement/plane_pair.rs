//! The known angle between two touched planes.

use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{
    Device, ModelError, ParameterId, Recording, SurroundingParameter, TouchedPlane,
};

use super::kind::{Measurement, Posture};

/// Angle between the normals against that of `[[plane_pair]]`, or its supplement where the normals point the
/// other way: one reading of the whole recording, which is with its first row.
pub(crate) struct PlanePair {
    /// Position in `[[plane_pair]]`, from 0.
    pub(crate) index: usize,
}

/// Per plane: which it is, and the derivatives of the angle by its tilts, times the weight.
pub(crate) struct Seen {
    planes: [Option<usize>; 2],
    slopes: [[f64; 2]; 2],
}

impl PlanePair {
    /// Which of the device's planes the pair is of.
    fn planes(&self, device: &Device) -> [Option<usize>; 2] {
        let pair = device.surroundings.plane_pairs.get(self.index);
        let index = |id: &String| device.surroundings.plane_index(id);
        [
            pair.and_then(|pair| index(&pair.a)),
            pair.and_then(|pair| index(&pair.b)),
        ]
    }
}

impl Measurement for PlanePair {
    type Seen = Seen;

    fn unit(&self, _: &Device) -> &'static str {
        "rad"
    }

    fn has_reading(&self, _: &Recording, row: usize) -> bool {
        row == 0
    }

    fn is_placed(&self, device: &Device) -> bool {
        self.planes(device).iter().all(Option::is_some)
    }

    fn stated_sd(&self, device: &Device) -> Option<f64> {
        let pairs = &device.surroundings.plane_pairs;
        pairs.get(self.index).map(|pair| pair.sd_rad)
    }

    fn sees(&self, parameter: ParameterId) -> bool {
        matches!(
            parameter,
            ParameterId::Surrounding(SurroundingParameter::Plane { .. })
        )
    }

    /// With c = n_a . n_b the angle is atan2(|n_a x n_b|, c), and its derivative -dc / sin(angle).
    fn see(&self, at: &Posture<'_>, weight: f64) -> Result<([f64; 3], Seen), ModelError> {
        let surroundings = &at.device.surroundings;
        let pair = surroundings.plane_pairs.get(self.index);
        let planes = self.planes(at.device);
        let nothing = Vector3::repeat(f64::NAN);
        let [a, b] = planes.map(|plane| {
            let plane = plane.and_then(|plane| surroundings.planes.get(plane));
            plane.map_or((nothing, [nothing; 2]), TouchedPlane::normal_and_slopes)
        });
        let (sine, cosine) = (a.0.cross(&b.0).norm(), a.0.dot(&b.0));
        let angle = sine.atan2(cosine);
        let stated = pair.map_or(f64::NAN, |pair| pair.angle_rad);
        let other = std::f64::consts::PI - stated;
        let wanted = if (angle - other).abs() < (angle - stated).abs() {
            other
        } else {
            stated
        };
        let factor = -weight / sine;
        let seen = Seen {
            planes,
            slopes: [
                a.1.map(|slope| factor * slope.dot(&b.0)),
                b.1.map(|slope| factor * slope.dot(&a.0)),
            ],
        };
        Ok(([weight * (angle - wanted), 0.0, 0.0], seen))
    }

    fn derivative(&self, seen: &Seen, _: &Posture<'_>, parameter: ParameterId) -> [f64; 3] {
        let mut slope = 0.0;
        if let ParameterId::Surrounding(SurroundingParameter::Plane { plane, index }) = parameter {
            for (own, slopes) in seen.planes.iter().zip(&seen.slopes) {
                if *own == Some(plane) {
                    slope += slopes.get(index).copied().unwrap_or(0.0);
                }
            }
        }
        [slope, 0.0, 0.0]
    }
}
