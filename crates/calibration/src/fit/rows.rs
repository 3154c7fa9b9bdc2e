//! Some rows of a recording for what need not see all of them.

/// At most so many rows, spread evenly.
pub(crate) fn spread_rows(rows: usize, most: usize) -> Vec<usize> {
    let count = rows.min(most);
    (0..count).map(|index| index * rows / count).collect()
}
