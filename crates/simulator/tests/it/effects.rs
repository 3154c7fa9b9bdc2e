//! Effects of transmissions, sensors and time against closed forms, on recordings without noise.

use haptical_simulator::model::kinematics::distance_m;
use haptical_simulator::model::kinematics::nalgebra::Vector3;
use haptical_simulator::model::{Device, Evaluation, Recording};
use haptical_simulator::{Driver, Effect};

use crate::hand::{at_row, cable, heavy_arm, largest, output, time, torque, with};

/// Rounding of angles and lengths below 10.
const ROUNDING: f64 = 1e-12;

fn same(one: &[f64], other: &[f64], tolerance: f64, what: &str) {
    assert_eq!(one.len(), other.len());
    for (row, (one, other)) in one.iter().zip(other).enumerate() {
        assert!(
            (one - other).abs() <= tolerance,
            "{what}, row {row}: {one} {other}"
        );
    }
}

/// Length from the first cable's anchor to the handle with the joints at `angles`.
fn length_m(device: &Device, angles: &[f64]) -> f64 {
    let mut evaluation = Evaluation::new(device);
    evaluation.move_outputs(angles).expect("a pose");
    let position_m = evaluation.pose().expect("a pose").position_m;
    distance_m(&position_m, &Vector3::from(device.cables[0].anchor_m)).expect("a way")
}

/// Outputs of a row; of a joint without an encoder the model's.
fn outputs(device: &Device, recording: &Recording, row: usize) -> Vec<f64> {
    let evaluation = at_row(device, recording, row);
    (0..4)
        .map(|joint| match &recording.output[joint] {
            Some(column) => column[row],
            None => evaluation.output_rad(joint),
        })
        .collect()
}

#[test]
fn a_stretching_cable_leaves_the_output_behind_by_torque_over_stiffness() {
    let (device, stiffness) = (heavy_arm(), 260.0);
    let clean = with(Vec::new());
    let soft = with(vec![Effect::CapstanCompliance {
        joint: 2,
        stiffness_nm_per_rad: stiffness,
    }]);
    assert_eq!(soft.joint, clean.joint);
    same(output(&soft, 0), output(&clean, 0), 0.0, "joint 1");
    let want: Vec<f64> = output(&clean, 1)
        .iter()
        .zip(torque(&soft, 1))
        .map(|(output, torque)| output - torque / stiffness)
        .collect();
    same(output(&soft, 1), &want, ROUNDING, "joint 2");
    assert!(largest(torque(&soft, 1).iter().copied()) > 1.0);
    for row in (0..soft.len()).step_by(50) {
        let length_m = length_m(&device, &outputs(&device, &soft, row));
        assert!((cable(&soft)[row] - length_m).abs() < ROUNDING);
    }
}

#[test]
fn a_soft_link_gives_behind_its_encoder() {
    let (device, stiffness) = (heavy_arm(), 300.0);
    let clean = with(Vec::new());
    let soft = with(vec![Effect::JointCompliance {
        joint: 1,
        stiffness_nm_per_rad: stiffness,
    }]);
    assert_eq!((&soft.joint, &soft.output), (&clean.joint, &clean.output));
    for row in (0..soft.len()).step_by(50) {
        let mut angles = outputs(&device, &soft, row);
        angles[0] -= torque(&soft, 0)[row] / stiffness;
        assert!((cable(&soft)[row] - length_m(&device, &angles)).abs() < ROUNDING);
    }
    assert!(largest(cable(&soft).iter().zip(cable(&clean)).map(|(a, b)| a - b)) > 1e-4);
}

/// Width and constancy of a loop: the gap stays in +-width/2 and reaches both ends.
fn loop_of(gaps: &[f64], width: f64) {
    assert!(gaps.iter().all(|gap| gap.abs() <= width / 2.0 + ROUNDING));
    for end in [-0.5, 0.5] {
        let at_end = gaps
            .iter()
            .filter(|gap| (*gap - end * width).abs() < ROUNDING)
            .count();
        assert!(
            at_end > gaps.len() / 10,
            "{at_end} rows at {end} of the width"
        );
    }
}

#[test]
fn play_driven_by_the_motor_moves_the_output_and_by_the_hand_the_motor() {
    let (device, width) = (heavy_arm(), 3e-3);
    let clean = with(Vec::new());
    let play = |driven_by| {
        with(vec![Effect::Backlash {
            joint: 1,
            width_rad: width,
            driven_by,
        }])
    };
    let gaps = |recording: &Recording| -> Vec<f64> {
        (0..recording.len())
            .map(|row| output(recording, 0)[row] - at_row(&device, recording, row).output_rad(0))
            .collect()
    };
    let motor = play(Driver::Motor);
    assert_eq!(motor.joint, clean.joint);
    loop_of(&gaps(&motor), width);
    let hand = play(Driver::Hand);
    assert_eq!(hand.output, clean.output);
    same(
        cable(&hand),
        cable(&clean),
        0.0,
        "the link is where the hand wants it",
    );
    loop_of(&gaps(&hand), width);
    assert_ne!(hand.joint[0], clean.joint[0]);
    assert_eq!(hand.joint[1], clean.joint[1]);
    // a motor that leads leaves the output behind, a hand that leads leaves the motor behind
    let rising = (1..clean.len())
        .find(|&row| clean.joint[0][row] > 0.3 && clean.joint[0][row] > clean.joint[0][row - 1])
        .expect("a way up");
    assert!(gaps(&motor)[rising] < 0.0 && gaps(&hand)[rising] > 0.0);
}

#[test]
fn friction_strains_by_its_amplitude_after_a_long_way_and_not_at_first() {
    let (device, amplitude) = (heavy_arm(), 7e-4);
    let recording = with(vec![Effect::Hysteresis {
        joint: 1,
        amplitude_rad: amplitude,
        transition_rad: 0.02,
        driven_by: Driver::Motor,
    }]);
    let strain =
        |row: usize| output(&recording, 0)[row] - at_row(&device, &recording, row).output_rad(0);
    assert_eq!(strain(0), 0.0);
    let far = (1..recording.len())
        .find(|&row| recording.joint[0][row].abs() > 0.5)
        .expect("a long way");
    let direction = recording.joint[0][far].signum();
    // 0.5 rad are 25 transitions
    assert!((strain(far) + direction * amplitude).abs() < 1e-9);
    assert!((0..recording.len()).all(|row| strain(row).abs() <= amplitude * (1.0 + 1e-9)));
}

#[test]
fn a_viscous_load_leaves_the_output_behind_by_delay_times_speed() {
    let (device, delay_s) = (heavy_arm(), 0.003);
    let recording = with(vec![Effect::ViscousLag { joint: 2, delay_s }]);
    let readings = &recording.joint[1];
    for row in (1..recording.len() - 1).step_by(11) {
        let speed = (readings[row + 1] - readings[row - 1]) * 100.0;
        let behind = output(&recording, 1)[row] - at_row(&device, &recording, row).output_rad(1);
        // a difference over 10 ms of a jerk below 100 rad/s^3
        assert!((behind + delay_s * speed).abs() < delay_s * 2e-3);
    }
}

#[test]
fn lost_counts_make_the_reading_too_high_from_their_time_on() {
    let device = heavy_arm();
    let clean = with(Vec::new());
    let count = device.joints[1].reading_quantum_rad().expect("counts");
    let step = |counts, time_s| Effect::EncoderCountLoss {
        joint: 2,
        counts,
        time_s,
    };
    let lost = with(vec![step(40.0, 5.0), step(-15.0, 8.0)]);
    for (row, time_s) in time(&lost).iter().enumerate() {
        let counts = match time_s {
            t if *t < 5.0 => 0.0,
            t if *t < 8.0 => 40.0,
            _ => 25.0,
        };
        let shift = lost.joint[1][row] - clean.joint[1][row];
        assert!(
            (shift - counts * count).abs() < ROUNDING,
            "{time_s}: {shift}"
        );
    }
    assert_eq!(
        (&lost.output, &lost.cable_m),
        (&clean.output, &clean.cable_m)
    );
}

#[test]
fn drifts_and_offsets_are_proportional_to_time_or_warmth() {
    let clean = with(Vec::new());
    let drifting = with(vec![
        Effect::JointDrift {
            joint: 1,
            rad_per_s: Some(2e-5),
            rad_per_degc: None,
        },
        Effect::JointDrift {
            joint: 2,
            rad_per_s: None,
            rad_per_degc: Some(3e-4),
        },
    ]);
    let warm = drifting.temperature_degc.as_ref().expect("a temperature");
    let times = time(&clean);
    for row in 0..clean.len() {
        let shift = |joint: usize| output(&drifting, joint)[row] - output(&clean, joint)[row];
        assert!((shift(0) - 2e-5 * times[row]).abs() < ROUNDING);
        assert!((shift(1) - 3e-4 * (warm[row] - 22.0)).abs() < ROUNDING);
    }
    assert!((warm[2399] - (22.0 + 4.0 * (1.0 - (-11.995_f64 / 60.0).exp()))).abs() < 1e-12);
    let cables = with(vec![
        Effect::CableZeroOffset { offset_m: 2e-3 },
        Effect::CableDrift { m_per_s: 1e-5 },
        Effect::ThermalDrift { m_per_degc: 4e-5 },
    ]);
    for row in 0..clean.len() {
        let want = 2e-3 + 1e-5 * times[row] + 4e-5 * (warm[row] - 22.0);
        assert!((cable(&cables)[row] - cable(&clean)[row] - want).abs() < ROUNDING);
    }
    // of a second cable nothing is said
    assert_eq!(cables.cable_m[1], clean.cable_m[1]);
}

#[test]
fn late_channels_show_the_motion_of_an_earlier_time() {
    let clean = with(Vec::new());
    // five and a half rows: between two of them
    let (delay_s, rows) = (0.0275, 5);
    let late = with(vec![
        Effect::EncoderLatency { delay_s },
        Effect::CableLatency { delay_s },
        Effect::ExternalEncoderLatency { joint: 2, delay_s },
    ]);
    let shifted = |one: &[f64], other: &[f64]| {
        for row in rows + 2..one.len() - 1 {
            let at = |back: usize| one[row - back];
            // a cubic through the four rows around the instant
            let want = (9.0 * (at(rows) + at(rows + 1)) - at(rows - 1) - at(rows + 2)) / 16.0;
            assert!(
                (other[row] - want).abs() < 2e-7,
                "{row}: {} {want}",
                other[row]
            );
        }
    };
    for joint in 0..4 {
        shifted(&clean.joint[joint], &late.joint[joint]);
    }
    shifted(cable(&clean), cable(&late));
    shifted(output(&clean, 1), output(&late, 1));
    assert_eq!(late.output[0], clean.output[0]);
    assert_eq!(
        (&late.cable_m[1], &late.torque_nm),
        (&clean.cable_m[1], &clean.torque_nm)
    );
}
