//! Torques of drives, errors of the force sensor and a play that a hand drives: against `haptical_effects`, and closed forms.

use haptical_effects::Context;
use haptical_effects::device::effects_of;
use haptical_effects::signal::smooth;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, DeviceEffect, Recording};
use haptical_runtime::{
    CompensatedModel, Convention, CoupledModel, Effect, Inputs, Joint, Link, Model, Motion, Over,
    RuntimeError, Side, Transmission,
};

use crate::devices::{fixture, model};
use crate::effect_lists::{compensated, named};
use crate::exported_effects::every_effect;

const TOLERANCE: f64 = 1e-12;
const ROWS: usize = 400;
const STEP_S: f64 = 0.01;

/// The device without effects.
fn base() -> Device {
    let mut device = fixture("every_effect.toml");
    device.effects.clear();
    device.surroundings.compliance.clear();
    device
}

fn recording(device: &Device, speed: f64) -> Recording {
    let wave = |pace: f64, phase: f64, size: f64| -> Vec<f64> {
        let at = |row: usize| size * (pace * STEP_S * row as f64 + phase).sin();
        (0..ROWS).map(at).collect()
    };
    let joints = 0..device.joints.len();
    Recording {
        line: (2..).take(ROWS).collect(),
        time_s: Some((0..ROWS).map(|row| STEP_S * row as f64).collect()),
        joint: joints
            .clone()
            .map(|joint| wave(speed * (3.0 + joint as f64), 0.4, 0.3))
            .collect(),
        output: vec![None; device.joints.len()],
        torque_nm: joints
            .map(|joint| Some(wave(1.0 + joint as f64, 0.2, 1.5)))
            .collect(),
        force_n: Some([1.1, 1.7, 2.3].map(|pace| wave(pace, 0.3, 3.0))),
        temperature_degc: Some(vec![22.0; ROWS]),
        ..Recording::default()
    }
}

/// Largest gap between what an effect adds to the torques by either.
fn compare(effect: DeviceEffect, speed: f64) {
    let base = base();
    let recording = recording(&base, speed);
    let context = Context::new(&base, &recording, &[]).unwrap();
    let device = Device {
        effects: vec![effect],
        ..base.clone()
    };
    let own = &effects_of(&device).unwrap()[0];
    let (amplitudes, shape) = own.amplitudes(&context);
    let signal = own.effect.signal(&context, &amplitudes, shape);
    let model = compensated::<3>(&device);
    let mut state = model.start();
    let is_sensor = own.effect.name().starts_with("force");
    let force_n: [Vec<f64>; 3] = std::array::from_fn(|axis| {
        let read = &recording.force_n.as_ref().unwrap()[axis];
        match own.effect.name() {
            "force-hysteresis" => smooth(read, 4, &context.runs),
            _ => read.clone(),
        }
    });
    let motion: Vec<_> = (0..3)
        .map(|joint| context.drive_motion(joint).unwrap())
        .collect();
    let mut seen = 0.0_f64;
    for row in 0..ROWS {
        let torque_nm: [f64; 3] =
            std::array::from_fn(|joint| context.torque_nm[joint].as_ref().unwrap()[row]);
        let inputs = Inputs {
            torque_nm,
            velocity: std::array::from_fn(|joint| motion[joint].velocity[row]),
            force_n: std::array::from_fn(|axis| force_n[axis][row]),
            temperature_degc: 22.0,
            ..Inputs::at(std::array::from_fn(|joint| motion[joint].value[row]))
        };
        let here = model.forward(&inputs, &mut state).unwrap();
        let linked_nm = here.link_torques_nm(&torque_nm);
        for joint in 0..3 {
            let expected = signal.on(joint).map_or(0.0, |values| values[row]);
            // the torque reads so much more than the links need
            let ours = match is_sensor {
                false => torque_nm[joint] - linked_nm[joint],
                true => {
                    let read_n = context.rotation[row] * Vector3::from(inputs.force_n);
                    let error_n = read_n - Vector3::from(here.hand_force_n);
                    context.twist[joint][row].linear.dot(&error_n)
                }
            };
            // rates and rotations of the two differ where readings are averaged: by the square of a count here
            let allowed = if is_sensor { 1e-5 } else { TOLERANCE };
            assert!(
                (ours - expected).abs() <= allowed,
                "{} {row} {joint}: {ours} {expected}",
                own.effect.name()
            );
            seen = seen.max(expected.abs());
        }
        let back_nm = here.drive_torques_nm([0.0; 3], [0.0; 3]).unwrap();
        let none_nm = here.link_torques_nm(&back_nm);
        assert!(
            none_nm.iter().all(|torque| torque.abs() < TOLERANCE),
            "{none_nm:?}"
        );
    }
    assert!(seen > 1e-3, "{} shows nothing", own.effect.name());
}

#[test]
fn torques_of_the_drives_are_those_of_the_effects() {
    compare(named("torque-gain", Some(0), &[("gain", 0.08)]), 1.0);
    let friction = [
        ("coulomb_nm", 0.2),
        ("viscous_nm_s_per_rad", 0.05),
        ("stribeck_nm", 0.1),
    ];
    for over in [("transition_rad", 0.02), ("transition_rad_per_s", 0.05)] {
        let numbers = [friction[0], friction[1], friction[2], over];
        compare(named("joint-friction", Some(2), &numbers), 1.0);
    }
    let slide = [
        ("coulomb_n", 2.0),
        ("viscous_n_s_per_m", 0.5),
        ("stribeck_n", 0.7),
        ("transition_m", 0.01),
    ];
    compare(named("joint-friction", Some(1), &slide), 1.0);
    let cogging = [("amplitude_nm", 0.03), ("phase_rad", 0.9), ("order", 6.0)];
    compare(named("motor-cogging", Some(2), &cogging), 1.0);
    // at rest: the acceleration of the handle is none
    compare(
        named("payload", None, &[("mass_kg", 0.25), ("from_run", 1.0)]),
        0.0,
    );
}

#[test]
fn forces_are_read_without_the_errors_of_their_sensor() {
    compare(
        named(
            "force-bias",
            None,
            &[("x_n", 0.2), ("y_n", -0.1), ("z_n", 0.3)],
        ),
        1.0,
    );
    compare(
        named(
            "force-gain",
            None,
            &[("x", 0.03), ("y", -0.02), ("z", 0.01)],
        ),
        1.0,
    );
    let crosstalk = [
        ("xy", 0.01),
        ("xz", 0.02),
        ("yx", -0.03),
        ("yz", 0.04),
        ("zx", 0.05),
        ("zy", -0.06),
    ];
    compare(named("force-crosstalk", None, &crosstalk), 1.0);
    let hysteresis = [
        ("x_n", 0.1),
        ("y_n", 0.2),
        ("z_n", -0.1),
        ("transition_n", 0.5),
    ];
    compare(named("force-hysteresis", None, &hysteresis), 1.0);
}

/// The motor is what a play of the link's motion carries along; where it moves, the link is known again.
#[test]
fn a_play_that_the_hand_drives_is_given_back() {
    const HALF_RAD: f64 = 5e-3;
    let play = Effect::Backlash {
        joint: 0,
        width_rad: 2.0 * HALF_RAD,
        driven_by: Side::Hand,
    };
    let mut device = base();
    for joint in &mut device.joints {
        joint.transmission_error = Default::default();
    }
    let model = CompensatedModel::new(CoupledModel::of_rows(model::<3>(&device)), [play]).unwrap();
    let mut state = model.start();
    let (mut motor, mut moved) = (0.0_f64, 0);
    for row in 0..500 {
        let link = 0.3 * (0.05 * f64::from(row)).sin();
        let before = motor;
        motor = motor.clamp(link - HALF_RAD, link + HALF_RAD);
        let found = model
            .forward(&Inputs::at([motor, 0.0, 0.0]), &mut state)
            .unwrap();
        if row > 0 && motor != before {
            assert!((found.state.outputs[0] - link).abs() < 1e-12, "row {row}");
            moved += 1;
        }
    }
    assert!(moved > 300);
}

#[test]
fn states_of_other_models_and_numbers_that_are_none_are_refused() {
    let model = |effect| {
        CompensatedModel::new(CoupledModel::of_rows(model::<3>(&base())), [effect]).unwrap()
    };
    let play = model(Effect::Backlash {
        joint: 1,
        width_rad: 0.01,
        driven_by: Side::Motor,
    });
    let creep = model(Effect::CapstanCreep {
        joint: 1,
        creep_per_nm: 1e-4,
    });
    let mut foreign = creep.start();
    let refused = play.forward(&Inputs::at([0.0; 3]), &mut foreign);
    assert_eq!(refused, Err(RuntimeError::ForeignState { effect: 1 }));
    let every = &every_effect::COMPENSATED;
    let mut state = every.start();
    let base = Inputs::at([0.1, 0.05, 0.2]);
    every.forward(&base, &mut state).unwrap();
    let kept = state;
    for value in [f64::NAN, f64::INFINITY, -2e12] {
        let all = [
            Inputs {
                torque_nm: [0.0, value, 0.0],
                ..base
            },
            Inputs {
                velocity: [0.0, 0.0, value],
                ..base
            },
            Inputs {
                acceleration: [value, 0.0, 0.0],
                ..base
            },
            Inputs {
                force_n: [0.0, value, 0.0],
                ..base
            },
            Inputs {
                handle_acceleration_mps2: [value; 3],
                ..base
            },
            Inputs {
                time_s: value,
                ..base
            },
            Inputs {
                temperature_degc: value,
                ..base
            },
            Inputs {
                readings: [value, 0.0, 0.0],
                ..base
            },
        ];
        for inputs in all {
            assert!(every.forward(&inputs, &mut state).is_err(), "{inputs:?}");
            assert!(
                every.inverse(&[0.0; 3], &inputs, &state).is_err(),
                "{inputs:?}"
            );
            assert_eq!(state, kept);
        }
        assert!(every.inverse(&[0.0, value, 0.0], &base, &state).is_err());
    }
    let text = every
        .inverse(&[0.0, 5e6, 0.0], &base, &state)
        .unwrap_err()
        .to_string();
    assert!(text.starts_with("joint 2: no reading"), "{text}");
}

#[test]
fn numbers_that_no_effect_can_have_are_refused_where_the_model_is_made() {
    let made = |effect| {
        CompensatedModel::new(
            CoupledModel::of_rows(model::<3>(&base())),
            [Effect::None, effect],
        )
        .err()
    };
    let text = |effect| made(effect).unwrap().to_string();
    let said = text(Effect::Backlash {
        joint: 0,
        width_rad: f64::NAN,
        driven_by: Side::Motor,
    });
    assert!(said.starts_with("effect 2: width_rad is NaN"), "{said}");
    let said = text(Effect::ViscousLag {
        joint: 3,
        delay_s: 0.1,
    });
    assert_eq!(said, "effect 2 is of joint 4; the device has 3");
    let said = text(Effect::Weight {
        row: 3,
        place_m: [0.0; 3],
        force_n: [0.0; 3],
    });
    assert_eq!(said, "effect 2 is of moving row 4; the device has 3");
    let said = text(Effect::LateralCompliance {
        joint: 1,
        rad_per_nm: 1e-3,
        origin_m: [0.0; 3],
    });
    assert!(said.contains("the axis of joint 2, which slides"), "{said}");
    let said = text(Effect::TorqueGain {
        joint: 1,
        gain: 1.0,
    });
    assert!(said.contains("between -0.9 and 0.9"), "{said}");
    assert_eq!(
        made(Effect::Hysteresis {
            joint: 2,
            amplitude_rad: 1e-3,
            transition_rad: 0.1,
            driven_by: Side::Hand
        }),
        None
    );
    let curve = |upper: f64, coefficients: &'static [f64]| {
        made(Effect::Curve {
            joint: 2,
            over: Over::Angle,
            lower: -0.5,
            upper,
            coefficients,
        })
    };
    assert_eq!(curve(0.5, &[0.0, 1e-3, 0.0, 1e-3]), None);
    let said = curve(0.5, &[0.0, 1e-3, 0.0]).unwrap().to_string();
    assert!(
        said.contains("number of coefficients is 3; allowed: at least 4"),
        "{said}"
    );
    let said = curve(-0.5, &[0.0; 4]).unwrap().to_string();
    assert!(said.contains("upper less lower is 0"), "{said}");
    let said = curve(0.5, &[0.0, f64::NAN, 0.0, 0.0]).unwrap().to_string();
    assert!(said.contains("coefficients is NaN"), "{said}");
}

/// A pose of the 7-DOF device is found again from a posture beside it.
#[test]
fn a_pose_is_given_back_by_readings() {
    use crate::exported_effects::effects;
    let model = &effects::COMPENSATED;
    let wanted = Inputs {
        torque_nm: [0.5, -0.4, 0.3, 0.2, 0.0, 0.1, 0.0],
        ..Inputs::at([0.31, -0.22, 0.43, -0.12, 0.2, -0.3, 0.4])
    };
    let mut state = model.start();
    let now = Inputs {
        readings: wanted.readings.map(|reading| reading - 0.15),
        ..wanted
    };
    model.forward(&now, &mut state).unwrap();
    let mut there = state;
    let pose = model.forward(&wanted, &mut there).unwrap().state.pose;
    let readings = model.inverse_pose(&pose, &now, &state).unwrap();
    let mut again = state;
    let found = model
        .forward(&Inputs { readings, ..now }, &mut again)
        .unwrap()
        .state
        .pose;
    assert!((found.position_m - pose.position_m).norm() < 1e-10);
    assert!((found.rotation - pose.rotation).norm() < 1e-10);
    let mut far = pose;
    far.position_m.x += 10.0;
    let text = model
        .inverse_pose(&far, &now, &state)
        .unwrap_err()
        .to_string();
    assert!(text.starts_with("the pose was not reached"), "{text}");
}

/// A joint about which nothing moves but the orientation: of half a turn no sine is left.
#[test]
fn a_pose_half_a_turn_away_is_not_taken_for_reached() {
    let joint = Joint {
        motion: Motion::Revolute,
        home: 0.0,
        transmission: Transmission::Exact,
    };
    let model = Model::new(
        Convention::Standard,
        Link::IDENTITY,
        [Link::IDENTITY],
        [joint],
    )
    .unwrap()
    .with_limits([[-2.0, 4.0]])
    .unwrap();
    let model = CompensatedModel::new(CoupledModel::of_rows(model), [Effect::None]).unwrap();
    let mut state = model.start();
    let pi = std::f64::consts::PI;
    for wanted in [pi, pi - 1e-6, 3.0, 2.0] {
        let pose = model.forward(&Inputs::at([wanted]), &mut state).unwrap();
        let found = model.inverse_pose(&pose.state.pose, &Inputs::at([0.0]), &state);
        // to either side
        match found {
            Ok([reading]) => assert!((reading - wanted).abs() < 1e-10, "{wanted}: {reading}"),
            Err(error) => assert_eq!(
                error.to_string().split_once(':').unwrap().0,
                "joint 1",
                "{wanted}: {error}"
            ),
        }
        let found = model.inverse_pose(&pose.state.pose, &Inputs::at([1.0]), &state);
        assert!((found.unwrap()[0] - wanted).abs() < 1e-10, "{wanted}");
    }
    // beyond the limits of the device, and no pose at all
    let mut pose = model
        .forward(&Inputs::at([-2.5]), &mut state)
        .unwrap()
        .state
        .pose;
    let found = model.inverse_pose(&pose, &Inputs::at([-1.0]), &state);
    assert!(
        matches!(found, Err(RuntimeError::BeyondLimit { joint: 1, .. })),
        "{found:?}"
    );
    pose.rotation *= 2.0;
    let found = model.inverse_pose(&pose, &Inputs::at([-1.0]), &state);
    assert_eq!(found, Err(RuntimeError::NotAPose));
}
