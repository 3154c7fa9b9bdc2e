//! Tables of what is asked before a verdict, and of what was adjusted before it.

use haptical_diagnosis::{AdjustedAnswer, Diagnosis};
use haptical_report::{Cell, Table};

use crate::error::Error;

/// Whether there may be a verdict: four questions, with what their answers rest on.
pub(in crate::diagnose::page) fn admission(diagnosis: &Diagnosis) -> Result<Table, Error> {
    let asked = &diagnosis.admission;
    let questions = [
        ("Do log and device belong together?", &asked.belongs),
        (
            "Are the base model's numbers credible?",
            &asked.credible_base,
        ),
        ("Is the noise known?", &asked.known_noise),
        ("Are there rows and motion enough?", &asked.enough),
    ];
    let rows = questions.map(|(question, check)| {
        vec![
            question.into(),
            check.answer.words().into(),
            check.why.as_str().into(),
        ]
    });
    let table = Table::with_heads(
        "Whether there may be a verdict",
        "question | answer | because",
    );
    Ok(table.with_rows(rows)?)
}

/// Friction and armature as they were fitted, next to those of the device file; none where nothing was adjusted.
pub(in crate::diagnose::page) fn adjusted(diagnosis: &Diagnosis) -> Result<Option<Table>, Error> {
    if diagnosis.adjusted.is_empty() {
        return Ok(None);
    }
    let row = |entry: &AdjustedAnswer| {
        vec![
            entry.number.as_str().into(),
            Cell::number(entry.joint as f64, 0),
            entry.unit.into(),
            Cell::number_or_missing(entry.before, 4),
            Cell::number(entry.after, 4),
            Cell::interval_or_missing(Some(entry.ci95), 4),
        ]
    };
    let heads = "number | joint | unit | device file | adjusted | 95 % interval";
    let table = Table::with_heads("Friction and armature of the drives", heads);
    Ok(Some(table.with_rows(diagnosis.adjusted.iter().map(row))?))
}
