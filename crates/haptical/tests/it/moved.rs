//! What moved of a URDF's arm is said by the origins of its joints, as the corrected URDF has them.

use std::path::{Path, PathBuf};

use haptical::calibration::{HeldOut, Options};
use haptical::design::Rig;
use haptical::files::Source;
use haptical::urdf::UrdfOrigins;
use haptical::urdf::corrected_urdf;
use haptical::{Device, Equipment, Found, Identify, Log, Truth, identify, simulate_postures};

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures")
}

fn camera() -> (Device, Found) {
    let equipment = Equipment {
        rig: Some(Source::given(&fixtures().join("rigs/camera.toml"))),
        ..Equipment::default()
    };
    let folder = fixtures().join("measured/camera");
    let device = Device::open(&Source::given(&folder.join("panda.urdf")), &equipment).unwrap();
    let log = Log::read(folder.join("log.csv"), &device).unwrap();
    let request = Identify {
        options: Options {
            held_out: HeldOut::None,
            ..Identify::default().options
        },
        ..Identify::default()
    };
    let found = identify(&device, &log, &request).unwrap();
    (device, found)
}

/// The `xyz` of a joint's origin, read from the text alone.
fn xyz(urdf: &str, joint: &str) -> [f64; 3] {
    let (_, own) = urdf
        .split_once(&format!("<joint name=\"{joint}\""))
        .unwrap();
    let (own, _) = own.split_once("</joint>").unwrap();
    let (_, origin) = own.split_once("<origin").unwrap();
    let (_, numbers) = origin.split_once("xyz=\"").unwrap();
    let (numbers, _) = numbers.split_once('"').unwrap();
    let numbers: Vec<f64> = numbers
        .split_whitespace()
        .map(|own| own.parse().unwrap())
        .collect();
    numbers.try_into().unwrap()
}

#[test]
fn shifts_of_a_urdfs_joints_are_those_of_the_corrected_file() {
    let (device, found) = camera();
    let given = std::fs::read_to_string(&device.source().path).unwrap();
    let ends = device.equipment().ends();
    let corrected = corrected_urdf(&given, "panda.urdf", ends, &found.calibration.device).unwrap();
    let moved = &found.result.moved;
    let mut compared = 0;
    for entry in moved.iter().filter(|entry| entry.unit == "m") {
        let Some((joint, axis)) = entry
            .name
            .strip_prefix("origin of ")
            .and_then(|rest| rest.split_once(", "))
        else {
            continue;
        };
        if !joint.starts_with("panda_joint") {
            continue;
        }
        let axis = ["x", "y", "z"].iter().position(|own| *own == axis).unwrap();
        let wanted = xyz(&corrected.text, joint)[axis] - xyz(&given, joint)[axis];
        assert!(
            (entry.deviation - wanted).abs() < 1e-9,
            "{}: {wanted}",
            entry.name
        );
        let half = 0.5 * (entry.ci95[1] - entry.ci95[0]);
        assert!(half > 1e-5 && half < 0.05, "{}: {half}", entry.name);
        compared += 1;
    }
    assert!(compared >= 6, "{compared}");
}

#[test]
fn the_numbers_that_moved_most_come_first_and_no_row_of_denavit_and_hartenberg_is_among_them() {
    let (_, found) = camera();
    let moved = &found.result.moved;
    // those whose interval tells to which side they moved, then the others
    let is_known = |entry: &haptical::MovedEntry| entry.ci95[0] > 0.0 || entry.ci95[1] < 0.0;
    assert!(moved.is_sorted_by_key(|entry| !is_known(entry)));
    let known = moved.iter().filter(|entry| is_known(entry)).count();
    assert!(known > 0 && known < moved.len(), "{known}");
    for part in [&moved[..known], &moved[known..]] {
        let multiples = part
            .iter()
            .map(|entry| entry.deviation.abs() / entry.plausible_size);
        assert!(multiples.is_sorted_by(|a, b| a >= b), "{part:?}");
    }
    let is_of_urdf = |name: &str| name.starts_with("origin of ") || name.starts_with("tracker_");
    assert!(moved.iter().all(|entry| is_of_urdf(&entry.name)));
    let said = found.to_string();
    assert!(
        said.contains("numbers that moved most") && said.contains("origin of panda_joint"),
        "{said}"
    );
    // 26 numbers that act like combinations of others are one sentence
    let dependent = said
        .lines()
        .filter(|line| line.trim_start().starts_with("dependent"));
    assert_eq!(dependent.count(), 1, "{said}");
    assert!(!said.contains('…'));
}

/// Sixty postures of the example's arm, whose every link is off, under a tracker at an unknown place.
#[test]
fn intervals_of_origins_hold_what_the_arm_has() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cli/assets");
    let urdf = std::fs::read_to_string(assets.join("arm6.urdf")).unwrap();
    let device = Device::load(assets.join("arm6.urdf")).unwrap();
    let postures = Log::read(assets.join("arm6-poses.csv"), &device).unwrap();
    let rig = Rig::parse("pose:unknown").unwrap();
    let (mut held, mut missed) = (0, Vec::new());
    for seed in 1..=3 {
        let made =
            simulate_postures(&device, Truth::Drawn(0.2), &postures, Some(&rig), seed).unwrap();
        let equipment = Equipment {
            rig: Some(Source::text(made.rig.unwrap(), "rig.toml")),
            ..Equipment::default()
        };
        let equipped = Device::open(&Source::given(&assets.join("arm6.urdf")), &equipment).unwrap();
        let log = Log::from_recording(made.recording, "drawn", &equipped).unwrap();
        let found = identify(&equipped, &log, &Identify::default()).unwrap();
        let chain = UrdfOrigins::read(&urdf, "arm6.urdf", device.equipment().ends()).unwrap();
        let (given, truth) = (
            chain.of(&device.model).unwrap(),
            chain.of(&made.truth).unwrap(),
        );
        for entry in &found.result.moved {
            let Some(own) = entry.name.strip_prefix("origin of ") else {
                continue;
            };
            let (joint, number) = own.split_once(", ").unwrap();
            let index = given.iter().position(|own| own.joint == joint).unwrap();
            let (from, to) = (given[index].pose, truth[index].pose);
            let axis = ["x", "y", "z"]
                .iter()
                .position(|own| number.ends_with(own))
                .unwrap();
            let turn = from.rotation.transpose() * to.rotation;
            // small: the skew part of a turn is its vector
            let vector = [
                turn[(2, 1)] - turn[(1, 2)],
                turn[(0, 2)] - turn[(2, 0)],
                turn[(1, 0)] - turn[(0, 1)],
            ];
            let wanted = match entry.unit.as_str() {
                "m" => to.position_m[axis] - from.position_m[axis],
                _ => 0.5 * vector[axis],
            };
            let [low, high] = entry.ci95;
            match (low..=high).contains(&wanted) {
                true => held += 1,
                false => missed.push(format!("{seed} {}: {wanted:e}", entry.name)),
            }
        }
    }
    // one in twenty of those that are known may miss
    assert!(held > 60 && missed.len() <= 3, "{held} {missed:?}");
}
