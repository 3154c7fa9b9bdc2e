//! `--base` at the one hand of a robot, `--tip` at the other: finger tips that touch.

use haptical_model::DeviceChain;
use haptical_urdf::{BaseAndTip, device_from_urdf};
use serde_json::Value;

use crate::folder::Folder;
use crate::two_arms::{ELBOWS_RAD, log, touches, urdf};

const ENDS: [&str; 4] = ["--base", "left_finger", "--tip", "right_finger"];

/// Both fingers' places are those of the description, and stay: the distance of the tips is 0.
const RIG: &str =
    "[tracker]\nbase = \"known\"\ntool = \"known\"\nposition_sd_m = 1e-4\nrotation_sd_rad = 1e-3\n";

fn identified(folder: &Folder, log: &str, out: &str) -> Vec<(String, f64, String)> {
    let arguments = [
        "identify",
        "--device",
        "robot.urdf",
        "--rig",
        "rig.toml",
        "--log",
        log,
        "--out",
        out,
    ];
    let (status, _, said) = folder.run(&[&arguments[..], &ENDS].concat());
    assert_eq!(status, Some(0), "{said}");
    assert!(
        said.contains("the base `left_finger` moves with respect to the root `pelvis`, so gravity has no fixed"),
        "{said}"
    );
    let json = std::fs::read_to_string(folder.path(out).join("identified.json")).unwrap();
    let json: Value = serde_json::from_str(&json).unwrap();
    let parameters = json["parameters"].as_array().unwrap().iter();
    let word = |own: &Value, key: &str| own[key].as_str().unwrap().to_owned();
    // what is not known has no value
    let known = parameters.filter_map(|own| Some((own, own["value"].as_f64()?)));
    known
        .map(|(own, value)| (word(own, "name"), value, word(own, "status")))
        .collect()
}

/// The elbows are turned by more than they read: rows 2 (upwards, left) and 7 (downwards, right) say so, and nothing
/// else does, whether the rows say that the distance is 0 or that both tips are one point.
#[test]
fn touching_hands_tell_the_elbows() {
    let folder = Folder::with("robot.urdf", &urdf());
    folder.write("rig.toml", RIG);
    folder.write("zero.csv", &log("x_m,y_m,z_m", "0,0,0"));
    folder.write("contact.csv", &log("contact", "fingers"));
    for (log, out) in [("zero.csv", "zero"), ("contact.csv", "contact")] {
        let found = identified(&folder, log, out);
        for (name, value, status) in found {
            let expected = match name.as_str() {
                "theta2" => ELBOWS_RAD[0],
                "theta7" => ELBOWS_RAD[1],
                // where the tips meet in the left one's frame is fitted
                _ if name.starts_with("contact.") => continue,
                _ => 0.0,
            };
            assert!((value - expected).abs() < 1e-8, "{out}: {name} is {value}");
            assert!(
                // rows of six numbers each have more than a chain needs
                expected == 0.0 || status == "combination",
                "{name} is {status}"
            );
        }
    }
    // what is recorded is recomputed
    let json = std::fs::read_to_string(folder.path("zero/identified.json")).unwrap();
    assert!(json.contains("\"--base=left_finger\"") && json.contains("\"--tip=right_finger\""));
    let (status, printed, said) = folder.run(&["verify", "zero"]);
    assert_eq!(status, Some(0), "{printed}{said}");
    // the corrected file moves as the device
    let arguments = [
        "export",
        "--device",
        "zero/identified.toml",
        "--format",
        "urdf",
        "--urdf",
        "robot.urdf",
    ];
    let export =
        |ends: &[&str]| folder.run(&[&arguments[..], &["--out", "corrected.urdf"], ends].concat());
    let (status, _, said) = export(&["--tip", "right_finger"]);
    assert_eq!(status, Some(2));
    assert!(
        said.contains("next: give --urdf or --mjcf, --base and --tip as the device came from them"),
        "{said}"
    );
    let (status, _, said) = export(&ENDS);
    assert_eq!(status, Some(0), "{said}");
    let corrected = std::fs::read_to_string(folder.path("corrected.urdf")).unwrap();
    let ends = BaseAndTip::between("left_finger", "right_finger");
    let device = device_from_urdf(&corrected, "corrected.urdf", ends)
        .unwrap()
        .device;
    for readings in touches() {
        let apart = DeviceChain::new(&device)
            .pose(&readings)
            .unwrap()
            .position_m;
        assert!(apart.norm() < 1e-9, "{apart}");
    }
}

/// Every command that takes a tip takes a base, and results say so.
#[test]
fn every_command_takes_a_base() {
    let folder = Folder::with("robot.urdf", &urdf());
    folder.write("rig.toml", RIG);
    folder.write("log.csv", &log("x_m,y_m,z_m", "0,0,0"));
    let with_log = [
        "--device",
        "robot.urdf",
        "--log",
        "log.csv",
        "--rig",
        "rig.toml",
    ];
    let planned = [
        "--device",
        "robot.urdf",
        "--measure",
        "position",
        "--poses",
        "20",
        "--candidates",
        "40",
    ];
    let commands: [(&str, &[&str], &str); 4] = [
        ("diagnose", &with_log, "out/gap.json"),
        ("play", &with_log, "page.html"),
        ("plan", &planned, "plan/plan.json"),
        (
            "simulate",
            &["--device", "robot.urdf", "--seconds", "5"],
            "simulated.csv",
        ),
    ];
    for (command, arguments, result) in commands {
        let out = match command {
            "diagnose" | "plan" => result.split('/').next().unwrap(),
            _ => result,
        };
        let (status, _, said) = folder.run(&[&[command, "--out", out], arguments, &ENDS].concat());
        assert_eq!(status, Some(0), "{command}: {said}");
        let record = match command {
            "simulate" => "simulated.csv.provenance.json",
            _ => result,
        };
        let record = std::fs::read_to_string(folder.path(record)).unwrap();
        let is_recorded = ["--base=left_finger", "--base left_finger"]
            .iter()
            .any(|flag| record.contains(flag));
        assert!(is_recorded, "{command} does not record the base");
    }
    for result in ["out", "plan"] {
        assert_eq!(folder.run(&["verify", result]).0, Some(0));
    }
    let (status, printed, said) =
        folder.run(&[&["check", "robot.urdf", "log.csv"], &ENDS[..]].concat());
    assert_eq!(status, Some(0), "{said}");
    assert!(printed.contains("joints: 8, links: 9"), "{printed}");
    let exported = [
        "export",
        "--device",
        "robot.urdf",
        "--format",
        "toml",
        "--out",
        "device.toml",
    ];
    assert_eq!(folder.run(&[&exported[..], &ENDS].concat()).0, Some(0));
    let device = std::fs::read_to_string(folder.path("device.toml")).unwrap();
    assert!(device.contains("name = \"left_joint4\"") && !device.contains("[gravity]"));
}

#[test]
fn a_base_is_refused_with_what_to_do() {
    let folder = Folder::with("robot.urdf", &urdf());
    folder.write("log.csv", &log("x_m,y_m,z_m", "0,0,0"));
    let said = |arguments: &[&str]| {
        let (status, _, said) = folder.run(arguments);
        assert_eq!(status, Some(2), "{said}");
        said
    };
    assert_eq!(
        said(&["check", "robot.urdf", "--base", "left_finger"]),
        "error: --base left_finger needs --tip too\n  where: robot.urdf\n  next: name the tip with --tip; branches end \
         at `pelvis`, `right_finger`\n"
    );
    let same = said(&["check", "robot.urdf", "--base", "trunk", "--tip", "trunk"]);
    assert!(
        same.contains(
            "next: name links with a joint that moves between them with --base and --tip\n"
        ),
        "{same}"
    );
    let unknown = said(&["check", "robot.urdf", "--base", "nose", "--tip", "trunk"]);
    assert!(
        unknown.starts_with("error: there is no link `nose`; ")
            && unknown.contains("next: correct the name that is given with --base or --tip\n"),
        "{unknown}"
    );
    folder.write("device.toml", "[[joint]]\n");
    let table = said(&["check", "device.toml", "--base", "trunk"]);
    assert!(
        table.starts_with(
            "error: --base names a link of a URDF or an MJCF, and device.toml is none\n"
        ),
        "{table}"
    );
    // a log of another chain: the chains from this base are counted
    let chain = ["--base", "left_link2", "--tip", "left_finger"];
    folder.write("short.csv", "theta1_rad\n0.1\n0.2\n");
    let other = said(
        &[
            &["plan", "--device", "robot.urdf", "--log", "short.csv"],
            &chain[..],
        ]
        .concat(),
    );
    assert!(
        other.contains("(joint `left_joint4`): the chain from `left_link2` ends at `left_finger`, as --tip says\n")
            && other.contains(
                "next: the chains from `left_link2` to `left_link3`, `left_link1` have 1 joint, as the log has: give \
                 --tip with the one that was measured\n"
            ),
        "{other}"
    );
}
