//! The readings that a robust loss distrusts, row by row.

use haptical_report::{Block, Cell, Section, Table};

use crate::error::Error;
use crate::identify::result::Identified;
use crate::units::Shown;

/// Rows that stand open; the others are folded.
const SHOWN: usize = 20;
/// Rows that the page has; identified.json has all.
const MOST: usize = 2000;

/// The section, of a result that has outliers.
pub(super) fn section(result: &Identified) -> Result<Section, Error> {
    let count = result.outliers.len();
    let words = format!(
        "{count} readings lie farther from the identified model than normal noise explains: one recording of a \
         thousand without wild readings has any. The {} loss was used, by which they count little or nothing. Look \
         whether a sensor failed at these lines of the log. The residual is model minus measurement, the farthest \
         first; deviations are those of the channel's good readings.",
        result.loss.used
    );
    let (open, folded) = (count.min(SHOWN), count.min(MOST));
    let mut blocks = vec![
        Block::Paragraph(words),
        Block::Table(table("Outliers", result, 0, open)?),
    ];
    if folded > open {
        let left_out = match count - folded {
            0 => String::new(),
            more => format!("; {more} more are in identified.json"),
        };
        blocks.push(Block::Folded {
            summary: format!("{} further outliers{left_out}", folded - open),
            blocks: vec![Block::Table(table("", result, open, folded)?)],
        });
    }
    Ok(Section::new("Outliers", blocks))
}

fn table(title: &str, result: &Identified, from: usize, to: usize) -> Result<Table, Error> {
    let columns = "line of the log | channel | residual | deviations";
    let mut table = Table::with_heads(title, columns);
    for outlier in &result.outliers[from..to] {
        let channel = outlier.channel.name();
        let mut reports = result.channels_fit.iter().chain(&result.channels);
        let unit = reports.find(|report| report.channel == channel);
        let shown = Shown::fine(unit.map_or("", |report| report.unit.as_str()));
        table.push(vec![
            Cell::number(outlier.line as f64, 0),
            channel.into(),
            shown.text(outlier.residual).into(),
            Cell::number(outlier.deviations, 1),
        ])?;
    }
    Ok(table)
}
