//! Recordings with one effect or two, named or rightly not.

use haptical_diagnosis::{Options, Verdict, diagnose};
use haptical_model::Recording;

use crate::arm::{
    Errors, STIFFNESS_NM_PER_RAD, Session, YIELDING_JOINT, assert_named, assert_near, device,
    diagnosed, every, motion_rad, record, record_yielding, summary,
};

/// Relative standard deviations of a stiffness: the scale of the torque, and a spring that is not quite
/// linear (docs/diagnosis.md, "Families and law errors").
const TORQUE_SCALE: f64 = 0.03;
const SPRING_LAW: f64 = 0.06;

#[test]
fn a_yielding_capstan_cable_is_named_with_its_stiffness() {
    for seed in [1, 2, 3] {
        let session = Session {
            seed,
            ..Session::default()
        };
        let diagnosis = diagnosed(&record_yielding(&session));
        let joint = Some(YIELDING_JOINT + 1);
        let (value, [low, high]) = assert_named(
            &diagnosis,
            "capstan-compliance",
            joint,
            "stiffness_nm_per_rad",
        );
        assert!(
            (low..=high).contains(&STIFFNESS_NM_PER_RAD),
            "{value} [{low}, {high}]"
        );
        // the interval is that of the torque's scale and the law, and hardly more
        let half = 0.5 * (high - low) / value;
        let stated = 1.96 * TORQUE_SCALE.hypot(SPRING_LAW);
        assert!((stated..1.05 * stated).contains(&half), "{half}");
        // torques are exact here
        assert!((value / STIFFNESS_NM_PER_RAD - 1.0).abs() < 0.02, "{value}");
        let cause = &diagnosis.causes[0];
        assert!(
            cause.plausible && cause.probability > 0.9,
            "{}",
            summary(&diagnosis)
        );
        assert!(
            diagnosis.unexplained_share < 0.02,
            "{}",
            diagnosis.unexplained_share
        );
    }
}

#[test]
fn half_of_the_rows_give_the_same_name() {
    let diagnosis = diagnosed(&every(&record_yielding(&Session::default()), 2));
    let joint = Some(YIELDING_JOINT + 1);
    let found = assert_named(
        &diagnosis,
        "capstan-compliance",
        joint,
        "stiffness_nm_per_rad",
    );
    assert_near(found, STIFFNESS_NM_PER_RAD);
}

#[test]
fn a_name_that_was_left_out_is_not_replaced_by_another() {
    let recording = record_yielding(&Session::default());
    let options = Options {
        without: vec!["capstan-compliance".to_owned()],
        ..Options::default()
    };
    let diagnosis = diagnose(&device(), &recording, &options).unwrap();
    assert_eq!(
        diagnosis.verdict,
        Verdict::Unknown,
        "{}",
        summary(&diagnosis)
    );
    assert_eq!(diagnosis.provenance.without, ["capstan-compliance"]);
    let place = diagnosis.place.unwrap();
    assert_eq!((place.channel.as_str(), place.joint), ("out2", Some(2)));
    assert_eq!(
        place.depends_on.first().map(String::as_str),
        Some("torque2_nm")
    );
}

#[test]
fn an_effect_of_no_catalogue_is_unknown_and_located() {
    // a dent in the drum of joint 1, 0.06 rad wide
    let session = Session::default();
    let recording = record(&session, |at| {
        let mut errors = Errors::default();
        let across = (at.reading_rad[0] - 0.3) / 0.06;
        errors.transmission_rad[0] = 2e-3 * (-0.5 * across * across).exp();
        errors
    });
    let diagnosis = diagnosed(&recording);
    assert_eq!(
        diagnosis.verdict,
        Verdict::Unknown,
        "{}",
        summary(&diagnosis)
    );
    let place = diagnosis.place.unwrap();
    assert_eq!((place.channel.as_str(), place.joint), ("out1", Some(1)));
    assert_eq!(
        place.depends_on.first().map(String::as_str),
        Some("theta1_rad")
    );
    // "near 0.3 rad": to a tenth
    assert!(
        ["0.2", "0.3"]
            .iter()
            .any(|place_rad| place.region.contains(place_rad)),
        "{}",
        place.region
    );
}

#[test]
fn compliance_behind_the_encoder_is_told_from_that_before_it() {
    let recording = record(&Session::default(), |at| {
        let mut errors = Errors::default();
        errors.joint_rad[1] = -at.torque_nm[1] / 400.0;
        errors
    });
    let diagnosis = diagnosed(&recording);
    let found = assert_named(
        &diagnosis,
        "joint-compliance",
        Some(2),
        "stiffness_nm_per_rad",
    );
    assert_near(found, 400.0);
}

#[test]
fn a_late_external_encoder_is_told_from_a_slow_drive() {
    const DELAY_S: f64 = 4e-3;
    let late =
        |at: &crate::arm::Instant| motion_rad(2, at.time_s - DELAY_S) - motion_rad(2, at.time_s);
    let recording = record(&Session::default(), |at| {
        let mut errors = Errors::default();
        errors.encoder_rad[2] = late(at);
        errors
    });
    let diagnosis = diagnosed(&recording);
    let found = assert_named(&diagnosis, "external-encoder-latency", Some(3), "delay_s");
    assert_near(found, DELAY_S);

    let recording = record(&Session::default(), |at| {
        let mut errors = Errors::default();
        errors.transmission_rad[2] = late(at);
        errors
    });
    let found = assert_named(&diagnosed(&recording), "viscous-lag", Some(3), "delay_s");
    assert_near(found, DELAY_S);
}

#[test]
fn lost_counts_are_counted_and_timed() {
    const COUNTS: f64 = 40.0;
    let step_rad = std::f64::consts::TAU / 20_000.0 / 8.0;
    let recording = record(&Session::default(), |at| {
        let mut errors = Errors::default();
        // in the second run, from 7 s on
        if at.time_s > 30.0 && at.elapsed_s >= 7.0 {
            errors.transmission_rad[0] = COUNTS * step_rad;
        }
        errors
    });
    let diagnosis = diagnosed(&recording);
    let (counts, interval) = assert_named(&diagnosis, "encoder-count-loss", Some(1), "counts");
    // which way counts are lost is a matter of the sign's meaning
    assert_near((counts, interval), COUNTS * counts.signum());
    assert!((counts.abs() - COUNTS).abs() < 1.0, "{counts}");
    let time = diagnosis.causes[0].parameters["time_s"];
    assert!((time.value - (52.0 + 7.0)).abs() < 0.05, "{time:?}");
}

/// A play of joint 3 that its motor drives.
fn record_play(width_rad: f64) -> Recording {
    let state = std::cell::Cell::new(0.0);
    record(&Session::default(), |at| {
        let reading = at.reading_rad[2];
        if at.elapsed_s == 0.0 {
            state.set(reading);
        }
        let played = state
            .get()
            .clamp(reading - 0.5 * width_rad, reading + 0.5 * width_rad);
        state.set(played);
        let mut errors = Errors::default();
        errors.transmission_rad[2] = played - reading;
        errors
    })
}

#[test]
fn play_is_found_with_its_width_as_itself_or_its_twin() {
    const WIDTH_RAD: f64 = 1.5e-3;
    let diagnosis = diagnosed(&record_play(WIDTH_RAD));
    let summary = summary(&diagnosis);
    assert_ne!(diagnosis.verdict, Verdict::Unknown, "{summary}");
    let cause = &diagnosis.causes[0];
    assert_eq!(
        (diagnosis.causes.len(), cause.joint),
        (1, Some(3)),
        "{summary}"
    );
    // a loop of half the width on either side is what both laws say away from reversals
    let found_rad = match cause.effect.as_str() {
        "backlash" => cause.parameters["width_rad"].value,
        "hysteresis" => 2.0 * cause.parameters["amplitude_rad"].value,
        _ => panic!("{summary}"),
    };
    assert!((found_rad / WIDTH_RAD - 1.0).abs() < 0.02, "{found_rad}");
}

#[test]
fn play_is_told_from_hysteresis() {
    let diagnosis = diagnosed(&record_play(1.5e-3));
    assert_named(&diagnosis, "backlash", Some(3), "width_rad");
}

#[test]
fn two_effects_are_both_found() {
    let recording = record(&Session::default(), |at| {
        let mut errors = Errors::default();
        errors.transmission_rad[1] = -at.torque_nm[1] / STIFFNESS_NM_PER_RAD;
        errors.encoder_rad[2] = motion_rad(2, at.time_s - 4e-3) - motion_rad(2, at.time_s);
        errors
    });
    let diagnosis = diagnosed(&recording);
    let mut found: Vec<(&str, Option<usize>)> = diagnosis
        .causes
        .iter()
        .map(|cause| (cause.effect.as_str(), cause.joint))
        .collect();
    found.sort_unstable();
    assert_eq!(
        found,
        [
            ("capstan-compliance", Some(2)),
            ("external-encoder-latency", Some(3))
        ],
        "{}",
        summary(&diagnosis)
    );
}

#[test]
fn the_shrink_is_measured_on_rows_that_the_fit_did_not_see() {
    let recording = record_yielding(&Session::default());
    let session = Session {
        seed: 5,
        start_s: 300.0,
        ..Session::default()
    };
    let other = record_yielding(&session);
    let options = Options {
        validation: Some(&other),
        ..Options::default()
    };
    let diagnosis = diagnose(&device(), &recording, &options).unwrap();
    let held_out = diagnosis.causes[0].held_out.clone().unwrap();
    assert_eq!(
        (held_out.channel.as_str(), held_out.unit.as_str()),
        ("out2", "rad")
    );
    // torque over stiffness is 1.7 mrad rms, noise 0.1 mrad
    let reduction = held_out.reduction_percent.unwrap();
    assert!(reduction > 95.0, "{held_out:?}");
    assert!(
        held_out.rms_after < 1.1 * held_out.noise_floor,
        "{held_out:?}"
    );
    let channels: Vec<&str> = diagnosis
        .predictions
        .iter()
        .map(|p| p.channel.as_str())
        .collect();
    let rows = channels
        .iter()
        .filter(|channel| **channel == "out2")
        .count();
    assert_eq!(rows, other.len());
    let first = diagnosis
        .predictions
        .iter()
        .find(|p| p.channel == "out2")
        .unwrap();
    assert_eq!(first.measured, other.output[1].as_ref().unwrap()[first.row]);
}
