//! `haptical simulate --poses`: plan, simulate, identify, diagnose, verify by the command; and what is refused.

use std::path::Path;

use haptical_model::Device;
use serde_json::Value;

use crate::{Sandbox, haptical, text};

/// Stiffness of the true arm's second joint \[N m/rad\].
const STIFFNESS: f64 = 2000.0;

/// Runs the command in the sandbox; it must refuse with these texts.
fn refused(sandbox: &Sandbox, words: &[&str], texts: &[&str]) {
    let output = haptical()
        .current_dir(sandbox.folder.path())
        .args(words)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{words:?}");
    let said = text(&output.stderr);
    for text in texts {
        assert!(said.contains(text), "{words:?}: {said}");
    }
}

fn read(sandbox: &Sandbox, name: &str) -> String {
    std::fs::read_to_string(sandbox.path(name)).unwrap()
}

fn arm(sandbox: &Sandbox) {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/urdf/arm.urdf");
    sandbox.write("arm.urdf", std::fs::read_to_string(fixtures).unwrap());
}

/// Most of the identified parameters of the arm have the truth within their intervals.
fn assert_covered(found: &Value, truth: &Device) {
    let within = found["parameters"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|own| {
            let known = truth.parameter(own["name"].as_str()?).ok()?.value(truth);
            let name = own["name"].as_str()?;
            let [low, high] = [own["ci95"][0].as_f64()?, own["ci95"][1].as_f64()?];
            (!name.starts_with("tracker")).then_some((low..=high).contains(&known))
        });
    let within: Vec<bool> = within.collect();
    let covered = within.iter().filter(|is_in| **is_in).count();
    assert!(
        within.len() > 15 && 5 * covered >= 4 * within.len(),
        "{covered} of {}",
        within.len()
    );
}

#[test]
fn a_urdf_arm_is_planned_simulated_identified_and_diagnosed() {
    let sandbox = Sandbox::new();
    arm(&sandbox);
    let arm = ["--device", "arm.urdf", "--tip", "tool"];
    let with = |command: &str, further: &[&str]| {
        let words: Vec<&str> = [command]
            .iter()
            .chain(&arm)
            .chain(further)
            .copied()
            .collect();
        sandbox.ran(&words)
    };
    let rig = "pose:unknown";
    with(
        "plan",
        &[
            "--measure",
            rig,
            "--poses",
            "100",
            "--candidates",
            "200",
            "--out",
            "plan",
        ],
    );
    let poses = ["--poses", "plan/poses.csv", "--measure", rig];
    let said = with(
        "simulate",
        &[&poses[..], &["--deviate", "0.2", "--out", "rigid.csv"]].concat(),
    );
    assert!(
        said.contains("rigid.csv, 100 postures") && said.contains("rigid.csv.rig.toml, for --rig")
    );

    // the same device with a joint that yields
    let yields = format!(
        "\n[[effect]]\nname = \"joint-compliance\"\njoint = 2\nstiffness_nm_per_rad = {STIFFNESS}\n"
    );
    sandbox.write(
        "truth.toml",
        read(&sandbox, "rigid.csv.truth.toml") + &yields,
    );
    with(
        "simulate",
        &[&poses[..], &["--truth", "truth.toml", "--out", "made.csv"]].concat(),
    );
    // names of parameters count rows, which a URDF has not
    let said = sandbox.ran(&[
        "check",
        "arm.urdf",
        "made.csv",
        "--tip",
        "tool",
        "--rig",
        "made.csv.rig.toml",
    ]);
    let rows = "The number in a parameter's name is its row: 0 is the base, 1 is `shoulder_pan`, ";
    assert!(said.contains(rows), "{said}");
    let log = ["--rig", "made.csv.rig.toml", "--log", "made.csv"];
    with("diagnose", &[&log[..], &["--out", "gap"]].concat());
    let gap = sandbox.json("gap/gap.json");
    assert_eq!(gap["verdict"], "named", "{}", gap["answer"]);
    assert_eq!(gap["causes"][0]["effect"], "joint-compliance");
    assert_eq!(gap["causes"][0]["joint"], 2);

    // named by an absolute path: of that the record keeps the last part
    let causes = sandbox.path("gap/gap.json").canonicalize().unwrap();
    let causes = causes.display().to_string();
    let said = with(
        "identify",
        &[
            &log[..],
            &["--with", &causes, "--held-out", "0", "--out", "result"],
        ]
        .concat(),
    );
    assert!(said.contains(rows), "{said}");
    let found = sandbox.json("result/identified.json");
    let number = &found["effects"][0]["parameters"]["stiffness_nm_per_rad"];
    let interval = &number["ci95"];
    let [low, high] = [0, 1].map(|end| interval[end].as_f64().unwrap());
    assert!(
        low < STIFFNESS && STIFFNESS < high && high < 1.1 * low,
        "{number}"
    );
    let truth = Device::load(&sandbox.path("made.csv.truth.toml"))
        .unwrap()
        .device;
    // a joint that yields is a number of its joint
    assert!((truth.compliance_rad_per_nm(1) * STIFFNESS - 1.0).abs() < 1e-12);
    assert_covered(&found, &truth);

    let said = sandbox.ran(&["verify", "result"]);
    assert!(said.contains("Verified"), "{said}");
    std::fs::rename(sandbox.path("gap/gap.json"), sandbox.path("moved.json")).unwrap();
    refused(
        &sandbox,
        &["verify", "result"],
        &["as --with is not there", "with --with"],
    );
    let said = sandbox.ran(&["verify", "result", "--with", "moved.json"]);
    assert!(said.contains("Verified"), "{said}");
}

#[test]
fn a_seed_gives_the_same_bytes_and_the_truth_says_where_sockets_are() {
    let sandbox = Sandbox::new();
    let rig = "out,contact:2:0.2";
    let device = ["--device", "device.toml", "--measure", rig];
    let plan = [
        "plan",
        "--poses",
        "40",
        "--candidates",
        "100",
        "--out",
        "plan",
    ];
    sandbox.ran(&[&plan[..], &device].concat());
    let simulate = [
        "simulate",
        "--poses",
        "plan/poses.csv",
        "--deviate",
        "0.2",
        "--out",
    ];
    for name in ["a.csv", "b.csv", "c.csv"] {
        let seed = if name == "c.csv" { "2" } else { "1" };
        sandbox.ran(&[&simulate[..], &[name, "--seed", seed], &device].concat());
    }
    assert_eq!(read(&sandbox, "a.csv"), read(&sandbox, "b.csv"));
    assert_eq!(
        read(&sandbox, "a.csv.truth.toml"),
        read(&sandbox, "b.csv.truth.toml")
    );
    assert_ne!(read(&sandbox, "a.csv"), read(&sandbox, "c.csv"));
    let truth = Device::load(&sandbox.path("a.csv.truth.toml"))
        .unwrap()
        .device;
    let ids: Vec<&str> = truth
        .surroundings
        .contacts
        .iter()
        .map(|own| own.id.as_str())
        .collect();
    assert!(
        ids.contains(&"socket1") && ids.contains(&"socket2"),
        "{ids:?}"
    );
    let rig = read(&sandbox, "a.csv.rig.toml");
    assert!(
        rig.contains("distance_m = 0.2") && !rig.contains("contact_point"),
        "{rig}"
    );
    // a device of other numbers is in its own log's reach: the log is read again as postures
    sandbox.ran(&[
        "simulate",
        "--device",
        "device.toml",
        "--rig",
        "a.csv.rig.toml",
        "--poses",
        "a.csv",
        "--out",
        "d.csv",
    ]);
    let header = |name: &str| read(&sandbox, name).lines().next().unwrap_or("").to_owned();
    assert_eq!(header("d.csv"), header("a.csv"));
}

#[test]
fn what_postures_cannot_show_is_refused_and_leaves_nothing() {
    let sandbox = Sandbox::new();
    let joints: Vec<String> = (1..=7).map(|joint| format!("theta{joint}_rad")).collect();
    let joints = joints.join(",");
    let free = format!("{joints}\n0,0.1,0,0,0,0,0\n0.2,0,0.1,0,0,0,0\n");
    sandbox.write("free.csv", &free);
    sandbox.write(
        "few.csv",
        format!("{joints},plane\n0,0.1,0,0,0,0,0,table\n0.2,0,0.1,0,0,0,0,table\n"),
    );
    sandbox.write(
        "effects.toml",
        "[[effect]]\nname = \"cable-latency\"\ndelay_s = 0.004\n",
    );
    let drift = "\n[[effect]]\nname = \"cable-drift\"\nm_per_s = 1e-6\n";
    sandbox.write("drifts.toml", sandbox.device_text() + drift);
    let far = "\n[[contact_point]]\nid = \"moon\"\nposition_m = [9.0, 0.0, 0.0]\n";
    sandbox.write("far.toml", sandbox.device_text() + far);
    sandbox.write(
        "moon.csv",
        format!("{joints},contact\n0,0.1,0,0,0,0,0,moon\n0.2,0,0.1,0,0,0,0,moon\n"),
    );
    let simulate = |device: &'static str, poses: &'static str, further: &[&'static str]| {
        [
            &[
                "simulate", "--device", device, "--poses", poses, "--out", "made.csv",
            ][..],
            further,
        ]
        .concat()
    };
    for (words, texts) in [
        (
            simulate("device.toml", "free.csv", &["--effects", "effects.toml"]),
            [
                "--effects is of a device that a hand moves",
                "[[effect]] tables into the device file",
            ],
        ),
        (
            simulate("device.toml", "free.csv", &["--measure", "out,contact:2"]),
            [
                "no column `contact` says which",
                "haptical plan --measure out,contact:2",
            ],
        ),
        (
            simulate("device.toml", "free.csv", &["--measure", "cable9"]),
            ["cable9", "next: "],
        ),
        (
            simulate("device.toml", "few.csv", &[]),
            ["plane `table` has 2 postures", "[[touched_plane]]"],
        ),
        (
            simulate("far.toml", "moon.csv", &[]),
            ["contact `moon`", "at none of its 2 postures"],
        ),
        (
            simulate("drifts.toml", "free.csv", &[]),
            [
                "cable-drift",
                "give what drives it in a column of the poses",
            ],
        ),
        (
            simulate("device.toml", "absent.csv", &[]),
            ["absent.csv", "next: "],
        ),
    ] {
        refused(&sandbox, &words, &texts);
        assert!(!sandbox.path("made.csv").exists(), "{words:?}");
    }
}
