//! What is said where columns are absent or constant.

use haptical_diagnosis::{Diagnosis, Options, Untestable, Verdict, diagnose};
use haptical_model::{Device, Recording};

use crate::arm::{
    Errors, Session, YIELDING_JOINT, assert_named, device, diagnosed, every, record,
    record_yielding, summary,
};

/// Why effects of a name are not tested, at any joint.
fn reasons<'d>(diagnosis: &'d Diagnosis, effect: &str) -> Vec<&'d Untestable> {
    diagnosis
        .untestable
        .iter()
        .filter(|entry| entry.effect == effect)
        .collect()
}

fn assert_untestable(diagnosis: &Diagnosis, effects: &[&str], reason: &str) {
    for effect in effects {
        let found = reasons(diagnosis, effect);
        assert!(!found.is_empty(), "{effect} is tested");
        assert!(
            found.iter().any(|entry| entry.why.contains(reason)),
            "{effect}: {found:?}"
        );
    }
}

#[test]
fn without_time_effects_in_time_are_untestable() {
    let mut recording = record_yielding(&Session::default());
    recording.time_s = None;
    let diagnosis = diagnosed(&recording);
    let in_time = [
        "viscous-lag",
        "encoder-latency",
        "cable-latency",
        "external-encoder-latency",
        "encoder-count-loss",
        "cable-count-loss",
        "external-encoder-count-loss",
        "capstan-slip",
        "cable-drift",
        "external-encoder-drift",
        "joint-drift",
    ];
    assert_untestable(&diagnosis, &in_time, "t_s");
    // what has nothing to do with time is still named
    let joint = Some(YIELDING_JOINT + 1);
    assert_named(
        &diagnosis,
        "capstan-compliance",
        joint,
        "stiffness_nm_per_rad",
    );
}

#[test]
fn constant_covariates_are_as_good_as_absent() {
    let mut recording = record(&Session::default(), |_| Errors::default());
    let rows = recording.len();
    recording.temperature_degc = Some(vec![23.0; rows]);
    recording.torque_nm[0] = Some(vec![0.4; rows]);
    let diagnosis = diagnosed(&recording);
    assert_untestable(
        &diagnosis,
        &["thermal-drift", "joint-drift"],
        "temp_degc is constant",
    );
    assert_untestable(&diagnosis, &["capstan-compliance"], "is constant");
    for entry in reasons(&diagnosis, "capstan-compliance") {
        assert!(
            entry.why.contains("torque") && entry.joints == [1],
            "{entry:?}"
        );
    }
    assert_eq!(diagnosis.verdict, Verdict::NoGap, "{}", summary(&diagnosis));
}

#[test]
fn absent_columns_are_named() {
    let mut recording = record(&Session::default(), |_| Errors::default());
    recording.torque_nm = vec![None; 3];
    let diagnosis = diagnosed(&recording);
    assert_untestable(
        &diagnosis,
        &["capstan-compliance", "capstan-creep"],
        "torque",
    );
    assert_untestable(&diagnosis, &["thermal-drift"], "temp_degc");
    assert_untestable(&diagnosis, &["tool-compliance"], "fx_n");
    for entry in &diagnosis.untestable {
        assert!(
            !entry.why.is_empty() && entry.joints.iter().all(|joint| *joint >= 1),
            "{entry:?}"
        );
    }
}

#[test]
fn one_run_is_enough_but_tells_nothing_of_a_changed_tool() {
    let session = Session {
        runs: 1,
        rows_of_a_run: 2400,
        ..Session::default()
    };
    let mut recording = record_yielding(&session);
    recording.run = None;
    let diagnosis = diagnosed(&recording);
    assert_untestable(&diagnosis, &["tool-changed"], "one run only");
    let joint = Some(YIELDING_JOINT + 1);
    assert_named(
        &diagnosis,
        "capstan-compliance",
        joint,
        "stiffness_nm_per_rad",
    );
    // contiguous blocks are held out
    assert!(diagnosis.causes[0].held_out.is_some());
}

/// Readings of the encoders alone, as of an arm without a cable.
fn encoders_alone(recording: &Recording) -> Recording {
    let mut alone = recording.clone();
    alone.cable_m = vec![None];
    alone
}

#[test]
fn without_the_cable_the_transmissions_are_diagnosed_alone() {
    let diagnosis = diagnosed(&encoders_alone(&record_yielding(&Session::default())));
    let channels: Vec<&str> = diagnosis
        .gap
        .channels
        .iter()
        .map(|c| c.channel.as_str())
        .collect();
    assert_eq!(channels, ["out1", "out2", "out3"]);
    assert_untestable(
        &diagnosis,
        &["cable-latency", "cable-zero-offset"],
        "cable_m",
    );
    assert_untestable(&diagnosis, &["joint-compliance"], "no distance");
    let first = &diagnosis.causes[0];
    assert_eq!(
        (first.effect.as_str(), first.joint),
        ("capstan-compliance", Some(2))
    );
    assert!(diagnosis.verdict.has_causes(), "{}", summary(&diagnosis));
}

/// Single postures with times: what they drift with is asked, and without links no drift of base or links is.
#[test]
fn single_postures_of_encoders_alone_are_diagnosed() {
    let device = Device {
        links: Vec::new(),
        cables: Vec::new(),
        ..device()
    };
    let recording = every(&encoders_alone(&record_yielding(&Session::default())), 97);
    let diagnosis = diagnose(&device, &recording, &Options::default()).unwrap();
    assert_eq!(diagnosis.gap.channels.len(), 3, "{}", summary(&diagnosis));
    assert_untestable(&diagnosis, &["external-encoder-windup"], "single postures");
}

#[test]
fn empty_cells_are_no_readings() {
    let mut recording = record_yielding(&Session::default());
    let cable = recording.cable_m[0].as_mut().unwrap();
    cable[300..700].fill(f64::NAN);
    let output = recording.output[1].as_mut().unwrap();
    output[1000..1400].fill(f64::NAN);
    for row in (0..2400).filter(|row| row * row % 7 == 2) {
        output[row] = f64::NAN;
    }
    let diagnosis = diagnosed(&recording);
    let joint = Some(YIELDING_JOINT + 1);
    assert_named(
        &diagnosis,
        "capstan-compliance",
        joint,
        "stiffness_nm_per_rad",
    );
    for channel in &diagnosis.gap.channels {
        assert!(
            channel.rms_before.is_finite() && channel.rms_after.is_finite(),
            "{channel:?}"
        );
    }
}

/// An encoder that is read at a lower rate leaves cells empty in step with the rows.
#[test]
fn an_encoder_of_a_lower_rate_is_fitted_too() {
    for step in 2..=5 {
        for first in 0..step {
            let mut recording = record_yielding(&Session::default());
            let output = recording.output[1].as_mut().unwrap();
            for row in (0..2400).filter(|row| row % step != first) {
                output[row] = f64::NAN;
            }
            let diagnosis = diagnosed(&recording);
            let joint = Some(YIELDING_JOINT + 1);
            assert_named(
                &diagnosis,
                "capstan-compliance",
                joint,
                "stiffness_nm_per_rad",
            );
        }
    }
}
