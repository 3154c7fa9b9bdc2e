//! The catalogue as a table of docs/diagnosis.md.

use std::fmt::Write as _;

use crate::{Parameter, Role, Spec, specs};

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
