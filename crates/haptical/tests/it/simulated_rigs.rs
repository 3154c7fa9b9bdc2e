//! Every rig that can be planned: plan, simulate, identify, and the truth within the intervals.

use haptical::calibration::{HeldOut, Options};
use haptical::files::Source;
use haptical::model::Device as Model;
use haptical::prelude::*;
use haptical::{Found, Truth, simulate_postures};

const FIXTURES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures");
/// Share of its plausible error that each number of a true device is off.
const SHARE: f64 = 0.2;
/// Least share of the identified parameters whose 95 % interval holds the truth: of 40 independent ones 34 do with a
/// probability of 99 %, and neighbours of one device are not independent.
const COVERED: f64 = 0.8;
/// Largest error in standard deviations.
const MOST_SDS: f64 = 5.0;
/// Sizes of a residual over its noise that are noise.
const NOISE: std::ops::Range<f64> = 0.6..1.5;

fn haptic7() -> Device {
    Device::load(format!("{FIXTURES}/devices/haptic7.toml")).unwrap()
}

/// The device with a rig file's text.
fn with_rig(device: &Device, rig: Option<&str>) -> Device {
    let equipment = Equipment {
        rig: rig.map(|rig| Source::text(rig, "rig.toml")),
        ..Equipment::default()
    };
    Device::open(&Source::text(device.to_toml(), "device.toml"), &equipment).unwrap()
}

fn planned(device: &Device, measure: &str, poses: usize) -> Log {
    let request = Request {
        rigs: vec![Rig::parse(measure).unwrap()],
        candidates: 3 * poses,
        poses,
        chooses: true,
        ..Request::default()
    };
    let files = plan(device, &request, None).unwrap().files().unwrap();
    let (_, csv) = files.iter().find(|(name, _)| *name == "poses.csv").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("poses.csv");
    std::fs::write(&path, csv).unwrap();
    Log::read(&path, device).unwrap()
}

/// Identifies a simulated log with what a user has of it: the nominal device and the rig.
fn identified(
    device: &Device,
    truth: Truth<'_>,
    postures: &Log,
    measure: Option<&str>,
    seed: u64,
) -> (Found, Model) {
    let rig = measure.map(|measure| Rig::parse(measure).unwrap());
    let made = simulate_postures(device, truth, postures, rig.as_ref(), seed).unwrap();
    assert!(made.warnings.is_empty(), "{:?}", made.warnings);
    let device = with_rig(device, made.rig.as_deref());
    let log = Log::from_recording(made.recording, "log.csv", &device).unwrap();
    let options = Options {
        held_out: HeldOut::None,
        ..Options::default()
    };
    let asked = Identify {
        options,
        ..Identify::default()
    };
    (identify(&device, &log, &asked).unwrap(), made.truth)
}

/// Turns and tilts count from where a fit began, not from where the truth lies; a plane's normal may point either way.
fn is_absolute(name: &str) -> bool {
    let part = name.rsplit(['.', '_']).next().unwrap_or("");
    !matches!(part, "rx" | "ry" | "rz") && !name.starts_with("plane.")
}

/// Asserts that the truth lies in the intervals and that noise is left; how many parameters were compared.
fn assert_recovers(what: &str, found: &Found, truth: &Model) -> usize {
    let mut missed = Vec::new();
    let mut compared = 0;
    for parameter in &found.result.parameters {
        let (Some(value), Some([low, high])) = (parameter.value, parameter.ci95) else {
            continue;
        };
        let Some(known) = truth.parameter(&parameter.name).ok() else {
            continue;
        };
        if !is_absolute(&parameter.name) {
            continue;
        }
        let known = known.value(truth);
        compared += 1;
        let sds = (value - known).abs() / ((high - low) / 3.92);
        assert!(
            sds < MOST_SDS,
            "{what}: {} is {value} [{low}, {high}], true {known}",
            parameter.name
        );
        if !(low..=high).contains(&known) {
            missed.push(parameter.name.clone());
        }
    }
    let covered = 1.0 - missed.len() as f64 / compared.max(1) as f64;
    assert!(covered >= COVERED, "{what}: {missed:?} of {compared}");
    for channel in &found.result.channels_fit {
        let left = channel.rms_after / channel.noise_floor;
        let is_one_reading = channel.readings <= 10;
        assert!(
            is_one_reading || NOISE.contains(&left),
            "{what}: {} leaves {left} of its noise",
            channel.channel
        );
    }
    compared
}

/// Plans, simulates and identifies with a device.
fn round_trip(device: &Device, measure: &str, poses: usize) -> usize {
    let postures = planned(device, measure, poses);
    let (found, truth) = identified(device, Truth::Drawn(SHARE), &postures, Some(measure), 1);
    assert_recovers(measure, &found, &truth)
}

#[test]
fn cables_and_encoders_give_the_truth_back() {
    let device = haptic7();
    assert!(round_trip(&device, "out,cable", 100) > 35);
    assert!(round_trip(&device, "out,cable,cable2:0.5,0.2,0.3:unknown", 100) > 40);
}

#[test]
fn trackers_give_the_truth_back() {
    let device = haptic7();
    assert!(round_trip(&device, "out,position", 80) > 35);
    assert!(round_trip(&device, "out,pose:unknown", 80) > 40);
}

#[test]
fn touches_give_the_truth_back() {
    let device = haptic7();
    assert!(round_trip(&device, "out,contact:2:0.2", 100) > 35);
    assert!(round_trip(&device, "out,plane:2,contact:2:0.2", 120) > 40);
}

#[test]
fn fixtures_give_the_truth_back() {
    assert!(round_trip(&haptic7(), "out,cable,fixture", 100) > 40);
}

#[test]
fn an_arm_of_a_urdf_gives_the_truth_back() {
    let device = Device::from_urdf(format!("{FIXTURES}/urdf/arm.urdf"), "tool").unwrap();
    assert!(round_trip(&device, "pose:unknown", 80) > 15);
    assert!(round_trip(&device, "contact:3:0.2", 100) > 15);
    assert!(round_trip(&device, "position", 80) > 15);
}

/// What a log is about that no plan has: tools, runs, held angles, hands.
fn again(device: &Device, rig: &str, rows: usize) -> usize {
    let equipment = Equipment {
        rig: Some(Source::given(
            format!("{FIXTURES}/rigs/{rig}.toml").as_ref(),
        )),
        ..device.equipment().clone()
    };
    let device = Device::open(device.source(), &equipment).unwrap();
    let log = Log::read(format!("{FIXTURES}/logs/{rig}.csv.gz"), &device).unwrap();
    let step = (log.recording.len() / rows).max(1);
    let every: Vec<usize> = (0..log.recording.len()).step_by(step).collect();
    let log = Log::from_recording(log.recording.select(&every), "log.csv", &device).unwrap();
    let (found, truth) = identified(&device, Truth::Drawn(SHARE), &log, None, 2);
    let channels = found.result.channels_fit.iter();
    let has_cable = channels.into_iter().any(|own| own.channel == "cable");
    assert_eq!(
        has_cable,
        rig == "homing",
        "the sensors are those of the log"
    );
    assert_recovers(rig, &found, &truth)
}

#[test]
fn logs_with_tools_and_runs_are_simulated_again() {
    let device = haptic7();
    assert!(again(&device, "reflectors", 180) > 35);
    assert!(again(&device, "stands", 100) > 35);
    assert!(again(&device, "homing", 135) > 40);
}

#[test]
fn two_hands_are_simulated_again() {
    let equipment = Equipment {
        tip: Some("left_hand".to_owned()),
        further_tips: vec!["right_hand".to_owned()],
        ..Equipment::default()
    };
    let path = format!("{FIXTURES}/urdf/humanoid.urdf");
    let device = Device::open(&Source::given(path.as_ref()), &equipment).unwrap();
    assert!(again(&device, "two-arms", 160) > 30);
}
