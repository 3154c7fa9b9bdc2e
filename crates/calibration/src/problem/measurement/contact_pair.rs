//! The known distance between two touched points.

use haptical_model::kinematics::distance_m;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, ModelError, ParameterId, Recording, SurroundingParameter};

use super::kind::{Measurement, Posture};

/// `|a - b|` against the distance of `[[contact_pair]]`: one reading of the whole recording, which is with
/// its first row. It gives touches their scale.
pub(crate) struct ContactPair {
    /// Position in `[[contact_pair]]`, from 0.
    pub(crate) index: usize,
}

/// The two points, and the direction from the second to the first times the weight.
pub(crate) struct Seen {
    points: [Option<usize>; 2],
    direction: Vector3<f64>,
}

impl ContactPair {
    /// Which of the device's points the pair is of.
    fn points(&self, device: &Device) -> [Option<usize>; 2] {
        let pair = device.contact_pairs.get(self.index);
        let index = |id: &String| device.surroundings.contact_index(id);
        [
            pair.and_then(|pair| index(&pair.a)),
            pair.and_then(|pair| index(&pair.b)),
        ]
    }
}

impl Measurement for ContactPair {
    type Seen = Seen;

    fn has_reading(&self, _: &Recording, row: usize) -> bool {
        row == 0
    }

    fn is_placed(&self, device: &Device) -> bool {
        self.points(device).iter().all(Option::is_some)
    }

    fn stated_sd(&self, device: &Device) -> Option<f64> {
        device.contact_pairs.get(self.index).map(|pair| pair.sd_m)
    }

    fn sees(&self, parameter: ParameterId) -> bool {
        matches!(
            parameter,
            ParameterId::Surrounding(SurroundingParameter::Contact { .. })
        )
    }

    fn see(&self, at: &Posture<'_>, weight: f64) -> Result<([f64; 3], Seen), ModelError> {
        let pair = at.device.contact_pairs.get(self.index);
        let points = self.points(at.device);
        let [a, b] = points.map(|point| {
            let point = point.and_then(|point| at.device.surroundings.contacts.get(point));
            Vector3::from(point.map_or([f64::NAN; 3], |point| point.position_m))
        });
        let distance = distance_m(&a, &b)?;
        let known = pair.map_or(f64::NAN, |pair| pair.distance_m);
        let seen = Seen {
            points,
            direction: (a - b) * (weight / distance),
        };
        Ok(([weight * (distance - known), 0.0, 0.0], seen))
    }

    fn derivative(&self, seen: &Seen, _: &Posture<'_>, parameter: ParameterId) -> [f64; 3] {
        let ParameterId::Surrounding(SurroundingParameter::Contact { point, axis }) = parameter
        else {
            return [0.0; 3];
        };
        let along = seen.direction[axis];
        let [a, b] = seen.points.map(|own| own == Some(point));
        [
            f64::from(u8::from(a)) * along - f64::from(u8::from(b)) * along,
            0.0,
            0.0,
        ]
    }
}
