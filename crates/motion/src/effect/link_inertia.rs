//! A link whose mass or centre of mass is another than the model's.

use std::rc::Rc;

use haptical_dynamics::Inertia;
use nalgebra::{Matrix3, Vector3};

use super::{Candidate, Context, Effect, Found};
use crate::change::Change;
use crate::thresholds::effect::{LINK_LAW_SD, MOST_CENTRE_M, MOST_MISSING_MASS, MOST_OF_ROD};

pub(super) const EFFECT: Effect = Effect::new("link-inertia", candidates)
    .exact()
    .changing(change);

fn change(found: &Found<'_>) -> Option<Change> {
    let (arm, joint) = (found.arm, found.joint?);
    // of several rows of one joint it is not said which it is
    let mut own = (0..arm.body_count())
        .filter(|body| arm.bodies.drive(*body).is_some_and(|own| own.0 == joint));
    let body = own.next().filter(|_| own.next().is_none())?;
    let (mass_kg, centre_m, inertia) = arm.about_centre(body);
    let now = match found.number("mass_kg") {
        Some(more_kg) if mass_kg > 0.0 => {
            let grown = inertia * (1.0 + more_kg / mass_kg);
            Inertia::about_centre(mass_kg + more_kg, &centre_m, &grown)
        }
        Some(more_kg) => Inertia::about_centre(more_kg, &centre_m, &inertia),
        None => {
            let shift = found.vector(["centre_x_m", "centre_y_m", "centre_z_m"]);
            Inertia::about_centre(mass_kg, &(centre_m + shift), &inertia)
        }
    };
    let before = arm.bodies.masses()[body].inertia.parameters();
    let now = now.parameters();
    let more = std::array::from_fn(|k| now[k] - before[k]);
    Some(Change::Inertia {
        body,
        more: Inertia::from_parameters(more),
    })
}

/// For each body its mass, alone at its centre of mass, and its centre of mass.
fn candidates(context: Context<'_>) -> Vec<Candidate<'_>> {
    let arm = &context.problem.arm;
    let mut found = Vec::new();
    for body in 0..arm.body_count() {
        let (mass_kg, centre_m, inertia) = arm.about_centre(body);
        let Some((joint, _)) = arm.bodies.drive(body) else {
            continue;
        };
        let at = |mass_kg, centre_m: Vector3<f64>, share: f64| {
            Inertia::about_centre(mass_kg, &centre_m, &(inertia * share)).parameters()
        };
        let candidate =
            |columns, numbers| Candidate::new(EFFECT.name, Some(joint), columns, numbers);
        let share = if mass_kg > 0.0 { 1.0 / mass_kg } else { 0.0 };
        let mass = context.problem.of_body(body, &at(1.0, centre_m, share));
        let mut of_mass = candidate(vec![mass], super::first("mass_kg")).about_to(LINK_LAW_SD);
        if mass_kg <= 0.0 {
            found.push(of_mass);
            continue;
        }
        of_mass.within = [-mass_kg, MOST_MISSING_MASS * mass_kg];
        found.push(of_mass);
        let shifts = (0..3).map(|axis| {
            let mut shift = Vector3::zeros();
            shift[axis] = 0.01;
            let (ahead, behind) = (
                at(mass_kg, centre_m + shift, 1.0),
                at(mass_kg, centre_m - shift, 1.0),
            );
            let slope = std::array::from_fn(|k| (ahead[k] - behind[k]) / 0.02);
            context.problem.of_body(body, &slope)
        });
        let mut of_centre = candidate(
            shifts.collect(),
            Rc::new(|own| {
                vec![
                    ("centre_x_m", own[0]),
                    ("centre_y_m", own[1]),
                    ("centre_z_m", own[2]),
                ]
            }),
        );
        let most = MOST_CENTRE_M.min(MOST_OF_ROD * rod_m(mass_kg, &inertia));
        of_centre.within = [-most, most];
        found.push(of_centre.of_kind(1));
    }
    found
}

/// Length of the thin rod that has a body's largest moment of inertia, about its centre of mass, and its mass: `I = m l^2 / 12`.
fn rod_m(mass_kg: f64, inertia_kgm2: &Matrix3<f64>) -> f64 {
    let largest = inertia_kgm2.symmetric_eigenvalues().max();
    (12.0 * largest.max(0.0) / mass_kg).sqrt()
}
