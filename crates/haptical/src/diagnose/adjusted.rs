//! What was fitted before the verdict, in words: the user's own model was off by that.

use haptical_diagnosis::{AdjustedAnswer, BESIDE_TORQUES, Diagnosis, OwnModel};

use crate::diagnose::words::listed;
use crate::units::Shown;

/// A file that is off by less than this many times what is left is one that needed no adjustment.
const OFF: f64 = 1.5;
/// Numbers that are said.
const SAID: usize = 3;

/// How far the device file as it is was off, and what was adjusted; none where it was not, or nothing was adjusted.
pub(super) fn adjusted(diagnosis: &Diagnosis) -> Option<String> {
    let off = |entry: &OwnModel| entry.rms_before / entry.rms_after.max(f64::MIN_POSITIVE);
    let models = diagnosis.own_model.iter().filter(|entry| off(entry) > OFF);
    let worst = models.max_by(|a, b| a.rms_before.total_cmp(&b.rms_before))?;
    let joint: usize = worst.channel.trim_start_matches("torque").parse().ok()?;
    let is_other = |entry: &&AdjustedAnswer| {
        let before = entry.before.unwrap_or(0.0);
        !(entry.ci95[0]..=entry.ci95[1]).contains(&before)
    };
    let others = diagnosis.adjusted.iter().filter(is_other);
    let (first, rest): (Vec<&AdjustedAnswer>, Vec<&AdjustedAnswer>) =
        others.partition(|entry| entry.joint == joint);
    if first.is_empty() {
        return None;
    }
    let said: Vec<String> = first.iter().take(SAID).map(|entry| number(entry)).collect();
    let more = match first.len().saturating_sub(SAID) + rest.len() {
        0 => String::new(),
        more => format!(" and {more} more numbers, see gap.json"),
    };
    let [before, after] =
        [worst.rms_before, worst.rms_after].map(|rms| Shown::fine(&worst.unit).text(rms));
    let causes = match diagnosis.verdict.has_causes() {
        true => "the causes, ",
        false => "",
    };
    let is_beside = |words: &String| words == BESIDE_TORQUES;
    let is_held = diagnosis.corrected.is_some() && !diagnosis.not_in_file.iter().any(is_beside);
    let writes = match is_held {
        true => "corrected.toml holds them",
        false => "`haptical identify --with dynamics` writes them into a device file",
    };
    Some(format!(
        "the device file as it is misses {} by {before}; {after} are left with {causes}{}{more}; {writes}",
        worst.channel,
        listed(&said)
    ))
}

fn number(entry: &AdjustedAnswer) -> String {
    let what = match entry.number.split('_').next() {
        Some("viscous") => "viscous friction",
        Some("armature") => "armature",
        _ => "friction",
    };
    let before = entry.before.map_or("none".to_owned(), |before| {
        format!("{}", (before * 1e3).round() / 1e3)
    });
    format!(
        "{what} of joint {} {before} -> {:.3} {}",
        entry.joint, entry.after, entry.unit
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example_tests::no_gap;

    #[test]
    fn friction_that_the_file_does_not_have_is_said_with_its_numbers() {
        let friction = |after: f64| AdjustedAnswer {
            name: "friction",
            number: "coulomb_nm".to_owned(),
            joint: 2,
            unit: "N m",
            before: Some(0.8),
            after,
            ci95: [after - 0.1, after + 0.1],
        };
        let model = |rms_before: f64| OwnModel {
            channel: "torque2".to_owned(),
            unit: "N m".to_owned(),
            rms_before,
            rms_after: 0.05,
        };
        let said = |after: f64, rms_before: f64| {
            let mut found = no_gap();
            found.adjusted = vec![friction(after)];
            found.own_model = vec![model(rms_before)];
            adjusted(&found)
        };
        let words = said(5.4, 6.8).unwrap_or_default();
        assert!(words.contains("misses torque2 by 6.800 N m"), "{words}");
        assert!(
            words.contains("friction of joint 2 0.8 -> 5.400 N m"),
            "{words}"
        );
        // as the file has it, and where that makes no difference
        assert_eq!(said(0.85, 6.8), None);
        assert_eq!(said(5.4, 0.06), None);
    }
}
