//! `haptical diagnose --list`: the effects that can be named, as a table or as JSON.

use haptical::servo::{SPECS, Spec as OfServo};
use haptical_effects::{Parameter, Spec, Unit, specs};
use haptical_report::Table;
use serde::Serialize;

use crate::failure::Failure;
use crate::terminal;

/// An effect, as `--json` lists it.
#[derive(Debug, Serialize)]
struct Entry {
    name: &'static str,
    enters: &'static str,
    needs: Vec<&'static str>,
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
    if json {
        let all = specs().map(entry).chain(SPECS.iter().map(of_servo));
        return terminal::write_json(&all.collect::<Vec<_>>());
    }
    terminal::write_output(format!("{}\n", table()?.to_terminal()).as_bytes())
}

fn entry(spec: &'static Spec) -> Entry {
    let number = |parameter: &Parameter| Number {
        name: parameter.name,
        unit: parameter.unit.symbol(),
        plausible: parameter
            .plausible
            .map(|end| (end < f64::MAX).then_some(end)),
    };
    Entry {
        name: spec.name,
        enters: spec.hook.words(),
        needs: spec.needs.iter().map(|need| need.words()).collect(),
        parameters: spec.parameters.iter().map(number).collect(),
        meaning: spec.meaning,
        inspect: spec.inspect,
    }
}

/// Where a servo's laws enter.
const ANSWER: &str = "answer to the command";

fn of_servo(spec: &'static OfServo) -> Entry {
    let number = |name: &&'static str| Number {
        name,
        unit: Unit::split(name).1.symbol(),
        plausible: [None, None],
    };
    Entry {
        name: spec.name,
        enters: ANSWER,
        needs: vec!["time", "command"],
        parameters: spec.parameters.iter().map(number).collect(),
        meaning: spec.meaning,
        inspect: spec.inspect,
    }
}

fn table() -> Result<Table, Failure> {
    let rows = specs().map(|spec| {
        let parameters: Vec<String> = spec.parameters.iter().map(with_unit).collect();
        let (enters, parameters) = (spec.hook.words(), parameters.join("\n"));
        vec![
            spec.name.into(),
            enters.into(),
            parameters.into(),
            spec.meaning.into(),
        ]
    });
    let rows = rows.chain(SPECS.iter().map(|spec| {
        vec![
            spec.name.into(),
            ANSWER.into(),
            spec.parameters.join("\n").into(),
            spec.meaning.into(),
        ]
    }));
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
    use super::*;

    #[test]
    fn every_effect_has_a_row_and_parameters_have_units() {
        let text = table().unwrap().to_terminal();
        for name in haptical_effects::names() {
            assert!(text.contains(&format!(" {name} ")), "{name}");
        }
        assert!(text.contains("stiffness_nm_per_rad [N m/rad]"), "{text}");
        assert!(text.contains("the cable slipped on the drum at one moment"));
    }

    #[test]
    fn an_open_end_of_a_range_is_null() {
        let slip = specs().find(|spec| spec.name == "capstan-slip").unwrap();
        let entry = entry(slip);
        assert_eq!(entry.parameters[0].plausible, [Some(0.0), Some(0.1)]);
        assert_eq!(entry.parameters[1].plausible, [Some(0.0), None]);
    }
}
