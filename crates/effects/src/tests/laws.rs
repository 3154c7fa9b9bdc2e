//! Laws of delays, steps, plays, drifts and functions of an angle, against the motion itself.

use super::compare::{added, angles, assert_agree, length_m, on, time_s, with_effect};
use super::rig::{RUN, Rig, context, reading, rigs, seven_joints, three_joints};

/// Third-order terms of a delay of 3 ms against its first order, and smoothing over seven rows.
const DELAYED: f64 = 2e-3;

#[test]
fn a_late_channel_shows_what_was_true_before() {
    const DELAY_S: f64 = 3e-3;
    for Rig {
        device, recording, ..
    } in rigs()
    {
        let context = context(&device, &recording);
        let given = [("delay_s", DELAY_S)];
        let cable = added(&context, "cable-latency", None, &given);
        let length = |time_s: f64| length_m(&device, &angles(&device, time_s));
        let late = |row: usize| length(time_s(row) - DELAY_S) - length(time_s(row));
        assert_agree(
            "cable-latency",
            on(&cable, &context, "cable"),
            late,
            DELAYED,
        );

        let angle = |row: usize, shift_s: f64| reading(&device, 0, time_s(row) + shift_s);
        let behind = |row: usize| angle(row, -DELAY_S) - angle(row, 0.0);
        let external = added(&context, "external-encoder-latency", Some(0), &given);
        assert_agree("external", on(&external, &context, "out1"), behind, DELAYED);
        let drive = added(&context, "viscous-lag", Some(0), &given);
        assert_agree("drive", on(&drive, &context, "out1"), behind, DELAYED);
        // late readings: the joint is where the readings will be
        let motors = added(&context, "encoder-latency", None, &given);
        let ahead = |row: usize| angle(row, DELAY_S) - angle(row, 0.0);
        assert_agree("motors", on(&motors, &context, "out1"), ahead, DELAYED);
        let ahead = |row: usize| length(time_s(row) + DELAY_S) - length(time_s(row));
        assert_agree("motors", on(&motors, &context, "cable"), ahead, DELAYED);
    }
}

#[test]
fn a_play_loses_half_its_width_on_either_side() {
    const WIDTH_RAD: f64 = 1e-3;
    let Rig {
        device, recording, ..
    } = seven_joints();
    let context = context(&device, &recording);
    let play = added(&context, "backlash", Some(0), &[("width_rad", WIDTH_RAD)]);
    let lost = on(&play, &context, "out1");
    let readings = &recording.joint[0];
    let mut seen = [0, 0];
    for row in 20..RUN {
        // ten rows of steady motion cross the play
        let steps = (row - 10..row).map(|row| readings[row + 1] - readings[row]);
        let (least, most) = steps.fold((f64::MAX, f64::MIN), |(a, b), step| {
            (a.min(step), b.max(step))
        });
        if least > 2e-4 {
            assert!(
                (lost[row] + 0.5 * WIDTH_RAD).abs() < 1e-12,
                "row {row}: {}",
                lost[row]
            );
            seen[0] += 1;
        } else if most < -2e-4 {
            assert!(
                (lost[row] - 0.5 * WIDTH_RAD).abs() < 1e-12,
                "row {row}: {}",
                lost[row]
            );
            seen[1] += 1;
        }
    }
    assert!(seen[0] > 50 && seen[1] > 50, "{seen:?}");
}

#[test]
fn lost_counts_are_counts_of_the_motor_over_the_ratio() {
    let Rig {
        device, recording, ..
    } = seven_joints();
    let context = context(&device, &recording);
    let step = |name: &str, joint: Option<usize>, stream: &str| {
        let signal = added(&context, name, joint, &[("counts", 60.0), ("time_s", 1.0)]);
        let values = on(&signal, &context, stream);
        assert_eq!((values[99], values[RUN]), (0.0, 0.0));
        values[100]
    };
    let count_rad = std::f64::consts::TAU / 20_000.0;
    let close =
        |found: f64, expected: f64| assert!((found - expected).abs() < 1e-15, "{found} {expected}");
    // a motor-side reading that is too high predicts too much: the streams stay behind it
    close(
        step("encoder-count-loss", Some(0), "out1"),
        -60.0 * count_rad / 8.0,
    );
    close(
        step("encoder-count-loss", Some(3), "out4"),
        -60.0 * count_rad / 12.0,
    );
    close(
        step("external-encoder-count-loss", Some(0), "out1"),
        60.0 * count_rad,
    );
    close(
        step("cable-count-loss", None, "cable"),
        60.0 * count_rad * 0.015,
    );
}

#[test]
fn counts_of_an_encoder_without_counts_are_not_radians() {
    // the second axis here states the standard deviation of its external encoder alone
    let Rig {
        device, recording, ..
    } = three_joints();
    let context = context(&device, &recording);
    let effect = with_effect(&device, "external-encoder-count-loss", Some(1), "counts");
    let step = added(
        &context,
        "external-encoder-count-loss",
        Some(1),
        &[("counts", 1.0)],
    );
    assert!(
        effect.untestable(&context).is_some() || super::size(&step) < 0.1,
        "{}",
        super::size(&step)
    );
}

#[test]
fn drifts_and_growth_have_the_rates_that_they_say() {
    let Rig {
        device, recording, ..
    } = seven_joints();
    let context = context(&device, &recording);
    let temperature = recording.temperature_degc.as_ref().unwrap();
    let mean = temperature.iter().sum::<f64>() / temperature.len() as f64;
    let steady = |row: usize| 2e-5 * (time_s(row) - time_s(row - row % RUN));
    let drive = added(&context, "joint-drift", Some(1), &[("rad_per_s", 2e-5)]);
    assert_agree("drive", on(&drive, &context, "out2"), steady, 1e-12);
    let external = added(
        &context,
        "external-encoder-drift",
        Some(1),
        &[("rad_per_s", 2e-5)],
    );
    assert_agree("encoder", on(&external, &context, "out2"), steady, 1e-12);
    let cable = added(&context, "cable-drift", None, &[("m_per_s", 2e-5)]);
    assert_agree("cable", on(&cable, &context, "cable"), steady, 1e-12);
    // temperatures are averaged over a second; the constant is the base model's
    let warm = added(&context, "joint-drift", Some(1), &[("rad_per_degc", 1e-4)]);
    let warm = on(&warm, &context, "out2");
    let grown = |row: usize| 1e-4 * (temperature[row] - temperature[60]);
    for row in [100, 150, 200, 250, 300] {
        let found = warm[row] - warm[60];
        assert!(
            (found - grown(row)).abs() < 0.05 * 1e-4 * 3.0,
            "row {row}: {found} {}",
            grown(row)
        );
    }
    let middle = warm.iter().sum::<f64>() / warm.len() as f64;
    assert!(middle.abs() < 1e-12 && (mean - 22.0).abs() < 3.0);
}

#[test]
fn functions_of_an_angle_are_those_that_they_say() {
    let Rig {
        device, recording, ..
    } = seven_joints();
    let context = context(&device, &recording);
    let angle = |joint: usize, row: usize| reading(&device, joint, time_s(row));
    let check = |name: &str, joint: usize, given: &[(&str, f64)], law: &dyn Fn(f64) -> f64| {
        let signal = added(&context, name, Some(joint), given);
        let out = format!("out{}", joint + 1);
        assert_agree(
            name,
            on(&signal, &context, &out),
            |row| law(angle(joint, row)),
            1e-12,
        );
    };
    let wave = [("amplitude_rad", 1e-3), ("phase_rad", 0.7), ("order", 3.0)];
    check("drum-out-of-round", 2, &wave[..2], &|q| {
        1e-3 * (2.0 * q - 0.7).cos()
    });
    check("external-encoder-eccentricity", 2, &wave[..2], &|q| {
        1e-3 * (q - 0.7).cos()
    });
    check("device-encoder-eccentricity", 3, &wave[..2], &|q| {
        1e-3 * (12.0 * q - 0.7).cos()
    });
    check("input-drum-harmonic", 2, &wave, &|q| {
        1e-3 * (24.0 * q - 0.7).cos()
    });
    check("cable-pitch", 1, &[("quadratic_per_rad", 2e-3)], &|q| {
        2e-3 * q * q
    });
    let coupled = added(&context, "cross-coupling", Some(1), &[("gain", 2e-3)]);
    assert_agree(
        "coupling",
        on(&coupled, &context, "out2"),
        |row| 2e-3 * angle(0, row),
        1e-12,
    );
    let values = [("width_rad", 2e-3), ("play_rad", 0.1), ("from_joint", 1.0)];
    let shown = added(&context, "coupled-backlash", Some(1), &values);
    let lost = crate::signal::play(&context.recording.joint[0], 0.05, &context.runs);
    assert_agree(
        "coupled play",
        on(&shown, &context, "out2"),
        |row| 1e-3 / 0.05 * lost[row],
        1e-12,
    );
    // a ratio deviation is eq. (1)'s, to first order in deviation over ratio
    check("ratio-error", 1, &[("ratio_deviation", 1e-3)], &|q| {
        -1e-3 / 8.0 * q
    });
}
