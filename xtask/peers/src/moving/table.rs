//! The table of docs/performance.md, Moving arms: a line for each program and log.

use std::collections::BTreeMap;
use std::fmt::Write;

use anyhow::{Context, Result};
use xtask_blind::{Answer, Cause};

use super::answers::{Case, Fit, Truth};

pub(super) fn table(truth: &Truth, cases: &[Case]) -> Result<String> {
    let version = cases.first().map_or("", |case| case.fit.version.as_str());
    let mut text = format!("MuJoCo {version}.\n\n");
    text.push_str("| withheld | program | answer | what it says of itself | seconds |\n");
    text.push_str("| --- | --- | --- | --- | --- |\n");
    for case in cases {
        let withheld = withheld(truth, &case.withheld);
        let (answer, seconds) = (identified(truth, &case.fit)?, case.fit.seconds);
        let says = of_itself(truth, &case.fit)?;
        writeln!(
            text,
            "| {withheld} | MuJoCo sysid | {answer} | {says} | {seconds:.1} |"
        )?;
        let (causes, verdict, seconds) = (causes(&case.gap), case.gap.verdict.text(), case.gap_s);
        writeln!(
            text,
            "| {withheld} | `haptical diagnose` | {causes} | {verdict} | {seconds:.1} |"
        )?;
    }
    Ok(text)
}

/// What the model lacks, as in `payload_kg 1`.
fn withheld(truth: &Truth, case: &str) -> String {
    let effects = truth.cases.get(case).into_iter().flatten();
    let effects: Vec<String> = effects
        .map(|(name, size)| format!("{name} {size}"))
        .collect();
    match effects.is_empty() {
        true => "nothing".to_owned(),
        false => effects.join(", "),
    }
}

/// The largest error of each number against the true arm's, per cent of the true value.
fn identified(truth: &Truth, fit: &Fit) -> Result<String> {
    let mut parts = Vec::new();
    for (kind, values) in &truth.values {
        let mut worst = (0.0_f64, 0);
        for (index, &true_value) in values.iter().enumerate() {
            let joint = index + 1;
            let found = number(&fit.values, kind, joint)?;
            let percent = 100.0 * (found / true_value - 1.0);
            if percent.abs() >= worst.0.abs() {
                worst = (percent, joint);
            }
        }
        let (percent, joint) = worst;
        parts.push(format!("{kind} {percent:+.1} % (joint {joint})"));
    }
    Ok(parts.join(", "))
}

/// How often its intervals hold the truth, bounds and warnings.
fn of_itself(truth: &Truth, fit: &Fit) -> Result<String> {
    let (mut held, mut all) = (0, 0);
    for (kind, values) in &truth.values {
        for (index, true_value) in values.iter().enumerate() {
            let found = number(&fit.values, kind, index + 1)?;
            let half = number(&fit.half_widths_95, kind, index + 1)?;
            held += usize::from((found - true_value).abs() <= half);
            all += 1;
        }
    }
    let warnings = match fit.warnings.as_slice() {
        [] => "no warning".to_owned(),
        texts => format!("warns: {}", texts.join("; ")),
    };
    let bounds = match fit.at_bound.as_slice() {
        [] => "none at a bound".to_owned(),
        names => format!("at a bound: {}", names.join(", ")),
    };
    let left = 100.0 * fit.relative_rms_after / fit.relative_rms_before;
    Ok(format!(
        "{warnings}; {bounds}; {left:.0} % of the residual left; {held} of {all} intervals hold the true value"
    ))
}

fn number(values: &BTreeMap<String, f64>, kind: &str, joint: usize) -> Result<f64> {
    let name = format!("{kind}{joint}");
    values.get(&name).copied().context(name)
}

/// The causes in their order; of neighbours with one name the first has its parameters, the others their joints.
fn causes(gap: &Answer) -> String {
    let mut parts: Vec<String> = Vec::new();
    let mut rest = gap.causes.as_slice();
    while let Some((first, after)) = rest.split_first() {
        let alike = after
            .iter()
            .take_while(|cause| cause.effect == first.effect)
            .count();
        let more = match alike {
            0 => String::new(),
            _ => {
                let joints = after.iter().take(alike).filter_map(|cause| cause.joint);
                let joints: Vec<String> = joints.map(|joint| joint.to_string()).collect();
                format!(", and at {}", joints.join(", "))
            }
        };
        parts.push(format!("{}{more}", one(first)));
        rest = after.get(alike..).unwrap_or_default();
    }
    match parts.is_empty() {
        true => "no cause".to_owned(),
        false => parts.join("; "),
    }
}

/// A cause with its parameters and their intervals.
fn one(cause: &Cause) -> String {
    let joint = cause.joint.map(|joint| format!("@{joint}"));
    let sizes = cause.parameters.iter().map(|(name, size)| {
        let interval = size
            .ci95
            .map(|[low, high]| format!(" [{low:.3}, {high:.3}]"));
        format!(
            "{name} {:.3}{}",
            size.value.unwrap_or(f64::NAN),
            interval.unwrap_or_default()
        )
    });
    let sizes: Vec<String> = sizes.collect();
    let colon = if sizes.is_empty() { "" } else { ": " };
    format!(
        "{}{} {:.0} %{colon}{}",
        cause.effect,
        joint.unwrap_or_default(),
        100.0 * cause.probability.unwrap_or(f64::NAN),
        sizes.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truth() -> Truth {
        serde_json::from_value(serde_json::json!({
            "cases": {"clean": {}, "payload": {"payload_kg": 1.0}},
            "true": {"armature": [0.5, 0.4], "damping": [2.0, 4.0]},
        }))
        .unwrap()
    }

    fn fit() -> Fit {
        serde_json::from_value(serde_json::json!({
            "version": "4.0.0", "seconds": 2.34,
            "values": {"armature1": 0.55, "armature2": 0.2, "damping1": 2.0, "damping2": 4.1},
            "half_widths_95": {"armature1": 0.06, "armature2": 0.1, "damping1": 0.1, "damping2": 0.2},
            "at_bound": [], "warnings": [], "relative_rms_before": 0.4, "relative_rms_after": 0.1,
        }))
        .unwrap()
    }

    #[test]
    fn the_largest_error_of_each_number_is_shown_with_its_joint() {
        let words = identified(&truth(), &fit()).unwrap();
        assert_eq!(
            words,
            "armature -50.0 % (joint 2), damping +2.5 % (joint 2)"
        );
    }

    #[test]
    fn an_interval_beside_the_truth_does_not_count() {
        let words = of_itself(&truth(), &fit()).unwrap();
        assert!(words.ends_with("25 % of the residual left; 3 of 4 intervals hold the true value"));
        assert!(words.starts_with("no warning; none at a bound"));
    }

    #[test]
    fn a_number_that_the_peer_does_not_answer_is_an_error() {
        let mut fit = fit();
        fit.values.remove("damping2");
        assert!(identified(&truth(), &fit).is_err());
    }

    #[test]
    fn causes_of_one_name_are_one_part() {
        let gap: Answer =
            serde_json::from_value(serde_json::json!({"verdict": "named", "causes": [
                {"effect": "payload", "joint": null, "probability": 0.95,
                 "parameters": {"mass_kg": {"value": 1.01, "ci95": [0.98, 1.04]}}},
                {"effect": "joint-friction", "joint": 1, "probability": 0.9, "parameters": {}},
                {"effect": "joint-friction", "joint": 3, "probability": 0.9, "parameters": {}},
            ]}))
            .unwrap();
        let words = causes(&gap);
        assert_eq!(
            words,
            "payload 95 %: mass_kg 1.010 [0.980, 1.040]; joint-friction@1 90 %, and at 3"
        );
        assert_eq!(withheld(&truth(), "payload"), "payload_kg 1");
        assert_eq!(withheld(&truth(), "clean"), "nothing");
    }
}
