//! Wild readings in a log: they are named row by row, and move nothing.

use std::process::Output;

use serde_json::Value;

use crate::{Sandbox, haptical, text};

/// The sandbox's log with the distance of every fifth row, from `first` on, 30 mm too long or too short, and
/// the lines of these rows.
fn spoil(sandbox: &Sandbox, first: usize) -> Vec<u64> {
    let log = std::fs::read_to_string(sandbox.path("log.csv")).unwrap();
    let mut lines: Vec<String> = log.lines().map(str::to_owned).collect();
    let column = lines[0]
        .split(',')
        .position(|name| name == "cable_m")
        .unwrap();
    let mut wild = Vec::new();
    for index in (1 + first..lines.len()).step_by(5) {
        let mut cells: Vec<String> = lines[index].split(',').map(str::to_owned).collect();
        let distance_m: f64 = cells[column].parse().unwrap();
        let sign = if index % 2 == 0 { 1.0 } else { -1.0 };
        cells[column] = (distance_m + sign * 0.03).to_string();
        lines[index] = cells.join(",");
        wild.push(index as u64 + 1);
    }
    sandbox.write("log.csv", lines.join("\n") + "\n");
    wild
}

fn result(sandbox: &Sandbox, output: &Output) -> Value {
    assert!(output.status.success(), "{}", text(&output.stderr));
    let json = std::fs::read_to_string(sandbox.path("result/identified.json")).unwrap();
    serde_json::from_str(&json).unwrap()
}

fn lines_of(result: &Value) -> Vec<u64> {
    let outliers = result["outliers"].as_array().unwrap().iter();
    let mut lines: Vec<u64> = outliers
        .map(|outlier| outlier["line"].as_u64().unwrap())
        .collect();
    lines.sort_unstable();
    lines
}

/// Place of the cable among the channels.
fn cable_of(result: &Value) -> usize {
    let mut channels = result["channels"].as_array().unwrap().iter();
    channels
        .position(|channel| channel["channel"] == "cable")
        .unwrap()
}

#[test]
fn wild_readings_are_named_row_by_row_and_move_nothing() {
    let sandbox = Sandbox::new();
    let clean = result(&sandbox, &sandbox.identify(&[]));
    assert_eq!(clean["loss"]["used"], "squares");
    assert_eq!(clean["outliers"], Value::Array(vec![]));
    let wild = spoil(&sandbox, 2);
    let output = sandbox.identify(&[]);
    let found = result(&sandbox, &output);
    assert!(text(&output.stderr).contains("farther from the model than noise explains"));
    assert_eq!(found["loss"]["used"], "tukey");
    assert_eq!(lines_of(&found), wild);
    // the table has the figures of the good readings, and next to them the count of the others
    let shown = text(&output.stdout);
    assert!(shown.contains("outliers are left out of before, after and reduction"));
    let cable = shown.lines().find(|line| line.contains("│ cable")).unwrap();
    let cells: Vec<&str> = cable.split('│').map(str::trim).collect();
    let number = |cell: usize| cells[cell].parse::<f64>().unwrap();
    let channel = &found["channels"].as_array().unwrap()[cable_of(&found)];
    assert_eq!(channel["outliers"].as_f64().unwrap(), number(4));
    assert!(
        number(6) < 1.5 * number(8) && number(7) > 10.0 * number(6),
        "{cable}"
    );
    assert!(number(9) > 90.0, "{cable}");
    let entries = |result: &Value| result["parameters"].as_array().unwrap().clone();
    for (before, after) in entries(&clean).iter().zip(entries(&found)) {
        assert_eq!(before["status"], after["status"], "{}", before["name"]);
        let number = |entry: &Value, key: &str| entry[key].as_f64();
        if let Some(deviation) = number(before, "standard_deviation") {
            let moved = number(before, "value").unwrap() - number(&after, "value").unwrap();
            assert!(moved.abs() < 3.0 * deviation, "{}: {moved}", before["name"]);
        }
    }
    let page = std::fs::read_to_string(sandbox.path("result/identify.html")).unwrap();
    assert!(page.contains("Outliers") && page.contains(&format!(">{}<", wild[0])));
    // the loss is recorded, so the result can be computed again
    let verify = haptical()
        .current_dir(sandbox.path("."))
        .args(["verify", "result"])
        .output()
        .unwrap();
    assert!(verify.status.success(), "{}", text(&verify.stdout));
}

#[test]
fn a_loss_can_be_chosen() {
    let sandbox = Sandbox::new();
    let wild = spoil(&sandbox, 0);
    for loss in ["huber", "cauchy", "tukey", "student-t"] {
        let found = result(&sandbox, &sandbox.identify(&["--loss", loss]));
        assert_eq!(found["loss"]["used"], loss);
        let lines = lines_of(&found);
        assert!(wild.iter().all(|line| lines.contains(line)), "{loss}");
    }
    let squares = result(&sandbox, &sandbox.identify(&["--loss", "squares"]));
    assert_eq!(squares["outliers"], Value::Array(vec![]));
}
