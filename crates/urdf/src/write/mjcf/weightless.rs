//! Rows that weigh nothing: what is between two joints of one body, or a rotor whose mass is counted elsewhere.

use haptical_model::kinematics::nalgebra::Matrix3;
use haptical_model::{Device, GivenInertia, RowBody, Segments};

/// Mass and inertia of a body that has none \[kg\], \[kg m^2\]: MuJoCo refuses those below 1e-15, and no torque shows this one.
const NOTHING: f64 = 1e-12;

/// Takes the plausible mass from rows whose mass is given as 0 and behind which something has a mass or an inertia: no number
/// of theirs is needed for a motion.
pub(super) fn set_weightless(bodies: &mut [RowBody], device: &Device, segments: &Segments) {
    let weighs: Vec<bool> = (segments.rows.iter())
        .map(|row| {
            let entry = row.body.as_ref();
            entry.is_none_or(|entry| {
                entry.mass_kg > 0.0 || matches!(entry.given_inertia(), GivenInertia::Body(_))
            })
        })
        .collect();
    for (row, body) in bodies.iter_mut().enumerate() {
        let Some(entry) = segments.rows[row].body.filter(|entry| entry.mass_kg == 0.0) else {
            continue;
        };
        let given = entry.given_inertia();
        if let GivenInertia::NoBody(_) = given {
            continue;
        }
        if !carries(device, &weighs, row) {
            continue;
        }
        body.mass_kg = NOTHING;
        if !matches!(given, GivenInertia::Body(_)) {
            body.inertia_kgm2 = Matrix3::identity() * NOTHING;
        }
        body.plausible = None;
    }
}

/// Whether a row or one behind it weighs something.
fn carries(device: &Device, weighs: &[bool], row: usize) -> bool {
    let rows = weighs.iter().enumerate().filter(|(_, weighs)| **weighs);
    let mut rows = rows.map(|(index, _)| index);
    rows.any(|index| {
        let mut next = Some(index + 1);
        while let Some(entry) = next.filter(|entry| *entry > row + 1) {
            next = device.parent(entry);
        }
        next == Some(row + 1)
    })
}
