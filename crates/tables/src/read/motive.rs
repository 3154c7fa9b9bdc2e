//! What an export of OptiTrack's Motive says of its columns: six or seven lines of names, units in the first of them.

use super::grid::Row;
use crate::rotation::is_order;

/// What an export says of itself.
#[derive(Default)]
pub(super) struct Facts {
    pub(super) units: Option<Vec<String>>,
    pub(super) note: Option<String>,
    /// Order of the Euler angles; none of quaternions.
    pub(super) euler: Option<String>,
}

/// What the first line says; nothing of other formats. `names` is the row of the letters of axes.
pub(super) fn facts(above: &[Row], names: Option<usize>, width: usize) -> Facts {
    let format = above.first().filter(|row| {
        let cell = row.cells.first();
        cell.is_some_and(|cell| cell == "Format Version")
    });
    let Some(first) = format else {
        return Facts::default();
    };
    let said = |key: &str| {
        let place = first.cells.iter().position(|cell| cell == key)?;
        first.cells.get(place + 1).map(String::as_str)
    };
    let length = said("Length Units").unwrap_or_default();
    let rotation = said("Rotation Type").unwrap_or_default().to_lowercase();
    let is_euler =
        is_order(&rotation) && ['x', 'y', 'z'].iter().all(|axis| rotation.contains(*axis));
    let euler = is_euler.then_some(rotation);
    let kinds = names.and_then(|row| above.get(row.checked_sub(1)?));
    let kind = |column: usize| {
        kinds
            .and_then(|row| row.cells.get(column))
            .map(String::as_str)
    };
    let units = (0..width).map(|column| match kind(column) {
        Some("Position" | "Mean Marker Error") => length.to_owned(),
        Some("Rotation") if euler.is_some() => "deg".to_owned(),
        _ => String::new(),
    });
    let note = "an export of OptiTrack's Motive; names in several lines are joined by points";
    Facts {
        units: Some(units.collect()),
        note: Some(note.to_owned()),
        euler,
    }
}

/// Whether a line of an export has kinds or numbers of bodies, which no name needs.
pub(super) fn is_left_out(row: &Row) -> bool {
    const LABELS: [&str; 4] = ["ID", "Parent", "Type", "Format Version"];
    const KINDS: [&str; 4] = ["Rigid Body", "Rigid Body Marker", "Marker", "Bone"];
    let mut labels = row.cells.iter().take(2);
    let mut filled = row.cells.iter().filter(|cell| !cell.is_empty());
    labels.any(|cell| LABELS.contains(&cell.as_str()))
        || filled.all(|cell| KINDS.contains(&cell.as_str()))
        || is_hexadecimal(row)
}

/// Whether a cell says what its line has.
pub(super) fn is_label(cell: &str, column: usize) -> bool {
    column < 2 && cell == "Name"
}

/// Whether all filled cells are long numbers to the base 16.
fn is_hexadecimal(row: &Row) -> bool {
    let mut filled = row.cells.iter().filter(|cell| !cell.is_empty());
    filled.all(|cell| cell.len() >= 8 && cell.bytes().all(|byte| byte.is_ascii_hexdigit()))
}
