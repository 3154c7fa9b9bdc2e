//! Touches of points at unknown places: what is named, and what is not.

use haptical_calibration::{Options, fit_device};
use haptical_diagnosis::Answered;
use haptical_diagnosis::Verdict;

use crate::arm::{assert_named, assert_near, summary};
use crate::touching::{Errors, TOUCH_SD_M, device, diagnosed, record};

/// Seeds of the recordings, in order, not chosen.
const SEEDS: [u64; 4] = [1, 2, 3, 4];
/// Joint that yields, from 0, and its stiffness \[N m/rad\]: 20 N m turn it by 10 mrad.
const YIELDING: usize = 1;
const STIFFNESS_NM_PER_RAD: f64 = 2e3;

fn yielding() -> Errors {
    let mut errors = Errors::default();
    errors.compliance_rad_per_nm[YIELDING] = 1.0 / STIFFNESS_NM_PER_RAD;
    errors
}

#[test]
fn a_joint_that_yields_to_its_weight_is_named() {
    for seed in SEEDS {
        let diagnosis = diagnosed(&device(), &record(seed, &yielding()), None);
        let named = assert_named(
            &diagnosis,
            "joint-compliance",
            Some(YIELDING + 1),
            "stiffness_nm_per_rad",
        );
        assert_near(named, STIFFNESS_NM_PER_RAD);
    }
}

#[test]
fn a_second_recording_of_other_sockets_shows_what_closes() {
    let first = record(SEEDS[0], &yielding());
    let mut second = record(SEEDS[0] + 50, &yielding());
    for id in second.contact.iter_mut().flatten() {
        id.push_str("-again");
    }
    let options = haptical_diagnosis::Options {
        validation: Some(&second),
        ..Default::default()
    };
    let diagnosis = haptical_diagnosis::diagnose(&device(), &first, &options).unwrap();
    let held_out = diagnosis.causes[0].held_out.as_ref().unwrap();
    assert!(
        held_out.rms_before > 1.3 * held_out.rms_after,
        "{held_out:?}"
    );
    assert!(
        held_out.rms_after < 1.3 * held_out.noise_floor,
        "{held_out:?}"
    );
    // a touch that stands alone is left out with its three coordinates
    let (rows, predicted) = (second.len(), diagnosis.predictions.len());
    assert!(
        predicted % 3 == 0 && predicted > 57 * rows / 20 && predicted <= 3 * rows,
        "{predicted}"
    );
}

#[test]
fn what_is_not_in_the_catalogue_stays_unknown_with_what_it_depends_on() {
    let mut options = haptical_diagnosis::Options::default();
    // everything that the course of a torque resembles
    let names = haptical_diagnosis::effect_names();
    options.without = names.into_iter().map(str::to_owned).collect();
    let recording = record(SEEDS[0], &yielding());
    let diagnosis = haptical_diagnosis::diagnose(&device(), &recording, &options).unwrap();
    let summary = summary(&diagnosis);
    assert_eq!(diagnosis.verdict, Verdict::Unknown, "{summary}");
    let place = diagnosis.place.unwrap();
    let surest = &place.dependence[0];
    assert_eq!(place.joint, Some(YIELDING + 1), "{summary}");
    assert!(
        surest.p_adjusted < 1e-6 && surest.p_value <= surest.p_adjusted,
        "{surest:?}"
    );
    let torque = place
        .dependence
        .iter()
        .find(|found| found.column == "torque2_nm")
        .unwrap();
    assert!(torque.p_adjusted < 1e-6, "{torque:?}");
    assert!(
        diagnosis
            .next_experiment
            .unwrap()
            .contains("direction of motion")
    );
}

#[test]
fn an_arm_without_an_error_has_no_gap() {
    for seed in SEEDS {
        let recording = record(seed, &Errors::default());
        let diagnosis = diagnosed(&device(), &recording, None);
        assert_eq!(
            diagnosis.verdict,
            Verdict::NoGap,
            "{seed}: {}",
            summary(&diagnosis)
        );
        assert!(diagnosis.causes.is_empty(), "{}", summary(&diagnosis));
        // against its own earlier model, by other touches
        let model = fit_device(
            &device(),
            &record(seed + 100, &Errors::default()),
            &Options::default(),
        );
        let diagnosis = diagnosed(&device(), &recording, Some(&model.unwrap().device));
        assert_eq!(
            diagnosis.verdict,
            Verdict::NoGap,
            "{seed}: {}",
            summary(&diagnosis)
        );
    }
}

/// Noise of a touch is in the joints' readings, and so in the derivatives at them: with millimetres of it their products
/// with the residuals are no chance any more. With distances known to a millimetre, the device keeps its size too.
#[test]
fn rough_touches_of_an_arm_without_an_error_have_no_gap() {
    let rough_m = 2e-3;
    for sd_m in [None, Some(1e-3)] {
        let mut device = device();
        device.surroundings.contact_sd_m = Some(TOUCH_SD_M + rough_m);
        match sd_m {
            None => device.contact_pairs.clear(),
            Some(sd_m) => device
                .contact_pairs
                .iter_mut()
                .for_each(|pair| pair.sd_m = sd_m),
        }
        for seed in SEEDS {
            let errors = Errors {
                rough_m,
                ..Errors::default()
            };
            let diagnosis = diagnosed(&device, &record(seed, &errors), None);
            let summary = summary(&diagnosis);
            assert_eq!(diagnosis.verdict, Verdict::NoGap, "{seed}: {summary}");
            assert!(diagnosis.causes.is_empty(), "{seed}: {summary}");
            let channels = diagnosis.gap.channels.iter();
            for pair in channels.filter(|channel| channel.channel.starts_with("contact-pair")) {
                assert!(
                    pair.rms_before < 3.0 * pair.noise_floor,
                    "{seed}: {summary}"
                );
            }
        }
    }
}

#[test]
fn without_a_stated_noise_nothing_says_that_there_is_no_gap() {
    let mut device = device();
    device.surroundings.contact_sd_m = None;
    for seed in SEEDS {
        let diagnosis = diagnosed(&device, &record(seed, &Errors::default()), None);
        assert_eq!(
            diagnosis.verdict,
            Verdict::Unknown,
            "{seed}: {}",
            summary(&diagnosis)
        );
        let asked = &diagnosis.admission.known_noise;
        assert_eq!(asked.answer, Answered::No, "{seed}: {}", asked.why);
        assert!(diagnosis.causes.is_empty() && diagnosis.corrected.is_none());
        assert!(
            diagnosis
                .warnings
                .iter()
                .any(|warning| warning.contains("sd_m"))
        );
    }
}

#[test]
fn another_tool_is_named_and_sized() {
    let tool_m = [4e-3, -7e-3, 2.2e-2];
    let size = tool_m
        .iter()
        .map(|part: &f64| part * part)
        .sum::<f64>()
        .sqrt();
    for seed in SEEDS {
        let model = fit_device(
            &device(),
            &record(seed + 100, &Errors::default()),
            &Options::default(),
        );
        let model = model.unwrap().device;
        let errors = Errors {
            tool_m,
            ..Errors::default()
        };
        let diagnosis = diagnosed(&device(), &record(seed, &errors), Some(&model));
        let named = assert_named(&diagnosis, "tool-changed", None, "shift_m");
        assert_near(named, size);
        let cause = &diagnosis.causes[0];
        for (axis, name) in ["shift_x_m", "shift_y_m", "shift_z_m"].iter().enumerate() {
            let part = cause.parameters[*name];
            assert_near((part.value, part.ci95), tool_m[axis]);
        }
        let place = diagnosis.place.as_ref().unwrap();
        assert_eq!(place.joint, Some(6), "{place:?}");
    }
}

#[test]
fn another_link_is_not_taken_for_another_tool() {
    for seed in SEEDS {
        let recording = record(seed, &Errors::default());
        let mut model = fit_device(
            &device(),
            &record(seed + 100, &Errors::default()),
            &Options::default(),
        )
        .unwrap()
        .device;
        model.links[2].a_m += 4e-3;
        let diagnosis = diagnosed(&device(), &recording, Some(&model));
        let names: Vec<&str> = diagnosis
            .causes
            .iter()
            .map(|cause| cause.effect.as_str())
            .collect();
        assert!(names.contains(&"link-geometry"), "{}", summary(&diagnosis));
        assert!(!names.contains(&"tool-changed"), "{}", summary(&diagnosis));
    }
}

#[test]
fn play_and_delays_cannot_be_tested_on_postures() {
    let diagnosis = diagnosed(&device(), &record(SEEDS[0], &Errors::default()), None);
    for effect in ["backlash", "hysteresis", "encoder-latency", "joint-drift"] {
        let found = diagnosis
            .untestable
            .iter()
            .any(|entry| entry.effect == effect);
        assert!(found, "{effect}");
    }
}
