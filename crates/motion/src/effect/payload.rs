//! A mass at the flange that the model lacks.

use std::rc::Rc;

use haptical_dynamics::Inertia;
use nalgebra::{Matrix3, Vector3};

use super::{Candidate, Context, Effect, Finer, Found};
use crate::change::Change;
use crate::thresholds::effect::{BODIES_LAW_SD, MOST_MISSING};

pub(super) const EFFECT: Effect = Effect::new("payload", |context| {
    at(context, Vector3::zeros()).into_iter().collect()
})
.exact()
.changing(change);

fn change(found: &Found<'_>) -> Option<Change> {
    let flange = found.arm.bodies.flange(0)?;
    let mass_kg = found.number("mass_kg").filter(|mass_kg| *mass_kg > 0.0)?;
    let moment = found.vector(["moment_x_kg_m", "moment_y_kg_m", "moment_z_kg_m"]);
    // the same about all axes, where it was fitted
    let own_kgm2 = found.read_off.get(4).copied().unwrap_or(0.0).max(0.0);
    let own = Matrix3::identity() * own_kgm2;
    let point = Inertia::about_centre(mass_kg, &(moment / mass_kg), &own);
    Some(Change::Inertia {
        body: flange.body?,
        more: point.seen_from(&flange.pose),
    })
}

/// Mass and centre of what hangs behind the flange, linear about a centre in the flange's frame, and its inertia about that centre, the
/// same about all axes.
fn at(context: Context<'_>, centre_m: Vector3<f64>) -> Option<Candidate<'_>> {
    let bodies = &context.problem.arm.bodies;
    let flange = bodies.flange(0)?;
    let body = flange.body?;
    let turn = flange.pose.rotation;
    let point = flange.pose.position_m + turn * centre_m;
    let of_point = |centre_m: Vector3<f64>| {
        Inertia::about_centre(1.0, &centre_m, &Matrix3::zeros()).parameters()
    };
    let mut columns = vec![context.problem.of_body(body, &of_point(point))];
    for axis in 0..3 {
        let direction: Vector3<f64> = turn * Vector3::ith(axis, 1.0);
        // quadratic in the centre: the central difference is the derivative
        let (ahead, behind) = (of_point(point + direction), of_point(point - direction));
        let slope = std::array::from_fn(|k| 0.5 * (ahead[k] - behind[k]));
        columns.push(context.problem.of_body(body, &slope));
    }
    let of_inertia = Inertia::about_centre(0.0, &point, &Matrix3::identity()).parameters();
    columns.push(context.problem.of_body(body, &of_inertia));
    let numbers = move |own: &[f64]| {
        let mass_kg = own[0];
        let moment = centre_m * mass_kg + Vector3::new(own[1], own[2], own[3]);
        vec![
            ("mass_kg", mass_kg),
            ("moment_x_kg_m", moment.x),
            ("moment_y_kg_m", moment.y),
            ("moment_z_kg_m", moment.z),
        ]
    };
    let mut found =
        Candidate::new(EFFECT.name, None, columns, Rc::new(numbers)).about_to(BODIES_LAW_SD);
    // more than a body has cannot be missing from it; its centre lies within a metre
    let body_kg = bodies.masses()[body].inertia.mass_kg;
    found.within = [-MOST_MISSING * body_kg, f64::INFINITY];
    found.about = vec![1.0, centre_m.x, centre_m.y, centre_m.z];
    found.finer = Finer::About(Rc::new(move |own| {
        let shift_m = Vector3::new(own[1], own[2], own[3]) / own[0];
        let is_near = own[0] > 0.0 && shift_m.norm() < 0.5;
        is_near.then(|| at(context, centre_m + shift_m)).flatten()
    }));
    Some(found)
}
