//! The catalogue of docs/diagnosis.md against the specs.

use std::path::PathBuf;

use haptical_effects::device::{is_law, laws};
use haptical_effects::{Hook, Spec, markdown, names, spec, specs};

/// Set to rewrite the table.
const REWRITE: &str = "REWRITE_DOCS";

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs/diagnosis.md")
}

#[test]
fn the_table_of_the_docs_is_the_printed_one() {
    let text = std::fs::read_to_string(path()).unwrap();
    let printed = markdown();
    let head = printed.lines().next().unwrap();
    let start = text.find(head).unwrap();
    let rows = text[start..]
        .lines()
        .take_while(|line| line.starts_with('|'));
    let end = start + rows.map(|line| line.len() + 1).sum::<usize>();
    if std::env::var_os(REWRITE).is_some() {
        let text = format!("{}{printed}{}", &text[..start], &text[end..]);
        std::fs::write(path(), text).unwrap();
        return;
    }
    for (line, printed) in text[start..end].lines().zip(printed.lines()) {
        assert_eq!(line, printed);
    }
    assert!(
        text[start..end] == printed,
        "docs/diagnosis.md, Catalogue, is out of date: {REWRITE}=1 cargo test -p haptical-effects --test it catalogue"
    );
}

#[test]
fn specs_are_complete() {
    for spec in specs() {
        let name = spec.name;
        for text in [spec.meaning, spec.inspect, spec.adds] {
            assert!(!text.is_empty() && !text.ends_with('.'), "{name}: {text}");
        }
        for other in spec.look_alikes {
            assert!(names().contains(other), "{name}: {other}");
        }
        for parameter in spec.parameters {
            let [low, high] = parameter.plausible;
            assert!(0.0 <= low && low < high, "{name}: {}", parameter.name);
        }
        assert!(spec.amplitudes > 0 && spec.log_prior <= 0.0, "{name}");
    }
}

#[test]
fn effects_of_one_name_mean_the_same_and_differ_in_place_or_number() {
    let all: Vec<_> = specs().collect();
    for (index, one) in all.iter().enumerate() {
        for other in all[index + 1..]
            .iter()
            .filter(|other| other.name == one.name)
        {
            assert_eq!((one.meaning, one.inspect), (other.meaning, other.inspect));
            let differ = one.hook != other.hook || one.parameters != other.parameters;
            assert!(differ, "{}", one.name);
        }
    }
}

#[test]
fn no_answer_to_a_command_is_a_law_of_a_device() {
    let of_commands = specs().filter(|spec| spec.hook == Hook::Command);
    let of_commands: Vec<&Spec> = of_commands.collect();
    assert_eq!(of_commands.len(), 8);
    for spec in of_commands {
        assert!(is_law(spec).is_err(), "{}", spec.name);
    }
    // a play of a drive is one, whatever else has its name
    assert!(laws().any(|spec| spec.name == "backlash"));
}

#[test]
fn a_name_with_its_joint_finds_the_effect() {
    assert_eq!(spec("backlash@3"), spec("backlash"));
    assert!(spec("backlash").is_some() && spec("no-such-effect").is_none());
}
