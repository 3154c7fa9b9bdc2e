//! What was repaired, for a terminal.

use std::fmt;

use haptical_report::Table;

use super::{Repair, RepairChange, RepairCheck};
use crate::diagnose::words::named_at;
use crate::units::Shown;

impl fmt::Display for Repair {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(log) = self.log {
            let rows = self.changes.iter().map(|change| {
                let cells = [
                    change.column.clone(),
                    lines(change),
                    what(change),
                    named_at(&change.cause, change.joint),
                ];
                cells.map(Into::into).to_vec()
            });
            let table = Table::with_heads("", "column | lines | what | cause").with_rows(rows);
            let table = table.map_err(|_| fmt::Error)?.to_terminal();
            writeln!(formatter, "\nrepaired {log}:\n{table}")?;
        }
        for kept in &self.kept {
            match self.log {
                Some(_) => writeln!(formatter, "kept     {kept}")?,
                None => writeln!(formatter, "repaired nothing, and no log is written: {kept}")?,
            }
        }
        if let Some(RepairCheck { answer, .. }) = &self.check {
            writeln!(formatter, "again    the repaired log diagnosed: {answer}")?;
        }
        Ok(())
    }
}

/// `12 to 6001`.
fn lines(change: &RepairChange) -> String {
    match change.lines {
        [first, last] if first == last => first.to_string(),
        [first, last] => format!("{first} to {last}"),
    }
}

/// `2.356 mrad added (60.0 counts)`.
fn what(change: &RepairChange) -> String {
    let by = |name: &str| change.by.get(name).copied();
    let cells = |count: usize| match count {
        1 => "1 cell".to_owned(),
        count => format!("{count} cells"),
    };
    let mut said = match change.what {
        "added" => {
            let sized = |unit| Some(Shown::fine(unit).text(by(&format!("added_{unit}"))?));
            let size = ["rad", "m"].into_iter().find_map(sized).unwrap_or_default();
            let counts = by("counts").map(|counts| format!(" ({counts:.1} counts)"));
            let counts = counts.unwrap_or_default();
            format!("{size}{counts} added to {}", cells(change.changed))
        }
        "resampled" => format!(
            "{:.3} ms earlier, {}",
            1e3 * by("delay_s").unwrap_or(0.0),
            cells(change.changed)
        ),
        "drift-removed" => {
            let numbers = change.by.iter();
            let numbers = numbers.map(|(name, value)| format!("{name} {value:.3e}"));
            let numbers = numbers.collect::<Vec<_>>().join(", ");
            format!("drift taken out of {}: {numbers}", cells(change.changed))
        }
        _ => String::new(),
    };
    if change.emptied > 0 {
        let separator = if said.is_empty() { "" } else { "; " };
        said.push_str(&format!("{separator}{} emptied", cells(change.emptied)));
    }
    said
}
