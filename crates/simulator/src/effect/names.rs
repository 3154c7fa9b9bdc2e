//! The names that `effects.toml` may contain.

use crate::effect::{KNOWN, Known};

/// Names of the effects that can be simulated.
pub fn simulated_effects() -> Vec<&'static str> {
    KNOWN.iter().map(|known| known.name).collect()
}

/// Keys of an effect in `effects.toml`, but for `name`; none for an effect that cannot be simulated.
pub fn simulated_keys(name: &str) -> Option<&'static [&'static str]> {
    known(name).map(|known| known.keys)
}

pub(crate) fn known(name: &str) -> Option<&'static Known> {
    KNOWN.iter().find(|known| known.name == name)
}

/// Likeness (Jaro & Winkler's) from which a name is offered in place of a wrong one.
const LIKENESS: f64 = 0.8;

/// The one of `names` that is most like `wrong`, as a question, or nothing.
pub(crate) fn did_you_mean(wrong: &str, names: &[&str]) -> String {
    let likeness = |name: &str| strsim::jaro_winkler(wrong, name);
    let nearest = names
        .iter()
        .copied()
        .max_by(|a, b| likeness(a).total_cmp(&likeness(b)))
        .filter(|name| likeness(name) > LIKENESS);
    nearest.map_or_else(String::new, |name| format!("did you mean `{name}`? "))
}
