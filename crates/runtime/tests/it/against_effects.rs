//! Devices with effects, row by row, against what `haptical_effects` says of a whole recording.
//!
//! Errors of joints are those that an external encoder at each joint would show. What effects of the structure displace
//! is what a tracker would show of a device with rigid drives at the true link angles.

use haptical_effects::Context;
use haptical_effects::device::{attached, bare};
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{Body, Device, Evaluation, Recording, Tracker, TransmissionError};
use haptical_runtime::{CompensatedModel, CompensatedState, EffectState, Inputs, State};
use proptest::collection::vec;
use proptest::prelude::*;

use crate::devices::any_device;
use crate::effect_lists::{ROOM, Seed, any_seed, compensated, drive_effect, structure_effect};

/// Angles and lengths here are of the size of 1; both sides round some hundred times.
const TOLERANCE: f64 = 1e-12;
/// Rows of each of two runs.
const RUN: usize = 100;
const STEP_S: f64 = 0.01;

/// A device and what drives its motion.
#[derive(Debug, Clone)]
struct Case {
    device: Device,
    drives: Vec<Seed>,
    structure: Vec<Seed>,
    phases: Vec<f64>,
}

fn any_case() -> impl Strategy<Value = Case> {
    let masses = vec(
        (0.05..0.5_f64, [-0.1..0.1_f64, -0.1..0.1_f64, -0.1..0.1_f64]),
        8,
    );
    let compliance = vec(prop_oneof![Just(0.0), 1e-4..5e-3_f64], 7);
    (1..=7_usize).prop_flat_map(move |joints| {
        (
            any_device(joints),
            masses.clone(),
            compliance.clone(),
            (vec(any_seed(), 1..=3), vec(any_seed(), 0..=2)),
            vec(0.0..6.0_f64, 7),
        )
            .prop_map(
                |(mut device, masses, compliance, (drives, structure), phases)| {
                    let bodies = masses.into_iter().map(|(mass_kg, centre_of_mass_m)| {
                        Some(Body {
                            mass_kg,
                            centre_of_mass_m,
                            inertia_kgm2: None,
                        })
                    });
                    device.bodies = bodies.take(device.links.len()).collect();
                    device.gravity_mps2 = Some([1.0, -2.0, -9.5]);
                    device.tracker = Some(Tracker {
                        base_known: true,
                        base_per_run: false,
                        tool_known: true,
                        position_sd_m: Some(1e-4),
                        rotation_sd_rad: Some(1e-3),
                        scale_sd: None,
                    });
                    for joint in &mut device.joints {
                        joint.external_encoder_sd_rad = Some(1e-4);
                    }
                    for (joint, rad_per_nm) in
                        compliance.into_iter().enumerate().take(device.joints.len())
                    {
                        let own = haptical_model::JointCompliance {
                            rad_per_nm,
                            fit: false,
                        };
                        device
                            .surroundings
                            .compliance
                            .resize(joint, Default::default());
                        device.surroundings.compliance.push(own);
                    }
                    Case {
                        device,
                        drives,
                        structure,
                        phases,
                    }
                },
            )
    })
}

/// Effects that no other one of the list is.
fn different(
    device: &Device,
    seeds: &[Seed],
    make: fn(&Device, Seed) -> haptical_model::DeviceEffect,
) -> Vec<haptical_model::DeviceEffect> {
    let mut effects: Vec<haptical_model::DeviceEffect> = Vec::new();
    for seed in seeds {
        let effect = make(device, *seed);
        if !effects
            .iter()
            .any(|other| (&other.name, other.joint) == (&effect.name, effect.joint))
        {
            effects.push(effect);
        }
    }
    effects
}

/// A smooth motion under varying loads: two runs, each at a temperature of its own.
fn recorded(device: &Device, phases: &[f64]) -> Recording {
    let rows = 2 * RUN;
    let time = |row: usize| STEP_S * (row % RUN) as f64 + if row < RUN { 0.0 } else { 10.0 };
    let wave = |pace: f64, phase: f64| -> Vec<f64> {
        let at = |row: usize| {
            let t = time(row);
            (pace * t + phase).sin() + 0.4 * (2.3 * pace * t - phase).cos()
        };
        (0..rows).map(at).collect()
    };
    let joints = device.joints.len();
    let scaled = |values: Vec<f64>, size: f64| {
        values
            .into_iter()
            .map(|value| size * value)
            .collect::<Vec<f64>>()
    };
    Recording {
        line: (2..).take(rows).collect(),
        run: Some((0..rows).map(|row| i64::from(row >= RUN)).collect()),
        time_s: Some((0..rows).map(time).collect()),
        joint: (0..joints)
            .map(|joint| scaled(wave(5.0 + 0.9 * joint as f64, phases[joint]), 0.6))
            .collect(),
        output: vec![Some(vec![0.0; rows]); joints],
        torque_nm: (0..joints)
            .map(|joint| {
                Some(scaled(
                    wave(1.0 + 0.3 * joint as f64, 2.0 * phases[joint]),
                    2.0,
                ))
            })
            .collect(),
        force_n: Some([1.1, 1.7, 2.3].map(|pace| scaled(wave(pace, phases[0]), 4.0))),
        temperature_degc: Some(
            (0..rows)
                .map(|row| if row < RUN { 19.0 } else { 24.5 })
                .collect(),
        ),
        position_m: Some([(); 3].map(|()| vec![0.0; rows])),
        orientation_wxyz: Some([1.0, 0.0, 0.0, 0.0].map(|part| vec![part; rows])),
        ..Recording::default()
    }
}

/// What all effects of a device add to the axes of a channel, row by row, for each of `axes` (channel and axis).
fn added<const AXES: usize>(
    device: &Device,
    recording: &Recording,
    axes: [(String, usize); AXES],
) -> [Vec<f64>; AXES] {
    let mut with = device.clone();
    let attached = attached(&mut with, recording).unwrap();
    axes.map(|(channel, axis)| {
        let mut sum = vec![0.0; recording.len()];
        let parts = attached
            .added
            .iter()
            .filter(|part| part.channel == channel && part.axis == axis);
        for part in parts {
            for (sum, value) in sum.iter_mut().zip(&part.readings) {
                *sum += value;
            }
        }
        sum
    })
}

/// Not `>`: NaN must fail as well.
fn near(ours: f64, theirs: f64, what: &str, case: &Case) -> f64 {
    let gap = (ours - theirs).abs();
    if gap <= TOLERANCE * theirs.abs().max(1.0) {
        return gap;
    }
    let effects: Vec<String> = case
        .device
        .effects
        .iter()
        .map(|effect| format!("{} {:?}", effect.label(), effect.numbers))
        .collect();
    panic!("{what}: {ours:?} here, {theirs:?} there\n{effects:#?}");
}

/// The rotation vector of a small turn.
fn turn(rotation: &Matrix3<f64>) -> Vector3<f64> {
    let twice = Vector3::new(
        rotation.m32 - rotation.m23,
        rotation.m13 - rotation.m31,
        rotation.m21 - rotation.m12,
    );
    let sine = 0.5 * twice.norm();
    match sine > 1e-12 {
        true => twice * (0.5 * sine.asin() / sine),
        false => twice * 0.5,
    }
}

/// Rows of a device through both, and the largest difference; none where the device has no pose at a row.
fn compare<const JOINTS: usize>(case: &Case) -> Option<f64> {
    let base = bare(&case.device);
    let drives = different(&base, &case.drives, drive_effect);
    let structure = different(&base, &case.structure, structure_effect);
    let recording = recorded(&base, &case.phases);
    let driven = Device {
        effects: drives.clone(),
        ..base.clone()
    };
    let context = Context::new(&base, &recording, &[]).ok()?;
    let outputs = std::array::from_fn(|joint| (format!("out{}", joint + 1), 0));
    let errors: [Vec<f64>; JOINTS] = added(&driven, &recording, outputs);
    // the same device with rigid drives, at the true link angles
    let mut rigid = base.clone();
    for joint in &mut rigid.joints {
        joint.transmission_error = TransmissionError::default();
    }
    let torque_nm = |joint: usize, row: usize| context.torque_nm[joint].as_ref().unwrap()[row];
    let true_output = |joint: usize, row: usize| context.output[joint][row] + errors[joint][row];
    let link = |joint: usize, row: usize| {
        true_output(joint, row) - base.compliance_rad_per_nm(joint) * torque_nm(joint, row)
    };
    let at_links = Recording {
        joint: (0..JOINTS)
            .map(|joint| (0..recording.len()).map(|row| link(joint, row)).collect())
            .collect(),
        ..recording.clone()
    };
    let context_of_links = Context::new(&rigid, &at_links, &[]).unwrap();
    let built = Device {
        effects: structure.clone(),
        ..rigid.clone()
    };
    let axes = std::array::from_fn(|axis| (["position", "orientation"][axis / 3].into(), axis % 3));
    let displaced: [Vec<f64>; 6] = added(&built, &at_links, axes);
    let (moved, turned) = displaced.split_at(3);

    let whole = Device {
        effects: [drives, structure].concat(),
        ..base.clone()
    };
    let case = &Case {
        device: whole.clone(),
        ..case.clone()
    };
    let model = compensated::<JOINTS>(&whole);
    let mut state = model.start();
    let mut evaluation = Evaluation::new(&rigid);
    let motion = context.motion.as_ref().unwrap();
    let mut largest = 0.0_f64;
    for row in 0..recording.len() {
        if row == RUN {
            state = model.start();
        }
        let rotation = context_of_links.rotation[row];
        let force_n = rotation.transpose() * context_of_links.force_n.as_ref().unwrap()[row];
        let inputs = Inputs {
            torque_nm: std::array::from_fn(|joint| torque_nm(joint, row)),
            velocity: std::array::from_fn(|joint| motion[joint].velocity[row]),
            acceleration: std::array::from_fn(|joint| motion[joint].acceleration[row]),
            force_n: force_n.into(),
            time_s: recording.time_s.as_ref().unwrap()[row] - if row < RUN { 0.0 } else { 10.0 },
            temperature_degc: recording.temperature_degc.as_ref().unwrap()[row],
            ..Inputs::at(std::array::from_fn(|joint| recording.joint[joint][row]))
        };
        let before = state;
        let CompensatedState {
            state: ours, links, ..
        } = model.forward(&inputs, &mut state).unwrap();
        for joint in 0..JOINTS {
            largest = largest.max(near(
                ours.outputs[joint],
                true_output(joint, row),
                "output",
                case,
            ));
            largest = largest.max(near(links[joint], link(joint, row), "link", case));
        }
        let angles: Vec<f64> = (0..JOINTS).map(|joint| link(joint, row)).collect();
        evaluation.move_outputs(&angles).unwrap();
        let pose = *evaluation.pose().unwrap();
        let way = ours.pose.position_m - pose.position_m;
        let angle = turn(&(ours.pose.rotation * pose.rotation.transpose()));
        for axis in 0..3 {
            largest = largest.max(near(way[axis], moved[axis][row], "displacement", case));
            largest = largest.max(near(angle[axis], turned[axis][row], "turn", case));
        }
        // and back, at some rows: the readings that give these values
        if row % 37 == 5 {
            give_back(&model, &ours, &inputs, &before, case);
        }
    }
    Some(largest)
}

/// The readings of joint values give them back, and those of a pose, from a posture beside it, the pose; where no readings
/// are found for a pose it is said.
fn give_back<const JOINTS: usize>(
    model: &CompensatedModel<JOINTS, JOINTS, ROOM>,
    ours: &State<JOINTS>,
    inputs: &Inputs<JOINTS>,
    before: &EffectState<ROOM>,
    case: &Case,
) {
    let found = model.inverse(&ours.outputs, inputs, before);
    let found = found.unwrap_or_else(|error| panic!("{error}\n{:#?}", case.device.effects));
    let mut again = *before;
    let back = Inputs {
        readings: found,
        ..*inputs
    };
    let there = model.forward(&back, &mut again).unwrap();
    for joint in 0..JOINTS {
        let gap = (there.state.outputs[joint] - ours.outputs[joint]).abs();
        assert!(gap < 1e-9, "inverse: {gap:e}\n{:#?}", case.device.effects);
    }
    let pose = &ours.pose;
    let beside = Inputs {
        readings: inputs.readings.map(|reading| reading + 0.05),
        ..*inputs
    };
    let found = model.inverse_pose(pose, &beside, before);
    POSES.with(|have| {
        let (reached, all) = have.get();
        have.set((reached + u32::from(found.is_ok()), all + 1));
    });
    let Ok(readings) = found else {
        return;
    };
    let inputs = Inputs {
        readings,
        ..*inputs
    };
    let there = model.forward(&inputs, &mut before.clone()).unwrap();
    let there = there.state.pose;
    let gap = (there.position_m - pose.position_m).amax();
    let gap = gap.max((there.rotation - pose.rotation).amax());
    assert!(
        gap < 1e-10,
        "pose: {gap:e} is left\n{:#?}",
        case.device.effects
    );
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(1000) })]

    #[test]
    fn every_row_of_every_device_with_effects(case in any_case()) {
        let largest = match case.device.joints.len() {
            1 => compare::<1>(&case),
            2 => compare::<2>(&case),
            3 => compare::<3>(&case),
            4 => compare::<4>(&case),
            5 => compare::<5>(&case),
            6 => compare::<6>(&case),
            _ => compare::<7>(&case),
        };
        if let Some(largest) = largest {
            LARGEST.with(|have| {
                let (count, before) = have.get();
                have.set((count + 1, before.max(largest)));
                if count + 1 == 1900 {
                    let (reached, all) = POSES.with(std::cell::Cell::get);
                    println!(
                        "largest difference after 1900 devices: {:e}; {reached} of {all} poses given back",
                        before.max(largest)
                    );
                    assert!(reached > all / 100 * 95, "{reached} of {all} poses were reached");
                }
            });
        }
    }
}

thread_local! {
    static POSES: std::cell::Cell<(u32, u32)> = const { std::cell::Cell::new((0, 0)) };
    static LARGEST: std::cell::Cell<(usize, f64)> = const { std::cell::Cell::new((0, 0.0)) };
}
