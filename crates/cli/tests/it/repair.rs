//! `haptical diagnose --repair`: the log without what is its own fault, diagnosed and identified again.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::{Sandbox, haptical, names_in, text};

/// A log of the template device with effects of the simulator's own laws; a folder for all that is made of it.
struct Case {
    sandbox: Sandbox,
}

impl Case {
    /// `log.csv` with the effects, `clean.csv` without: the same motion and the same noise.
    fn simulated(effects: &str, motion: &[&str]) -> Self {
        let sandbox = Sandbox::new();
        sandbox.write("effects.toml", effects);
        let case = Self { sandbox };
        let with: &[&str] = if effects.is_empty() {
            &[]
        } else {
            &["--effects", "effects.toml"]
        };
        case.run(&[&["simulate", "--force", "--out", "log.csv"], with, motion].concat());
        case.run(&[&["simulate", "--out", "clean.csv"][..], motion].concat());
        case
    }

    fn run(&self, arguments: &[&str]) -> String {
        let (command, further) = arguments.split_first().unwrap();
        let device: &[&str] = &[*command, "--device", "device.toml"];
        self.sandbox.ran(&[device, further].concat())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.sandbox.path(name)
    }

    fn repaired(&self, further: &[&str]) -> (Value, String) {
        let flags = [
            "diagnose", "--log", "log.csv", "--repair", "--out", "result",
        ];
        let said = self.run(&[&flags, further].concat());
        (self.sandbox.json("result/gap.json"), said)
    }

    /// The answer to the repaired log, from its file.
    fn again(&self, further: &[&str]) -> Value {
        let flags = ["diagnose", "--log", "result/repaired.csv", "--out", "again"];
        self.run(&[&flags, further].concat());
        self.sandbox.json("again/gap.json")
    }

    /// Errors of what a log identifies, in the standard deviations of those of the clean log: the device file is the truth.
    fn errors(&self, logs: [&str; 3]) -> [f64; 3] {
        let identified = logs.map(|log| {
            let out = format!("of-{}", log.replace('/', "-"));
            self.run(&["identify", "--log", log, "--out", &out]);
            self.sandbox.json(&format!("{out}/identified.json"))
        });
        let errors = |result: &Value| {
            let (mut squares, mut count) = (0.0, 0.0);
            let own = result["parameters"].as_array().unwrap();
            for clean in identified[0]["parameters"].as_array().unwrap() {
                let same = own.iter().find(|own| own["name"] == clean["name"]);
                let sd = clean["standard_deviation"].as_f64();
                if let (Some(sd), Some(error)) =
                    (sd, same.and_then(|own| own["deviation"].as_f64()))
                {
                    squares += (error / sd).powi(2);
                    count += 1.0;
                }
            }
            f64::sqrt(squares / count)
        };
        [0, 1, 2].map(|index| errors(&identified[index]))
    }
}

/// A minute at 100 rows a second.
const MINUTE: [&str; 6] = ["--seconds", "60", "--rate-hz", "100", "--seed", "3"];
/// Half of it: enough for what has no instant.
const HALF_A_MINUTE: [&str; 6] = ["--seconds", "30", "--rate-hz", "100", "--seed", "3"];

/// Errors after a repair may be so much larger than those of a log that was sound: a cell is lost, noise is smoothed, and a
/// fault's size is known to a part of the noise.
const AS_GOOD_AS_SOUND: f64 = 1.2;
/// So many times larger are they where nothing is repaired: else the test would tell nothing.
const CLEARLY_WORSE: f64 = 1.5;

/// Repairs; the check of the repaired log finds no gap.
fn assert_repaired(case: &Case, cause: &str, further: &[&str]) -> Value {
    let (gap, said) = case.repaired(further);
    let repair = &gap["repair"];
    assert_eq!(repair["log"], "repaired.csv", "{said}");
    assert_eq!(gap["causes"][0]["effect"], cause, "{said}");
    assert!(
        said.contains("`haptical identify --log repaired.csv`")
            && !said.contains("`--repair` writes")
            && said.contains("repaired repaired.csv"),
        "{said}"
    );
    assert_eq!(repair["check"]["verdict"], "no-gap", "{said}");
    assert_eq!(
        case.sandbox.json("result/repaired.json")["changes"],
        repair["changes"]
    );
    repair.clone()
}

fn assert_as_good_as_sound(case: &Case) {
    let [clean, repaired, faulty] = case.errors(["clean.csv", "result/repaired.csv", "log.csv"]);
    assert!(repaired < AS_GOOD_AS_SOUND * clean, "{repaired} {clean}");
    assert!(faulty > CLEARLY_WORSE * clean, "{faulty} {clean}");
}

/// The cells of two logs that differ: line and column, from 0.
fn changed(one: &Path, other: &Path) -> Vec<(usize, usize)> {
    let [one, other] = [one, other].map(|path| std::fs::read_to_string(path).unwrap());
    assert_eq!(one.lines().count(), other.lines().count());
    let mut found = Vec::new();
    for (line, (one, other)) in one.lines().zip(other.lines()).enumerate() {
        let (one, other) = (one.split(','), other.split(','));
        let cells = one.zip(other).enumerate();
        found.extend(cells.filter(|(_, (a, b))| a != b).map(|(at, _)| (line, at)));
    }
    found
}

#[test]
fn lost_counts_are_added_back_from_their_row_on() {
    let effects =
        "[[effect]]\nname = \"encoder-count-loss\"\njoint = 2\ncounts = 60\ntime_s = 31.305\n";
    let case = Case::simulated(effects, &MINUTE);
    let repair = assert_repaired(&case, "encoder-count-loss", &[]);
    let change = &repair["changes"][0];
    assert_eq!(
        (&change["column"], &change["joint"]),
        (&"theta2_rad".into(), &2.into())
    );
    // rows are 10 ms apart from 0 on, and line 2 is the first: 31.31 s is on line 3133
    assert_eq!(change["lines"], serde_json::json!([3133, 6001]));
    let counts = change["by"]["counts"].as_f64().unwrap();
    assert!((counts - 60.0).abs() < 0.5, "{change}");
    let cells = changed(&case.path("log.csv"), &case.path("result/repaired.csv"));
    let column = cells[0].1;
    assert!(
        cells
            .iter()
            .all(|(line, at)| *line >= 3132 && *at == column)
    );
    assert_eq!(cells.len(), 6000 - 3131);
    assert_as_good_as_sound(&case);
    // the check of the repair is what its file says to a diagnosis
    let again = case.again(&[]);
    assert_eq!(repair["check"]["answer"], again["answer"]);
}

/// Of more than 25 000 rows a diagnosis takes every second: the row is found between two of them.
#[test]
fn rows_that_a_diagnosis_skips_are_repaired_too() {
    let effects =
        "[[effect]]\nname = \"encoder-count-loss\"\njoint = 2\ncounts = 60\ntime_s = 31.3\n";
    let case = Case::simulated(
        effects,
        &["--seconds", "255", "--rate-hz", "100", "--seed", "3"],
    );
    let (gap, said) = case.repaired(&[]);
    let change = &gap["repair"]["changes"][0];
    assert_eq!(change["lines"], serde_json::json!([3132, 25501]), "{said}");
    assert_eq!(gap["repair"]["check"]["verdict"], "no-gap");
}

#[test]
fn a_late_cable_is_brought_to_its_times() {
    let effects = "[[effect]]\nname = \"cable-latency\"\ndelay_s = 0.004\n";
    let case = Case::simulated(effects, &HALF_A_MINUTE);
    let repair = assert_repaired(&case, "cable-latency", &[]);
    let change = &repair["changes"][0];
    assert_eq!(
        (&change["column"], &change["what"]),
        (&"cable_m".into(), &"resampled".into())
    );
    // nothing was recorded after the last row
    assert_eq!(
        (&change["emptied"], &change["emptied_lines"]),
        (&1.into(), &serde_json::json!([3001]))
    );
    // the fault is the log's: no device has it, and the model of the result has it no more
    assert!(!case.path("result/corrected.toml").exists());
}

#[test]
fn late_motor_encoders_are_brought_to_their_times() {
    let effects = "[[effect]]\nname = \"encoder-latency\"\ndelay_s = 0.004\n";
    let case = Case::simulated(effects, &HALF_A_MINUTE);
    let repair = assert_repaired(&case, "encoder-latency", &[]);
    let changes = repair["changes"].as_array().unwrap();
    let of = |what: &str| {
        changes
            .iter()
            .filter(|change| change["what"] == what)
            .count()
    };
    // seven joints; the last row keeps its joints and loses four external encoders and the cable
    assert_eq!((of("resampled"), of("emptied")), (7, 5), "{changes:?}");
}

/// The lines of a log with the tracker's columns a row later: what they show is what was there a step before.
fn with_late_tracker(log: &str) -> String {
    let lines: Vec<Vec<&str>> = log.lines().map(|line| line.split(',').collect()).collect();
    let is_late = |at: usize| ["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"].contains(&lines[0][at]);
    let mut text = lines[0].join(",") + "\n";
    for pair in lines[1..].windows(2) {
        let cells = (0..lines[0].len()).map(|at| pair[usize::from(!is_late(at))][at]);
        text += &(cells.collect::<Vec<_>>().join(",") + "\n");
    }
    text
}

/// Encoders ahead of a tracker and a tracker behind the encoders are one log: the answer says so, and what is moved is the tracker.
#[test]
fn encoders_that_are_ahead_are_said_to_be_a_late_tracker_which_is_moved() {
    let sandbox = Sandbox::new();
    sandbox.ran(&["init", "arm", "--example", "urdf-arm"]);
    let arm = ["--device", "arm/arm6.urdf", "--rig", "arm/rig.toml"];
    let motion = [
        "--seconds",
        "20",
        "--rate-hz",
        "100",
        "--seed",
        "5",
        "--out",
    ];
    sandbox.ran(&[&["simulate"][..], &arm, &motion, &["on-time.csv"]].concat());
    let log = std::fs::read_to_string(sandbox.path("on-time.csv")).unwrap();
    sandbox.write("late.csv", with_late_tracker(&log));
    let flags = ["--log", "late.csv", "--repair", "--out", "result"];
    let said = sandbox.ran(&[&["diagnose"][..], &arm, &flags].concat());
    let gap = sandbox.json("result/gap.json");
    let cause = &gap["causes"][0];
    assert_eq!(gap["verdict"], "named", "{said}");
    assert_eq!(cause["effect"], "encoder-latency", "{said}");
    let twin = serde_json::json!(["tracker-latency"]);
    assert_eq!(cause["confusable_with"], twin, "{said}");
    let delay_s = cause["parameters"]["delay_s"]["value"].as_f64().unwrap();
    assert!((delay_s + 0.01).abs() < 2e-4, "{delay_s}");
    let words = "usually mean that the tracker is late by 10 ms";
    let warnings = gap["warnings"].as_array().unwrap().iter();
    let mut warnings = warnings.filter_map(Value::as_str);
    assert!(warnings.any(|own| own.contains(words)), "{gap}");
    assert!(
        said.contains("`haptical identify --log repaired.csv`"),
        "{said}"
    );
    let changes = gap["repair"]["changes"].as_array().unwrap();
    let columns: Vec<&str> = (changes.iter())
        .map(|change| change["column"].as_str().unwrap())
        .collect();
    assert_eq!(columns, ["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"]);
    let by_s = changes[0]["by"]["delay_s"].as_f64().unwrap();
    assert!((by_s + delay_s).abs() < 1e-12, "{by_s}");
    assert_eq!(gap["repair"]["check"]["verdict"], "no-gap", "{said}");
}

#[test]
fn a_drift_of_the_cable_is_taken_out() {
    let effects = "[[effect]]\nname = \"cable-drift\"\nm_per_s = 4e-6\n";
    let motion = ["--seconds", "400", "--rate-hz", "10", "--seed", "3"];
    let case = Case::simulated(effects, &motion);
    let repair = assert_repaired(&case, "cable-drift", &[]);
    let rate = repair["changes"][0]["by"]["m_per_s"].as_f64().unwrap();
    assert!((rate / 4e-6 - 1.0).abs() < 0.02, "{rate}");
}

#[test]
fn wild_readings_are_emptied() {
    let case = Case::simulated("", &MINUTE);
    let log = std::fs::read_to_string(case.path("log.csv")).unwrap();
    let mut lines: Vec<Vec<String>> = log
        .lines()
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect();
    let names = lines[0].clone();
    let at = |name: &str| names.iter().position(|own| own == name).unwrap();
    let mut wild = Vec::new();
    for index in 0..60 {
        let (line, column) = (60 + 97 * index, at(["cable_m", "out2_rad"][index % 2]));
        let value: f64 = lines[line][column].parse().unwrap();
        lines[line][column] = format!("{:.7}", value + [0.05, -0.03, 0.02][index % 3]);
        wild.push((line, column));
    }
    let lines: Vec<String> = lines.iter().map(|cells| cells.join(",")).collect();
    case.sandbox.write("log.csv", lines.join("\n") + "\n");
    assert_repaired(&case, "outliers", &[]);
    assert_eq!(
        changed(&case.path("log.csv"), &case.path("result/repaired.csv")),
        wild
    );
}

#[test]
fn what_is_of_the_device_or_not_sure_stays_in_the_log() {
    let slack = "[[effect]]\nname = \"backlash\"\njoint = 2\nwidth_rad = 2e-3\n";
    for (effects, verdict, why) in [
        (slack, "named", "of the device, not of the log"),
        ("", "no-gap", "there is no gap"),
    ] {
        let case = Case::simulated(effects, &HALF_A_MINUTE);
        let (gap, said) = case.repaired(&[]);
        assert_eq!(gap["verdict"], verdict, "{said}");
        assert_eq!(
            (&gap["repair"]["log"], &gap["repair"]["check"]),
            (&Value::Null, &Value::Null)
        );
        assert!(
            said.contains("no log is written") && said.contains(why),
            "{said}"
        );
        let names = names_in(&case.path("result"));
        assert!(
            !names.iter().any(|name| name.starts_with("repaired")),
            "{names:?}"
        );
        assert_eq!(
            names.contains(&"corrected.toml".to_owned()),
            !effects.is_empty()
        );
    }
}

#[test]
fn a_repair_is_made_again_by_verify_and_never_over_its_input() {
    let effects = "[[effect]]\nname = \"cable-latency\"\ndelay_s = 0.004\n";
    let case = Case::simulated(effects, &HALF_A_MINUTE);
    let (gap, _) = case.repaired(&[]);
    assert_eq!(gap["repair"]["log"], "repaired.csv");
    let verified = case.sandbox.ran(&["verify", "result"]);
    assert!(verified.contains("repaired.csv"));
    let over = haptical()
        .current_dir(case.sandbox.folder.path())
        .args(["diagnose", "--device", "device.toml", "--repair"])
        .args(["--log", "result/repaired.csv", "--out", "result"])
        .output()
        .unwrap();
    assert_eq!(over.status.code(), Some(2));
    assert!(
        text(&over.stderr).contains("is an input of this run"),
        "{}",
        text(&over.stderr)
    );
}

/// Root mean square of a channel before and after its causes.
fn channel<'g>(gap: &'g Value, name: &str) -> &'g Value {
    let channels = gap["gap"]["channels"].as_array().unwrap();
    channels.iter().find(|own| own["channel"] == name).unwrap()
}

/// Logs of another simulator. That of the late cable was made by straight lines between rows, which is no delay: where the
/// cable speeds up that leaves three fifths more than noise.
#[test]
fn logs_of_another_simulator_are_repaired() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    for (set, wanted) in [("04-cable-latency", "unknown"), ("05-count-loss", "no-gap")] {
        let log = shared.join("gap-sets").join(set).join("log.csv.gz");
        if !log.exists() {
            println!("skipped: no {}", log.display());
            continue;
        }
        let case = Case {
            sandbox: Sandbox::new(),
        };
        std::fs::copy(
            shared.join("devices/haptic7.toml"),
            case.path("device.toml"),
        )
        .unwrap();
        case.run(&[
            "diagnose",
            "--log",
            log.to_str().unwrap(),
            "--repair",
            "--out",
            "result",
        ]);
        let gap = case.sandbox.json("result/gap.json");
        assert_eq!(gap["repair"]["log"], "repaired.csv.gz", "{set}");
        assert_eq!(gap["repair"]["check"]["verdict"], wanted, "{set}");
        case.run(&[
            "diagnose",
            "--log",
            "result/repaired.csv.gz",
            "--out",
            "again",
        ]);
        let again = case.sandbox.json("again/gap.json");
        assert_eq!(again["verdict"], wanted, "{set}");
        let named = |cause: &Value| cause["effect"].as_str().unwrap().ends_with("latency");
        assert!(
            !again["causes"].as_array().unwrap().iter().any(named),
            "{set}"
        );
        let [before, after] =
            [&gap, &again].map(|gap| channel(gap, "cable")["rms_before"].as_f64().unwrap());
        let floor = channel(&again, "cable")["noise_floor"].as_f64().unwrap();
        let most = if wanted == "no-gap" { 1.1 } else { 1.8 };
        assert!(
            after < most * floor && after < 0.1 * before,
            "{set}: {before} {after} {floor}"
        );
    }
}

/// A device that mostly rests: between the changes of a count neighbours do not differ at all, and each change stood alone.
#[test]
fn changes_of_a_count_are_no_wild_readings() {
    let (gap, said) = Case::simulated("", &HALF_A_MINUTE).repaired(&[]);
    assert_eq!(gap["verdict"], "no-gap", "{said}");
    assert_eq!(gap["causes"], serde_json::json!([]), "{said}");
    assert!(gap["repair"]["log"].is_null(), "{said}");
}
