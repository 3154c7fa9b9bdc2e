//! Tables of the causes: how sure they are, their numbers, what else could stand in their place.

use haptical_diagnosis::{CandidateAnswer, Diagnosis};
use haptical_report::{Block, Cell, Table};

use crate::diagnose::quantity::Quantity;
use crate::diagnose::words::{listed, named_at};
use crate::error::Error;
use crate::units::Shown;

/// Candidates that are not folded away.
const OPEN_CANDIDATES: usize = 6;

/// How sure each cause is and how much it closes on unseen data.
pub(in crate::diagnose::page) fn causes(diagnosis: &Diagnosis) -> Result<Block, Error> {
    let mut table = Table::with_heads(
        "How sure they are",
        "cause | probability [%] | share of the gap [%] | not told from | unseen data | gap closed there [%] \
             | 95 % interval [%]",
    );
    for cause in &diagnosis.causes {
        let mut rivals = listed(&cause.confusable_with);
        if rivals.is_empty() {
            "nothing".clone_into(&mut rivals);
        }
        let held_out = cause.held_out.as_ref();
        let interval = held_out.and_then(|held_out| held_out.reduction_ci95);
        table.push(vec![
            named_at(&cause.effect, cause.joint).into(),
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
            interval.map_or(Cell::Missing, |[low, high]| Cell::interval(low, high, 1)),
        ])?;
    }
    if !diagnosis.held_out.is_empty() {
        table
            .notes
            .push(format!("Unseen data: {}.", diagnosis.held_out));
    }
    Ok(Block::Table(table))
}

/// Numbers of the causes.
pub(in crate::diagnose::page) fn parameters(diagnosis: &Diagnosis) -> Result<Block, Error> {
    let columns = "cause | parameter | value | 95 % interval | unit | in gap.json";
    let mut table = Table::with_heads("Their numbers", columns);
    for cause in &diagnosis.causes {
        for (name, parameter) in &cause.parameters {
            let quantity = Quantity::new(&cause.effect, name, parameter.value);
            table.push(vec![
                named_at(&cause.effect, cause.joint).into(),
                quantity.words.as_str().into(),
                quantity.cell(parameter.value, parameter.ci95),
                quantity.interval(parameter.value, parameter.ci95),
                quantity.unit.into(),
                name.as_str().into(),
            ])?;
        }
        if !cause.plausible {
            table.notes.push(format!(
                "{}: a size that a sound device hardly has; another effect may hide behind it.",
                named_at(&cause.effect, cause.joint)
            ));
        }
    }
    Ok(Block::Table(table))
}

/// The nearest candidates with "none of the catalogue", and all of them where there are more.
pub(in crate::diagnose::page) fn candidates(
    diagnosis: &Diagnosis,
) -> Result<(Block, Option<Block>), Error> {
    let columns = "candidate | probability [%] | nats behind | explains alone [%]";
    let row = |candidate: &CandidateAnswer| -> Vec<Cell> {
        vec![
            named_at(&candidate.effect, candidate.joint).into(),
            Cell::number(100.0 * candidate.probability, 1),
            Cell::number(candidate.nats_behind, 1),
            Cell::number(100.0 * candidate.share, 1),
        ]
    };
    let mut open = Table::with_heads("The nearest candidates for the first cause", columns);
    for candidate in diagnosis.candidates.iter().take(OPEN_CANDIDATES) {
        open.push(row(candidate))?;
    }
    open.push(vec![
        "none of the catalogue".into(),
        Cell::number(100.0 * diagnosis.probability_unknown, 1),
        Cell::Missing,
        Cell::Missing,
    ])?;
    open.notes = vec![
        "Nats behind: how much less likely the data are with this candidate than with the best. \
         Explains alone: share of what the first cause explains."
            .to_owned(),
    ];
    if diagnosis.candidates.len() <= OPEN_CANDIDATES {
        return Ok((Block::Table(open), None));
    }
    let mut all = Table::with_heads("", columns);
    for candidate in &diagnosis.candidates {
        all.push(row(candidate))?;
    }
    Ok((Block::Table(open), Some(Block::Table(all))))
}

#[cfg(test)]
mod tests {
    use super::super::only;
    use super::*;
    use crate::diagnose::example_tests::named;

    #[test]
    fn further_candidates_are_folded_and_none_of_them_is_one() {
        let mut diagnosis = named();
        let (open, folded) = candidates(&diagnosis).unwrap();
        assert!(folded.is_none());
        let rows = only(open).rows;
        assert_eq!(rows.len(), 5);
        assert_eq!(rows[4][0], "none of the catalogue".into());
        let last = diagnosis.candidates[3].clone();
        diagnosis.candidates.extend(vec![last; 10]);
        let (open, folded) = candidates(&diagnosis).unwrap();
        assert_eq!(only(open).rows.len(), OPEN_CANDIDATES + 1);
        assert_eq!(only(folded.unwrap()).rows.len(), 14);
    }

    #[test]
    fn implausible_causes_have_a_note() {
        let mut diagnosis = named();
        diagnosis.causes[0].plausible = false;
        let notes = only(parameters(&diagnosis).unwrap()).notes;
        assert!(
            notes[0].starts_with("capstan-compliance at joint 2"),
            "{notes:?}"
        );
    }
}
