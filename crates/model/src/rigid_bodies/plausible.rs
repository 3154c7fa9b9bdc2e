//! Masses and inertias of moving rows: the device's, or plausible ones of a rod along the row's geometry.

use haptical_kinematics::nalgebra::{Matrix3, Vector3};

use crate::{Device, Segments};

/// Mass of a link per length where none is known \[kg/m\]: assumption A150.
const KG_PER_M: f64 = 2.0;
/// Mass of a link at least, where none is known \[kg\]: assumption A150.
const LEAST_KG: f64 = 0.05;
/// Mass of a link that is said to have none \[kg\]: simulators divide by it. Assumption A150.
const NEXT_TO_NOTHING_KG: f64 = 1e-3;
/// Radius of the rod \[m\]: assumption A150.
const RADIUS_M: f64 = 0.02;
/// Least moment of the mass's own distribution, per trace: below it no body is that flat.
const FLATTEST: f64 = 1e-6;

/// What a moving row carries.
#[derive(Debug, Clone)]
pub struct RowBody {
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Centre of mass behind the motion \[m\].
    pub centre_m: Vector3<f64>,
    /// Inertia about it \[kg m^2\].
    pub inertia_kgm2: Matrix3<f64>,
    /// From the row's frame to what hangs on it next \[m\].
    pub reach_m: Vector3<f64>,
    /// What is plausible and not known, in words.
    pub plausible: Option<&'static str>,
}

impl RowBody {
    /// The inertia as ixx, iyy, izz, ixy, ixz, iyz, the order of a device file.
    pub fn inertia_entries_kgm2(&self) -> [f64; 6] {
        [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|place| self.inertia_kgm2[place])
    }

    /// Bodies of all moving rows of a device: what its file gives, and a rod of 2 kg/m along the row's geometry for what
    /// it does not (assumption A150).
    ///
    /// ```
    /// use haptical_model::{Device, RowBody, Segments};
    /// let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
    ///     [[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\n[[joint]]\n";
    /// let lever = Device::from_toml(text, "lever.toml")?.device;
    /// let bodies = RowBody::of_rows(&lever, &Segments::of_device(&lever)?);
    /// assert_eq!((bodies[0].mass_kg, bodies[0].plausible), (0.8, Some("mass and inertia")));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of_rows(device: &Device, segments: &Segments) -> Vec<Self> {
        let rows = segments.rows.iter().enumerate();
        rows.map(|(row, segment)| {
            let reach_m = reach(device, segments, row);
            let Some(own) = segment.body else {
                let mass_kg = (KG_PER_M * reach_m.norm()).max(LEAST_KG);
                return RowBody {
                    mass_kg,
                    centre_m: reach_m * 0.5,
                    inertia_kgm2: rod(mass_kg, &reach_m),
                    reach_m,
                    plausible: Some("mass and inertia"),
                };
            };
            let mass_kg = match own.mass_kg > 0.0 {
                true => own.mass_kg,
                false => NEXT_TO_NOTHING_KG,
            };
            let inertia = own.inertia_kgm2.filter(|_| own.mass_kg > 0.0);
            let sound = inertia.and_then(|inertia| sound(&inertia));
            RowBody {
                mass_kg,
                centre_m: own.centre_m,
                inertia_kgm2: sound.unwrap_or_else(|| rod(mass_kg, &reach_m)),
                reach_m,
                plausible: match (sound, inertia) {
                    (Some(_), _) => None,
                    (None, Some(_)) => {
                        Some("inertia, because the one that is given is that of no body,")
                    }
                    (None, None) if own.mass_kg > 0.0 => Some("inertia"),
                    (None, None) => Some("mass, which is given as 0, and inertia"),
                },
            }
        })
        .collect()
    }
}

/// From a row's frame to the first frame that hangs on it, or to its hand, at home.
fn reach(device: &Device, segments: &Segments, row: usize) -> Vector3<f64> {
    let child = (0..segments.rows.len()).find(|child| device.parent(child + 1) == Some(row + 1));
    if let Some(child) = child.and_then(|child| segments.rows.get(child)) {
        return child.origin(device).position_m;
    }
    let hand = device.hands.iter().position(|hand| hand.row == row + 1);
    let handle = segments.handles.get(hand.unwrap_or(0));
    handle.map_or(Vector3::zeros(), |handle| handle.position_m)
}

/// Inertia of a round rod about its centre; one of no length is as long as it is thick.
fn rod(mass_kg: f64, along_m: &Vector3<f64>) -> Matrix3<f64> {
    let length_m = along_m.norm().max(2.0 * RADIUS_M);
    let axis = along_m.try_normalize(1e-9).unwrap_or_else(Vector3::z);
    let about = 0.5 * mass_kg * RADIUS_M * RADIUS_M;
    let across = mass_kg * (3.0 * RADIUS_M * RADIUS_M + length_m * length_m) / 12.0;
    Matrix3::identity() * across + axis * axis.transpose() * (about - across)
}

/// An inertia as one of a body: the second moments of its mass, half the trace less the inertia, are not negative. One
/// that is flat but for rounding is made a little thicker; none where it is worse.
fn sound(inertia: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let inertia = (inertia + inertia.transpose()) * 0.5;
    let trace = inertia.trace();
    if !(trace > 0.0 && trace.is_finite()) {
        return None;
    }
    let least = Matrix3::identity() * (FLATTEST * trace);
    let moments = Matrix3::identity() * (0.5 * trace) - inertia;
    if (moments - least).cholesky().is_some() {
        return Some(inertia);
    }
    // each moment of the thicker body is larger by half of what is added to the diagonal
    let thicker = inertia + least * 4.0;
    (moments + least).cholesky().map(|_| thicker)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rod_has_the_inertia_of_a_cylinder() {
        // m r^2 / 2 along, m (3 r^2 + l^2) / 12 across
        let inertia = rod(3.0, &Vector3::new(0.0, 0.5, 0.0));
        assert!((inertia[(1, 1)] - 3.0 * 0.02 * 0.02 / 2.0).abs() < 1e-15);
        let across = 3.0 * (3.0 * 0.02 * 0.02 + 0.25) / 12.0;
        assert!(
            (inertia[(0, 0)] - across).abs() < 1e-15 && (inertia[(2, 2)] - across).abs() < 1e-15
        );
    }

    #[test]
    fn an_inertia_that_no_body_has_is_not_taken() {
        let diagonal = |x, y, z| Matrix3::from_diagonal(&Vector3::new(x, y, z));
        assert_eq!(
            sound(&diagonal(1.0, 1.0, 1.5)),
            Some(diagonal(1.0, 1.0, 1.5))
        );
        // one moment is above the sum of the others
        assert_eq!(sound(&diagonal(1.0, 1.0, 2.5)), None);
        assert_eq!(sound(&diagonal(0.0, 0.0, 0.0)), None);
        assert_eq!(sound(&diagonal(-1.0, 1.0, 1.0)), None);
        // a plate is flat, and no flatter than rounding after it is made thicker
        let plate = sound(&diagonal(1.0, 1.0, 2.0)).unwrap_or_default();
        assert!(plate[(0, 0)] + plate[(1, 1)] > plate[(2, 2)]);
        assert!((plate - diagonal(1.0, 1.0, 2.0)).amax() < 1e-4);
    }
}
