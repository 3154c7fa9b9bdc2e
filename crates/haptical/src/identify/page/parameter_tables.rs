//! Tables of the parameters: identified, not identified, correlated.

use haptical_report::{Block, Cell, Table, earned_decimals};

use crate::error::Error;
use crate::identify::intervals;
use crate::identify::result::{Identified, ParameterEntry};
use crate::identify::summary::in_words;
use crate::units::Shown;

/// Values of all identified parameters with their intervals.
pub(super) fn identified(result: &Identified) -> Result<Table, Error> {
    let columns = "parameter | unit | nominal | identified | deviation | standard deviation | 95 % interval of the \
             value";
    let entries = result.parameters.iter();
    let rows = entries.filter(|entry| entry.value.is_some()).map(row);
    let mut table = Table::with_heads("", columns).with_rows(rows)?.with_note(
        "Lengths in mm, angles in mrad; ratio deviations have no unit. The names stand for keys of \
         the device file, listed in identified.json.",
    );
    let sentence = result.intervals.as_ref().map(intervals::sentence);
    table.notes.extend(sentence);
    Ok(table)
}

fn row(entry: &ParameterEntry) -> Vec<Cell> {
    let shown = Shown::coarse(&entry.unit);
    let half = entry.ci95.map(|[low, high]| 0.5 * (high - low));
    let spread = half.or(entry.standard_deviation).unwrap_or(0.0) * shown.per_si;
    let decimals = earned_decimals(spread).unwrap_or(6);
    let number = |value: Option<f64>| {
        Cell::number_or_missing(value.map(|value| value * shown.per_si), decimals)
    };
    vec![
        entry.name.as_str().into(),
        shown.name.into(),
        number(entry.nominal),
        number(entry.value),
        number(entry.deviation),
        number(entry.standard_deviation),
        entry.ci95.map_or(Cell::Missing, |[low, high]| {
            Cell::interval(low * shown.per_si, high * shown.per_si, decimals)
        }),
    ]
}

/// What the data fix of parameters that they do not fix alone; none where they fix all alone.
pub(super) fn combinations(result: &Identified) -> Result<Option<Block>, Error> {
    if result.combinations.is_empty() {
        return Ok(None);
    }
    let sums = result.combinations.iter();
    let rows = sums.map(|sum| vec![in_words(sum).into()]);
    let table = Table::with_heads("Fixed only in a combination", "combination").with_rows(rows)?;
    let table = table.with_note(
        "Half widths of 95 % intervals by the noise. The interval of a single parameter of these counts the plausible \
         errors of the others, which the data do not tell from it; lengths in mm, angles in mrad, factors in SI units.",
    );
    Ok(Some(table.into()))
}

/// What kept its nominal value, and why.
pub(super) fn not_identified(result: &Identified) -> Result<Vec<Block>, Error> {
    let judged = &result.identifiability;
    let mut blocks = vec![Block::Paragraph(format!(
        "Rank {} of {} candidates at the solution ({} by singular values), {} at the nominal \
         device.",
        judged.solution.rank,
        judged.solution.candidates,
        judged.solution.singular_rank,
        judged.at_nominal.rank,
    ))];
    if result.not_identified.is_empty() {
        let all = "Every candidate was identified.".to_owned();
        blocks.push(Block::Paragraph(all));
        return Ok(blocks);
    }
    let columns = "parameter | status | why";
    let refused = result.not_identified.iter();
    let rows = refused.map(|it| vec![(&it.name).into(), it.status.into(), (&it.reason).into()]);
    let table = Table::with_heads("Kept at the nominal value", columns).with_rows(rows)?;
    let table = table.with_note(
        "invisible: without effect on any measurement; dependent: its effect is a combination of \
         others'; weak: fixed no better than it is plausibly large; held: the samples support a form without it.",
    );
    blocks.push(table.into());
    if !result.named_rows.is_empty() {
        blocks.push(Block::Paragraph(result.named_rows.clone()));
    }
    Ok(blocks)
}

/// Pairs of parameters that the data tell apart badly.
pub(super) fn correlations(result: &Identified) -> Result<Block, Error> {
    if result.correlations_above_0_95.is_empty() {
        let none = "No two identified parameters are correlated above 0.95.".to_owned();
        return Ok(Block::Paragraph(none));
    }
    let columns = "parameter | and | correlation";
    let pairs = result.correlations_above_0_95.iter();
    let rows = pairs.map(|(one, other, correlation)| {
        vec![one.into(), other.into(), Cell::number(*correlation, 4)]
    });
    let table = Table::with_heads("Correlations above 0.95", columns).with_rows(rows)?;
    Ok(table.into())
}
