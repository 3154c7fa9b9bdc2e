//! A mass that the arm carries in a part of its runs, and the friction that all its joints have throughout.

use haptical_model::{Body, Device};

use crate::effects::{Draw, Effect, Facts, Info, Stage, UNKNOWN};
use crate::laws::{SlipElement, maxwell_slip};
use crate::rig::dynamics::Dynamics;
use crate::rig::scene::Scene;

/// Answers that friction of all joints may be given.
const FRICTION: [&str; 4] = [
    "joint-friction",
    "motor-cogging",
    "torque-gain",
    "unbalanced-gravity",
];

/// A mass fixed to the body of a row of the table, its centre in the frame of that body, from the run in the middle on; with
/// `is_put_down` before it.
fn carried(info: Info, body: usize, mass_kg: f64, centre_m: [f64; 3], is_put_down: bool) -> Effect {
    // torques add up body by body: those of a chain on which nothing has mass but this
    let act = move |scene: &Scene<'_>, torque_nm: &mut [Vec<f64>]| {
        let mut bare = scene.device.clone();
        bare.bodies.iter_mut().for_each(|body| *body = None);
        if let Some(slot) = bare.bodies.get_mut(body) {
            *slot = Some(Body {
                mass_kg,
                centre_of_mass_m: centre_m,
                inertia_kgm2: None,
            });
        }
        let change = scene.motion.run.last().map_or(1, |last| last + 1) / 2;
        let mut dynamics = Dynamics::new(&bare);
        let mut own = vec![0.0; scene.device.joints.len()];
        for row in 0..scene.len() {
            if (scene.motion.run[row] < change) != is_put_down {
                continue;
            }
            let at = |column: &[Vec<f64>]| -> Vec<f64> {
                column.iter().map(|values| values[row]).collect()
            };
            dynamics.torques_nm(
                &at(&scene.motion.angle_rad),
                &at(&scene.motion.rate_rad_s),
                &at(&scene.motion.acceleration_rad_s2),
                [0.0; 3],
                &mut own,
            );
            for (column, own) in torque_nm.iter_mut().zip(&own) {
                column[row] += own;
            }
        }
    };
    let sign = if is_put_down { -1.0 } else { 1.0 };
    let [x_m, y_m, z_m] = centre_m;
    let facts = Facts::default()
        .with("mass_kg", sign * mass_kg)
        .law("row", body as f64)
        .laws(named!(x_m, y_m, z_m));
    Effect::of_columns(info, Stage::Torque, facts, act)
}

/// Where the handle is in the frame of the last body: after the turn, along and beside the axis.
fn flange_m(device: &Device) -> [f64; 3] {
    let last = device.links.last();
    last.map_or([0.0; 3], |link| [link.a_m, 0.0, link.d_m])
}

/// A mass at the flange, its centre within some centimetres of it.
pub(crate) fn payload(draw: &mut Draw<'_>) -> Effect {
    let mut centre_m = flange_m(draw.device);
    for value in &mut centre_m {
        *value += draw.random.uniform(-0.04, 0.04);
    }
    let mass_kg = draw.amplitude(0.3);
    let is_put_down = draw.random.index(3) == 0;
    let last = draw.device.links.len().saturating_sub(1);
    let info = draw.anywhere("payload", &["payload"]);
    carried(info, last, mass_kg, centre_m, is_put_down)
}

/// A mass on one of the links in the middle of the chain, up to two decimetres off its axis.
pub(crate) fn payload_on_link(draw: &mut Draw<'_>) -> Effect {
    let links = draw.device.links.len();
    let centre_m = [(); 3].map(|()| draw.random.sign() * draw.random.uniform(0.05, 0.2));
    let body = 2 + draw.random.index(links.saturating_sub(4).max(1));
    let mass_kg = draw.amplitude(0.5);
    let info = draw.anywhere("payload-on-link", &["payload"]);
    carried(info, body, mass_kg, centre_m, false)
}

/// Dry and viscous friction of every joint, the same in all runs.
fn friction(draw: &mut Draw<'_>, name: &'static str, right: &[&'static str]) -> Effect {
    // per joint: dry friction [N m], its width [rad], viscous friction [N m s/rad], and how much more one way
    let joints = (0..draw.device.joints.len()).map(|_| {
        [
            draw.amplitude(0.03),
            draw.random.around(4e-3, 3.0),
            draw.amplitude(0.01),
            draw.random.uniform(-0.2, 0.2),
        ]
    });
    let joints: Vec<[f64; 4]> = joints.collect();
    let act = move |scene: &Scene<'_>, torque_nm: &mut [Vec<f64>]| {
        for (joint, [dry_nm, width_rad, viscous, one_way]) in joints.iter().enumerate() {
            let elements = [0.4, 1.0, 2.2].map(|width| SlipElement {
                weight: dry_nm / 3.0,
                width: width * width_rad,
            });
            let sides = maxwell_slip(&scene.motion.angle_rad[joint], &elements);
            let rates = &scene.motion.rate_rad_s[joint];
            for (value, (side, rate)) in torque_nm[joint].iter_mut().zip(sides.iter().zip(rates)) {
                let more = if *rate > 0.0 { 1.0 + one_way } else { 1.0 };
                *value += more * side + viscous * rate;
            }
        }
    };
    let info = Info {
        acceptable: FRICTION.to_vec(),
        ..draw.anywhere(name, right)
    };
    Effect::of_columns(info, Stage::Torque, Facts::default(), act)
}

/// Friction of all joints beside something else, which is what has to be named.
pub(crate) fn friction_beside(draw: &mut Draw<'_>) -> Effect {
    friction(draw, "friction-beside", &[])
}

/// Friction of all joints and nothing else: no name is wanted, those of friction may be given.
pub(crate) fn friction_alone(draw: &mut Draw<'_>) -> Effect {
    friction(draw, "friction-alone", &UNKNOWN)
}
