//! The catalogue as a list of names, and as a table of docs/diagnosis.md.

use std::fmt::Write as _;

use crate::{Parameter, Role, Spec, names, specs};

/// A name of the catalogue with all that it means, wherever its effect is looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Name: `backlash`.
    pub name: &'static str,
    /// Where it enters.
    pub enters: Vec<&'static str>,
    /// What a log must have: all of one of these lists.
    pub needs_any: Vec<Vec<&'static str>>,
    /// Numbers that an answer may give; what is plausible of them is plausible somewhere.
    pub parameters: Vec<Parameter>,
    /// What happens, a clause without a full stop.
    pub meaning: &'static str,
    /// What to look at on the device.
    pub inspect: &'static str,
}

/// The catalogue, one entry a name.
///
/// ```
/// let entries = haptical_effects::entries();
/// let backlash = entries.iter().find(|entry| entry.name == "backlash").unwrap();
/// assert_eq!(backlash.enters, ["transmission", "answer to the command"]);
/// assert_eq!(backlash.parameters.len(), 1);
/// ```
pub fn entries() -> Vec<Entry> {
    names().into_iter().filter_map(entry).collect()
}

fn entry(name: &'static str) -> Option<Entry> {
    let mut specs = specs().filter(|spec| spec.name == name);
    let mut entry = of_spec(specs.next()?);
    for spec in specs {
        let other = of_spec(spec);
        let is_new = |needs: &Vec<&str>| !entry.needs_any.contains(needs);
        let needs: Vec<Vec<&str>> = other.needs_any.into_iter().filter(is_new).collect();
        entry.needs_any.extend(needs);
        if !entry.enters.contains(&other.enters[0]) {
            entry.enters.extend(other.enters);
        }
        for parameter in other.parameters {
            match entry
                .parameters
                .iter_mut()
                .find(|known| known.name == parameter.name)
            {
                Some(known) => {
                    let [low, high] = parameter.plausible;
                    known.plausible = [known.plausible[0].min(low), known.plausible[1].max(high)];
                }
                None => entry.parameters.push(parameter),
            }
        }
    }
    Some(entry)
}

fn of_spec(spec: &'static Spec) -> Entry {
    Entry {
        name: spec.name,
        enters: vec![spec.hook.words()],
        needs_any: vec![spec.needs.iter().map(|need| need.words()).collect()],
        parameters: spec.parameters.to_vec(),
        meaning: spec.meaning,
        inspect: spec.inspect,
    }
}

/// The rows of the table, with its head.
pub fn markdown() -> String {
    let mut text = String::from(
        "| effect | id | enters | adds | needs | bound |\n| --- | --- | --- | --- | --- | --- |\n",
    );
    for spec in specs() {
        let needs: Vec<&str> = spec.needs.iter().map(|need| need.words()).collect();
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} |",
            spec.name,
            spec.source,
            spec.hook.words(),
            spec.adds.replace('|', "\\|"),
            needs.join(", "),
            bounds(spec)
        );
    }
    text.replace("|  |", "| |")
}

/// `width_rad 0.1`, the sizes alone.
fn bounds(spec: &Spec) -> String {
    let sizes = spec.parameters.iter().filter(|size| size.is_size());
    let bounds: Vec<String> = sizes.map(bound).collect();
    bounds.join(", ")
}

fn bound(parameter: &Parameter) -> String {
    let [low, high] = parameter.plausible;
    let name = parameter.name;
    match parameter.role {
        Role::Inverse => format!("{name} {low}"),
        _ if high == f64::MAX => name.to_owned(),
        _ if parameter.times_ratio => format!("{name} {high} R"),
        _ if !(0.01..=1e3).contains(&high) => format!("{name} {high:e}"),
        _ => format!("{name} {high}"),
    }
}
