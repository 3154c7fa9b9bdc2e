//! Recordings that fix nothing, and names that do not exist.

use haptical_diagnosis::{DiagnosisError, Options, diagnose, effect_names};

use crate::arm::{Errors, Session, device, record};

#[test]
fn too_few_rows_are_refused_as_such() {
    for rows_of_a_run in [1, 2, 4] {
        let session = Session {
            runs: 1,
            rows_of_a_run,
            ..Session::default()
        };
        let recording = record(&session, |_| Errors::default());
        let error = diagnose(&device(), &recording, &Options::default()).unwrap_err();
        assert!(error.is_unidentifiable(), "{rows_of_a_run} rows: {error}");
        assert!(error.to_string().len() > 20, "{error}");
    }
}

#[test]
fn a_device_at_rest_is_refused() {
    let mut recording = record(&Session::default(), |_| Errors::default());
    for column in &mut recording.joint {
        let rest = column[0];
        column.fill(rest);
    }
    let error = diagnose(&device(), &recording, &Options::default()).unwrap_err();
    assert!(error.is_unidentifiable(), "{error}");
}

#[test]
fn an_unknown_effect_is_refused_with_the_nearest_name() {
    let recording = record(&Session::default(), |_| Errors::default());
    let options = Options {
        without: vec!["capstan-complience".to_owned()],
        ..Options::default()
    };
    let error = diagnose(&device(), &recording, &options).unwrap_err();
    assert!(
        matches!(&error, DiagnosisError::UnknownEffect { .. }),
        "{error:?}"
    );
    assert!(
        error
            .to_string()
            .contains("did you mean `capstan-compliance`"),
        "{error}"
    );
    assert!(!error.is_unidentifiable());
}

#[test]
fn every_name_can_be_left_out() {
    let names = effect_names();
    assert!(names.len() > 50, "{}", names.len());
    let session = Session {
        rows_of_a_run: 300,
        ..Session::default()
    };
    let recording = record(&session, |_| Errors::default());
    let options = Options {
        without: names.iter().map(|name| (*name).to_owned()).collect(),
        ..Options::default()
    };
    let diagnosis = diagnose(&device(), &recording, &options).unwrap();
    assert!(diagnosis.causes.is_empty());
    assert_eq!(diagnosis.provenance.tested, 0);
}

#[test]
fn the_alias_of_joint_compliance_is_known() {
    let session = Session {
        rows_of_a_run: 300,
        ..Session::default()
    };
    let recording = record(&session, |_| Errors::default());
    let options = Options {
        without: vec!["link-compliance".to_owned()],
        ..Options::default()
    };
    let diagnosis = diagnose(&device(), &recording, &options).unwrap();
    assert!(
        !diagnosis
            .detectable
            .iter()
            .any(|entry| entry.effect == "joint-compliance")
    );
}
