//! Masses that the file does not have, and a base that does not stand upright.

use haptical_model::kinematics::nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use super::{Draw, Drawn};
use crate::moving::motion::rigid::Link;
use crate::moving::motion::specimen::Specimen;

/// Changes the arm before it moves.
fn built(build: impl Fn(&mut Specimen) + Send + Sync + 'static) -> Drawn {
    Drawn::new(|drawn| drawn.build = Box::new(build))
}

/// A body with a ball more. Moments about the common centre by Steiner's theorem.
pub(crate) fn bolt(link: &mut Link, mass_kg: f64, place_m: Vector3<f64>, radius_m: f64) {
    let whole = link.mass_kg + mass_kg;
    let centre = (link.centre_m * link.mass_kg + place_m * mass_kg) / whole;
    let moved = |mass: f64, from: Vector3<f64>| {
        let arm: Vector3<f64> = from - centre;
        (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * mass
    };
    link.inertia_kgm2 += moved(link.mass_kg, link.centre_m)
        + moved(mass_kg, place_m)
        + Matrix3::identity() * (0.4 * mass_kg * radius_m * radius_m);
    link.mass_kg = whole;
    link.centre_m = centre;
}

fn mass_of_arm(draw: &Draw<'_>) -> f64 {
    draw.arm.axes.iter().map(|axis| axis.mass_kg).sum()
}

/// A load at the flange, a tenth to a fifth of the arm's mass.
pub(crate) fn payload(draw: &mut Draw<'_>) -> Drawn {
    let mass_kg = draw.size * mass_of_arm(draw) * draw.random.uniform(0.1, 0.2);
    let off = |draw: &mut Draw<'_>| draw.random.uniform(-0.04, 0.04);
    let reach = draw.random.uniform(0.03, 0.1);
    let offset = Vector3::new(off(draw), off(draw), reach);
    let last = draw.arm.count() - 1;
    let place_m = Vector3::from(draw.arm.flange_m) + offset;
    let [x_m, y_m, z_m]: [f64; 3] = offset.into();
    built(move |specimen| bolt(&mut specimen.chain.links[last], mass_kg, place_m, 0.04))
        .with_all(named!(mass_kg, x_m, y_m, z_m))
}

/// A box on a link that the file does not know, a twentieth of the arm's mass.
pub(crate) fn link_inertia(draw: &mut Draw<'_>) -> Drawn {
    let mass_kg = draw.size * mass_of_arm(draw) * draw.random.uniform(0.05, 0.09);
    let mut off = || draw.random.uniform(-0.06, 0.06);
    let offset = Vector3::new(off(), off(), off());
    let joint = draw.joint;
    let place_m = Vector3::from(draw.arm.axes[joint].centre_m) + offset;
    built(move |specimen| bolt(&mut specimen.chain.links[joint], mass_kg, place_m, 0.05))
        .at(joint)
        .with("mass_kg", mass_kg)
}

/// A rotor whose inertia is off by 60 to 150 %.
pub(crate) fn armature(draw: &mut Draw<'_>) -> Drawn {
    let factor = 1.0 + draw.size * draw.random.uniform(0.6, 1.5);
    let joint = draw.joint;
    built(move |specimen| specimen.armature[joint] *= factor)
        .at(joint)
        .with("factor", factor)
}

/// A base that leans by 2 to 6 degrees.
pub(crate) fn gravity_direction(draw: &mut Draw<'_>) -> Drawn {
    let lean_rad = draw.size * draw.random.uniform(2.0, 6.0).to_radians();
    let (sine, cosine) = libm::sincos(draw.random.phase_rad());
    let axis = Unit::new_unchecked(Vector3::new(cosine, sine, 0.0));
    let turn = Rotation3::from_axis_angle(&axis, lean_rad);
    built(move |specimen| specimen.chain.gravity_mps2 = turn * specimen.chain.gravity_mps2)
        .with("lean_rad", lean_rad)
        .with("axis_x", cosine)
        .with("axis_y", sine)
}
