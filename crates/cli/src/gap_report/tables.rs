//! Tables of a diagnosis.

use haptical_diagnosis::{CandidateAnswer, Diagnosis, Verdict};
use haptical_report::{Block, Cell, Column, Table};

use crate::diagnosis_words::{listed, named_at};
use crate::failure::Failure;
use crate::quantity::Quantity;
use crate::units::Shown;

/// Candidates that are not folded away.
const OPEN_CANDIDATES: usize = 6;

/// A table under columns named `name` or `name [unit]`.
fn table(title: &str, columns: &[&str]) -> Table {
    let column = |text: &&str| match text.split_once(" [") {
        Some((name, unit)) => Column::new(name, unit.trim_end_matches(']')),
        None => Column::new(*text, ""),
    };
    Table::new(title, columns.iter().map(column).collect())
}

/// Before, after, floor and what was closed, channel by channel; without a gap, what there is.
pub(super) fn channels(diagnosis: &Diagnosis) -> Result<Block, Failure> {
    let title = "Root mean square of the residual, channel by channel";
    if diagnosis.verdict == Verdict::NoGap {
        let mut table = table(title, &["channel", "unit", "residual", "noise floor"]);
        for channel in &diagnosis.gap.channels {
            let shown = Shown::fine(&channel.unit);
            table.push(vec![
                channel.channel.as_str().into(),
                shown.name.into(),
                shown.cell(channel.rms_before),
                shown.cell(channel.noise_floor),
            ])?;
        }
        return Ok(Block::Table(table));
    }
    let columns = [
        "channel",
        "unit",
        "before",
        "after",
        "noise floor",
        "share of the gap [%]",
        "gap closed [%]",
        "95 % interval [%]",
    ];
    let mut table = table(title, &columns);
    for channel in &diagnosis.gap.channels {
        let shown = Shown::fine(&channel.unit);
        table.push(vec![
            channel.channel.as_str().into(),
            shown.name.into(),
            shown.cell(channel.rms_before),
            shown.cell(channel.rms_after),
            shown.cell(channel.noise_floor),
            Cell::number(100.0 * channel.share_of_gap, 1),
            Cell::number_or_missing(channel.reduction_percent, 1),
            channel
                .reduction_ci95
                .map_or(Cell::Missing, |[low, high]| Cell::interval(low, high, 1)),
        ])?;
    }
    table.notes = vec![
        "Before: the model alone. After: with the causes in it. Gap closed: of what lies above the \
         noise floor; a dash where nothing does."
            .to_owned(),
    ];
    Ok(Block::Table(table))
}

/// Of touches: everything that the residuals were asked for; none for other recordings.
pub(super) fn dependence(diagnosis: &Diagnosis) -> Result<Option<Block>, Failure> {
    let found = diagnosis.place.iter().flat_map(|place| &place.dependence);
    let columns = [
        "column",
        "it depends on",
        "p",
        "p, all together",
        "share [%]",
    ];
    let mut table = table("What the residuals of the touches depend on", &columns);
    let mut is_empty = true;
    for found in found {
        is_empty = false;
        table.push(vec![
            found.column.as_str().into(),
            found.on.as_str().into(),
            Cell::scientific(found.p_value, 2),
            Cell::scientific(found.p_adjusted, 2),
            Cell::number(100.0 * found.share, 1),
        ])?;
    }
    table.notes = vec![
        "p: probability that chance gives as much, errors within one posture allowed to go together; all \
         together: by Holm's method."
            .to_owned(),
    ];
    Ok((!is_empty).then_some(Block::Table(table)))
}

/// How sure each cause is and how much it closes on unseen data.
pub(super) fn causes(diagnosis: &Diagnosis) -> Result<Block, Failure> {
    let mut table = table(
        "How sure they are",
        &[
            "cause",
            "probability [%]",
            "share of the gap [%]",
            "not told from",
            "unseen data",
            "gap closed there [%]",
            "95 % interval [%]",
        ],
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
pub(super) fn parameters(diagnosis: &Diagnosis) -> Result<Block, Failure> {
    let columns = [
        "cause",
        "parameter",
        "value",
        "95 % interval",
        "unit",
        "in gap.json",
    ];
    let mut table = table("Their numbers", &columns);
    for cause in &diagnosis.causes {
        for (name, parameter) in &cause.parameters {
            let quantity = Quantity::new(name, parameter.value);
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
pub(super) fn candidates(diagnosis: &Diagnosis) -> Result<(Block, Option<Block>), Failure> {
    let columns = [
        "candidate",
        "probability [%]",
        "nats behind",
        "explains alone [%]",
    ];
    let row = |candidate: &CandidateAnswer| -> Vec<Cell> {
        vec![
            named_at(&candidate.effect, candidate.joint).into(),
            Cell::number(100.0 * candidate.probability, 1),
            Cell::number(candidate.nats_behind, 1),
            Cell::number(100.0 * candidate.share, 1),
        ]
    };
    let mut open = table("The nearest candidates for the first cause", &columns);
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
    let mut all = table("", &columns);
    for candidate in &diagnosis.candidates {
        all.push(row(candidate))?;
    }
    Ok((Block::Table(open), Some(Block::Table(all))))
}

/// Odd values of the model.
pub(super) fn plausibility(diagnosis: &Diagnosis) -> Result<Block, Failure> {
    let title = "Values of the model that a sound device hardly has: an effect may hide in them";
    let mut table = table(title, &["parameter", "what is odd"]);
    for hint in &diagnosis.plausibility {
        table.push(vec![
            hint.parameter.as_str().into(),
            hint.why.as_str().into(),
        ])?;
    }
    Ok(Block::Table(table))
}

/// Smallest sizes that would have been noticed: effects by joints.
pub(super) fn detectable(diagnosis: &Diagnosis) -> Result<Option<Block>, Failure> {
    let all = &diagnosis.detectable;
    let mut joints: Vec<usize> = all.iter().filter_map(|entry| entry.joint).collect();
    joints.sort_unstable();
    joints.dedup();
    let mut columns = vec!["effect".to_owned(), "parameter".to_owned()];
    columns.extend(joints.iter().map(|joint| format!("joint {joint}")));
    let of_device = all.iter().any(|entry| entry.joint.is_none());
    if of_device {
        columns.push("device".to_owned());
    }
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    let mut table = table("", &columns);
    let mut done: Vec<(&str, &str)> = Vec::new();
    for entry in all {
        let key = (entry.effect.as_str(), entry.parameter.as_str());
        if done.contains(&key) {
            continue;
        }
        done.push(key);
        let at = |joint: Option<usize>| {
            all.iter()
                .find(|other| {
                    (other.effect.as_str(), other.parameter.as_str()) == key && other.joint == joint
                })
                .map_or(Cell::Missing, |found| {
                    Quantity::new(key.1, found.value).short(found.value).into()
                })
        };
        let mut row: Vec<Cell> = vec![key.0.into(), Quantity::new(key.1, entry.value).words.into()];
        row.extend(joints.iter().map(|joint| at(Some(*joint))));
        if of_device {
            row.push(at(None));
        }
        table.push(row)?;
    }
    table.notes = vec![
        "An effect of this size would have been noticed in four of five recordings like this one; \
         of a stiffness, any smaller one."
            .to_owned(),
    ];
    Ok(Some(Block::Table(table)))
}

/// What the model swallows.
pub(super) fn invisible(diagnosis: &Diagnosis) -> Result<Option<Block>, Failure> {
    let mut table = table("", &["effect", "why", "what it would falsify"]);
    for entry in &diagnosis.invisible {
        table.push(vec![
            named_at(&entry.effect, entry.joint).into(),
            entry.why.as_str().into(),
            entry.would_bias.as_str().into(),
        ])?;
    }
    Ok(Some(Block::Table(table)))
}

/// What cannot be tested, and why.
pub(super) fn untestable(diagnosis: &Diagnosis) -> Result<Option<Block>, Failure> {
    let mut table = table("", &["effect", "joints", "why"]);
    for entry in &diagnosis.untestable {
        let joints: Vec<String> = entry.joints.iter().map(ToString::to_string).collect();
        let joints = if joints.is_empty() {
            Cell::Missing
        } else {
            joints.join(", ").into()
        };
        table.push(vec![
            entry.effect.as_str().into(),
            joints,
            entry.why.as_str().into(),
        ])?;
    }
    Ok(Some(Block::Table(table)))
}

/// Noise of each channel.
pub(super) fn noise(diagnosis: &Diagnosis) -> Result<Block, Failure> {
    let columns = [
        "channel",
        "of the stated noise",
        "correlation of successive rows",
        "left out as outliers [%]",
        "estimated from",
    ];
    let mut table = table("", &columns);
    for entry in &diagnosis.noise {
        table.push(vec![
            entry.channel.as_str().into(),
            Cell::number(entry.ratio, 3),
            Cell::number(entry.colour, 2),
            Cell::number(100.0 * entry.outlier_share, 2),
            entry.from.as_str().into(),
        ])?;
    }
    Ok(Block::Table(table))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example_diagnosis::named;

    fn only(block: Block) -> Table {
        match block {
            Block::Table(table) => table,
            other => panic!("{other:?} is not a table"),
        }
    }

    #[test]
    fn detectable_sizes_stand_under_their_joints() {
        let mut diagnosis = named();
        let mut device = diagnosis.detectable[0].clone();
        device.effect = "cable-latency".to_owned();
        device.parameter = "delay_s".to_owned();
        device.joint = None;
        device.value = 1.6e-5;
        diagnosis.detectable.push(device);
        let found = only(detectable(&diagnosis).unwrap().unwrap());
        let heads: Vec<&str> = found.columns.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(
            heads,
            ["effect", "parameter", "joint 1", "joint 2", "device"]
        );
        let texts = |row: usize| -> Vec<Cell> { found.rows[row].clone() };
        let cells = |all: [&str; 5]| {
            all.map(|text| {
                if text.is_empty() {
                    Cell::Missing
                } else {
                    text.into()
                }
            })
            .to_vec()
        };
        assert_eq!(
            texts(0),
            cells(["backlash", "width", "20.0 µrad", "30.0 µrad", ""])
        );
        assert_eq!(
            texts(1),
            cells(["cable-latency", "delay", "", "", "16.0 µs"])
        );
    }

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
