//! Several logs judged together, and the recording that settles a diagnosis.

use serde_json::Value;

use crate::moving_log::{ROWS, moving_log};
use crate::{Sandbox, haptical, names_in, text};

/// Two logs of a device whose joint 2 yields.
fn two_logs() -> Sandbox {
    let sandbox = Sandbox::new();
    let device = sandbox.device_text();
    for (part, name) in [(1, "log.csv"), (2, "log2.csv")] {
        sandbox.write(name, moving_log(&device, 1e-3, part));
    }
    sandbox
}

#[test]
fn two_logs_are_judged_together_and_verified() {
    let sandbox = two_logs();
    let output = sandbox.diagnose(&["--log", "log2.csv"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    let wanted = format!("logs     log.csv ({ROWS} rows), log2.csv ({ROWS} rows), judged together");
    assert!(said.contains(&wanted), "{said}");
    let both = sandbox.json("result/gap.json");
    assert_eq!(both["logs"][1]["file"], "log2.csv");
    assert_eq!(both["provenance"]["rows"], 2 * ROWS);
    let cause = |gap: &Value| gap["causes"][0].clone();
    let width = |gap: &Value| {
        let ends = &cause(gap)["parameters"]["stiffness_nm_per_rad"]["ci95"];
        ends[1].as_f64().unwrap() - ends[0].as_f64().unwrap()
    };
    assert_eq!(
        (&both["verdict"], &cause(&both)["joint"]),
        (&"named".into(), &2.into())
    );
    sandbox.ran(&["verify", "result"]);
    assert_eq!(sandbox.diagnose(&[]).status.code(), Some(0));
    let one = sandbox.json("result/gap.json");
    assert!(one.get("logs").is_none());
    // the evidence adds: the interval is narrower, but for what the torque's scale leaves open
    assert!(
        width(&both) <= width(&one),
        "{} {}",
        width(&both),
        width(&one)
    );
}

#[test]
fn logs_that_cannot_be_judged_together_are_refused() {
    let sandbox = two_logs();
    let refused = |further: &[&str]| {
        let output = sandbox.diagnose(further);
        assert_eq!(output.status.code(), Some(2));
        text(&output.stderr)
    };
    let twice = refused(&["--log", "log.csv"]);
    assert!(twice.contains("the same log is given twice"), "{twice}");
    let log = std::fs::read_to_string(sandbox.path("log2.csv")).unwrap();
    let torque = log
        .lines()
        .next()
        .unwrap()
        .split(',')
        .position(|name| name == "torque2_nm");
    let without = |line: &str| {
        let cells = line.split(',').enumerate();
        let kept: Vec<&str> = cells
            .filter(|(at, _)| Some(*at) != torque)
            .map(|(_, cell)| cell)
            .collect();
        kept.join(",") + "\n"
    };
    sandbox.write("less.csv", log.lines().map(without).collect::<String>());
    let less = refused(&["--log", "less.csv"]);
    assert!(
        less.contains("less.csv") && less.contains("it has no torque2, and log.csv has"),
        "{less}"
    );
    assert_eq!(
        names_in(&sandbox.path(""))
            .iter()
            .filter(|name| *name == "result")
            .count(),
        0
    );
}

#[test]
fn a_recording_is_chosen_for_an_open_answer() {
    let sandbox = two_logs();
    assert_eq!(sandbox.diagnose(&[]).status.code(), Some(0));
    let settle = |gap: &str, log: &str| {
        haptical()
            .current_dir(sandbox.path(""))
            .args([
                "plan",
                "--device",
                "device.toml",
                "--settle",
                gap,
                "--log",
                log,
            ])
            .args(["--rows", "600", "--candidates", "24", "--out", "next"])
            .output()
            .unwrap()
    };
    let named = settle("result/gap.json", "log.csv");
    let said = text(&named.stderr);
    assert_eq!(named.status.code(), Some(2));
    assert!(
        said.contains("its verdict is named: there is nothing to settle"),
        "{said}"
    );
    // the same answer as if a play were as likely
    let mut open = sandbox.json("result/gap.json");
    open["verdict"] = "ambiguous".into();
    open["candidates"][1] = serde_json::json!({
        "effect": "backlash", "joint": 2, "nats_behind": 1.0, "parameters": {"width_rad": 1e-3},
    });
    sandbox.write("open.json", open.to_string());
    let other = settle("open.json", "log2.csv");
    assert!(
        text(&other.stderr).contains("it was made from other logs"),
        "{}",
        text(&other.stderr)
    );
    let output = settle("open.json", "log.csv");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    assert!(
        said.contains("if it is")
            && said.contains("haptical diagnose --log log.csv --log next.csv"),
        "{said}"
    );
    assert_eq!(
        names_in(&sandbox.path("next")),
        ["plan.json", "poses.csv", "report.html"]
    );
    let plan = sandbox.json("next/plan.json");
    let poses = std::fs::read_to_string(sandbox.path("next/poses.csv")).unwrap();
    assert!(poses.starts_with("time_s,theta1_rad,theta2_rad"), "{poses}");
    assert_eq!(plan["rows"], poses.lines().count() - 1);
    assert!(plan["rows"].as_u64().unwrap() <= 600);
    for odds in plan["odds"].as_array().unwrap() {
        // no name is surer than 99 %
        let after = odds["after"].as_f64().unwrap();
        assert!(after > 0.0 && after < 99.1, "{odds}");
    }
    let verified = haptical()
        .current_dir(sandbox.path(""))
        .args(["verify", "next"])
        .output()
        .unwrap();
    assert_eq!(
        verified.status.code(),
        Some(0),
        "{} {}",
        text(&verified.stdout),
        text(&verified.stderr)
    );
}
