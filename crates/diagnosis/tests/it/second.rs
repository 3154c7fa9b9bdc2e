//! A second recording is judged beside the log, whatever that has.

use haptical_diagnosis::{Diagnosis, Options, Verdict, diagnose};
use haptical_model::Recording;

use crate::arm::{Errors, Session, device, record, record_yielding, summary};

fn session(seed: u64) -> Session {
    Session {
        seed,
        start_s: 300.0 * seed as f64,
        ..Session::default()
    }
}

fn clean(seed: u64) -> Recording {
    record(&session(seed), |_| Errors::default())
}

fn beside(second: &Recording) -> Diagnosis {
    let options = Options {
        validation: Some(second),
        ..Options::default()
    };
    diagnose(&device(), &clean(1), &options).unwrap()
}

#[test]
fn a_second_clean_recording_has_no_gap() {
    for seed in 2..=6 {
        let found = beside(&clean(seed));
        assert_eq!(found.verdict, Verdict::NoGap, "{seed}: {}", summary(&found));
        let second = found.second.unwrap();
        assert!(second.channels.iter().all(|own| !own.has_gap));
        assert!(second.channels.len() >= 3 && second.not_predicted.is_empty());
    }
}

#[test]
fn what_the_second_recording_alone_shows_is_a_gap_in_verdict_table_and_warnings() {
    let bent = record(&session(3), |now| Errors {
        cable_m: 2e-4 * (5.0 * now.reading_rad[0]).sin(),
        ..Errors::default()
    });
    for (second, channel) in [(record_yielding(&session(2)), "out2"), (bent, "cable")] {
        let found = beside(&second);
        assert_eq!(found.verdict, Verdict::Unknown, "{}", summary(&found));
        assert!(found.causes.is_empty() && found.corrected.is_none());
        let place = found.place.as_ref().unwrap();
        assert_eq!(place.region, "in the second recording alone");
        let table = &found.gap.channels;
        let own = table.iter().find(|own| own.channel == channel).unwrap();
        assert!(
            own.has_gap && own.rms_after > 1.2 * own.noise_floor,
            "{own:?}"
        );
        let second = found.second.as_ref().unwrap();
        assert!(second.is_gap_of_it_alone);
        let mut said = found.warnings.iter();
        assert!(
            said.any(
                |said| said.contains("does not hold for the second recording")
                    && said.contains(channel)
            ),
            "{:?}",
            found.warnings
        );
    }
}

#[test]
fn a_channel_that_the_second_recording_lacks_is_said_not_to_be_judged() {
    let mut second = clean(2);
    second.cable_m = vec![None; second.cable_m.len()];
    let found = beside(&second);
    let mut said = found.warnings.iter();
    assert!(
        said.any(|said| said.contains("not judged") && said.contains("cable")),
        "{:?}",
        found.warnings
    );
}
