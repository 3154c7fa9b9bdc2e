//! An arm that sags, diagnosed with a device file that has masses, and with one that has none.

use haptical_diagnosis::{Diagnosis, Options, Verdict, diagnose};
use haptical_model::{Device, Recording, Statics};

use crate::postures::{POSITION_SD_M, device, recorded_with};

/// Of the second and the third joint.
const STIFFNESSES_NM_PER_RAD: [f64; 2] = [9e3, 4e3];

fn without_torques(mut recording: Recording) -> Recording {
    recording.torque_nm.iter_mut().for_each(|own| *own = None);
    recording
}

fn weightless() -> Device {
    let mut device = device();
    device.bodies.iter_mut().for_each(|own| *own = None);
    device
}

fn diagnosed(device: &Device, recording: &Recording) -> Diagnosis {
    diagnose(device, recording, &Options::default()).unwrap()
}

fn is_told(diagnosis: &Diagnosis) -> bool {
    let mut warnings = diagnosis.warnings.iter();
    warnings.any(|own| own.starts_with("what bends under its load was not tested"))
}

#[test]
fn a_sag_is_named_with_masses_and_without_them_nothing_is_sure() {
    let heavy = device();
    let recording = without_torques(recorded_with(5, POSITION_SD_M, |posture, link| {
        let mut statics = Statics::new(&heavy);
        let load = statics.load(posture.reading, |_| None).unwrap();
        for (joint, stiffness) in [1, 2].into_iter().zip(STIFFNESSES_NM_PER_RAD) {
            link[joint] -= load.torques_nm[joint] / stiffness;
        }
        Default::default()
    }));
    let with = diagnosed(&heavy, &recording);
    let mut names = with.causes.iter().map(|cause| cause.effect.as_str());
    assert!(
        names.all(|name| name == "joint-compliance"),
        "{:?}",
        with.causes
    );
    assert!(!with.causes.is_empty() && !is_told(&with));
    let without = diagnosed(&weightless(), &recording);
    assert_ne!(without.verdict, Verdict::NoGap);
    assert_ne!(without.verdict, Verdict::Named, "{:?}", without.causes);
    for cause in &without.causes {
        assert!(cause.probability <= 0.5, "{cause:?}");
        let mut beside = cause.confusable_with.iter();
        assert!(beside.any(|name| name == "joint-compliance"), "{cause:?}");
    }
    assert!(!without.causes.is_empty() && is_told(&without));
    assert!(without.next_experiment.unwrap().contains("`mass_kg`"));
}

/// Nothing bends about a vertical axis under weights.
#[test]
fn what_no_weight_explains_is_as_sure_as_with_masses() {
    let recording = without_torques(recorded_with(6, POSITION_SD_M, |posture, link| {
        link[0] += 1.5e-3 * (posture.reading[0] - 0.4).sin();
        Default::default()
    }));
    let [with, without] = [device(), weightless()].map(|own| diagnosed(&own, &recording));
    for diagnosis in [&with, &without] {
        assert_eq!(diagnosis.verdict, Verdict::Named, "{:?}", diagnosis.causes);
        assert_eq!(diagnosis.causes[0].joint, Some(1));
        assert!(!is_told(diagnosis));
    }
    assert_eq!(with.causes[0].effect, without.causes[0].effect);
}
