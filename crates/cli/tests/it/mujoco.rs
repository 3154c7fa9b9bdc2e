//! Exported models in MuJoCo itself: they stand, they follow, and their handles are where Haptical has them.
//!
//! Python with `mujoco` and `numpy` is asked for: the interpreter of `HAPTICAL_PYTHON`, or `python3`. Without it each test
//! says that it skips.

use std::path::{Path, PathBuf};

use haptical_model::kinematics::Pose;
use haptical_model::{Device, DeviceChain};
use serde_json::{Value, json};

use crate::export::export;
use crate::python::interpreter;
use crate::text;

/// How far MuJoCo's pose of a site may be from ours \[m\], or as an entry of a rotation.
const SAME_POSE: f64 = 1e-9;
/// How far weight may pull a held joint away \[rad\], \[m\]: assumption A151, and what springs add to it.
const SAG: f64 = 0.012;
/// How far a joint may be behind its target, at 0.6 rad/s: velocity over half the natural frequency, and the sag.
const LAG: f64 = 0.05;
/// How long is simulated \[s\]. The models that the command wrote before had no inertias, and left the number range after
/// 0.23 s.
const SECONDS: f64 = 10.0;

/// An interpreter with MuJoCo; none is said on standard output.
pub(crate) fn python() -> Option<String> {
    interpreter(&["-c", "import mujoco, numpy"], "mujoco")
}

/// Asks tests/fixtures/mujoco_stands.py.
fn ask(python: &str, question: &Value) -> Value {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/mujoco_stands.py");
    crate::python::ask(python, &script, question)
}

fn repository(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../fixtures")
        .join(name);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: {name} is not here, as in a packaged crate");
    None
}

/// Readings that cover most of each joint's range, by a rule without a pattern.
fn readings(device: &Device, case: usize) -> Vec<f64> {
    let joints = device.joints.iter().enumerate();
    let spread = |(index, joint): (usize, &haptical_model::Joint)| {
        let share = (0.618_034 * (1 + case * device.joints.len() + index) as f64).fract();
        let (lower, upper) = (joint.lower_rad.max(-1.5), joint.upper_rad.min(1.5));
        lower + (upper - lower) * share
    };
    joints.map(spread).collect()
}

/// What is exported, how, and what a simulation needs.
struct Case {
    device: PathBuf,
    flags: Vec<String>,
    site: &'static str,
    /// MuJoCo's names of the joints with a row of their own.
    names: Vec<String>,
    /// Joint value in the file per reading.
    per_reading: Vec<f64>,
}

/// Exports a device as MJCF, compares its handle with ours, and simulates it; gives what was found.
fn stands(python: &str, model: &Device, case: &Case) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.xml");
    let flags: Vec<&str> = case.flags.iter().map(String::as_str).collect();
    let output = export(&case.device, "mjcf", &file, &flags);
    assert!(output.status.success(), "{}", text(&output.stderr));

    // rows that follow are bound by equalities, which kinematics alone do not know: their values are set too
    let written = std::fs::read_to_string(&file).unwrap();
    let document = roxmltree::Document::parse(&written).unwrap();
    let bonds: Vec<(String, String, f64)> = document
        .descendants()
        .filter(|node| node.has_tag_name("joint") && node.has_attribute("joint1"))
        .map(|node| {
            let own = |key: &str| node.attribute(key).unwrap().to_owned();
            let gain = own("polycoef").split(' ').nth(1).unwrap().parse().unwrap();
            (own("joint1"), own("joint2"), gain)
        })
        .filter(|(first, _, _)| !first.ends_with("_coupling"))
        .collect();
    let mut pose_joints = case.names.clone();
    pose_joints.extend(bonds.iter().map(|(first, _, _)| first.clone()));
    let mut poses = Vec::new();
    let mut expected: Vec<Pose> = Vec::new();
    for number in 0..50 {
        let readings = readings(model, number);
        let mut values: Vec<f64> = readings
            .iter()
            .zip(&case.per_reading)
            .map(|(reading, scale)| reading * scale)
            .collect();
        for (_, second, gain) in &bonds {
            let source = case.names.iter().position(|name| name == second).unwrap();
            values.push(gain * values[source]);
        }
        poses.push(values);
        expected.push(DeviceChain::new(model).pose(&readings).unwrap());
    }
    let amplitude =
        |joint: &haptical_model::Joint| (0.25 * (joint.upper_rad - joint.lower_rad)).min(0.3);
    let amplitudes: Vec<f64> = (model.joints.iter().zip(&case.per_reading))
        .map(|(joint, scale)| amplitude(joint) * scale)
        .collect();
    let question = json!({
        "file": file, "site": case.site, "joints": case.names, "pose_joints": pose_joints, "poses": poses,
        "seconds": SECONDS, "amplitude": amplitudes, "speed": 2.0,
    });
    let found = ask(python, &question);
    for (found, expected) in found["poses"].as_array().unwrap().iter().zip(&expected) {
        let number = |value: &Value| value.as_f64().unwrap();
        for axis in 0..3 {
            let gap = (number(&found[0][axis]) - expected.position_m[axis]).abs();
            assert!(gap < SAME_POSE, "{gap:e}");
            for other in 0..3 {
                let gap = number(&found[1][3 * axis + other]) - expected.rotation[(axis, other)];
                assert!(gap.abs() < SAME_POSE, "{gap:e}");
            }
        }
    }
    for (way, bound) in [("hold", SAG), ("follow", LAG)] {
        let run = &found[way];
        let said = format!("{} {way}: {run}", case.device.display());
        println!(
            "{} {way}: {} s, warnings {}, largest error {}",
            case.device.display(),
            run["time_s"],
            run["warnings"],
            run["largest"]
        );
        assert_eq!(run["finite"], true, "{said}");
        assert_eq!(run["warnings"], 0, "{said}");
        assert!(run["time_s"].as_f64().unwrap() > SECONDS - 0.01, "{said}");
        assert!(run["largest"].as_f64().unwrap() < bound, "{said}");
    }
    let still = found["hold"]["still"].as_f64().unwrap();
    assert!(still < 1e-3, "it moves at {still} rad/s while it is held");
    found
}

fn numbered(joints: usize) -> Vec<String> {
    (1..=joints).map(|joint| joint.to_string()).collect()
}

#[test]
fn the_paper_s_device_stands() {
    let (Some(python), Some(device)) = (python(), repository("devices/haptic7.toml")) else {
        return;
    };
    let model = Device::load(&device).unwrap().device;
    let found = stands(
        &python,
        &model,
        &Case {
            device,
            flags: Vec::new(),
            site: "handle",
            names: numbered(7),
            per_reading: vec![1.0; 7],
        },
    );
    let masses: f64 = model.bodies.iter().flatten().map(|body| body.mass_kg).sum();
    assert!((found["mass_kg"].as_f64().unwrap() - masses).abs() < 1e-12);
}

#[test]
fn arms_of_urdfs_stand() {
    let Some(python) = python() else {
        return;
    };
    // a spindle turns a slide, whose value in the file is the slide's
    let linkage = vec![1.0, 0.01, 1.0];
    for (name, tip, scales) in [
        ("urdf/arm", None, None),
        ("urdf/linkage", None, Some(linkage)),
        ("urdf/humanoid", Some("left_hand"), None),
        // a maker's arm; the limits of two joints exclude 0
        ("measured/camera/panda", None, None),
    ] {
        let Some(device) = repository(&format!("{name}.urdf")) else {
            return;
        };
        let urdf = std::fs::read_to_string(&device).unwrap();
        let ends = haptical_urdf::BaseAndTip {
            tip,
            ..haptical_urdf::BaseAndTip::default()
        };
        let model = haptical_urdf::device_from_urdf(&urdf, name, ends)
            .unwrap()
            .device;
        let tip = tip.map(|tip| ["--tip".to_owned(), tip.to_owned()]);
        let case = Case {
            device,
            flags: tip.into_iter().flatten().collect(),
            site: "handle",
            names: model.joints.iter().map(|own| own.name.clone()).collect(),
            per_reading: scales.unwrap_or_else(|| vec![1.0; model.joints.len()]),
        };
        stands(&python, &model, &case);
    }
}

/// Springs, plays, couplings, friction and late encoders: the model stands, and what yields is as far as its law says.
#[test]
fn what_the_drives_yield_is_simulated() {
    let (Some(python), Some(nominal)) = (python(), repository("devices/haptic7.toml")) else {
        return;
    };
    let effects = "\n[[effect]]\nname = \"capstan-compliance\"\njoint = 2\nstiffness_nm_per_rad = 260.0\n\
        [[effect]]\nname = \"joint-compliance\"\njoint = 2\nstiffness_nm_per_rad = 400.0\n\
        [[effect]]\nname = \"joint-compliance\"\njoint = 7\nstiffness_nm_per_rad = 40.0\n\
        [[effect]]\nname = \"backlash\"\njoint = 2\nwidth_rad = 0.004\n\
        [[effect]]\nname = \"backlash\"\njoint = 5\nwidth_rad = 0.002\n\
        [[effect]]\nname = \"cross-coupling\"\njoint = 3\ngain = 0.02\nfrom_joint = 2\n\
        [[effect]]\nname = \"joint-friction\"\njoint = 1\ncoulomb_nm = 0.05\nviscous_nm_s_per_rad = 0.02\nstribeck_nm = 0.0\n\
        transition_rad_per_s = 0.02\n\
        [[effect]]\nname = \"input-drum-harmonic\"\njoint = 1\namplitude_rad = 0.0004\nphase_rad = 0.3\norder = 2\n\
        [[effect]]\nname = \"encoder-latency\"\ndelay_s = 0.004\n\
        [[effect]]\nname = \"external-encoder-latency\"\njoint = 2\ndelay_s = 0.002\n";
    let folder = tempfile::tempdir().unwrap();
    let device = folder.path().join("device.toml");
    let text = std::fs::read_to_string(nominal).unwrap();
    std::fs::write(&device, text + effects).unwrap();
    // the poses are compared without any load, so without what it bends
    let mut model = Device::load(&device).unwrap().device;
    model.surroundings.compliance.clear();
    let found = stands(
        &python,
        &model,
        &Case {
            device,
            flags: Vec::new(),
            site: "handle",
            names: numbered(7),
            per_reading: vec![1.0; 7],
        },
    );
    let held = &found["hold"];
    let value = |name: &str| held["joints"][name][0].as_f64().unwrap();
    let torque = |name: &str| -held["forces"][name].as_f64().unwrap();
    // a spring's torque is its stiffness times its angle, and both springs of a joint bear the same
    assert!((torque("2_cable") - 260.0 * value("2_cable")).abs() < 1e-5);
    let ratio = value("2_cable") * 260.0 / (value("2_spring") * 400.0);
    assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
    // a loaded play rests at its end, and no farther
    assert!(
        (value("2_play").abs() - 0.002).abs() < 2e-5,
        "{}",
        value("2_play")
    );
    // a coupled joint moves with its source
    let coupled = value("3_coupling") - 0.02 * value("2");
    assert!(coupled.abs() < 2e-5, "{coupled:e}");
    // the external encoder sees motor, cable and play, but not the spring behind it
    let sum = value("2") + value("2_cable") + value("2_play");
    let out = held["sensors"]["out2_rad"][0].as_f64().unwrap();
    assert!((out - sum).abs() < 1e-6, "{out} {sum}");
    // what MuJoCo has no means for is added by the Python in the file: the drum turns 8 times as far
    let theta = held["sensors"]["theta1_rad"][0].as_f64().unwrap();
    let reading = held["readings"]["theta1_rad"][0].as_f64().unwrap();
    let expected = theta - 0.0004 * (2.0 * 8.0 * theta - 0.3).cos();
    assert!((reading - expected).abs() < 1e-15, "{reading} {expected}");
    // a late encoder shows what was true 4 ms ago; MuJoCo reads sensors a step before, and keeps them for one
    let run = &found["follow"];
    let now = run["joints"]["4"][0].as_f64().unwrap();
    let late = run["sensors"]["theta4_rad"][0].as_f64().unwrap();
    let rate = run["sensors"]["theta4_rad_per_s"][0].as_f64().unwrap();
    assert!(
        (late - (now - 0.004 * rate)).abs() < 6e-4 * rate.abs(),
        "{late} {now} {rate}"
    );
}

/// The user's own file with a calibrated geometry: MuJoCo has its handle where Haptical has it.
#[test]
fn a_corrected_file_moves_as_the_device() {
    let (Some(python), Some(original)) = (python(), repository("mjcf/robot.xml")) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let (device, file) = (
        folder.path().join("device.toml"),
        folder.path().join("corrected.xml"),
    );
    let tip = ["--tip", "tool"];
    assert!(export(&original, "toml", &device, &tip).status.success());
    let mut model = Device::load(&device).unwrap().device;
    for (row, link) in model.links.iter_mut().enumerate() {
        let own = 1e-3 * (1.0 + row as f64);
        (link.a_m, link.d_m, link.theta_rad, link.alpha_rad) = (own, -own, 2.0 * own, -3.0 * own);
    }
    std::fs::write(&device, model.to_new_toml().unwrap()).unwrap();
    let mjcf = original.to_str().unwrap();
    let output = export(&device, "mjcf", &file, &["--mjcf", mjcf, "--tip", "tool"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let names: Vec<&str> = model
        .joints
        .iter()
        .map(|joint| joint.name.as_str())
        .collect();
    let poses: Vec<Vec<f64>> = (0..20).map(|case| readings(&model, case)).collect();
    let question = json!({"file": file, "site": "tool", "joints": names, "poses": poses});
    let found = ask(&python, &question);
    for (found, readings) in found["poses"].as_array().unwrap().iter().zip(&poses) {
        let expected = DeviceChain::new(&model).pose(readings).unwrap();
        for axis in 0..3 {
            let gap = (found[0][axis].as_f64().unwrap() - expected.position_m[axis]).abs();
            assert!(gap < SAME_POSE, "{gap:e}");
        }
    }
}

/// Springs, a play and a coupling in the user's own file: it is held and moved by its own actuators, and what yields is as far as
/// its law says.
#[test]
fn new_joints_in_a_file_of_one_s_own_stand() {
    let (Some(python), Some(original)) = (python(), repository("mjcf/robot.xml")) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let device = folder.path().join("device.toml");
    let tip = ["--tip", "tool"];
    assert!(export(&original, "toml", &device, &tip).status.success());
    let effects = "\n[[effect]]\nname = \"joint-compliance\"\njoint = 2\nstiffness_nm_per_rad = 900.0\n\
        [[effect]]\nname = \"joint-compliance\"\njoint = 3\nstiffness_nm_per_rad = 400.0\n\
        [[effect]]\nname = \"backlash\"\njoint = 3\nwidth_rad = 0.004\n\
        [[effect]]\nname = \"cross-coupling\"\njoint = 4\ngain = 0.02\nfrom_joint = 2\n";
    let toml = std::fs::read_to_string(&device).unwrap();
    std::fs::write(&device, toml + effects).unwrap();
    // a keyframe of the file gets the numbers of the new joints
    let keyed = folder.path().join("keyed.xml");
    let key = "<keyframe><key name=\"home\" qpos=\"0 0.1 -0.1 0\" ctrl=\"0 0.1 -0.1 0\"/></keyframe>\n</mujoco>";
    let xml = std::fs::read_to_string(&original).unwrap();
    std::fs::write(&keyed, xml.replace("</mujoco>", key)).unwrap();
    let mut model = Device::load(&device).unwrap().device;
    let file = folder.path().join("corrected.xml");
    let mjcf = keyed.to_str().unwrap();
    let flags = ["--mjcf", mjcf, "--tip", "tool", "--new-joints"];
    let output = export(&device, "mjcf", &file, &flags);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let names = ["yaw", "shoulder", "elbow", "wrist"];
    let poses: Vec<Vec<f64>> = (0..20).map(|case| readings(&model, case)).collect();
    let question = json!({
        "file": file, "site": "tool", "joints": names, "poses": poses,
        "seconds": SECONDS, "amplitude": [0.3, 0.3, 0.3, 0.3], "speed": 2.0,
    });
    let found = ask(&python, &question);
    // without a load nothing is bent
    model.surroundings.compliance.clear();
    for (found, readings) in found["poses"].as_array().unwrap().iter().zip(&poses) {
        let expected = DeviceChain::new(&model).pose(readings).unwrap();
        for axis in 0..3 {
            let gap = (found[0][axis].as_f64().unwrap() - expected.position_m[axis]).abs();
            assert!(gap < SAME_POSE, "{gap:e}");
        }
    }
    for way in ["hold", "follow"] {
        let run = &found[way];
        assert_eq!(
            (&run["finite"], &run["warnings"]),
            (&json!(true), &json!(0)),
            "{way}: {run}"
        );
    }
    let held = &found["hold"];
    let still = held["still"].as_f64().unwrap();
    assert!(still < 1e-3, "it moves at {still} rad/s while it is held");
    let value = |name: &str| held["joints"][name][0].as_f64().unwrap();
    let torque = |name: &str| -held["forces"][name].as_f64().unwrap();
    let gap = torque("shoulder_spring") - 900.0 * value("shoulder_spring");
    assert!(gap.abs() < 1e-4, "{gap:e} {}", value("shoulder_spring"));
    // the weight of the arm bends it: 0.4 to 0.6 m of 1.6 kg
    assert!(
        value("shoulder_spring").abs() > 1e-3,
        "{}",
        value("shoulder_spring")
    );
    let play = value("elbow_play").abs();
    assert!((play - 0.002).abs() < 2e-5, "{play}");
    let coupled = value("wrist_coupling") - 0.02 * value("shoulder");
    assert!(coupled.abs() < 1e-4, "{coupled:e}");
}
