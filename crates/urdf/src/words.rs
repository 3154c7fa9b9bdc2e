//! Lists of names in sentences.

/// Most names in a warning or an error.
const MOST_NAMES: usize = 8;

/// Names in quotes, the first few of them.
pub(crate) fn listed<'n>(names: impl Iterator<Item = &'n str>) -> String {
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    joined(&names)
}

/// Words with commas between, the first few of them.
pub(crate) fn joined(words: &[String]) -> String {
    let shown = words[..words.len().min(MOST_NAMES)].join(", ");
    match words.len().checked_sub(MOST_NAMES) {
        Some(more @ 1..) => format!("{shown} and {more} more"),
        _ => shown,
    }
}
