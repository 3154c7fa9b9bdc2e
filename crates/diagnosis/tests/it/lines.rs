//! Readings that oscillate at one frequency, however fast against what is averaged.

use haptical_diagnosis::{Diagnosis, Options, Over, Verdict, diagnose};
use haptical_model::{Device, Evaluation, Recording};

use crate::arm::{
    CABLE_SD_M, Errors, STEP_S, Session, assert_named, assert_near, device, diagnosed, record,
    record_yielding, summary,
};
use crate::normal::Normal;

const TAU: f64 = std::f64::consts::TAU;

/// An oscillation of the cable's readings.
fn humming(amplitude_m: f64, hz: f64, session: &Session) -> Recording {
    record(session, |at| Errors {
        cable_m: amplitude_m * (TAU * hz * at.time_s + 0.3).cos(),
        ..Errors::default()
    })
}

/// The frequency of the first cause, where it has one.
fn frequency_hz(diagnosis: &Diagnosis) -> f64 {
    diagnosis.causes[0].parameters["frequency_hz"].value
}

#[test]
fn an_oscillation_of_the_cable_is_named_with_frequency_and_amplitude() {
    for hz in [7.03, 20.3, 44.7] {
        let diagnosis = diagnosed(&humming(1e-3, hz, &Session::default()));
        let found = assert_named(&diagnosis, "periodic-disturbance", None, "amplitude_m");
        assert_near(found, 1e-3);
        let found_hz = frequency_hz(&diagnosis);
        assert!((found_hz / hz - 1.0).abs() < 1e-3, "{found_hz} {hz}");
        // nothing of it is left, and nothing of it passes for noise
        let cable = diagnosis.gap.channels.last().unwrap();
        assert!(cable.rms_after < 1.1 * cable.noise_floor, "{cable:?}");
        assert!(cable.noise_floor < 1.2e-5, "{cable:?}");
    }
}

#[test]
fn a_weak_oscillation_of_an_external_encoder_is_named_with_its_joint() {
    // as large as the noise
    let recording = record(&Session::default(), |at| {
        let mut errors = Errors::default();
        errors.encoder_rad[1] = 1e-4 * (TAU * 16.7 * at.time_s).sin();
        errors
    });
    let diagnosis = diagnosed(&recording);
    let found = assert_named(&diagnosis, "periodic-disturbance", Some(2), "amplitude_rad");
    assert_near(found, 1e-4);
    assert!((frequency_hz(&diagnosis) / 16.7 - 1.0).abs() < 1e-3);
}

#[test]
fn an_oscillation_need_not_keep_its_phase_between_runs() {
    let recording = record(&Session::default(), |at| Errors {
        cable_m: 2e-4 * (TAU * 23.1 * at.elapsed_s).cos(),
        ..Errors::default()
    });
    let diagnosis = diagnosed(&recording);
    let found = assert_named(&diagnosis, "periodic-disturbance", None, "amplitude_m");
    assert_near(found, 2e-4);
}

#[test]
fn an_oscillation_whose_name_was_left_out_is_a_gap_all_the_same() {
    let recording = humming(1e-3, 20.3, &Session::default());
    let options = Options {
        without: vec!["periodic-disturbance".to_owned()],
        ..Options::default()
    };
    let diagnosis = diagnose(&device(), &recording, &options).unwrap();
    let summary = summary(&diagnosis);
    assert_eq!(diagnosis.verdict, Verdict::Unknown, "{summary}");
    assert_eq!(diagnosis.place.unwrap().channel, "cable", "{summary}");
}

#[test]
fn an_oscillation_beside_a_yielding_cable_leaves_the_stiffness() {
    let mut recording = record_yielding(&Session::default());
    let time_s = recording.time_s.clone().unwrap();
    for (value, time_s) in recording.cable_m[0]
        .as_mut()
        .unwrap()
        .iter_mut()
        .zip(time_s)
    {
        *value += 3e-4 * (TAU * 31.3 * time_s).sin();
    }
    let diagnosis = diagnosed(&recording);
    let names: Vec<&str> = diagnosis.causes.iter().map(|c| c.effect.as_str()).collect();
    assert_eq!(diagnosis.verdict, Verdict::Named, "{}", summary(&diagnosis));
    assert!(
        names.contains(&"capstan-compliance") && names.contains(&"periodic-disturbance"),
        "{names:?}"
    );
}

#[test]
fn noise_of_a_resonance_is_no_oscillation() {
    // an autoregression of second order about 20 Hz, 1.5 Hz wide
    let mut recording = record(&Session::default(), |_| Errors::default());
    let mut noise = Normal::new(5);
    let (decay, turn) = ((-TAU * 0.75 * STEP_S).exp(), TAU * 20.0 * STEP_S);
    let (mut one, mut two) = (0.0, 0.0);
    for value in recording.cable_m[0].as_mut().unwrap() {
        let next = 2.0 * decay * turn.cos() * one - decay * decay * two + 2e-5 * noise.next();
        (two, one) = (one, next);
        *value += next;
    }
    let diagnosis = diagnosed(&recording);
    let is_line = |name: &str| name == "periodic-disturbance";
    assert!(
        diagnosis.causes.iter().all(|cause| !is_line(&cause.effect)),
        "{}",
        summary(&diagnosis)
    );
}

/// A joint that turns at a steady pace, with an error of its angle that is periodic in time for that.
fn steady(error_rad: impl Fn(f64) -> f64) -> (Device, Recording) {
    let text = "[[joint]]\ntransmission = \"capstan\"\ntransmission_ratio = 8.0\n\
                drum_distance_m = 0.0675\nexternal_encoder_sd_rad = 1e-4\n";
    let device = Device::from_toml(text, "one.toml").unwrap().device;
    let mut evaluation = Evaluation::new(&device);
    let mut noise = Normal::new(3);
    let mut recording = Recording {
        line: (2..2402).collect(),
        time_s: Some((0..2400).map(|row| STEP_S * f64::from(row)).collect()),
        joint: vec![Vec::new()],
        output: vec![Some(Vec::new())],
        torque_nm: vec![None],
        ..Recording::default()
    };
    for row in 0..2400 {
        let reading = TAU * STEP_S * f64::from(row);
        evaluation.move_to(&[reading]).unwrap();
        let seen = evaluation.output_rad(0) + error_rad(reading) + 1e-4 * noise.next();
        recording.joint[0].push(reading);
        recording.output[0].as_mut().unwrap().push(seen);
    }
    (device, recording)
}

#[test]
fn a_harmonic_of_a_drum_at_a_steady_pace_is_not_named_an_oscillation() {
    // the order of the input drum: the same as 16 Hz at one turn in a second
    let (device, recording) = steady(|reading| 1e-3 * (16.0 * reading + 0.4).cos());
    let diagnosis = diagnose(&device, &recording, &Options::default()).unwrap();
    let first = &diagnosis.causes[0];
    assert_ne!(
        first.effect,
        "periodic-disturbance",
        "{}",
        summary(&diagnosis)
    );
    assert_ne!(diagnosis.verdict, Verdict::NoGap);
}

#[test]
fn an_oscillation_at_a_steady_pace_is_told_from_the_harmonics() {
    // no order of a drum: 11.3 periods in a turn
    let (device, recording) = steady(|reading| 1e-3 * (11.3 * reading + 0.4).cos());
    let diagnosis = diagnose(&device, &recording, &Options::default()).unwrap();
    let found = assert_named(&diagnosis, "periodic-disturbance", Some(1), "amplitude_rad");
    assert_near(found, 1e-3);
}

/// A line whose phase wanders is no single oscillation, so no effect of the catalogue; it is no noise either.
#[test]
fn a_line_of_wandering_phase_is_no_noise() {
    for seed in [1, 2, 3] {
        let session = Session {
            seed,
            ..Session::default()
        };
        let recording = record(&session, |at| {
            let wander = 3.0 * (0.9 * at.time_s).sin() + 2.0 * (2.3 * at.time_s + 1.0).sin();
            Errors {
                cable_m: 1.2 * CABLE_SD_M * (TAU * 20.3 * at.time_s + wander).cos(),
                ..Errors::default()
            }
        });
        let diagnosis = diagnosed(&recording);
        let summary = summary(&diagnosis);
        assert_ne!(diagnosis.verdict, Verdict::NoGap, "{summary}");
        let mut channels = diagnosis.gap.channels.iter();
        let cable = channels.find(|gap| gap.channel == "cable");
        assert!(cable.unwrap().has_gap);
    }
}

#[test]
fn noise_is_tested_over_frequency_time_posture_and_approach() {
    let tested = diagnosed(&record(&Session::default(), |_| Errors::default())).whiteness;
    let all = [Over::Frequency, Over::Time, Over::Posture, Over::Approach];
    assert_eq!(tested.over, all, "{tested:?}");
    assert!(
        tested.tests > 20 && tested.least_p_adjusted.unwrap() > 3e-3,
        "{tested:?}"
    );
}
