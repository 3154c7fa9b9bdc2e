//! A link whose mass or centre of mass is another than the model's.

use std::rc::Rc;

use haptical_dynamics::Inertia;
use nalgebra::{Matrix3, Vector3};

use super::{Candidate, Context, Effect, Finer, Found};
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
        let share = if mass_kg > 0.0 { 1.0 / mass_kg } else { 0.0 };
        let of_one_kg = Inertia::about_centre(1.0, &centre_m, &(inertia * share)).parameters();
        let columns = vec![context.problem.of_body(body, &of_one_kg)];
        let of_mass = Candidate::new(EFFECT.name, Some(joint), columns, super::first("mass_kg"));
        let mut of_mass = of_mass.about_to(LINK_LAW_SD);
        if mass_kg <= 0.0 {
            found.push(of_mass);
            continue;
        }
        of_mass.within = [-mass_kg, MOST_MISSING_MASS * mass_kg];
        found.push(of_mass);
        found.extend(of_centre(context, body, None));
    }
    found
}

/// A centre of mass that is off, linear about a shift \[m\] if there is one.
///
/// Moments about the joint are quadratic in the shift: their slope halfway to a shift is the secant through it, exact where the
/// coefficients are that shift.
fn of_centre<'c>(
    context: Context<'c>,
    body: usize,
    about_m: Option<Vector3<f64>>,
) -> Option<Candidate<'c>> {
    let arm = &context.problem.arm;
    let (mass_kg, centre_m, inertia) = arm.about_centre(body);
    let (joint, _) = arm.bodies.drive(body)?;
    let halfway_m = centre_m + 0.5 * about_m.unwrap_or_default();
    let shifts = (0..3).map(|axis| {
        let mut step = Vector3::zeros();
        step[axis] = 0.01;
        let [ahead, behind] = [halfway_m + step, halfway_m - step]
            .map(|centre_m| Inertia::about_centre(mass_kg, &centre_m, &inertia).parameters());
        let slope = std::array::from_fn(|k| (ahead[k] - behind[k]) / 0.02);
        context.problem.of_body(body, &slope)
    });
    let numbers = |shift: &[f64]| {
        vec![
            ("centre_x_m", shift[0]),
            ("centre_y_m", shift[1]),
            ("centre_z_m", shift[2]),
        ]
    };
    let found = Candidate::new(EFFECT.name, Some(joint), shifts.collect(), Rc::new(numbers));
    let most = MOST_CENTRE_M.min(MOST_OF_ROD * rod_m(mass_kg, &inertia));
    Some(Candidate {
        within: [-most, most],
        about: about_m
            .iter()
            .flat_map(|shift| [shift.x, shift.y, shift.z])
            .collect(),
        finer: Finer::About(Rc::new(move |shift| {
            of_centre(
                context,
                body,
                Some(Vector3::from_column_slice(shift.get(..3)?)),
            )
        })),
        ..found.of_kind(1)
    })
}

/// Length of the thin rod that has a body's largest moment of inertia, about its centre of mass, and its mass: `I = m l^2 / 12`.
fn rod_m(mass_kg: f64, inertia_kgm2: &Matrix3<f64>) -> f64 {
    let largest = inertia_kgm2.symmetric_eigenvalues().max();
    (12.0 * largest.max(0.0) / mass_kg).sqrt()
}
