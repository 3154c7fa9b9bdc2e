//! Two arms of one tree in one fit: a humanoid whose numbers another program knows (fixtures/urdf/humanoid.py).

use std::path::Path;

use haptical_calibration::Tracked;
use haptical_model::{Device, Evaluation, Mount, Recording, holding_torques_nm};
use serde_json::Value;

use crate::folder::Folder;

const HANDS: [&str; 4] = ["--tip", "left_hand", "--tip", "right_hand"];

/// The humanoid's files in a folder, and what is known of it.
fn humanoid() -> (Folder, Value) {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures");
    let read = |name: &str| std::fs::read(fixtures.join(name)).unwrap();
    let folder = Folder::with(
        "robot.urdf",
        std::str::from_utf8(&read("urdf/humanoid.urdf")).unwrap(),
    );
    std::fs::write(folder.path("rig.toml"), read("rigs/two-arms.toml")).unwrap();
    std::fs::write(folder.path("log.csv.gz"), read("logs/two-arms.csv.gz")).unwrap();
    let truth = serde_json::from_slice(&read("urdf/humanoid.json")).unwrap();
    (folder, truth)
}

fn run(folder: &Folder, arguments: &[&str]) -> (String, String) {
    let (status, printed, said) = folder.run(arguments);
    assert_eq!(status, Some(0), "{arguments:?}: {printed}{said}");
    (printed, said)
}

const DEVICE: [&str; 4] = ["--device", "robot.urdf", "--rig", "rig.toml"];

fn identify(folder: &Folder, out: &str, further: &[&str]) -> Value {
    let log = ["--log", "log.csv.gz", "--out", out];
    run(
        folder,
        &[&["identify"][..], &DEVICE, &log, &HANDS, further].concat(),
    );
    let json = std::fs::read_to_string(folder.path(out).join("identified.json")).unwrap();
    serde_json::from_str(&json).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    let numbers = value.as_array().unwrap().iter();
    numbers.map(|number| number.as_f64().unwrap()).collect()
}

/// Root mean square of how far a device is from what the camera system sees of each hand at postures of no log \[m\].
fn errors_m(device: &Device, truth: &Value) -> Vec<f64> {
    let unseen = truth["built"]["unseen"].as_array().unwrap();
    let hands = device.hands.iter().map(|hand| hand.name.clone());
    let errors = hands.map(|hand| {
        let readings: Vec<Vec<f64>> = unseen.iter().map(|row| numbers(&row["joints"])).collect();
        let recording = Recording {
            line: (2..unseen.len() as u64 + 2).collect(),
            joint: (0..device.joints.len())
                .map(|joint| readings.iter().map(|row| row[joint]).collect())
                .collect(),
            hand: Some(vec![hand.clone(); unseen.len()]),
            ..Recording::default()
        };
        let torques = holding_torques_nm(device, &recording).unwrap().unwrap();
        let mut evaluation = Evaluation::new(device);
        let mut sum = 0.0;
        for (row, own) in unseen.iter().enumerate() {
            evaluation.choose_hand(device.hand_at(&recording, row));
            let torques: Vec<f64> = torques.iter().map(|column| column[row]).collect();
            evaluation.set_torques(&torques);
            evaluation.move_pose_to(&readings[row]).unwrap();
            let mount = Mount {
                tool: device.surroundings.tool_index(&hand),
                base: None,
            };
            let tracked = Tracked::new(device, evaluation.pose().unwrap(), mount).unwrap();
            let seen = numbers(&own["seen_m"][&hand]);
            let seen = |axis: usize| tracked.pose().position_m[axis] - seen[axis];
            sum += (0..3).map(|axis| seen(axis).powi(2)).sum::<f64>();
        }
        (sum / (3 * unseen.len()) as f64).sqrt()
    });
    errors.collect()
}

fn load(path: &Path) -> Device {
    let loaded = Device::load(path).unwrap();
    assert_eq!(loaded.warnings, Vec::<String>::new());
    loaded.device
}

/// What the joints yield is found within its intervals, and both hands are predicted at postures that no log has.
#[test]
fn both_arms_are_recovered_in_one_fit() {
    let (folder, truth) = humanoid();
    let rigid = identify(&folder, "rigid", &[]);
    let elastic = identify(&folder, "elastic", &["--with", "joint-compliance"]);
    let known = numbers(&truth["built"]["compliance_rad_per_nm"]);
    let parameters = elastic["parameters"].as_array().unwrap();
    let (mut found, mut missed) = (0, Vec::new());
    for (joint, wanted) in known.iter().enumerate() {
        let name = format!("joint_compliance{}", joint + 1);
        let own = parameters
            .iter()
            .find(|own| own["name"] == name.as_str())
            .unwrap();
        let (Some(low), Some(high)) = (own["ci95"][0].as_f64(), own["ci95"][1].as_f64()) else {
            continue;
        };
        found += 1;
        if !(low..=high).contains(wanted) {
            missed.push(format!("{name}: {wanted} is not in {low}..{high}"));
        }
    }
    // of so many at 95 % one is missed by chance, three are not
    assert!(found >= 9 && missed.len() <= 2, "{found} found, {missed:?}");
    let noise_m = truth["built"]["noise_m"].as_f64().unwrap();
    let errors = [("rigid", 1.0), ("elastic", 0.5)].map(|(out, most)| {
        let device = load(&folder.path(out).join("identified.toml"));
        let errors = errors_m(&device, &truth);
        if out == "elastic" {
            assert!(
                errors.iter().all(|error| *error < most * noise_m),
                "{errors:?}"
            );
        }
        errors
    });
    assert!(
        errors[0]
            .iter()
            .zip(&errors[1])
            .all(|(rigid, elastic)| rigid > &(3.0 * elastic)),
        "{errors:?}"
    );
    // each hand has a line of its own
    let hands = rigid["channels"][0]["hands"].as_array().unwrap();
    let names: Vec<&str> = hands
        .iter()
        .map(|hand| hand["hand"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["left_hand", "right_hand"]);
    assert!(hands.iter().all(|hand| hand["readings"] == 480));
    // what is recorded is made again
    let text = std::fs::read_to_string(folder.path("rigid/identified.json")).unwrap();
    assert!(text.contains("\"--tip=left_hand\"") && text.contains("\"--tip=right_hand\""));
    run(&folder, &["verify", "rigid"]);
}

/// One arm alone says less of the torso than both do.
#[test]
fn two_arms_tell_more_of_the_torso_than_one() {
    let (folder, _) = humanoid();
    let both = identify(&folder, "both", &["--with", "joint-compliance"]);
    let text = std::fs::read(folder.path("log.csv.gz")).unwrap();
    let mut log = String::new();
    std::io::Read::read_to_string(&mut flate2::read::GzDecoder::new(text.as_slice()), &mut log)
        .unwrap();
    // the columns of the torso and the left arm, and its rows
    let rows = log
        .lines()
        .filter(|line| !line.contains("right_hand"))
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            [&cells[..8], &cells[15..]].concat().join(",")
        });
    folder.write("left.csv", &(rows.collect::<Vec<_>>().join("\n") + "\n"));
    let log = [
        "--log",
        "left.csv",
        "--out",
        "left",
        "--tip",
        "left_hand",
        "--with",
        "joint-compliance",
    ];
    run(&folder, &[&["identify"][..], &DEVICE, &log].concat());
    let left = std::fs::read_to_string(folder.path("left/identified.json")).unwrap();
    let left: Value = serde_json::from_str(&left).unwrap();
    let width = |result: &Value, name: &str| {
        let parameters = result["parameters"].as_array().unwrap();
        let own = parameters.iter().find(|own| own["name"] == name).unwrap();
        Some(own["ci95"][1].as_f64()? - own["ci95"][0].as_f64()?)
    };
    let mut compared = 0;
    for joint in 1..=2 {
        let name = format!("joint_compliance{joint}");
        if let (Some(both), Some(left)) = (width(&both, &name), width(&left, &name)) {
            assert!(
                both < left,
                "{name}: {both:e} with both arms, {left:e} with one"
            );
            compared += 1;
        }
    }
    assert!(compared > 0);
}

/// What is made of one chain says so and what to do.
#[test]
fn what_takes_one_chain_refuses_hands() {
    let (folder, _) = humanoid();
    let log = ["--log", "log.csv.gz"];
    let plan = ["--measure", "position", "--poses", "20"];
    let commands: [(&str, &str, &[&str]); 5] = [
        ("play", "page.html", &log),
        ("plan", "plan", &plan),
        ("simulate", "simulated.csv", &["--seconds", "5"]),
        ("export", "model.h", &["--format", "c-header"]),
        ("export", "model.rs", &["--format", "rust"]),
    ];
    for (command, out, further) in commands {
        let (status, _, said) =
            folder.run(&[&[command, "--out", out][..], &DEVICE, &HANDS, further].concat());
        assert_eq!(status, Some(2), "{command}: {said}");
        assert!(
            said.contains("the device has the hands left_hand, right_hand, and"),
            "{command}: {said}"
        );
        assert!(
            said.contains("of a URDF with one --tip"),
            "{command}: {said}"
        );
        assert!(!folder.path(out).exists(), "{command}");
    }
    // an MJCF has a site for each hand
    let export = ["export", "--format", "mjcf", "--out", "model.xml"];
    run(&folder, &[&export[..], &DEVICE, &HANDS].concat());
    let text = std::fs::read_to_string(folder.path("model.xml")).unwrap();
    for hand in ["left_hand", "right_hand"] {
        assert!(text.contains(&format!("<site name=\"{hand}\"")), "{text}");
    }
    // as a file of its own it is the same device
    let export = ["export", "--format", "toml", "--out", "device.toml"];
    run(&folder, &[&export[..], &DEVICE, &HANDS].concat());
    let text = std::fs::read_to_string(folder.path("device.toml")).unwrap();
    assert!(
        text.contains("[[hand]]") && text.contains("parent = 3"),
        "{text}"
    );
    let (printed, _) = run(&folder, &["check", "device.toml", "log.csv.gz"]);
    assert!(
        printed.contains("channels (readings): position (320)"),
        "{printed}"
    );
}

/// A log of another device's hands is refused with file, line and column.
#[test]
fn a_hand_of_no_device_is_refused() {
    let (folder, _) = humanoid();
    let head: Vec<String> = (1..=14).map(|joint| format!("theta{joint}_rad")).collect();
    let row = ["0.1"; 14].join(",");
    let log = format!(
        "{},hand,x_m,y_m,z_m\n{row},left_hand,1,2,3\n{row},foot,1,2,3\n",
        head.join(",")
    );
    folder.write("feet.csv", &log);
    let run = |tips: &[&str]| {
        folder.run(
            &[
                &["check", "robot.urdf", "feet.csv", "--rig", "rig.toml"][..],
                tips,
            ]
            .concat(),
        )
    };
    let (status, _, said) = run(&HANDS);
    assert_eq!(status, Some(2));
    assert!(
        said.contains("feet.csv:3:15") && said.contains("the device has no hand `foot`"),
        "{said}"
    );
}
