//! Tables of the causes: how sure they are, their numbers, and their rivals.

use haptical_diagnosis::{CandidateAnswer, Diagnosis};
use haptical_report::{Cell, Table};

use crate::diagnose::quantity::Quantity;
use crate::diagnose::words::{earlier, listed, named_at, placed};
use crate::error::Error;
use crate::units::Shown;

/// Nats from which on their tenths say nothing.
const MANY_NATS: f64 = 100.0;
/// Candidates that are not folded away.
const OPEN_CANDIDATES: usize = 6;

/// How sure each cause is and how much it closes on unseen data.
pub(in crate::diagnose::page) fn causes(diagnosis: &Diagnosis) -> Result<Table, Error> {
    let columns = "cause | probability [%] | share of the gap [%] | confusable with | unseen data | gap closed there [%] \
             | 95 % interval [%]";
    let rows = diagnosis.causes.iter().map(|cause| {
        let rivals = match cause.confusable_with.as_slice() {
            [] => "nothing".to_owned(),
            names => listed(names),
        };
        let held_out = cause.held_out.as_ref();
        vec![
            placed(cause).into(),
            Cell::number(100.0 * cause.probability, 1),
            Cell::number(100.0 * cause.share, 1),
            rivals.into(),
            held_out.map_or(Cell::Missing, |held_out| {
                let shown = Shown::fine(&held_out.unit);
                let before = shown.text(held_out.rms_before);
                let after = shown.text(held_out.rms_after);
                Cell::Text(format!("{}: {before} to {after}", held_out.channel))
            }),
            Cell::number_or_missing(held_out.and_then(|held| held.reduction_percent), 1),
            Cell::interval_or_missing(held_out.and_then(|held| held.reduction_ci95), 1),
        ]
    });
    let mut table = Table::with_heads("How sure they are", columns).with_rows(rows)?;
    if !diagnosis.held_out.is_empty() {
        table.notes = vec![format!("Unseen data: {}.", diagnosis.held_out)];
    }
    Ok(table)
}

/// Numbers of the causes.
pub(in crate::diagnose::page) fn parameters(diagnosis: &Diagnosis) -> Result<Table, Error> {
    let columns = "cause | parameter | value and 95 % interval | in gap.json";
    let mut table = Table::with_heads("Their numbers", columns);
    for cause in &diagnosis.causes {
        let named = placed(cause);
        for (name, parameter) in &cause.parameters {
            let quantity = Quantity::new(&cause.effect, name, parameter.value);
            table.push(vec![
                (&named).into(),
                (&quantity.words).into(),
                (quantity.text(parameter.value, parameter.ci95) + &earlier(cause, name)).into(),
                name.into(),
            ])?;
        }
        if !cause.plausible {
            table.notes.push(format!(
                "{named}: a size that a sound device hardly has; another effect may hide behind it."
            ));
        }
    }
    Ok(table)
}

/// The nearest candidates with "none of the catalogue", and all of them where there are more.
pub(in crate::diagnose::page) fn candidates(
    diagnosis: &Diagnosis,
) -> Result<(Table, Option<Table>), Error> {
    let columns = "candidate | probability [%] | nats behind | explains alone [%]";
    let row = |candidate: &CandidateAnswer| -> Vec<Cell> {
        vec![
            named_at(&candidate.effect, candidate.joint).into(),
            Cell::number(100.0 * candidate.probability, 1),
            Cell::number(
                candidate.nats_behind,
                usize::from(candidate.nats_behind < MANY_NATS),
            ),
            Cell::number(100.0 * candidate.share, 1),
        ]
    };
    let all = &diagnosis.candidates;
    let none = vec![
        "none of the catalogue".into(),
        Cell::number(100.0 * diagnosis.probability_unknown, 1),
        Cell::Missing,
        Cell::Missing,
    ];
    let nearest = all.iter().take(OPEN_CANDIDATES).map(row).chain([none]);
    let title = "The nearest candidates for the first cause";
    let open = Table::with_heads(title, columns).with_rows(nearest)?.with_note(
        "Nats behind: how much less likely the data are with this candidate than with the best. \
         Explains alone: share of what the first cause explains.",
    );
    if all.len() <= OPEN_CANDIDATES {
        return Ok((open, None));
    }
    let all = Table::with_heads("", columns).with_rows(all.iter().map(row))?;
    Ok((open, Some(all)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example_tests::named;

    #[test]
    fn further_candidates_are_folded_and_none_of_them_is_one() {
        let mut diagnosis = named();
        let (open, folded) = candidates(&diagnosis).unwrap();
        assert!(folded.is_none());
        let rows = open.rows();
        assert_eq!(rows.len(), 5);
        assert_eq!(rows[4][0], "none of the catalogue".into());
        let last = diagnosis.candidates[3].clone();
        diagnosis.candidates.extend(vec![last; 10]);
        let (open, folded) = candidates(&diagnosis).unwrap();
        assert_eq!(open.rows().len(), OPEN_CANDIDATES + 1);
        assert_eq!(folded.unwrap().rows().len(), 14);
    }

    #[test]
    fn implausible_causes_have_a_note() {
        let mut diagnosis = named();
        diagnosis.causes[0].plausible = false;
        let notes = parameters(&diagnosis).unwrap().notes;
        assert!(
            notes[0].starts_with("capstan-compliance at joint 2"),
            "{notes:?}"
        );
    }
}
