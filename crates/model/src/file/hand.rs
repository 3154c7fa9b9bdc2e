//! Reads how rows hang on each other, and the hands at which chains end.

use crate::file::reader::Section;
use crate::file::row::read_origin;
use crate::{DeviceFileError, Hand};

type Result<T> = std::result::Result<T, DeviceFileError>;

/// Where the handle of a device with one chain is, and a hand's.
const HANDLE: [&str; 2] = ["handle_xyz_m", "handle_wxyz"];

/// The row that each of rows 1 to n hangs on; empty where it is the row before throughout.
pub(crate) fn read_parents(sections: &[Section<'_, '_>]) -> Result<Vec<usize>> {
    let mut parents = Vec::with_capacity(sections.len());
    for (row, section) in sections.iter().enumerate() {
        let stated = section.number("parent")?;
        let before = row.saturating_sub(1);
        let parent = stated.map_or(Some(before), |number| {
            (0..row).find(|earlier| *earlier as f64 == number)
        });
        let Some(parent) = parent else {
            let allowed = match row {
                0 => "row 0 is the base, which hangs on nothing: remove the key".to_owned(),
                _ => format!(
                    "a row hangs on an earlier one, from 0 to {before}, so that none hangs on itself: list \
                     the rows from the base to the hands"
                ),
            };
            let found = stated.unwrap_or_default().to_string();
            return Err(section.refuse("parent", found, &allowed));
        };
        if row > 0 {
            parents.push(parent);
        }
    }
    if parents.iter().copied().eq(0..parents.len()) {
        parents.clear();
    }
    Ok(parents)
}

/// The tables `[[hand]]`; a device whose rows branch needs them.
pub(crate) fn read_hands(
    root: &Section<'_, '_>,
    head: Option<&Section<'_, '_>>,
    rows: &[Section<'_, '_>],
    parents: &[usize],
    warnings: &mut Vec<String>,
) -> Result<Vec<Hand>> {
    let mut seen = Vec::new();
    let hands = root.each("hand", warnings, |section| {
        let hand = read_hand(section, rows.len(), &seen)?;
        seen.push(hand.name.clone());
        Ok(hand)
    })?;
    if hands.is_empty() {
        let branch = rows.iter().find(|row| row.has("parent"));
        if let (Some(row), false) = (branch, parents.is_empty()) {
            let advice = "rows branch here: say where each chain ends, with [[hand]] name = \"left\", row = 8";
            return Err(root.missing_for(row, "hand", advice));
        }
    } else if let Some(head) = head
        && let Some(key) = HANDLE.into_iter().find(|key| head.has(key))
    {
        let allowed = "a device with [[hand]] has one for each: write it there";
        return Err(head.refuse(key, "the place of one handle", allowed));
    }
    Ok(hands)
}

fn read_hand(section: &Section<'_, '_>, rows: usize, others: &[String]) -> Result<Hand> {
    let name = section.text("name")?;
    let name =
        name.ok_or_else(|| section.missing("name", "give it as the log's column `hand` has it"))?;
    if name.is_empty() || name.trim() != name {
        let allowed = "a word without blanks at its ends is expected";
        return Err(section.refuse("name", format!("\"{name}\""), allowed));
    }
    if others.iter().any(|other| other == name) {
        return Err(section.refuse("name", format!("\"{name}\" again"), "each hand has its own"));
    }
    let number = section.required(
        "row",
        "give the [[link]] behind which it is, row 0 being the base",
    )?;
    let row = (1..rows).find(|row| *row as f64 == number).ok_or_else(|| {
        let allowed = format!("a row from 1 to {} is expected", rows.saturating_sub(1));
        section.refuse("row", number.to_string(), &allowed)
    })?;
    Ok(Hand {
        name: name.to_owned(),
        row,
        handle: read_origin(section, HANDLE[0], HANDLE[1])?,
    })
}
