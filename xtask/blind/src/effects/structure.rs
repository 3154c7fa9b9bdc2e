//! A structure that is not rigid: axes that wobble, a base and a tool that give, a tool put on anew.

use haptical_model::kinematics::nalgebra::Vector3;

use crate::effects::{Act, Draw, Effect, Facts, Info};
use crate::laws::vector_gain;
use crate::rig::geometry::Flex;
use crate::rig::scene::Scene;

/// Where a structure moves, row by row: at a joint it tilts \[rad\], at the hook it shifts \[m\].
#[derive(Debug, Clone, Copy)]
enum Where {
    Joint(usize),
    Hook,
}

/// An effect that moves a place of the structure.
fn moved(
    info: Info,
    place: Where,
    facts: impl Fn(&Scene<'_>) -> Facts + Send + Sync + 'static,
    by: impl Fn(&Scene<'_>) -> Vec<[f64; 3]> + Send + Sync + 'static,
) -> Effect {
    let act = move |scene: &Scene<'_>, flex: &mut Flex| {
        let slot = match place {
            Where::Joint(joint) => &mut flex.tilt_rad[joint],
            Where::Hook => &mut flex.tool_m,
        };
        match slot {
            Some(present) => {
                for (sum, more) in present.iter_mut().zip(by(scene)) {
                    for (axis, value) in sum.iter_mut().zip(more) {
                        *axis += value;
                    }
                }
            }
            empty => *empty = Some(by(scene)),
        }
    };
    Effect::new(info, facts, Act::Flex(Box::new(act)))
}

/// Run-out of a joint's axis, twice per turn: a bearing whose axis tilts as it turns.
pub(crate) fn axis_wobble(draw: &mut Draw<'_>) -> Effect {
    const ORDER: f64 = 2.0;
    let joint = draw.joint;
    let amplitude_rad = draw.amplitude(1.5e-3);
    let phase_rad = draw.random.phase_rad();
    // ratio of the short to the long axis of the tilt's ellipse
    let ellipse = draw.random.sign() * draw.random.uniform(0.8, 1.0);
    let tilts = move |scene: &Scene<'_>| -> Vec<[f64; 3]> {
        let tilt = |angle: &f64| {
            let (sin, cos) = libm::sincos(ORDER * angle + phase_rad);
            let (home_sin, home_cos) = libm::sincos(phase_rad);
            let [x, y] = [amplitude_rad, amplitude_rad * ellipse];
            [x * (cos - home_cos), y * (sin - home_sin), 0.0]
        };
        scene.motion.angle_rad[joint].iter().map(tilt).collect()
    };
    let facts = move |_: &Scene<'_>| {
        Facts::default()
            .with("amplitude_rad", amplitude_rad)
            .with("order", ORDER)
            .law("ellipse", ellipse)
    };
    let info = draw.at_joint("axis-wobble", &["axis-wobble"]);
    moved(info, Where::Joint(joint), facts, tilts)
}

/// What gives under loads, by `gain / (1 + |load| / hardening)` times the load.
fn hardening(loads: &[[f64; 3]], gain: f64, hardening: f64) -> Vec<[f64; 3]> {
    let give = |load: &[f64; 3]| {
        let factor = gain / (1.0 + Vector3::from(*load).norm() / hardening);
        load.map(|part| factor * part)
    };
    loads.iter().map(give).collect()
}

/// Compliance of the base plate under its moment, the same about every axis, a little harder under load.
pub(crate) fn base_compliance(draw: &mut Draw<'_>) -> Effect {
    let rad_per_nm = draw.amplitude(1.5e-3);
    let hardening_nm = draw.random.uniform(15.0, 40.0);
    // the base carries the opposite of the moment on the first link
    let tilts =
        move |scene: &Scene<'_>| hardening(&scene.base_moment_nm, -rad_per_nm, hardening_nm);
    let facts = move |scene: &Scene<'_>| {
        let effective = -vector_gain(&scene.base_moment_nm, &tilts(scene));
        Facts::default()
            .with("rad_per_nm", effective)
            .law("initial_rad_per_nm", rad_per_nm)
            .law("hardening_nm", hardening_nm)
    };
    let names = ["base-compliance", "lateral-compliance"];
    let info = draw.anywhere("base-compliance", &names);
    moved(info, Where::Joint(0), facts, tilts)
}

/// Compliance of the tool's connector: a handle that gives under the hand.
pub(crate) fn tool_compliance(draw: &mut Draw<'_>) -> Effect {
    let m_per_n = draw.amplitude(1.5e-4);
    let hardening_n = draw.random.uniform(20.0, 60.0);
    let shifts = move |scene: &Scene<'_>| hardening(&scene.force_n, m_per_n, hardening_n);
    let facts = move |scene: &Scene<'_>| {
        Facts::default()
            .with("m_per_n", vector_gain(&scene.force_n, &shifts(scene)))
            .law("initial_m_per_n", m_per_n)
            .law("hardening_n", hardening_n)
    };
    let info = draw.anywhere("tool-compliance", &["tool-compliance"]);
    moved(info, Where::Hook, facts, shifts)
}

/// The tool was taken off and put on between two runs: it sits elsewhere from the second one on.
pub(crate) fn tool_changed(draw: &mut Draw<'_>) -> Effect {
    let size_m = draw.amplitude(0.6e-3);
    let direction = Vector3::from_fn(|_, _| draw.random.normal());
    let shift_m: [f64; 3] = (direction.normalize() * size_m).into();
    let shifts = move |scene: &Scene<'_>| -> Vec<[f64; 3]> {
        let runs = scene.motion.run.iter();
        runs.map(|run| if *run > 0 { shift_m } else { [0.0; 3] })
            .collect()
    };
    let facts = move |_: &Scene<'_>| {
        let [x_m, y_m, z_m] = shift_m;
        Facts::default()
            .with("shift_m", Vector3::from(shift_m).norm())
            .laws(named!(x_m, y_m, z_m))
    };
    let info = draw.anywhere("tool-changed", &["tool-changed"]);
    moved(info, Where::Hook, facts, shifts)
}
