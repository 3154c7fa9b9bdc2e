//! Errors of force sensors and motors: bias, gain, cross-talk, friction, cogging, unbalanced mass.

use haptical_model::{Body, Device};

use crate::effects::{Draw, Effect, Facts, Info};
use crate::laws::{SlipElement, maxwell_slip};
use crate::rig::scene::Scene;

/// Name of a force that does not pass the sensor.
pub(super) const GRIP: &str = "grip-force";

/// What a force reading shows for a force.
#[derive(Debug, Clone, Copy)]
enum Sensor {
    /// A constant and a drift with temperature, along one axis \[N, N/K\].
    Bias {
        axis: usize,
        bias_n: f64,
        n_per_degc: f64,
    },
    /// One axis reads too much, a little less at high forces.
    Gain { axis: usize, gain: f64 },
    /// One axis sees another.
    Crosstalk {
        from: usize,
        into: usize,
        share: f64,
    },
    /// A loop over the force along one axis \[N\].
    Loop {
        axis: usize,
        amplitude_n: f64,
        width_n: f64,
    },
    /// A part of the hand's force does not pass the sensor: one axis, sums of slow sines \[N\].
    Grip { axis: usize, size_n: f64, tag: u64 },
}

/// An effect of the force sensor.
#[derive(Debug)]
struct OfSensor {
    info: Info,
    sensor: Sensor,
}

/// Forces at which the gain has lost a tenth \[N\].
const GAIN_LOSS_N: f64 = 30.0;

impl Effect for OfSensor {
    fn info(&self) -> &Info {
        &self.info
    }

    fn facts(&self, _scene: &Scene<'_>) -> Facts {
        let facts = Facts::default();
        match self.sensor {
            Sensor::Bias {
                bias_n, n_per_degc, ..
            } => facts.law("bias_n", bias_n).law("n_per_degc", n_per_degc),
            Sensor::Gain { gain, .. } => facts.law("gain", gain),
            Sensor::Crosstalk { share, .. } => facts.law("share", share),
            Sensor::Loop { amplitude_n, .. } => facts.law("amplitude_n", amplitude_n),
            Sensor::Grip { size_n, .. } => facts.law("size_n", size_n),
        }
    }

    fn force(&self, scene: &Scene<'_>, force_n: &mut [Vec<f64>; 3]) {
        match self.sensor {
            Sensor::Bias {
                axis,
                bias_n,
                n_per_degc,
            } => {
                for (value, degc) in force_n[axis].iter_mut().zip(&scene.temperature_degc) {
                    *value += bias_n + n_per_degc * (degc - scene.cold_degc);
                }
            }
            Sensor::Gain { axis, gain } => {
                for value in &mut force_n[axis] {
                    *value += gain * *value * (1.0 - value.abs() / (10.0 * GAIN_LOSS_N));
                }
            }
            Sensor::Crosstalk { from, into, share } => {
                let source = force_n[from].clone();
                for (value, other) in force_n[into].iter_mut().zip(source) {
                    *value += share * other;
                }
            }
            Sensor::Loop {
                axis,
                amplitude_n,
                width_n,
            } => {
                let elements = [0.5, 1.0, 2.0].map(|width| SlipElement {
                    weight: amplitude_n / 3.0,
                    width: width * width_n,
                });
                let extra = maxwell_slip(&force_n[axis], &elements);
                for (value, extra) in force_n[axis].iter_mut().zip(extra) {
                    *value -= extra;
                }
            }
            Sensor::Grip { axis, size_n, tag } => {
                let mut random = scene.events(tag);
                let waves = [(); 4].map(|()| [random.uniform(0.3, 5.0), random.phase_rad()]);
                for (row, value) in force_n[axis].iter_mut().enumerate() {
                    let time_s = scene.elapsed_s(row);
                    let sines = waves
                        .iter()
                        .map(|[rate, phase]| libm::sin(rate * time_s + phase));
                    *value -= 0.7 * size_n * sines.sum::<f64>();
                }
            }
        }
    }
}

fn of_sensor(draw: &Draw<'_>, name: &'static str, sensor: Sensor) -> Box<dyn Effect> {
    let info = Info {
        name,
        right: vec![name],
        // an error of the readings is, row by row, a force that does not pass the sensor
        acceptable: vec![GRIP],
        ..draw.anywhere(name, &[])
    };
    Box::new(OfSensor { info, sensor })
}

/// A bias of one axis that drifts with temperature.
pub(crate) fn force_bias(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let bias_n = draw.signed(0.3);
    let sensor = Sensor::Bias {
        axis: draw.random.index(3),
        bias_n,
        n_per_degc: bias_n * draw.random.uniform(-0.02, 0.02),
    };
    of_sensor(draw, "force-bias", sensor)
}

/// A gain error of one axis.
pub(crate) fn force_gain(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let sensor = Sensor::Gain {
        axis: draw.random.index(3),
        gain: draw.signed(0.15),
    };
    of_sensor(draw, "force-gain", sensor)
}

/// Cross-talk between two axes.
pub(crate) fn force_crosstalk(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let from = draw.random.index(3);
    let sensor = Sensor::Crosstalk {
        from,
        into: (from + 1 + draw.random.index(2)) % 3,
        share: draw.signed(0.1),
    };
    of_sensor(draw, "force-crosstalk", sensor)
}

/// A loop of the sensor.
pub(crate) fn force_hysteresis(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let sensor = Sensor::Loop {
        axis: draw.random.index(3),
        amplitude_n: draw.amplitude(0.1),
        width_n: draw.random.uniform(0.1, 0.4),
    };
    of_sensor(draw, "force-hysteresis", sensor)
}

/// Force that does not pass the sensor.
pub(crate) fn grip_force(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let sensor = Sensor::Grip {
        axis: draw.random.index(3),
        size_n: draw.amplitude(0.4),
        tag: draw.tag,
    };
    of_sensor(draw, GRIP, sensor)
}

/// What a motor's torque has to do besides moving the link.
#[derive(Debug, Clone, Copy)]
enum Motor {
    /// Stribeck friction: Coulomb, extra at rest, viscous \[N m, N m, N m s/rad\].
    Friction {
        coulomb_nm: f64,
        extra_nm: f64,
        viscous_nms: f64,
    },
    /// Ripple over the motor angle, with the second harmonic \[N m\].
    Cogging {
        amplitude_nm: f64,
        poles: f64,
        phase_rad: f64,
        second: f64,
    },
    /// The current's scale.
    Gain { gain: f64 },
}

/// An effect of one joint's torque reading.
#[derive(Debug)]
struct OfMotor {
    info: Info,
    joint: usize,
    motor: Motor,
}

/// Speed below which friction passes through zero, and that of Stribeck's extra \[rad/s\].
const FRICTION_SPEED_RAD_S: f64 = 0.01;
const STRIBECK_SPEED_RAD_S: f64 = 0.08;

impl Effect for OfMotor {
    fn info(&self) -> &Info {
        &self.info
    }

    fn facts(&self, _scene: &Scene<'_>) -> Facts {
        let facts = Facts::default();
        match self.motor {
            Motor::Friction {
                coulomb_nm,
                viscous_nms,
                ..
            } => facts
                .law("coulomb_nm", coulomb_nm)
                .law("viscous_nms", viscous_nms),
            Motor::Cogging {
                amplitude_nm,
                poles,
                ..
            } => facts.law("amplitude_nm", amplitude_nm).law("poles", poles),
            Motor::Gain { gain } => facts.law("gain", gain),
        }
    }

    fn torque(&self, scene: &Scene<'_>, torque_nm: &mut [Vec<f64>]) {
        let angle = &scene.motion.angle_rad[self.joint];
        let rate = &scene.motion.rate_rad_s[self.joint];
        let ratio = scene.device.joints[self.joint].transmission_ratio;
        for (row, torque) in torque_nm[self.joint].iter_mut().enumerate() {
            *torque += match self.motor {
                Motor::Friction {
                    coulomb_nm,
                    extra_nm,
                    viscous_nms,
                } => {
                    let slow = rate[row] / STRIBECK_SPEED_RAD_S;
                    let level = coulomb_nm + extra_nm * libm::exp(-slow * slow);
                    level * libm::tanh(rate[row] / FRICTION_SPEED_RAD_S) + viscous_nms * rate[row]
                }
                Motor::Cogging {
                    amplitude_nm,
                    poles,
                    phase_rad,
                    second,
                } => {
                    let motor = poles * ratio * angle[row];
                    amplitude_nm * (libm::sin(motor + phase_rad) + second * libm::sin(2.0 * motor))
                }
                Motor::Gain { gain } => gain * *torque,
            };
        }
    }
}

/// Friction in a joint.
pub(crate) fn joint_friction(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let coulomb_nm = draw.amplitude(0.06);
    let motor = Motor::Friction {
        coulomb_nm,
        extra_nm: coulomb_nm * draw.random.uniform(0.0, 0.4),
        viscous_nms: coulomb_nm * draw.random.uniform(0.1, 0.6),
    };
    let info = draw.at_joint("joint-friction", &["joint-friction"]);
    let joint = draw.joint;
    Box::new(OfMotor { info, joint, motor })
}

/// Cogging of a motor.
pub(crate) fn motor_cogging(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let motor = Motor::Cogging {
        amplitude_nm: draw.amplitude(0.03),
        poles: 7.0 + draw.random.index(6) as f64,
        phase_rad: draw.random.phase_rad(),
        second: draw.random.uniform(0.0, 0.3),
    };
    let info = draw.at_joint("motor-cogging", &["motor-cogging"]);
    let joint = draw.joint;
    Box::new(OfMotor { info, joint, motor })
}

/// A torque scale far beyond what the file allows.
pub(crate) fn torque_gain(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let gain = draw.signed(0.3);
    let info = draw.at_joint("torque-gain", &["torque-gain"]);
    let joint = draw.joint;
    let motor = Motor::Gain { gain };
    Box::new(OfMotor { info, joint, motor })
}

/// A mass that the file does not have.
#[derive(Debug)]
struct Unbalanced {
    info: Info,
    row: usize,
    mass_kg: f64,
    centre_m: [f64; 3],
}

impl Effect for Unbalanced {
    fn info(&self) -> &Info {
        &self.info
    }

    fn facts(&self, _scene: &Scene<'_>) -> Facts {
        Facts::default().law("mass_kg", self.mass_kg)
    }

    fn device(&self, device: &mut Device) {
        let Some(slot) = device.bodies.get_mut(self.row) else {
            return;
        };
        let before = slot.unwrap_or(Body {
            mass_kg: 0.0,
            centre_of_mass_m: self.centre_m,
            inertia_kgm2: None,
        });
        let mass_kg = before.mass_kg + self.mass_kg;
        if mass_kg > 0.0 {
            let centre = |axis: usize| {
                let moment = before.mass_kg * before.centre_of_mass_m[axis]
                    + self.mass_kg * self.centre_m[axis];
                moment / mass_kg
            };
            *slot = Some(Body {
                mass_kg,
                centre_of_mass_m: [0, 1, 2].map(centre),
                inertia_kgm2: None,
            });
        }
    }
}

/// A mass off a joint's axis that the file does not know.
pub(crate) fn unbalanced_gravity(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let centre_m = [(); 3].map(|()| draw.random.sign() * draw.random.uniform(0.03, 0.08));
    Box::new(Unbalanced {
        info: draw.at_joint("unbalanced-gravity", &["unbalanced-gravity"]),
        row: draw.joint + 1,
        mass_kg: draw.amplitude(0.15),
        centre_m,
    })
}
