//! Numbers that decide are in `thresholds` of their crate, whose files make the version of a result.

use std::collections::BTreeSet;

use crate::{root, rust_files};

/// Crates that judge.
const JUDGING: [&str; 4] = ["diagnosis", "judge", "motion", "servo"];

/// Constants with a number that decide nothing, a line each: file, name, why.
const ELSEWHERE: &str = "\
diagnosis/src/answer/p_spline.rs DIFFERENCE: coefficients of a second difference
diagnosis/src/answer/shrink/reduction.rs BOOTSTRAP_SEED: a seed, printed in each result
diagnosis/src/answer/tables.rs DRAWN: rows of a picture
diagnosis/src/force/posture.rs PER_LINK: size of an array
diagnosis/src/moving/between.rs BY_LOAD: a word of the device file
diagnosis/src/moving/warnings.rs LISTED_ROWS: rows that a message lists
diagnosis/src/noise/outliers.rs NORMAL_MEDIAN: a constant of mathematics
diagnosis/src/version.rs PRIME: factor of a hash
diagnosis/src/version.rs START: start of a hash
motion/src/arm.rs PARAMETERS: size of an array
motion/src/effect/contact.rs OF_POINT: size of an array
motion/src/effect/torque_saturation.rs CLIPPED: place in a list
motion/src/identify/bias.rs NOISE_SEED: a seed, printed in each result
motion/src/identify/numbers.rs ORDER: places in a list
motion/src/identify/shape.rs BELOW: places in a matrix
servo/src/change/sums.rs MOST_COLUMNS: size of an array
servo/src/episodes/gain.rs AFTER: place of a column
servo/src/episodes/gain.rs POSITION_AFTER: place of a column
servo/src/episodes/moments.rs COLUMNS: size of an array
servo/src/episodes/moments.rs FIRST_TAP: place of a column
servo/src/episodes/scale.rs NORMAL_MEDIAN: a constant of mathematics
servo/src/fit/search.rs AXES: size of an array
";

#[test]
fn numbers_that_decide_are_thresholds() {
    let mut found = BTreeSet::new();
    for name in JUDGING {
        let folder = root().join("crates").join(name).join("src");
        for file in rust_files(&folder) {
            let path = file.strip_prefix(&folder).unwrap().display().to_string();
            if path.starts_with("thresholds") || path.contains("tests") {
                continue;
            }
            let text = std::fs::read_to_string(&file).unwrap();
            for constant in numbers(&text) {
                found.insert((format!("{name}/src/{path}"), constant));
            }
        }
    }
    let allowed: BTreeSet<(String, String)> = (ELSEWHERE.lines())
        .map(|line| {
            let (constant, why) = line.split_once(": ").unwrap();
            let (file, name) = constant.split_once(' ').unwrap();
            assert!(!why.is_empty(), "{line}");
            (file.to_owned(), name.to_owned())
        })
        .collect();
    let outside: Vec<_> = found.difference(&allowed).collect();
    let gone: Vec<_> = allowed.difference(&found).collect();
    assert!(
        outside.is_empty(),
        "these belong to thresholds: {outside:?}"
    );
    assert!(gone.is_empty(), "listed, and not there: {gone:?}");
}

/// Names of the constants of a file whose type is of numbers and whose value has a literal number; tests at its end excepted.
fn numbers(text: &str) -> Vec<String> {
    let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
    let code: Vec<&str> = (code.lines())
        .filter(|line| !line.trim_start().starts_with("//"))
        .collect();
    let code = code.join("\n");
    let mut names = Vec::new();
    for (at, _) in code
        .match_indices("const ")
        .chain(code.match_indices("static "))
    {
        let rest = code[at..].split_once(' ').unwrap().1;
        let Some((head, rest)) = rest.split_once(" =") else {
            continue;
        };
        let Some((name, kind)) = head.split_once(": ") else {
            continue;
        };
        let value = rest.split(";\n").next().unwrap();
        let is_constant = !head.contains('\n')
            && name
                .chars()
                .all(|c| c.is_ascii_uppercase() || c == '_' || c.is_ascii_digit());
        if is_constant && words(kind).any(is_kind) && words(value).any(is_number) {
            names.push(name.to_owned());
        }
    }
    names
}

/// What lies between signs.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_')
        .filter(|word| !word.is_empty())
}

/// Whether this is a type of numbers.
fn is_kind(word: &str) -> bool {
    let sized = word.strip_prefix(['f', 'i', 'u']);
    sized.is_some_and(|size| size == "size" || size.parse::<u8>().is_ok())
}

fn is_number(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_digit())
}

#[test]
fn a_number_is_found_whatever_its_type() {
    let text = "\
/// A comment: const NO: f64 = 1.0;
const SHARE: f64 = 0.5;
    pub(super) const STEPS: [f64; 2] = [
        1e-3, 0.1,
    ];
const UNIT: std::ops::Range<f64> = 0.5..10.0;
const LONG: [f64; 2] =
    [1e-3, 0.1];
const NAMES: [&str; 2] = [\"a\", \"b\"];
const OTHER: f64 = thresholds::fit::X2;
pub const fn one() -> f64 { 1.0 }
    const OF_TRAIT: f64;
fn sized<const N: usize>() {
    let count = 2;
}
static SEED: u64 = 1;
#[cfg(test)]
mod tests {
    const ROWS: usize = 12;
}
";
    assert_eq!(numbers(text), ["SHARE", "STEPS", "UNIT", "LONG", "SEED"]);
}

/// A file that is not read does not count in the version.
#[test]
fn every_file_of_thresholds_counts_in_the_version() {
    let mut seen = 0;
    for name in std::fs::read_dir(root().join("crates")).unwrap() {
        let folder = name.unwrap().path().join("src");
        let files = rust_files(&folder);
        let is_of = |path: &std::path::Path| {
            let path = path.strip_prefix(&folder).unwrap();
            path.starts_with("thresholds") || path.ends_with("thresholds.rs")
        };
        let texts: Vec<String> = (files.iter())
            .map(|file| std::fs::read_to_string(file).unwrap())
            .collect();
        for file in files.iter().filter(|file| is_of(file)) {
            let path = file.file_name().unwrap().to_string_lossy();
            let is_read = |text: &String| {
                (text.split("include_str!(\"").skip(1)).any(|rest| {
                    let read = rest.split('"').next().unwrap();
                    read.rsplit('/').next() == Some(&*path)
                })
            };
            assert!(
                path == "mod.rs" || texts.iter().any(is_read),
                "{}",
                file.display()
            );
            seen += 1;
        }
    }
    assert!(seen > 15, "only {seen} files");
}
