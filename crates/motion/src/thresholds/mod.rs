//! Every number that decides a verdict, a selection, a fit's end or an interval, by topic.
//!
//! Each says its unit (a pure number where none is given) and what it means; a line before a group names the module that uses it.

pub(crate) mod between;
pub(crate) mod effect;
pub(crate) mod examine;
pub(crate) mod fit;
pub(crate) mod identify;
pub(crate) mod plausible;
pub(crate) mod scale;
pub(crate) mod select;
pub(crate) mod signal;
pub(crate) mod tracking;

/// Texts of the files with the numbers that decide: `haptical-diagnosis` makes a version of them.
pub const TEXTS: [&str; 10] = [
    include_str!("between.rs"),
    include_str!("effect.rs"),
    include_str!("examine.rs"),
    include_str!("fit.rs"),
    include_str!("identify.rs"),
    include_str!("plausible.rs"),
    include_str!("scale.rs"),
    include_str!("select.rs"),
    include_str!("signal.rs"),
    include_str!("tracking.rs"),
];
