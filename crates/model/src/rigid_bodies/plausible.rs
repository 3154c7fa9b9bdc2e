//! Masses and inertias of moving rows: the device's, or plausible ones of a rod along the row's geometry.

use haptical_kinematics::nalgebra::{Matrix3, Vector3};

use super::credible::{FLATTEST, GivenInertia};
use crate::{Device, Segments};

/// Mass of a link per length where none is known \[kg/m\]: assumption A150.
const KG_PER_M: f64 = 2.0;
/// Mass of a link at least, where none is known \[kg\]: assumption A150.
const LEAST_KG: f64 = 0.05;
/// Mass of a link that is said to have none \[kg\]: simulators divide by it. Assumption A150.
const NEXT_TO_NOTHING_KG: f64 = 1e-3;
/// Radius of the rod \[m\]: assumption A150.
const RADIUS_M: f64 = 0.02;

/// What is said of an inertia that [`GivenInertia`] refuses.
const OF_NO_BODY: &str = "inertia, because no body has the one that is given";
/// What is said of an inertia without a mass.
const NO_MASS: &str = "mass, which is given as 0";
/// What is said of a row that is given as weightless.
const NEITHER: &str = "mass, which is given as 0, and inertia";

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

    /// What is made up of some of the rows, in a sentence for each kind; `keys` are those of a device file that would say it.
    pub fn said_of_plausible(
        bodies: &[Self],
        keys: &str,
        is_told: impl Fn(usize) -> bool,
    ) -> Vec<String> {
        let mut kinds: Vec<&'static str> = bodies.iter().filter_map(|own| own.plausible).collect();
        kinds.sort_unstable();
        kinds.dedup();
        let mut said = Vec::new();
        for kind in kinds {
            let rows = (0..bodies.len()).filter(|row| bodies[*row].plausible == Some(kind));
            let links = rows
                .filter(|row| is_told(*row))
                .map(|row| format!("link{}", row + 1));
            let links: Vec<String> = links.collect();
            if links.is_empty() {
                continue;
            }
            let links = links.join(", ");
            said.push(match (kind, kind.split_once(", ")) {
                (NEITHER, _) => format!("plausible {kind} of {links}"),
                (_, Some((what, why))) => format!("plausible {what} of {links}, {why}"),
                _ => format!(
                    "plausible {kind} of {links}, which the device file does not give ({keys})"
                ),
            });
        }
        said
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
            let has_mass = own.mass_kg > 0.0;
            let mass_kg = match has_mass {
                true => own.mass_kg,
                false => NEXT_TO_NOTHING_KG,
            };
            let given = own.given_inertia();
            let (inertia_kgm2, plausible) = match given {
                // a rotor whose mass is counted elsewhere
                GivenInertia::Body(inertia) if has_mass => (thick(&inertia), None),
                GivenInertia::Body(inertia) => (thick(&inertia), Some(NO_MASS)),
                GivenInertia::NoBody(_) => (rod(mass_kg, &reach_m), Some(OF_NO_BODY)),
                GivenInertia::None | GivenInertia::Point if has_mass => {
                    (rod(mass_kg, &reach_m), Some("inertia"))
                }
                GivenInertia::None | GivenInertia::Point => (rod(mass_kg, &reach_m), Some(NEITHER)),
            };
            RowBody {
                mass_kg,
                centre_m: own.centre_m,
                inertia_kgm2,
                reach_m,
                plausible,
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

/// An inertia that a body has, a little thicker where it is flat but for rounding: simulators ask for some thickness.
fn thick(inertia: &Matrix3<f64>) -> Matrix3<f64> {
    let least = Matrix3::identity() * (FLATTEST * inertia.trace());
    let moments = Matrix3::identity() * (0.5 * inertia.trace()) - inertia;
    match (moments - least).cholesky() {
        Some(_) => *inertia,
        // each moment of the thicker body is larger by half of what is added to the diagonal
        None => inertia + least * 4.0,
    }
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
    fn a_plate_is_made_no_thicker_than_rounding() {
        let diagonal = |x, y, z| Matrix3::from_diagonal(&Vector3::new(x, y, z));
        assert_eq!(thick(&diagonal(1.0, 1.0, 1.5)), diagonal(1.0, 1.0, 1.5));
        let plate = thick(&diagonal(1.0, 1.0, 2.0));
        assert!(plate[(0, 0)] + plate[(1, 1)] > plate[(2, 2)]);
        assert!((plate - diagonal(1.0, 1.0, 2.0)).amax() < 1e-4);
    }
}
