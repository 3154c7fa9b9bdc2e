//! Recordings with more than one effect, or one beyond all measure.

use haptical_diagnosis::{Diagnosis, Verdict};

use crate::arm::{Errors, Session, assert_named, assert_near, diagnosed, record, summary};

fn found(diagnosis: &Diagnosis) -> Vec<(&str, Option<usize>)> {
    let mut found: Vec<(&str, Option<usize>)> = diagnosis
        .causes
        .iter()
        .map(|cause| (cause.effect.as_str(), cause.joint))
        .collect();
    found.sort_unstable();
    found
}

/// Counts lost three times the same way: the best single step is in the middle of the ramp that they
/// resemble.
#[test]
fn a_staircase_of_lost_counts_is_no_drift() {
    const STEP_RAD: f64 = 1e-3;
    let session = Session {
        runs: 1,
        rows_of_a_run: 3000,
        ..Session::default()
    };
    let recording = record(&session, |at| {
        let mut errors = Errors::default();
        let steps = [8.0, 15.5, 22.0]
            .iter()
            .filter(|time| at.elapsed_s >= **time);
        errors.encoder_rad[1] = STEP_RAD * steps.count() as f64;
        errors
    });
    let diagnosis = diagnosed(&recording);
    let counts = assert_named(&diagnosis, "external-encoder-count-loss", Some(2), "counts");
    assert_near(counts, STEP_RAD * 20_000.0 / std::f64::consts::TAU);
}

/// A step's law cannot be judged while another effect is still in the data.
#[test]
fn lost_counts_are_found_beside_a_drift_at_another_joint() {
    let session = Session {
        runs: 1,
        rows_of_a_run: 3000,
        ..Session::default()
    };
    let recording = record(&session, |at| {
        let mut errors = Errors::default();
        errors.encoder_rad[1] = if at.elapsed_s >= 11.0 { 8e-4 } else { 0.0 };
        errors.transmission_rad[0] = 4e-5 * at.elapsed_s;
        errors
    });
    let diagnosis = diagnosed(&recording);
    assert_eq!(
        found(&diagnosis),
        [
            ("external-encoder-count-loss", Some(2)),
            ("joint-drift", Some(1))
        ],
        "{}",
        summary(&diagnosis)
    );
}

/// An error a thousand times the noise drives the base model's fit anywhere; the answer is the effect with a
/// flag, or that nothing can be said, but never another name.
#[test]
fn an_effect_beyond_all_measure_is_flagged_or_refused() {
    let recording = record(&Session::default(), |at| {
        let mut errors = Errors::default();
        errors.encoder_rad[1] = 8e-3 * at.elapsed_s;
        errors
    });
    match haptical_diagnosis::diagnose(
        &crate::arm::device(),
        &recording,
        &haptical_diagnosis::Options::default(),
    ) {
        Ok(diagnosis) => {
            let summary = summary(&diagnosis);
            assert_ne!(diagnosis.verdict, Verdict::NoGap, "{summary}");
            let first = &diagnosis.causes[0];
            assert_eq!(
                (first.effect.as_str(), first.joint, first.implausible),
                ("external-encoder-drift", Some(2), true),
                "{summary}"
            );
        }
        Err(error) => assert!(error.is_unidentifiable(), "{error}"),
    }
}
