//! Hand-guided recordings without effects: the model's own numbers, torques by virtual work, noise.

use haptical_simulator::model::kinematics::nalgebra::{Rotation3, Vector3};
use haptical_simulator::model::kinematics::{Chain, distance_m};
use haptical_simulator::model::{Device, Evaluation, Recording, Statics};
use haptical_simulator::{
    Effect, Effects, Encoders, MotionSettings, Noise, Settings, SimulatorError, record_motion,
    simulate_motion,
};

use crate::device::{arm, transmissions_only};
use crate::hand::{SEED, at_row, cable, heavy_arm, output, quiet, readings, time, torque, with};
use crate::inertia::motion_nm;

#[test]
fn without_effects_and_noise_rows_are_the_model_s_bits() {
    let (device, recording) = (heavy_arm(), with(Vec::new()));
    let simulation = simulate_motion(&device, &Effects::none(), &quiet(), SEED).expect("ready");
    assert_eq!(recording.len(), 2400);
    for row in 0..recording.len() {
        let evaluation = at_row(&device, &recording, row);
        let time_s = time(&recording)[row];
        assert_eq!(time_s.to_bits(), (row as f64 / 200.0).to_bits());
        for joint in 0..4 {
            let wanted = simulation.motion().joint_motion(joint, time_s).position;
            assert_eq!(recording.joint[joint][row], wanted);
            if let Some(column) = &recording.output[joint] {
                assert_eq!(column[row], evaluation.output_rad(joint));
            }
        }
        let position_m = evaluation.pose().expect("a pose").position_m;
        for (cable, column) in device.cables.iter().zip(&recording.cable_m) {
            let length_m = distance_m(&position_m, &Vector3::from(cable.anchor_m)).expect("a way");
            assert_eq!(column.as_ref().expect("a cable")[row], length_m);
        }
    }
    let present: Vec<bool> = recording.output.iter().map(Option::is_some).collect();
    assert_eq!(present, [true, true, true, false]);
}

/// Potential energy of the weights less F . P, the hand's force fixed in space; another route than the
/// simulator's: each mass in the pose of the row before it, turned by hand.
fn potential_nm(device: &Device, angles: &[f64], force_n: &Vector3<f64>) -> f64 {
    let (links, motions) = (device.chain_links(), device.motions());
    let pose = |rows: usize| {
        let chain = Chain::new(device.convention, &links[..rows], &motions[..rows]).expect("rows");
        chain.pose(&angles[..rows - 1]).expect("a pose")
    };
    let gravity = Vector3::from(device.gravity_mps2.expect("gravity"));
    let mut sum = -force_n.dot(&pose(5).position_m);
    for (row, body) in device.bodies.iter().enumerate() {
        let Some(body) = body else { continue };
        let before = pose(row);
        let turn =
            Rotation3::from_axis_angle(&Vector3::z_axis(), links[row].theta_rad + angles[row - 1]);
        let place = turn * Vector3::from(body.centre_of_mass_m);
        sum -= body.mass_kg * gravity.dot(&(before.position_m + before.rotation * place));
    }
    sum
}

#[test]
fn torques_are_the_slope_of_the_potential_energy_and_move_the_links() {
    const STEP: f64 = 1e-5;
    // of differences of mass matrices that are differences themselves
    const TOLERANCE_NM: f64 = 1e-5;
    let (device, recording) = (heavy_arm(), with(Vec::new()));
    let force = recording.force_n.as_ref().expect("forces");
    let mut sizes = [0.0_f64; 4];
    for row in (0..recording.len()).step_by(97) {
        let evaluation = at_row(&device, &recording, row);
        let angles: Vec<f64> = (0..4).map(|joint| evaluation.output_rad(joint)).collect();
        let own = Vector3::new(force[0][row], force[1][row], force[2][row]);
        let force_n = evaluation.pose().expect("a pose").rotation * own;
        let moving = motion_nm(&device, &recording, row);
        for joint in 0..4 {
            let shifted = |shift: f64| {
                let mut angles = angles.clone();
                angles[joint] += shift;
                potential_nm(&device, &angles, &force_n)
            };
            let slope = (shifted(STEP) - shifted(-STEP)) / (2.0 * STEP);
            let (got, want) = (torque(&recording, joint)[row], slope + moving[joint]);
            assert!(
                (got - want).abs() < TOLERANCE_NM,
                "joint {joint}: {got} {want}"
            );
            sizes[joint] = sizes[joint].max(got.abs());
        }
    }
    assert!(sizes.iter().all(|size| *size > 0.1), "{sizes:?}");
}

/// The slide is 0.2 m out at home, and what it carries is too.
#[test]
fn a_slide_carries_its_mass_from_home() {
    let mut device = heavy_arm();
    device.bodies[3] = device.bodies[2];
    let recording = record_motion(&device, &Effects::none(), &quiet(), SEED).expect("a recording");
    let force = recording.force_n.as_ref().expect("forces");
    let mut statics = Statics::new(&device);
    for row in (0..recording.len()).step_by(97) {
        let evaluation = at_row(&device, &recording, row);
        let angles: Vec<f64> = (0..4).map(|joint| evaluation.output_rad(joint)).collect();
        let own = Vector3::new(force[0][row], force[1][row], force[2][row]);
        let load = statics.load(&angles, |handle| Some(handle.rotation * own));
        let moving = motion_nm(&device, &recording, row);
        for (joint, weight) in load.expect("a load").torques_nm.iter().enumerate() {
            let (got, expected) = (torque(&recording, joint)[row], weight + moving[joint]);
            assert!(
                (got - expected).abs() < 1e-5,
                "joint {joint}: {got} {expected}"
            );
        }
    }
}

#[test]
fn the_force_has_its_root_mean_square_and_does_not_jump() {
    let mut settings = quiet();
    settings.motion.seconds = 200.0;
    settings.motion.rate_hz = 50.0;
    let recording = record_motion(&arm(), &Effects::none(), &settings, 3).expect("a recording");
    for axis in recording.force_n.as_ref().expect("forces") {
        let square: f64 = axis.iter().map(|force| force * force).sum::<f64>() / axis.len() as f64;
        assert!((square.sqrt() / 2.0 - 1.0).abs() < 0.2, "{}", square.sqrt());
        // 12 sines of 0.82 N, at most 9.42 rad/s: 92 N/s, 1.9 N in a row's time
        assert!(axis.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 1.9));
    }
}

#[test]
fn described_encoders_show_whole_counts_and_roughness_is_larger_on_joints_3_and_4() {
    let mut device = arm();
    device.joints[3].external_encoder_counts_per_rev = Some(30_000.0);
    device.joints[3].transmission = device.joints[0].transmission;
    device.joints[3].drum_distance_m = Some(0.07);
    let mut settings = MotionSettings {
        motion: quiet().motion,
        ..MotionSettings::default()
    };
    let recording = record_motion(&device, &Effects::none(), &settings, 3).expect("a recording");
    let is_whole = |value: f64, count: f64| {
        let counts = value / count;
        (counts - counts.round()).abs() < 1e-6
    };
    for (joint, of) in device.joints.iter().enumerate() {
        let motor = std::f64::consts::TAU
            / of.encoder_counts_per_rev.expect("counts")
            / of.transmission_ratio.abs();
        assert!(
            recording.joint[joint]
                .iter()
                .all(|value| is_whole(*value, motor))
        );
        let own = std::f64::consts::TAU / of.external_encoder_counts_per_rev.expect("counts");
        assert!(
            output(&recording, joint)
                .iter()
                .all(|value| is_whole(*value, own))
        );
    }
    // roughness alone
    settings.encoders = Encoders::Exact;
    let jiggle_rms = |effects: &Effects| -> Vec<f64> {
        let recording = record_motion(&device, effects, &settings, 3).expect("rows");
        let rows = recording.len() as f64;
        let square = |joint: usize| -> f64 {
            (0..recording.len())
                .map(|row| {
                    at_row(&device, &recording, row).output_rad(joint)
                        - output(&recording, joint)[row]
                })
                .map(|jiggle| jiggle * jiggle)
                .sum()
        };
        (0..4).map(|joint| (square(joint) / rows).sqrt()).collect()
    };
    // the slide is joint 3 here, and has no drums: it is smooth
    assert_eq!(
        jiggle_rms(&Effects::none()),
        [0.0; 4],
        "clean unless asked for"
    );
    let rms = jiggle_rms(
        &Effects::none()
            .with_assumed_roughness(&device)
            .expect("effects"),
    );
    for (got, want) in rms.iter().zip([3e-5, 3e-5, 0.0, 3e-4]) {
        assert!((got - want).abs() <= 0.4 * want, "{rms:?}");
    }
    let rough = Effect::DrumRoughness {
        joint: 2,
        rms_rad: 1e-3,
    };
    let rms = jiggle_rms(&Effects::new(vec![rough]).expect("effects"));
    assert!(
        rms[0] == 0.0 && rms[3] == 0.0 && (rms[1] - 1e-3).abs() < 4e-4,
        "{rms:?}"
    );
}

#[test]
fn roughness_belongs_to_the_device_and_noise_to_the_recording() {
    let device = arm();
    let mut settings = quiet();
    let rough = Effect::DrumRoughness {
        joint: 1,
        rms_rad: 1e-3,
    };
    let effects = Effects::new(vec![rough]).expect("effects");
    // at rest at home the jiggle is that of one angle
    let home = |settings: &MotionSettings, seed| {
        output(
            &record_motion(&device, &effects, settings, seed).expect("rows"),
            0,
        )[0]
    };
    let first = home(&settings, 1);
    assert_eq!(first, home(&settings, 2));
    settings.device_seed = 2;
    assert!((first - home(&settings, 1)).abs() > 1e-6);
}

fn noisy() -> MotionSettings {
    let encoders = Settings {
        output_noise: Noise::GaussianAndCounts,
        motor_counts: true,
        ..Settings::paper()
    };
    MotionSettings {
        motion: quiet().motion,
        encoders: Encoders::Same(encoders),
        ..MotionSettings::default()
    }
}

/// arm() without counts on joint 4's outside; its cables have a drum.
fn noisy_recording(seed: u64) -> Recording {
    record_motion(&heavy_arm(), &Effects::none(), &noisy(), seed).expect("a recording")
}

#[test]
fn a_seed_is_the_same_bits_and_another_seed_another_recording() {
    assert_eq!(noisy_recording(5), noisy_recording(5));
    let (one, other) = (noisy_recording(5), noisy_recording(6));
    assert_ne!(one.joint, other.joint);
    assert_ne!(one.torque_nm, other.torque_nm);
}

#[test]
fn noises_of_different_channels_are_independent() {
    let (device, recording) = (heavy_arm(), noisy_recording(9));
    let clean = record_motion(
        &device,
        &Effects::none(),
        &MotionSettings {
            motion: noisy().motion,
            ..quiet()
        },
        9,
    )
    .expect("a recording");
    let pairs = [
        (output(&recording, 0), output(&clean, 0)),
        (output(&recording, 1), output(&clean, 1)),
        (torque(&recording, 0), torque(&clean, 0)),
        (torque(&recording, 1), torque(&clean, 1)),
        (cable(&recording), cable(&clean)),
    ];
    let noises = pairs.map(|(noisy, clean)| -> Vec<f64> {
        noisy
            .iter()
            .zip(clean)
            .map(|(noisy, clean)| noisy - clean)
            .collect()
    });
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    for (index, one) in noises.iter().enumerate() {
        assert!(dot(one, one) > 0.0);
        for other in &noises[..index] {
            let correlation = dot(one, other) / (dot(one, one) * dot(other, other)).sqrt();
            // 2400 rows: five standard deviations
            assert!(correlation.abs() < 0.1, "{correlation}");
        }
    }
}

#[test]
fn rows_in_chunks_are_the_rows_at_once() {
    let (device, settings) = (heavy_arm(), noisy());
    let whole = noisy_recording(5);
    let mut simulation =
        simulate_motion(&device, &Effects::none(), &settings, 5).expect("a simulation");
    assert_eq!(simulation.rows(), 2400);
    let mut chunk = simulation.no_rows();
    assert!(chunk.is_empty());
    let mut first = 0;
    loop {
        let count = simulation.fill(&mut chunk, 71).expect("rows");
        assert_eq!(count, chunk.len());
        if count == 0 {
            break;
        }
        let indices: Vec<usize> = (first..first + count).collect();
        assert!(chunk == whole.select(&indices), "rows from {first}");
        first += count;
    }
    assert_eq!(first, whole.len());
}

#[test]
fn a_device_without_links_has_readings_and_outputs_alone() {
    let device = transmissions_only();
    let recording = record_motion(&device, &Effects::none(), &quiet(), 1).expect("a recording");
    assert!(recording.cable_m.iter().all(Option::is_none));
    assert!(recording.torque_nm.iter().all(Option::is_none) && recording.force_n.is_none());
    let mut evaluation = Evaluation::new(&device);
    for row in [0, 700, 1300] {
        evaluation
            .move_to(&readings(&recording, row))
            .expect("a place");
        assert_eq!(output(&recording, 1)[row], evaluation.output_rad(1));
    }
}

#[test]
fn the_handle_keeps_clear_of_the_cables_exits() {
    let mut device = arm();
    // an exit amid the workspace, where a way would come near by chance
    let recording = with(Vec::new());
    let pose = at_row(&device, &recording, 900)
        .pose()
        .expect("a pose")
        .position_m;
    device.cables[1].anchor_m = pose.into();
    let clear = record_motion(&device, &Effects::none(), &quiet(), SEED).expect("a recording");
    let second = clear.cable_m[1].as_ref().expect("a cable");
    let shortest = second.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(shortest > 0.02, "{shortest}");
    assert_ne!(clear.joint, recording.joint);
}

#[test]
fn settings_outside_their_domain_are_refused() {
    let device = arm();
    type Change = fn(&mut MotionSettings);
    let changes: [(&str, Change); 7] = [
        ("rate_hz", |s| s.motion.rate_hz = f64::NAN),
        ("seconds", |s| s.motion.seconds = -1.0),
        ("seconds x rate_hz", |s| s.motion.rate_hz = 1e12),
        ("range_share", |s| s.motion.range_share = 1.1),
        ("force_rms_n", |s| s.force_rms_n = f64::INFINITY),
        ("torque_sd_nm", |s| s.torque_sd_nm = -1.0),
        ("time_constant_s", |s| {
            s.temperature
                .as_mut()
                .expect("a temperature")
                .time_constant_s = 0.0;
        }),
    ];
    for (name, change) in changes {
        let mut settings = quiet();
        change(&mut settings);
        let refused = simulate_motion(&device, &Effects::none(), &settings, 1);
        match refused.expect_err(name) {
            SimulatorError::Setting { setting, .. } => assert_eq!(setting, name),
            error => unreachable!("{name}: {error}"),
        }
    }
}
