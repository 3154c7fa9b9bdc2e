//! A model that was identified beside an effect: the effect is named, and not the numbers that it bent.

use haptical_diagnosis::{Diagnosis, Options, Verdict, diagnose};
use haptical_model::{Device, ParameterId};

use crate::arm::{
    STIFFNESS_NM_PER_RAD, Session, YIELDING_JOINT, assert_named, assert_near, device, diagnosed,
    record_yielding, summary,
};

fn against(model: &Device) -> Diagnosis {
    let fresh = record_yielding(&Session {
        seed: 7,
        rows_of_a_run: 3700,
        ..Session::default()
    });
    let options = Options {
        model: Some(model),
        ..Options::default()
    };
    diagnose(&device(), &fresh, &options).unwrap()
}

fn calibrated_beside_the_effect() -> Device {
    diagnosed(&record_yielding(&Session::default())).device
}

#[test]
fn numbers_that_a_cause_had_bent_are_no_causes() {
    let diagnosis = against(&calibrated_beside_the_effect());
    let joint = Some(YIELDING_JOINT + 1);
    let found = assert_named(
        &diagnosis,
        "capstan-compliance",
        joint,
        "stiffness_nm_per_rad",
    );
    assert_near(found, STIFFNESS_NM_PER_RAD);
    assert_eq!(diagnosis.causes.len(), 1, "{}", summary(&diagnosis));
    let absorbed = diagnosis.absorbed.unwrap();
    let share = absorbed.share.unwrap();
    assert!((0.05..0.999).contains(&share), "{share}");
    assert!(!absorbed.moved.is_empty());
    for number in &absorbed.moved {
        let [low, high] = number.value.ci95;
        assert!(!(low..=high).contains(&number.earlier), "{number:?}");
        assert!(!number.unit.is_empty(), "{number:?}");
    }
}

#[test]
fn a_number_that_changed_beside_the_effect_stays_a_cause() {
    let mut model = calibrated_beside_the_effect();
    let changed = ParameterId::Transmission { joint: 0, index: 1 };
    let value = changed.value(&model) + 0.5;
    changed.set(&mut model, value);
    let diagnosis = against(&model);
    assert_eq!(diagnosis.verdict, Verdict::Named, "{}", summary(&diagnosis));
    let has = |name: &str, joint: usize| {
        let mut causes = diagnosis.causes.iter();
        causes.any(|cause| cause.effect == name && cause.joint == Some(joint))
    };
    assert!(
        has("ratio-error", 1) && has("capstan-compliance", YIELDING_JOINT + 1),
        "{}",
        summary(&diagnosis)
    );
}

#[test]
fn a_model_that_holds_absorbed_nothing() {
    let diagnosis = diagnosed(&record_yielding(&Session::default()));
    assert_eq!(diagnosis.absorbed, None);
}
