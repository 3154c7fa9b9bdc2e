//! `haptical diagnose --list`: the effects that can be named, as a table or as JSON.

use haptical_effects::{Entry, Parameter, entries};
use haptical_report::Table;
use serde::Serialize;

use crate::failure::Failure;
use crate::terminal;

/// An effect, as `--json` lists it.
#[derive(Debug, Serialize)]
struct Listed {
    name: &'static str,
    /// Where, in words.
    enters: String,
    /// What a log must have: all of one of these lists.
    needs_any: Vec<Vec<&'static str>>,
    /// Those that an answer may give.
    parameters: Vec<Number>,
    meaning: &'static str,
    inspect: &'static str,
}

/// A number of an effect; without limits where none is known.
#[derive(Debug, Serialize)]
struct Number {
    name: &'static str,
    unit: &'static str,
    plausible: [Option<f64>; 2],
}

/// Prints the catalogue.
pub(crate) fn print(json: bool) -> Result<(), Failure> {
    let all: Vec<Listed> = entries().into_iter().map(listed).collect();
    terminal::tell(json, &all, format!("{}\n", table()?.to_terminal()))
}

fn listed(entry: Entry) -> Listed {
    let known = |end| (end < f64::MAX).then_some(end);
    let number = |parameter: &Parameter| Number {
        name: parameter.name,
        unit: parameter.unit.symbol(),
        plausible: parameter.plausible.map(known),
    };
    Listed {
        name: entry.name,
        enters: entry.enters.join(", "),
        needs_any: entry.needs_any,
        parameters: entry.parameters.iter().map(number).collect(),
        meaning: entry.meaning,
        inspect: entry.inspect,
    }
}

fn table() -> Result<Table, Failure> {
    let rows = entries().into_iter().map(|entry| {
        let parameters: Vec<String> = entry.parameters.iter().map(with_unit).collect();
        vec![
            entry.name.into(),
            entry.enters.join(", ").into(),
            parameters.join("\n").into(),
            entry.meaning.into(),
        ]
    });
    Ok(Table::with_heads("", "effect | enters | parameters | meaning").with_rows(rows)?)
}

/// `width_rad [rad]`.
fn with_unit(parameter: &Parameter) -> String {
    match parameter.unit.symbol() {
        "" => parameter.name.to_owned(),
        symbol => format!("{} [{symbol}]", parameter.name),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use haptical_effects::{names, specs};

    use super::*;

    #[test]
    fn every_effect_has_a_row_and_parameters_have_units() {
        let text = table().unwrap().to_terminal();
        for name in names() {
            assert!(text.contains(&format!(" {name} ")), "{name}");
        }
        assert!(text.contains("stiffness_nm_per_rad [N m/rad]"), "{text}");
        assert!(text.contains("the cable slipped on the drum at one moment"));
    }

    #[test]
    fn an_open_end_of_a_range_is_null() {
        let all: Vec<Listed> = entries().into_iter().map(listed).collect();
        let entry = all.iter().find(|own| own.name == "capstan-slip").unwrap();
        assert_eq!(entry.parameters[0].plausible, [Some(0.0), Some(0.1)]);
        assert_eq!(entry.parameters[1].plausible, [Some(0.0), None]);
    }

    #[test]
    fn a_name_has_one_row_and_each_of_its_numbers_one_unit() {
        let entries = entries();
        let unique: BTreeSet<&str> = entries.iter().map(|entry| entry.name).collect();
        assert_eq!(unique.len(), entries.len());
        for entry in &entries {
            for own in &entry.parameters {
                let same = specs().filter(|spec| spec.name == entry.name);
                let mut same = same.flat_map(|spec| spec.parameters);
                let is_one = |other: &Parameter| other.name != own.name || other.unit == own.unit;
                assert!(same.all(is_one), "{}: {}", entry.name, own.name);
            }
        }
        // a limit of torque has no speed
        let saturation = entries.iter().find(|own| own.name == "torque-saturation");
        let numbers = saturation.unwrap().parameters.iter().map(|own| own.name);
        assert_eq!(numbers.collect::<Vec<_>>(), ["limit_nm"]);
    }

    #[test]
    fn every_name_of_a_servo_is_in_the_catalogue() {
        for name in haptical::servo::NAMES {
            assert!(haptical_effects::command::is_on_answer(name), "{name}");
        }
    }
}
