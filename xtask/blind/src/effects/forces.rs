//! Errors of force sensors and motors: bias, gain, cross-talk, friction, cogging, unbalanced mass.

use haptical_model::{Body, Device};

use crate::effects::{Act, Draw, Effect, Facts, Info, Stage, fixed};
use crate::laws::{SlipElement, maxwell_slip};
use crate::rig::scene::Scene;

/// Name of a force that does not pass the sensor.
pub(super) const GRIP: &str = "grip-force";
/// Forces at which the gain has lost a tenth \[N\].
const GAIN_LOSS_N: f64 = 30.0;
/// Speed below which friction passes through zero, and that of Stribeck's extra \[rad/s\].
const FRICTION_SPEED_RAD_S: f64 = 0.01;
const STRIBECK_SPEED_RAD_S: f64 = 0.08;

/// An effect of the force sensor: what it does to the readings along the axes.
fn of_sensor(
    draw: &Draw<'_>,
    name: &'static str,
    facts: Facts,
    act: impl Fn(&Scene<'_>, &mut [Vec<f64>]) + Send + Sync + 'static,
) -> Effect {
    let info = Info {
        // an error of the readings is, row by row, a force that does not pass the sensor
        acceptable: vec![GRIP],
        ..draw.anywhere(name, &[name])
    };
    Effect::of_columns(info, Stage::Force, facts, act)
}

/// A bias of one axis that drifts with temperature.
pub(crate) fn force_bias(draw: &mut Draw<'_>) -> Effect {
    let bias_n = draw.signed(0.3);
    let axis = draw.random.index(3);
    let n_per_degc = bias_n * draw.random.uniform(-0.02, 0.02);
    let facts = Facts::default().laws(named!(bias_n, n_per_degc));
    of_sensor(draw, "force-bias", facts, move |scene, force_n| {
        for (value, degc) in force_n[axis].iter_mut().zip(&scene.temperature_degc) {
            *value += bias_n + n_per_degc * (degc - scene.cold_degc);
        }
    })
}

/// A gain error of one axis: it reads too much, a little less at high forces.
pub(crate) fn force_gain(draw: &mut Draw<'_>) -> Effect {
    let axis = draw.random.index(3);
    let gain = draw.signed(0.15);
    let facts = Facts::default().law("gain", gain);
    of_sensor(draw, "force-gain", facts, move |_, force_n| {
        for value in &mut force_n[axis] {
            *value += gain * *value * (1.0 - value.abs() / (10.0 * GAIN_LOSS_N));
        }
    })
}

/// Cross-talk between two axes: one sees another.
pub(crate) fn force_crosstalk(draw: &mut Draw<'_>) -> Effect {
    let from = draw.random.index(3);
    let into = (from + 1 + draw.random.index(2)) % 3;
    let share = draw.signed(0.1);
    let facts = Facts::default().law("share", share);
    of_sensor(draw, "force-crosstalk", facts, move |_, force_n| {
        let source = force_n[from].clone();
        for (value, other) in force_n[into].iter_mut().zip(source) {
            *value += share * other;
        }
    })
}

/// A loop of the sensor over the force along one axis.
pub(crate) fn force_hysteresis(draw: &mut Draw<'_>) -> Effect {
    let axis = draw.random.index(3);
    let amplitude_n = draw.amplitude(0.1);
    let width_n = draw.random.uniform(0.1, 0.4);
    let facts = Facts::default().law("amplitude_n", amplitude_n);
    of_sensor(draw, "force-hysteresis", facts, move |_, force_n| {
        let elements = [0.5, 1.0, 2.0].map(|width| SlipElement {
            weight: amplitude_n / 3.0,
            width: width * width_n,
        });
        let extra = maxwell_slip(&force_n[axis], &elements);
        for (value, extra) in force_n[axis].iter_mut().zip(extra) {
            *value -= extra;
        }
    })
}

/// A part of the hand's force that does not pass the sensor: one axis, sums of slow sines.
pub(crate) fn grip_force(draw: &mut Draw<'_>) -> Effect {
    let axis = draw.random.index(3);
    let size_n = draw.amplitude(0.4);
    let tag = draw.tag;
    let facts = Facts::default().law("size_n", size_n);
    of_sensor(draw, GRIP, facts, move |scene, force_n| {
        let mut random = scene.events(tag);
        let waves = [(); 4].map(|()| [random.uniform(0.3, 5.0), random.phase_rad()]);
        for (row, value) in force_n[axis].iter_mut().enumerate() {
            let time_s = scene.elapsed_s(row);
            let sines = waves.iter();
            let sines = sines.map(|[rate, phase]| libm::sin(rate * time_s + phase));
            *value -= 0.7 * size_n * sines.sum::<f64>();
        }
    })
}

/// What a joint's motor has to do besides moving its link, from its angle, its rate and its torque.
fn of_motor(
    draw: &Draw<'_>,
    name: &'static str,
    facts: Facts,
    more_nm: impl Fn(f64, f64, f64) -> f64 + Send + Sync + 'static,
) -> Effect {
    let joint = draw.joint;
    let act = move |scene: &Scene<'_>, torque_nm: &mut [Vec<f64>]| {
        let rows = scene.motion.angle_rad[joint].iter();
        let rows = rows.zip(&scene.motion.rate_rad_s[joint]);
        for (torque, (angle, rate)) in torque_nm[joint].iter_mut().zip(rows) {
            *torque += more_nm(*angle, *rate, *torque);
        }
    };
    let info = draw.at_joint(name, &[name]);
    Effect::of_columns(info, Stage::Torque, facts, act)
}

/// Friction in a joint: Coulomb's with Stribeck's extra at rest, and viscous.
pub(crate) fn joint_friction(draw: &mut Draw<'_>) -> Effect {
    let coulomb_nm = draw.amplitude(0.06);
    let extra_nm = coulomb_nm * draw.random.uniform(0.0, 0.4);
    let viscous_nms = coulomb_nm * draw.random.uniform(0.1, 0.6);
    let facts = Facts::default().laws(named!(coulomb_nm, viscous_nms));
    of_motor(draw, "joint-friction", facts, move |_, rate, _| {
        let slow = rate / STRIBECK_SPEED_RAD_S;
        let level = coulomb_nm + extra_nm * libm::exp(-slow * slow);
        level * libm::tanh(rate / FRICTION_SPEED_RAD_S) + viscous_nms * rate
    })
}

/// Cogging of a motor: ripple over its angle, with the second harmonic.
pub(crate) fn motor_cogging(draw: &mut Draw<'_>) -> Effect {
    let amplitude_nm = draw.amplitude(0.03);
    let poles = 7.0 + draw.random.index(6) as f64;
    let phase_rad = draw.random.phase_rad();
    let second = draw.random.uniform(0.0, 0.3);
    let ratio = draw.device.joints[draw.joint].transmission_ratio;
    let facts = Facts::default().laws(named!(amplitude_nm, poles));
    of_motor(draw, "motor-cogging", facts, move |angle, _, _| {
        let motor = poles * ratio * angle;
        amplitude_nm * (libm::sin(motor + phase_rad) + second * libm::sin(2.0 * motor))
    })
}

/// A torque scale far beyond what the file allows.
pub(crate) fn torque_gain(draw: &mut Draw<'_>) -> Effect {
    let gain = draw.signed(0.3);
    let facts = Facts::default().law("gain", gain);
    of_motor(draw, "torque-gain", facts, move |_, _, torque| {
        gain * torque
    })
}

/// A mass off a joint's axis that the file does not know.
pub(crate) fn unbalanced_gravity(draw: &mut Draw<'_>) -> Effect {
    let centre_m = [(); 3].map(|()| draw.random.sign() * draw.random.uniform(0.03, 0.08));
    let row = draw.joint + 1;
    let more_kg = draw.amplitude(0.15);
    let act = move |device: &mut Device| {
        let Some(slot) = device.bodies.get_mut(row) else {
            return;
        };
        let before = slot.unwrap_or(Body {
            mass_kg: 0.0,
            centre_of_mass_m: centre_m,
            inertia_kgm2: None,
        });
        let mass_kg = before.mass_kg + more_kg;
        if mass_kg > 0.0 {
            let centre = |axis: usize| {
                let moment =
                    before.mass_kg * before.centre_of_mass_m[axis] + more_kg * centre_m[axis];
                moment / mass_kg
            };
            *slot = Some(Body {
                mass_kg,
                centre_of_mass_m: [0, 1, 2].map(centre),
                inertia_kgm2: None,
            });
        }
    };
    let info = draw.at_joint("unbalanced-gravity", &["unbalanced-gravity"]);
    let facts = Facts::default().law("mass_kg", more_kg);
    Effect::new(info, fixed(facts), Act::Device(Box::new(act)))
}
