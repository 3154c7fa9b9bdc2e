//! The readings that a robust loss distrusts, row by row.

use haptical_calibration::Outlier;
use haptical_report::{Block, Cell, Table};

use crate::error::Error;
use crate::identify::result::Identified;
use crate::units::Shown;

/// Rows that are open; the others are folded.
const SHOWN: usize = 20;
/// Rows that the page has; identified.json has all.
const MOST: usize = 2000;

/// What there is to say of a result that has outliers.
pub(super) fn blocks(result: &Identified) -> Result<Vec<Block>, Error> {
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
        table("Outliers", &result.outliers[..open], result)?.into(),
    ];
    if folded > open {
        let left_out = match count - folded {
            0 => String::new(),
            more => format!("; {more} more are in identified.json"),
        };
        blocks.push(Block::Folded {
            summary: format!("{} further outliers{left_out}", folded - open),
            blocks: vec![table("", &result.outliers[open..folded], result)?.into()],
        });
    }
    Ok(blocks)
}

fn table(title: &str, outliers: &[Outlier], result: &Identified) -> Result<Table, Error> {
    let columns = "line of the log | channel | residual | deviations";
    let rows = outliers.iter().map(|outlier| {
        let channel = outlier.channel.name();
        let shown = Shown::fine(result.unit(&channel));
        vec![
            Cell::number(outlier.line as f64, 0),
            channel.into(),
            shown.text(outlier.residual).into(),
            Cell::number(outlier.deviations, 1),
        ]
    });
    Ok(Table::with_heads(title, columns).with_rows(rows)?)
}
