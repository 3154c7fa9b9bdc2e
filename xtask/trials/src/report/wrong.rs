//! The trials that were not answered rightly, each with what was said and how to run it again.

use haptical_report::{ReportError, Table};
use xtask_blind::{Answer, TrialScore, Verdict};
use xtask_output::cells;

use crate::batch::Case;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Fault {
    NoAnswer,
    NamedWrong,
    FalseAlarm,
    ClassWrong,
    /// A gap was seen and nothing named, though the catalogue has the name.
    Declined,
    Incomplete,
    /// The right name at the wrong joint.
    Joint,
    Extra,
    Missed,
}

impl Fault {
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::NoAnswer => "no answer",
            Self::NamedWrong => "named and wrong",
            Self::FalseAlarm => "false alarm",
            Self::ClassWrong => "class without the truth",
            Self::Declined => "declined",
            Self::Incomplete => "not all found",
            Self::Joint => "joint",
            Self::Extra => "false extra cause",
            Self::Missed => "missed",
        }
    }
}

/// What is wrong with the answer of a trial; none where it is right.
pub(crate) fn fault(case: &Case) -> Option<Fault> {
    let Some(score) = &case.score else {
        return Some(Fault::NoAnswer);
    };
    if score.right {
        return if score.joint_right == Some(false) && !score.is_unknown {
            Some(Fault::Joint)
        } else {
            (score.false_causes > 0).then_some(Fault::Extra)
        };
    }
    Some(of_wrong(score))
}

fn of_wrong(score: &TrialScore) -> Fault {
    match score.verdict {
        Verdict::NoGap => Fault::Missed,
        Verdict::Named if score.groups > 1 && score.groups_found > 0 => Fault::Incomplete,
        Verdict::Named => Fault::NamedWrong,
        _ if score.is_clean => Fault::FalseAlarm,
        Verdict::Ambiguous if score.groups > 1 && score.groups_found > 0 => Fault::Incomplete,
        Verdict::Ambiguous => Fault::ClassWrong,
        Verdict::Unknown => Fault::Declined,
    }
}

/// The table of the trials with one of these faults, worst first.
pub(crate) fn table(
    title: &str,
    cases: &[Case],
    wanted: impl Fn(&Case, Fault) -> bool,
) -> Result<Table, ReportError> {
    let mut found: Vec<(Fault, &Case)> = cases
        .iter()
        .filter_map(|case| Some((fault(case)?, case)))
        .filter(|(fault, case)| wanted(case, *fault))
        .collect();
    found.sort_by_key(|(fault, _)| *fault);
    let mut table = Table::with_heads(title, "fault | trial | device | truth | verdict | answer");
    for (fault, case) in found {
        let answer = case.answer.as_ref();
        let said = match (answer, &case.error) {
            (Some(answer), _) => answered(answer),
            (None, error) => error.clone().unwrap_or_default(),
        };
        table.push(cells! {
            fault.words(), case.arguments(), case.truth.device.clone(), truth(case),
            answer.map_or("none", |answer| answer.verdict.text()), said,
        })?;
    }
    Ok(table)
}

/// `backlash joint 3 + cable-drift`, with the size where it is not a strong one.
pub(super) fn truth(case: &Case) -> String {
    if case.truth.effects.is_empty() || case.suite == "s8" {
        return case.truth.name.clone();
    }
    let effects = case.truth.effects.iter().map(|effect| {
        let size = Some(effect.size).filter(|size| *size != 1.0);
        let size = size.map(|size| format!(" x {size:.2}"));
        effect.effect.clone() + &at_joint(effect.joint) + &size.unwrap_or_default()
    });
    let effects: Vec<String> = effects.collect();
    let without = &case.truth.without;
    effects.join(" + ") + &listed(" (without ", without, ")")
}

/// ` joint 3`; nothing without a joint.
fn at_joint(joint: Option<usize>) -> String {
    joint.map_or(String::new(), |joint| format!(" joint {joint}"))
}

/// Names between two texts; nothing without names.
fn listed(before: &str, names: &[String], after: &str) -> String {
    match names {
        [] => String::new(),
        names => format!("{before}{}{after}", names.join(", ")),
    }
}

/// `backlash joint 3, p 0.93, or hysteresis; cable-drift, p 0.99`.
fn answered(answer: &Answer) -> String {
    let causes = answer.causes.iter().map(|cause| {
        let probability = cause.probability.map(|p| format!(", p {p:.2}"));
        cause.effect.clone()
            + &at_joint(cause.joint)
            + &probability.unwrap_or_default()
            + &listed(", or ", &cause.confusable_with, "")
    });
    let causes: Vec<String> = causes.collect();
    let place = answer.place.as_ref().map_or(String::new(), |place| {
        let joint = place.joint.map(|joint| format!(", joint {joint}"));
        let columns = match place.depends_on.is_empty() {
            true => "nothing".to_owned(),
            false => place.depends_on.join(", "),
        };
        format!(
            "in {}{}, depends on {columns}",
            place.channel.as_deref().unwrap_or("no channel"),
            joint.unwrap_or_default()
        )
    });
    let unknown = answer
        .probability_unknown
        .filter(|_| answer.verdict == Verdict::Unknown)
        .map_or(String::new(), |p| format!("p unknown {p:.2}"));
    let parts = [causes.join("; "), unknown, place];
    let said: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    said.join("; ")
}
