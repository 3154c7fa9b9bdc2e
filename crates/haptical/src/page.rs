//! Shared by the pages of all results: sizes of figures, tables of facts.

use haptical_report::{Cell, Table};

use crate::error::Error;

/// Width of a figure, and height of one with two axes \[px\].
pub(crate) const FIGURE_PX: (u32, u32) = (860, 340);
/// Most points of a series; of longer ones every k-th is drawn.
pub(crate) const MOST_POINTS: usize = 800;

/// At most [`MOST_POINTS`] points, evenly chosen.
pub(crate) fn thinned(points: impl Iterator<Item = (f64, f64)> + Clone) -> Vec<(f64, f64)> {
    let step = points.clone().count().div_ceil(MOST_POINTS).max(1);
    points.step_by(step).collect()
}

/// A table of facts: what, and its value.
pub(crate) fn facts(
    title: &str,
    facts: impl IntoIterator<Item = (impl Into<Cell>, String)>,
) -> Result<Table, Error> {
    let rows = facts.into_iter();
    let rows = rows.map(|(what, value)| vec![what.into(), value.into()]);
    Ok(Table::with_heads(title, "what | value").with_rows(rows)?)
}
