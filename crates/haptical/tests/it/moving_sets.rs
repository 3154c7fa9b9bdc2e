//! Recordings of a moving arm whose effects are known, simulated by others: another library's rigid bodies, drives with laws of their
//! own.

use std::path::PathBuf;

use haptical::diagnosis::Verdict;
use haptical::{Device, Diagnose, Log, diagnose, identify_dynamics};

/// The set, what may be named first, and the joint.
const SETS: [(&str, &[&str], Option<usize>); 10] = [
    ("01-clean", &[], None),
    ("02-payload", &["payload"], None),
    ("03-encoder-latency", &["encoder-latency"], None),
    ("04-torque-gain", &["torque-gain"], Some(3)),
    ("05-stribeck", &["stribeck-friction"], Some(2)),
    (
        "06-elastic-second",
        &["capstan-compliance", "joint-compliance"],
        Some(2),
    ),
    ("07-backlash-second", &["backlash"], Some(1)),
    ("08-cogging", &["motor-cogging"], Some(1)),
    ("09-contact", &["contact"], None),
    ("10-unknown-dent", &["unknown"], None),
];

/// Numbers of the effects as they were made.
const NUMBERS: [(&str, &str, f64); 6] = [
    ("payload", "mass_kg", 4.0),
    ("torque-gain", "gain", 0.3 / 1.3),
    ("motor-cogging", "order", 101.0),
    ("motor-cogging", "amplitude_nm", 3.0),
    ("stribeck-friction", "speed_rad_per_s", 0.12),
    ("stribeck-friction", "torque_nm", 7.0),
];

/// The recordings; none, with words, where they are absent.
fn sets() -> Option<PathBuf> {
    let sets = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/moving-sets");
    if !sets.exists() {
        println!("skipped: no {}", sets.display());
        return None;
    }
    Some(sets)
}

#[test]
fn what_moves_an_arm_of_a_urdf_is_named() {
    assert_named("arm_a.urdf");
}

#[test]
fn what_moves_an_arm_of_an_mjcf_is_named() {
    assert_named("arm_a.xml");
}

fn assert_named(model: &str) {
    let Some(sets) = sets() else { return };
    let device = Device::load(sets.join(model)).unwrap();
    for (set, right, joint) in SETS {
        let log = Log::read(sets.join(set).join("log.csv.gz"), &device).unwrap();
        let found = diagnose(&device, &log, &Diagnose::default())
            .unwrap()
            .diagnosis;
        let first = found.causes.first();
        // a wrist's torque beside a payload is in no other unit
        let of_units =
            (found.warnings.iter()).find(|own| own.contains("times what the links ask for"));
        assert_eq!(of_units, None, "{set}");
        let told = (
            found.verdict,
            first.map(|own| (own.effect.as_str(), own.joint)),
        );
        let is_right = match right {
            [] => told == (Verdict::NoGap, None),
            ["unknown"] => found.verdict == Verdict::Unknown,
            names => {
                found.verdict == Verdict::Named
                    && first.is_some_and(|own| {
                        names.contains(&own.effect.as_str()) && own.joint == joint
                    })
            }
        };
        assert!(is_right, "{set} with {model}: {told:?}");
        for cause in &found.causes {
            for (_, number, truth) in NUMBERS.iter().filter(|own| own.0 == cause.effect) {
                let [low, high] = cause.parameters[*number].ci95;
                assert!(
                    (low..=high).contains(truth),
                    "{set} with {model}: {number} [{low}, {high}], truth {truth}"
                );
            }
            // the gap's record and the cause's check are one number
            let Some(own) = &cause.held_out else { continue };
            let mut channels = found.gap.channels.iter();
            let gap = channels.find(|gap| gap.channel == own.channel).unwrap();
            assert_eq!(
                (gap.reduction_percent, gap.held_out),
                (own.reduction_percent, true)
            );
        }
        if let Some(play) = first.filter(|own| own.effect == "backlash") {
            let width_rad = play.parameters["width_rad"].value;
            assert!(
                (width_rad - 0.006).abs() < 5e-5,
                "{model}: {width_rad} rad, truth 0.006"
            );
        }
        if let Some(payload) = first.filter(|own| own.effect == "payload") {
            let mass_kg = payload.parameters["mass_kg"].value;
            assert!(
                (mass_kg - 4.0).abs() < 0.25,
                "{model}: {mass_kg} kg, truth 4"
            );
        }
    }
}

/// What is identified from one log of a sound arm is no gap on another.
#[test]
fn a_sound_arm_that_was_identified_has_no_gap() {
    let Some(sets) = sets() else { return };
    for model in ["arm_a.urdf", "arm_a.xml"] {
        let device = Device::load(sets.join(model)).unwrap();
        let read = |name: &str| Log::read(sets.join("01-clean").join(name), &device).unwrap();
        let (log, second) = (read("log.csv.gz"), read("log2.csv.gz"));
        let found = identify_dynamics(&device, &log, Some(&second), None).unwrap();
        let unseen = found.result.stacked_percent_validate.unwrap();
        assert!(unseen.after < 2.5 && unseen.before > 40.0, "{unseen:?}");
        let request = Diagnose {
            model: Some(&found.device),
            ..Diagnose::default()
        };
        let told = diagnose(&device, &second, &request).unwrap().diagnosis;
        assert_eq!(told.verdict, Verdict::NoGap, "{model}: {:?}", told.causes);
    }
}
