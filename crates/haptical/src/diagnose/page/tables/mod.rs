//! Tables of a diagnosis: the channels, what their residuals depend on, what is odd, the noise.

mod causes;
mod unseen;

use haptical_diagnosis::{Diagnosis, Verdict};
use haptical_report::{Block, Cell, Table};

use crate::error::Error;
use crate::units::Shown;

pub(super) use self::causes::{candidates, causes, parameters};
pub(super) use self::unseen::{detectable, invisible, untestable};

/// Before, after, floor and what was closed, channel by channel; without a gap, what there is.
pub(super) fn channels(diagnosis: &Diagnosis) -> Result<Block, Error> {
    let title = "Root mean square of the residual, channel by channel";
    if diagnosis.verdict == Verdict::NoGap {
        let mut table = Table::with_heads(title, "channel | unit | residual | noise floor");
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
    let columns = "channel | unit | before | after | noise floor | share of the gap [%] | gap closed [%] | 95 % \
             interval [%]";
    let mut table = Table::with_heads(title, columns);
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
pub(super) fn dependence(diagnosis: &Diagnosis) -> Result<Option<Block>, Error> {
    let found = diagnosis.place.iter().flat_map(|place| &place.dependence);
    let columns = "column | it depends on | p | p, all together | share [%]";
    let mut table = Table::with_heads("What the residuals of the touches depend on", columns);
    for found in found {
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
    Ok((!table.rows.is_empty()).then_some(Block::Table(table)))
}

/// Odd values of the model.
pub(super) fn plausibility(diagnosis: &Diagnosis) -> Result<Block, Error> {
    let title = "Values of the model that a sound device hardly has: an effect may hide in them";
    let mut table = Table::with_heads(title, "parameter | what is odd");
    for hint in &diagnosis.plausibility {
        table.push(vec![
            hint.parameter.as_str().into(),
            hint.why.as_str().into(),
        ])?;
    }
    Ok(Block::Table(table))
}

/// Noise of each channel.
pub(super) fn noise(diagnosis: &Diagnosis) -> Result<Block, Error> {
    let columns = "channel | of the stated noise | correlation of successive rows | left out as outliers [%] | \
             estimated from";
    let mut table = Table::with_heads("", columns);
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
fn only(block: Block) -> Table {
    match block {
        Block::Table(table) => table,
        other => panic!("{other:?} is not a table"),
    }
}
