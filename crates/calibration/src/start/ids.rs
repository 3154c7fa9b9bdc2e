//! Ids of what rows are about.

use std::collections::BTreeSet;

/// The ids of a column in the order in which they come, without empty ones.
pub(crate) fn listed(ids: &[String]) -> Vec<String> {
    let mut seen = BTreeSet::new();
    let new = ids
        .iter()
        .filter(|id| !id.is_empty() && seen.insert(id.as_str()));
    new.cloned().collect()
}
