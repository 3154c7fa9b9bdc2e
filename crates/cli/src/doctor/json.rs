//! The findings for programs.

use haptical::servo::{EpisodeFinding, Fault};
use serde_json::{Map, Value, json};

use super::Examined;
use super::recording::{Label, Recorded, Unit};
use super::{text, words};

/// Half-width of a 95 % interval in standard deviations.
const HALF_WIDTH: f64 = 1.96;

pub(super) fn json(examined: &Examined) -> Value {
    let recorded = &examined.recorded;
    let joints = examined
        .report
        .joints
        .iter()
        .zip(&recorded.names)
        .enumerate();
    let joints: Vec<Value> = joints
        .map(|(joint, (report, name))| {
            let findings = report
                .findings
                .iter()
                .map(|finding| of_finding(joint, finding, recorded));
            json!({
                "joint": joint + 1,
                "name": name,
                "findings": findings.collect::<Vec<_>>(),
                "answer_s": report.answer_s,
                "repeated_readings": report.repeated,
            })
        })
        .collect();
    let episodes: Vec<Value> = (examined.report.episodes.iter().enumerate())
        .map(|(episode, verdict)| {
            let effects = verdict.rows.iter().map(|row| {
                let fault = &examined.report.rows[*row];
                json!({"effect": fault.kind.effect(), "parameters": {"rows": fault.rows, "of": fault.of, "first_s": fault.first_s}})
            });
            json!({
                "episode": number(recorded, episode),
                "file": file(&recorded.labels[episode]),
                "verdict": words::verdict(verdict.verdict),
                "why": words::why(examined, episode),
                "rows": recorded.episodes[episode].len(),
                "findings": effects.collect::<Vec<_>>(),
            })
        })
        .collect();
    json!({
        "kind": recorded.kind,
        "answer": text::headline(examined),
        "unit": unit(recorded.unit),
        "joints": joints,
        "episodes": episodes,
        "not_tested": words::not_tested(examined),
        "warnings": recorded.warnings,
    })
}

fn unit(unit: Unit) -> Option<&'static str> {
    match unit {
        Unit::Radians => Some("rad"),
        Unit::Degrees => Some("deg"),
        Unit::Percent => Some("percent"),
        Unit::Unknown => None,
    }
}

/// The data set's number; of a folder of logs the place among them, from 0.
fn number(recorded: &Recorded, episode: usize) -> i64 {
    match recorded.labels[episode] {
        Label::Number(number) => number,
        Label::File(_) => episode as i64,
    }
}

fn file(label: &Label) -> Option<&str> {
    match label {
        Label::Number(_) => None,
        Label::File(name) => Some(name),
    }
}

fn of_finding(joint: usize, finding: &EpisodeFinding, recorded: &Recorded) -> Value {
    let episode = |index: usize| number(recorded, index);
    json!({
        "effect": finding.fault.effect(),
        "parameters": parameters(joint, &finding.fault, recorded),
        "since_episode": episode(finding.since),
        "until_episode": finding.until.map(episode),
        "probability": finding.probability,
    })
}

fn parameters(joint: usize, fault: &Fault, recorded: &Recorded) -> Value {
    let with_interval = |value: f64, sd: f64| json!({"value": value, "ci95": [value - HALF_WIDTH * sd, value + HALF_WIDTH * sd]});
    // a position under its name with its unit
    let (ending, factor) = match recorded.unit_of(joint) {
        Unit::Radians => ("_rad", 1.0),
        Unit::Degrees => ("_rad", 1_f64.to_radians()),
        Unit::Percent => ("_percent", 1.0),
        Unit::Unknown => ("", 1.0),
    };
    let mut all = Map::new();
    let mut put = |name: String, value: Value| all.insert(name, value);
    match fault {
        Fault::Offset { size, sd, side } => {
            put(
                format!("offset{ending}"),
                with_interval(size * factor, sd * factor),
            );
            put(
                "side".to_owned(),
                json!(side.map(|side| match side {
                    haptical::servo::Side::Position => "position",
                    haptical::servo::Side::Command => "command",
                })),
            );
        }
        Fault::Gain { factor, sd } => {
            put("factor".to_owned(), with_interval(*factor, *sd));
        }
        Fault::Latency { delay_s, sd_s } => {
            put("delay_s".to_owned(), with_interval(*delay_s, *sd_s));
        }
        Fault::Dead { at } => {
            put(format!("at{ending}"), json!(at * factor));
        }
        Fault::Swapped { with } => {
            put("with_joint".to_owned(), json!(with + 1));
            put("with_name".to_owned(), json!(recorded.names[*with]));
        }
        Fault::Clipped {
            at,
            is_upper,
            share,
        } => {
            put(format!("at{ending}"), json!(at * factor));
            put(
                "end".to_owned(),
                json!(if *is_upper { "upper" } else { "lower" }),
            );
            put("share_of_rows".to_owned(), json!(share));
        }
        _ => {}
    }
    Value::Object(all)
}
