//! The table of docs/real-arms.md: a line for each set.

use serde_json::Value;

use super::sets::{Answers, Set};

/// Sizes as people read them.
const SCALES: [(f64, &str); 3] = [(1.0, ""), (1e-3, "m"), (1e-6, "µ")];

pub(super) const HEAD: &str = "| set | known | identify: held out before → after | verdict | causes | identify --with gap.json: held out | gap closed on unseen data | seconds: identify, diagnose |\n\
     | --- | --- | --- | --- | --- | --- | --- | --- |\n";

pub(super) fn absent(set: &Set) -> String {
    format!(
        "| {} | {} | not run: its data are not here | | | | | |\n",
        set.name, set.known
    )
}

pub(super) fn line(set: &Set, answers: &Answers) -> String {
    let (gap, diagnosed_s) = &answers.gap;
    let identified = answers.identified.as_ref();
    let calibrated = identified.map_or("-".to_owned(), |(result, _)| held_out(result));
    let seconds = match identified {
        Some((_, identified_s)) => format!("{identified_s:.1}, {diagnosed_s:.1}"),
        None => format!("-, {diagnosed_s:.1}"),
    };
    format!(
        "| {} | {} | {calibrated} | {} | {} | {} | {} | {seconds} |\n",
        set.name,
        set.known,
        gap["verdict"].as_str().unwrap_or_default(),
        causes(gap),
        answers.with_causes.as_ref().map_or("-".to_owned(), after),
        closed(gap),
    )
}

/// What is left of held-out rows.
fn after(identified: &Value) -> String {
    let channels = identified["channels"].as_array().into_iter().flatten();
    joined(channels.filter_map(|channel| {
        let (name, unit) = (channel["channel"].as_str()?, channel["unit"].as_str()?);
        Some(format!(
            "{name} {}",
            size(channel["rms_after"].as_f64()?, unit)
        ))
    }))
}

fn held_out(identified: &Value) -> String {
    let channels = identified["channels"].as_array().into_iter().flatten();
    joined(channels.filter_map(|channel| {
        let (name, unit) = (channel["channel"].as_str()?, channel["unit"].as_str()?);
        let rms = |key: &str| Some(size(channel[key].as_f64()?, unit));
        Some(format!(
            "{name} {} → {}",
            rms("rms_before")?,
            rms("rms_after")?
        ))
    }))
}

fn causes(gap: &Value) -> String {
    let causes = gap["causes"].as_array().into_iter().flatten();
    joined(causes.filter_map(|cause| {
        let name = cause["effect"].as_str()?;
        let joint = cause["joint"].as_u64().map(|joint| format!("@{joint}"));
        let probability = 100.0 * cause["probability"].as_f64()?;
        let rivals = cause["confusable_with"].as_array();
        let rivals = rivals.into_iter().flatten().filter_map(Value::as_str);
        let rivals: Vec<&str> = rivals.collect();
        let beside = match rivals.is_empty() {
            true => String::new(),
            false => format!(" (or {})", rivals.join(", ")),
        };
        Some(format!(
            "{name}{} {probability:.0} %{beside}",
            joint.unwrap_or_default()
        ))
    }))
}

fn closed(gap: &Value) -> String {
    let channels = gap["gap"]["channels"].as_array().into_iter().flatten();
    joined(channels.filter_map(|channel| {
        let percent = channel["reduction_percent"].as_f64()?;
        let ends = channel["reduction_ci95"].as_array();
        let ends = ends.into_iter().flatten().filter_map(Value::as_f64);
        let ends: Vec<f64> = ends.collect();
        let name = channel["channel"].as_str()?;
        let unseen = channel["held_out"].as_bool()?;
        let interval = match ends.as_slice() {
            [low, high] => format!(" [{low:.0}, {high:.0}]"),
            _ => String::new(),
        };
        unseen.then(|| format!("{name} {percent:.0} %{interval}"))
    }))
}

fn joined(parts: impl Iterator<Item = String>) -> String {
    let parts: Vec<String> = parts.collect();
    match parts.is_empty() {
        true => "-".to_owned(),
        false => parts.join("; "),
    }
}

fn size(value: f64, unit: &str) -> String {
    let fits = |(scale, _): &&(f64, &str)| value.abs() >= 0.9 * scale;
    let (scale, prefix) = SCALES.iter().find(fits).unwrap_or(&SCALES[2]);
    format!("{:.2} {prefix}{unit}", value / scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_has_the_prefix_that_suits_it() {
        assert_eq!(size(1.234e-4, "m"), "123.40 µm");
        assert_eq!(size(2.5e-3, "rad"), "2.50 mrad");
        assert_eq!(size(1.5, "N m"), "1.50 N m");
    }

    #[test]
    fn a_cause_has_its_joint_and_its_rivals() {
        let gap = serde_json::json!({"causes": [
            {"effect": "backlash", "joint": 2, "probability": 0.8, "confusable_with": ["hysteresis"]}
        ]});
        assert_eq!(causes(&gap), "backlash@2 80 % (or hysteresis)");
    }
}
