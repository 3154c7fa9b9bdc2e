//! What a program wants to know of an effect is said in the effect's own file: few places elsewhere ask for an effect by its name.

use std::collections::{BTreeMap, BTreeSet};

use crate::{read, root, rust_files};

/// Most places in all.
const MOST: usize = 40;

/// Folders with a file for each effect.
const OF_EFFECTS: [&str; 4] = [
    "effects/src",
    "motion/src/effect",
    "servo/src/effect",
    "simulator/src/effect",
];

/// Names that are a column of a log and an attribute of an MJCF as well.
const WORDS: [&str; 2] = ["armature", "contact"];

/// Places elsewhere, a line a file: how many, and why no field of `Spec` serves.
const ELSEWHERE: &str = "\
diagnosis/src/force/changes/mod.rs 1: what a request leaves out has a name alone
diagnosis/src/judge/earlier_model/groups.rs 1: a number of the base model goes by a name of the catalogue
diagnosis/src/judge/earlier_model/mod.rs 1: a number of the base model goes by a name of the catalogue
diagnosis/src/judge/earlier_model/zeros.rs 1: the one effect whose columns are those of a number of the base model
diagnosis/src/moving/mod.rs 2: a fault of the log, which no catalogue of a device has
diagnosis/src/torques_alone.rs 1: the one load that comes and goes between runs
haptical/src/diagnose/next.rs 2: sentences with the joint's number within
model/src/device/drive.rs 1: the model knows no effects, and has the numbers of a joint's friction
model/src/device/effect.rs 1: the model knows no effects, and has the numbers of a joint's friction
model/src/file/effect.rs 4: the model knows no effects, and reads a compliance as a number and the sides of a play as words
motion/src/between/answer.rs 1: a rival that this crate has no law for
motion/src/between/terms.rs 4: the terms between motor and link, named once where their laws are
motion/src/examine.rs 2: rows and encoders that are set right before anything else is looked for
motion/src/examined.rs 3: what a finding is, asked for here alone
motion/src/findings.rs 1: the fault of a log, named where it is found
motion/src/select/mod.rs 1: the one factor on all torques, which stands alone
motion/src/select/rivals.rs 1: the one effect that an inertia may pass for
motion/src/tracking/mod.rs 2: the delay of commands, named where its law is
servo/src/next.rs 6: the next experiment of each law of a servo
simulator/src/forward/joint.rs 1: the simulator has laws of its own, and knows no effects
simulator/src/forward/mod.rs 2: the simulator has laws of its own, and knows no effects
";

#[test]
fn few_places_ask_for_an_effect_by_its_name() {
    let found = places();
    let listed: BTreeMap<String, usize> = (ELSEWHERE.lines())
        .map(|line| {
            let (place, why) = line.split_once(": ").unwrap();
            let (file, count) = place.split_once(' ').unwrap();
            assert!(!why.is_empty(), "{line}");
            (file.to_owned(), count.parse().unwrap())
        })
        .collect();
    assert_eq!(
        found, listed,
        "files that ask for effects by their names (left) and the list (right): ask `Spec` for its hook and form instead"
    );
    let sum: usize = found.values().sum();
    assert!(sum <= MOST, "{sum} places ask for an effect by its name");
}

#[test]
fn every_way_of_asking_counts() {
    let names = Names::read();
    for (code, wanted) in [
        ("match name { \"backlash\" => 1, \"payload\" => 2 }", 2),
        ("own.name == BACKLASH.name", 1),
        ("effects::force::PAYLOAD.name != own.name", 1),
        ("[JOINT_OFFSET.name, NAME].contains(&name)", 2),
        ("Some(friction::NAME | lag::NAME) => true,", 2),
        ("    // \"backlash\"", 0),
        ("Term::Spring => JOINT_SPRING,", 0),
        ("effect: PAYLOAD.name,", 0),
        ("\"a backlash of\"", 0),
        ("\"contact\"", 0),
        ("#[cfg(test)]\nmod tests {\n    \"backlash\"", 0),
    ] {
        assert_eq!(names.asked(code), wanted, "{code}");
    }
}

/// Files that ask for an effect by its name, and how often.
fn places() -> BTreeMap<String, usize> {
    let names = Names::read();
    let sources = sources().into_iter().filter(|(path, _)| {
        let mut folders = OF_EFFECTS.iter();
        !folders.any(|folder| path.starts_with(folder))
    });
    let counts = sources.map(|(path, text)| (path, names.asked(&text)));
    counts.filter(|(_, count)| *count > 0).collect()
}

/// Source of the libraries without tests, by its path from `crates`.
fn sources() -> Vec<(String, String)> {
    let crates = root().join("crates");
    let files = rust_files(&crates).into_iter().filter_map(|file| {
        let path = file.strip_prefix(&crates).unwrap().display().to_string();
        let is_source = path.contains("/src/") && !path.contains("tests");
        is_source.then(|| (path, std::fs::read_to_string(&file).unwrap()))
    });
    files.collect()
}

/// Names of effects, and the constants that hold one.
struct Names {
    names: BTreeSet<String>,
    constants: BTreeSet<String>,
}

impl Names {
    /// The names are the first column of the catalogue, which a test of `effects` compares with the registry.
    fn read() -> Self {
        let page = read("docs/diagnosis.md");
        let rows = page
            .lines()
            .skip_while(|line| !line.starts_with("| effect | id |"));
        let rows = rows.skip(2).take_while(|line| line.starts_with("| "));
        let names = rows.filter_map(|row| row.split(" | ").next()?.strip_prefix("| "));
        let names: BTreeSet<String> = names.map(str::to_owned).collect();
        assert!(names.len() > 70, "the catalogue has lost its effects");
        let constant = |line: &str| {
            let (head, value) = line.split_once(" = ")?;
            let (_, name) = head.strip_suffix(": &str")?.rsplit_once("const ")?;
            let is_name = value.ends_with(".name;") || names.contains(value.split('"').nth(1)?);
            is_name.then(|| name.to_owned())
        };
        let sources = sources();
        let lines = sources.iter().flat_map(|(_, text)| text.lines());
        Self {
            constants: lines.filter_map(constant).collect(),
            names,
        }
    }

    /// How often a text asks for an effect by its name: literals, and comparisons with constants; tests at its end excepted.
    fn asked(&self, text: &str) -> usize {
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        let lines = code
            .lines()
            .filter(|line| !line.trim_start().starts_with("//"));
        let of_line = |line: &str| {
            let is_name = |word: &&str| self.names.contains(*word) && !WORDS.contains(word);
            let literals = line.split('"').skip(1).step_by(2).filter(is_name).count();
            literals + self.compared(line)
        };
        lines.map(of_line).sum()
    }

    /// Constants that a line compares with, or matches.
    fn compared(&self, line: &str) -> usize {
        let is_of_word = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
        let mut count = 0;
        let mut start = 0;
        while let Some(first) = line[start..].find(is_of_word) {
            let at = start + first;
            let rest = &line[at..];
            let (word, after) = rest.split_at(rest.find(|c| !is_of_word(c)).unwrap_or(rest.len()));
            start = at + word.len();
            let of_spec = after
                .strip_prefix(".name")
                .filter(|after| !after.starts_with(is_of_word));
            let is_constant = word.len() > 2 && !word.contains(|c: char| c.is_ascii_lowercase());
            if !is_constant || (of_spec.is_none() && !self.constants.contains(word)) {
                continue;
            }
            let before = line[..at].trim_end_matches(|c| is_of_word(c) || c == ':');
            let before = before.trim_end_matches(['&', '*', '(', '[', ' ']);
            let after = of_spec.unwrap_or(after).trim_start();
            let is_pattern = of_spec.is_none() && after.contains("=>");
            let is_compared = ["==", "!="]
                .iter()
                .any(|sign| before.ends_with(sign) || after.starts_with(sign));
            count += usize::from(is_compared || is_pattern || after.contains(".contains("));
        }
        count
    }
}
