//! Robots' own formats: ROS 2's transmissions, origins as a xacro takes them, and URDFs in the programs that read them.
//!
//! The programs (Pinocchio, Drake, yourdfpy, xacro) are asked through Python: the interpreter of `HAPTICAL_PYTHON`, or
//! `python3`. Where one is missing the test says that it skips; what can be said without them is said without them.

use std::path::{Path, PathBuf};

use haptical_model::{Device, DeviceChain};
use haptical_urdf::{BaseAndTip, device_from_urdf};
use roxmltree::{Document, Node};
use serde_json::{Value, json};

use crate::export::export;
use crate::python::interpreter;
use crate::text;
use crate::urdf::fixture;

/// How far a program's pose may be from ours \[m\], or as an entry of a rotation.
const SAME_POSE: f64 = 1e-9;

fn script() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/robot_formats.py")
}

/// An interpreter with a program; none is said on standard output.
fn python(program: &str) -> Option<String> {
    let script = script();
    interpreter(&[script.to_str()?, "--has", program], program)
}

fn ask(python: &str, question: &Value) -> Value {
    crate::python::ask(python, &script(), question)
}

/// The arm of fixtures/urdf as a device whose numbers are off, as a file in a folder.
fn calibrated(folder: &Path) -> Option<(PathBuf, PathBuf, Device)> {
    let urdf = fixture("arm.urdf")?;
    let text = std::fs::read_to_string(&urdf).unwrap();
    let read = device_from_urdf(&text, "arm.urdf", BaseAndTip::to("palm")).unwrap();
    let mut device = read.device;
    for (row, link) in device.links.iter_mut().enumerate().skip(1) {
        let off = 1e-3 * (1 + row) as f64;
        (link.a_m, link.alpha_rad, link.d_m) = (off, -off, 0.5 * off);
        (link.theta_rad, link.beta_rad) = (2.0 * off, 0.3 * off);
    }
    let path = folder.join("calibrated.toml");
    std::fs::write(&path, device.to_new_toml().unwrap()).unwrap();
    let device = Device::load(&path).unwrap().device;
    Some((urdf, path, device))
}

fn readings(device: &Device, case: usize) -> Vec<f64> {
    let joints = device.joints.iter().enumerate();
    let spread = joints.map(|(index, joint)| {
        let share = (0.618_034 * (1 + case * device.joints.len() + index) as f64).fract();
        let (lower, upper) = (joint.lower_rad.max(-1.5), joint.upper_rad.min(1.5));
        lower + (upper - lower) * share
    });
    spread.collect()
}

/// Position, then the rotation row by row.
fn pose(device: &Device, readings: &[f64]) -> Vec<f64> {
    let pose = DeviceChain::new(device).pose(readings).unwrap();
    let mut numbers: Vec<f64> = pose.position_m.iter().copied().collect();
    // nalgebra's numbers are column by column
    numbers.extend(pose.rotation.transpose().iter());
    numbers
}

fn apart(one: &[f64], other: &[f64]) -> f64 {
    assert_eq!(one.len(), other.len());
    let pairs = one.iter().zip(other).map(|(a, b)| (a - b).abs());
    pairs.fold(0.0, f64::max)
}

fn numbers(value: &Value) -> Vec<f64> {
    let all = value.as_array().unwrap().iter();
    all.map(|own| own.as_f64().unwrap()).collect()
}

/// Whether a program has the poses that the device has.
fn has_our_poses(
    program: &str,
    file: &Path,
    device: &Device,
    (root, tip): (&str, &str),
) -> Option<Value> {
    let python = python(program)?;
    let text = std::fs::read_to_string(file).unwrap();
    let document = Document::parse(&text).unwrap();
    let joints = document
        .descendants()
        .filter(|node| node.has_tag_name("joint"));
    let names: Vec<&str> = joints.filter_map(|node| node.attribute("name")).collect();
    let of_device: Vec<String> = device
        .joints
        .iter()
        .map(|joint| match names.contains(&joint.name.as_str()) {
            true => joint.name.clone(),
            false => format!("joint{}", joint.name),
        })
        .collect();
    let all: Vec<Vec<f64>> = (0..20).map(|case| readings(device, case)).collect();
    let question = json!({
        "program": program, "file": file, "tip": tip, "root": root, "joints": of_device, "readings": all, "steps": true,
    });
    let answer = ask(&python, &question);
    for (readings, own) in all.iter().zip(answer["poses"].as_array().unwrap()) {
        let apart = apart(&numbers(own), &pose(device, readings));
        assert!(
            apart < SAME_POSE,
            "{program}, {}: {apart:e}",
            file.display()
        );
    }
    Some(answer)
}

/// A URDF that was written is a device again, with the same poses; a corrected one has the names of the original one, so that
/// an SRDF fits.
#[test]
fn a_urdf_that_was_written_has_the_same_poses_and_names() {
    let folder = tempfile::tempdir().unwrap();
    let Some((urdf, device_file, device)) = calibrated(folder.path()) else {
        return;
    };
    let (urdf, out) = (urdf.to_str().unwrap(), folder.path().join("out.urdf"));
    for program in ["pinocchio", "drake", "isaac", "moveit"] {
        for given in [&["--urdf", urdf, "--tip", "palm"][..], &[]] {
            let flags = [given, &["--for", program, "--force"]].concat();
            let output = export(&device_file, "urdf", &out, &flags);
            assert!(output.status.success(), "{}", text(&output.stderr));
            let written = std::fs::read_to_string(&out).unwrap();
            let tip = if given.is_empty() { "handle" } else { "palm" };
            let again = device_from_urdf(&written, "out.urdf", BaseAndTip::to(tip))
                .unwrap()
                .device;
            for case in 0..50 {
                let readings = readings(&device, case);
                let apart = apart(&pose(&device, &readings), &pose(&again, &readings));
                assert!(apart < 1e-12, "{program} {given:?}: {apart:e}");
            }
            if given.is_empty() {
                continue;
            }
            let original = std::fs::read_to_string(urdf).unwrap();
            for tag in ["link", "joint"] {
                assert_eq!(names(&written, tag), names(&original, tag));
            }
        }
    }
}

fn names(xml: &str, tag: &str) -> Vec<String> {
    let document = Document::parse(xml).unwrap();
    let own = document.root_element().children();
    let own = own.filter(|node| node.has_tag_name(tag));
    own.map(|node| node.attribute("name").unwrap().to_owned())
        .collect()
}

#[test]
fn pinocchio_drake_and_yourdfpy_have_our_poses() {
    let folder = tempfile::tempdir().unwrap();
    let Some((urdf, device_file, device)) = calibrated(folder.path()) else {
        return;
    };
    let haptic7 = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/devices/haptic7.toml");
    let handle = Device::load(&haptic7).unwrap().device;
    for program in ["pinocchio", "drake", "yourdfpy"] {
        let corrected = folder.path().join(format!("{program}-corrected.urdf"));
        let new = folder.path().join(format!("{program}-new.urdf"));
        let mut flags = vec!["--urdf", urdf.to_str().unwrap(), "--tip", "palm"];
        let own = ["--for", program];
        let own = if program == "yourdfpy" {
            &[][..]
        } else {
            &own[..]
        };
        flags.extend(own);
        assert!(
            export(&device_file, "urdf", &corrected, &flags)
                .status
                .success()
        );
        // the rest of this file is one that Drake refuses: a mesh in a package that is nowhere
        if program != "drake" {
            has_our_poses(program, &corrected, &device, ("world", "palm"));
        }
        assert!(export(&haptic7, "urdf", &new, own).status.success());
        let Some(answer) = has_our_poses(program, &new, &handle, ("base", "handle")) else {
            continue;
        };
        if program == "drake" {
            assert_eq!(answer["actuators"], 7);
        }
        if program == "pinocchio" {
            assert!(answer["least_inertia"].as_f64().unwrap() > 1e-7, "{answer}");
        }
    }
}

#[test]
fn what_a_program_makes_of_a_urdf_is_said_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let Some((urdf, device_file, _)) = calibrated(folder.path()) else {
        return;
    };
    let out = folder.path().join("out.urdf");
    let of_original = [
        "--urdf",
        urdf.to_str().unwrap(),
        "--tip",
        "palm",
        "--force",
        "--for",
    ];
    let said = |program: &str| {
        let output = export(
            &device_file,
            "urdf",
            &out,
            &[&of_original[..], &[program]].concat(),
        );
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stderr)
    };
    let drake = said("drake");
    assert!(
        drake.contains("Drake: `shoulder_lift`, `elbow`") && drake.contains("and so no actuator"),
        "{drake}"
    );
    let pinocchio = said("pinocchio");
    assert!(
        pinocchio.contains("two numbers in q, its cosine and its sine: `elbow`"),
        "{pinocchio}"
    );
    assert!(!pinocchio.contains("actuator"));
    // a rail that carries a link which has a mass is no link without one
    assert!(said("isaac").contains("make") && !said("isaac").contains("`upper`"));
    let output = export(&device_file, "mjcf", &out, &["--for", "drake", "--force"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("--for is for --format urdf alone"));
}

/// A drive that is a line, and one that is none.
const DRIVES: &str = "[device]\nname = \"7-axis arm\"\n[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n[[link]]\na_m = 0.3\nalpha_rad = 0.0\nd_m = 0.0\n\
    [[link]]\na_m = 0.2\nalpha_rad = 0.0\nd_m = 0.0\n\
    [[joint]]\nname = \"shoulder\"\ntransmission = \"capstan\"\ntransmission_ratio = 8.0\ndrum_distance_m = 0.07\nlower_rad = -1.0\n\
    upper_rad = 1.2\n[joint.transmission_error]\noffset_rad = 0.013\nratio_deviation = -0.025\n\
    output_drum_xy_m = [0.0, 0.0]\ninput_drum_xy_m = [0.0, 0.0]\n\
    [[joint]]\nname = \"elbow\"\ntransmission = \"capstan\"\ntransmission_ratio = 8.0\ndrum_distance_m = 0.07\nlower_rad = -1.0\n\
    upper_rad = 1.0\n[joint.transmission_error]\noffset_rad = -0.004\nratio_deviation = 0.01\n\
    output_drum_xy_m = [0.0004, -0.0003]\ninput_drum_xy_m = [0.0, 0.0]\n";

/// `<mechanical_reduction>` and `<offset>` of each `<transmission>`, by the joint's name.
fn transmissions(xml: &str) -> Vec<(String, f64, f64)> {
    let document = Document::parse(xml).unwrap();
    let of_tag = |node: Node<'_, '_>, tag: &str| -> f64 {
        let own = node.children().find(|own| own.has_tag_name(tag)).unwrap();
        own.text().unwrap().trim().parse().unwrap()
    };
    let all = document
        .descendants()
        .filter(|node| node.has_tag_name("transmission"));
    let all = all.map(|node| {
        let joint = node
            .children()
            .find(|own| own.has_tag_name("joint"))
            .unwrap();
        assert_eq!(joint.attribute("role"), Some("joint1"));
        let name = joint.attribute("name").unwrap().to_owned();
        (
            name,
            of_tag(joint, "mechanical_reduction"),
            of_tag(joint, "offset"),
        )
    });
    all.collect()
}

/// ros2_control's law is `joint = actuator / mechanical_reduction + offset`: that of the drive where the drive is a line.
#[test]
fn ros2_control_has_the_drives_offsets_and_reductions() {
    let folder = tempfile::tempdir().unwrap();
    let (file, out) = (
        folder.path().join("arm.toml"),
        folder.path().join("arm.xacro"),
    );
    std::fs::write(&file, DRIVES).unwrap();
    let device = Device::load(&file).unwrap().device;
    let output = export(&file, "ros2-control", &out, &[]);
    let said = text(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(
        said.contains("joint `elbow`: the line of its transmission leaves up to")
            && !said.contains("shoulder"),
        "{said}"
    );
    let written = std::fs::read_to_string(&out).unwrap();
    // a macro is called as an element, and no element's name begins with a digit
    assert!(
        written.contains("<xacro:macro name=\"_7_axis_arm_ros2_control\""),
        "{written}"
    );
    let found = transmissions(&written);
    assert_eq!(
        found.iter().map(|own| own.0.as_str()).collect::<Vec<_>>(),
        ["shoulder", "elbow"]
    );
    let mut worst = [0.0_f64; 2];
    for (joint, (_, reduction, offset)) in found.iter().enumerate() {
        for step in 0..=20 {
            let reading = -1.0 + 0.1 * f64::from(step);
            let wanted = reading + device.joints[joint].error_rad(reading).unwrap();
            worst[joint] = worst[joint].max((reading / reduction + offset - wanted).abs());
        }
    }
    // what the drum's place does is no line: a few milliradians, of which the line leaves less
    assert!(
        worst[0] < 1e-12 && (1e-4..3e-3).contains(&worst[1]),
        "{worst:?}"
    );
    // by xacro itself, as the original URDF would include it
    let Some(python) = python("xacro") else {
        return;
    };
    let Some((_, device_file, device)) = calibrated(folder.path()) else {
        return;
    };
    assert!(
        export(&device_file, "ros2-control", &out, &["--force"])
            .status
            .success()
    );
    for (zeros, is_in) in [("false", 0.0), ("true", 1.0)] {
        let robot = format!(
            "<robot name=\"a\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\"><xacro:include filename=\"{}\"/>\
             <xacro:arm_ros2_control zeros_in_offsets=\"{zeros}\"/></robot>",
            out.display()
        );
        let whole = folder.path().join("whole.xacro");
        std::fs::write(&whole, robot).unwrap();
        let answer = ask(&python, &json!({"program": "xacro", "file": whole}));
        let found = transmissions(answer["text"].as_str().unwrap());
        assert_eq!(found.len(), device.joints.len());
        for (joint, (name, reduction, offset)) in found.iter().enumerate() {
            let link = device.links[device.own_row(joint).unwrap()];
            let zero = if name == "extension" {
                link.d_m
            } else {
                link.theta_rad
            };
            assert!(
                zero != 0.0 && *reduction == 1.0 && (offset - is_in * zero).abs() < 1e-15,
                "{name} {offset}"
            );
        }
    }
}

/// The origins of the table are those of the corrected URDF, number by number.
#[test]
fn a_xacros_origins_are_those_of_the_corrected_urdf() {
    let folder = tempfile::tempdir().unwrap();
    let Some((urdf, device_file, _)) = calibrated(folder.path()) else {
        return;
    };
    let (yaml, xml) = (
        folder.path().join("kinematics.yaml"),
        folder.path().join("arm.urdf"),
    );
    let flags = ["--urdf", urdf.to_str().unwrap(), "--tip", "palm"];
    let output = export(&device_file, "kinematics-yaml", &yaml, &flags);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(export(&device_file, "urdf", &xml, &flags).status.success());
    let (yaml, xml) = (
        std::fs::read_to_string(yaml).unwrap(),
        std::fs::read_to_string(xml).unwrap(),
    );
    let document = Document::parse(&xml).unwrap();
    let mut lines = yaml
        .lines()
        .filter(|line| !line.trim_start().starts_with('#'));
    assert_eq!(lines.next(), Some("kinematics:"));
    let mut entries = 0;
    while let Some(line) = lines.next() {
        let key = line.trim();
        if key.starts_with("hash: haptical_") {
            continue;
        }
        let key = key.strip_suffix(':').unwrap();
        let numbers: Vec<f64> = ["x", "y", "z", "roll", "pitch", "yaw"]
            .iter()
            .map(|name| {
                let own = lines.next().unwrap().trim().strip_prefix(name).unwrap();
                own.strip_prefix(": ").unwrap().parse().unwrap()
            })
            .collect();
        let joint = document.descendants().find(|node| {
            let child = node.children().find(|own| own.has_tag_name("child"));
            node.has_tag_name("joint") && child.and_then(|own| own.attribute("link")) == Some(key)
        });
        let origin = joint
            .unwrap()
            .children()
            .find(|own| own.has_tag_name("origin"))
            .unwrap();
        let written: Vec<f64> = ["xyz", "rpy"]
            .iter()
            .flat_map(|name| origin.attribute(*name).unwrap().split(' '))
            .map(|word| word.parse().unwrap())
            .collect();
        assert_eq!(numbers, written, "{key}");
        entries += 1;
    }
    // the moving rows, and what is fixed behind the last one
    assert!(entries >= 7, "{entries}\n{yaml}");
    let output = export(
        &device_file,
        "kinematics-yaml",
        &folder.path().join("none.yaml"),
        &[],
    );
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("--urdf names none"));
}
