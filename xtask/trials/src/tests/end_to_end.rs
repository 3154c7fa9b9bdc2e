//! Two trials from the seal to the score.

use xtask_blind::{Suite, sha256_hex};

use crate::batch::Batch;

fn batch() -> Batch {
    Batch {
        seed: 3,
        trials: vec![(Suite::Clean, 0), (Suite::Singles, 0)],
        jobs: 2,
        haptical: None,
    }
}

#[test]
fn a_seal_is_opened_with_its_truth_alone() {
    let batch = batch();
    let sealed = batch.seal().unwrap();
    let published = batch.commitments(&sealed);
    let by_hand = |number: usize| {
        let sealed: &xtask_blind::Sealed = &sealed[number];
        sha256_hex(&format!("{}\n{}", sealed.salt, sealed.truth_json))
    };
    assert_eq!(published[0].commitment, by_hand(0));
    assert_eq!(published[1].commitment, by_hand(1));

    let alone = Batch {
        trials: vec![(Suite::Singles, 0)],
        ..batch.clone()
    };
    let again = alone.commitments(&alone.seal().unwrap());
    assert_eq!(again[0], published[1], "the same when it is run alone");

    let mut swapped = sealed.clone();
    swapped.swap(0, 1);
    assert!(
        batch.diagnose(&swapped).is_err(),
        "other trials than were sealed"
    );
    let other = Batch { seed: 4, ..alone };
    assert_ne!(other.seal().unwrap()[0].commitment, published[1].commitment);
}

#[test]
fn two_trials_are_sealed_answered_opened_and_judged() {
    let batch = batch();
    let sealed = batch.seal().unwrap();
    let published = batch.commitments(&sealed);
    let rehearsal = batch.rehearse().unwrap();
    let fixed = batch.diagnose(&sealed).unwrap();
    assert!(rehearsal.agrees(&fixed), "one core and all cores");
    assert!(!rehearsal.agrees(&fixed[..1]), "an answer is missing");
    let answers = batch.answers(&fixed);

    let mut forged = sealed.clone();
    forged[1].truth_json = forged[1]
        .truth_json
        .replacen("\"index\":0", "\"index\":7", 1);
    assert_ne!(forged[1], sealed[1]);
    let refused = batch.open(&published, forged, batch.diagnose(&sealed).unwrap());
    assert!(refused.is_err(), "a truth changed after the commitment");

    let cases = batch.open(&published, sealed, fixed).unwrap();
    assert_eq!(cases.len(), 2);
    for (case, answer) in cases.iter().zip(&answers) {
        assert_eq!(case.error, None);
        assert_eq!(case.answer_sha256, answer.answer_sha256);
        assert!(case.time_s > 0.0 && case.rows > 1000);
        assert!(case.rerun.contains("--first 0 --count 1 --seed 3"));
    }
    assert!(cases[0].truth.is_clean() && !cases[1].truth.is_clean());
    let single = cases[1].score.as_ref().unwrap();
    assert!(single.detected, "a strong effect");
}

/// A drift of 3 sd and more, named in the first recording, is predicted in the second; the diagnosis gets no second recording.
#[test]
fn a_corrected_device_predicts_the_recording_that_was_kept_back() {
    let drawn = |index: u64| Suite::Loop.draw(index, 3).unwrap();
    let drift = (0..32).find(|index| drawn(*index).truth.name == "cable-drift");
    let drift = drift.unwrap();
    let joints = drawn(drift).device.joints;
    let encoders = joints
        .iter()
        .filter(|joint| joint.output_sd_rad().is_some());
    let encoders = encoders.count();
    let batch = Batch {
        trials: vec![(Suite::Loop, drift), (Suite::Absent, 0)],
        ..batch()
    };
    let sealed = batch.seal().unwrap();
    let published = batch.commitments(&sealed);
    let fixed = batch.diagnose(&sealed).unwrap();
    assert!(
        fixed[0].reductions.is_empty(),
        "validated on what was kept back"
    );
    let cases = batch.open(&published, sealed, fixed).unwrap();
    assert_eq!((&cases[0].error, &cases[1].error), (&None, &None));
    let closing = cases[0].closing.as_ref().unwrap();
    assert!(closing.closed_percent.unwrap() > 75.0, "{closing:?}");
    assert_eq!(closing.channels.len(), 1 + encoders, "the cable too");
    let fit = cases[1].fit.as_ref().unwrap();
    assert!(!fit.shown && cases[1].closing.is_none(), "{fit:?}");
}
