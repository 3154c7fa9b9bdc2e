//! Checks the comparison, the committed files, and that every workload runs.

use std::collections::{BTreeMap, BTreeSet};

use super::committed::{find, record};
use super::compare::{Comparison, Verdict};
use super::count::collected;
use super::environment::{Environment, compiler};
use super::output::Results;
use super::workloads::all;
use super::{chosen, folder};

fn here() -> Environment {
    Environment {
        release: "1.95.0".to_owned(),
        rustc: "rustc 1.95.0 (59807616e 2026-04-14)".to_owned(),
        target: "x86_64-unknown-linux-gnu".to_owned(),
        lanes: "AVX2 and FMA".to_owned(),
        valgrind: "valgrind-3.19.0".to_owned(),
    }
}

#[test]
fn five_percent_either_way_is_the_same_and_six_is_not() {
    for (counted, verdict) in [
        (940, Verdict::Fewer),
        (949, Verdict::Fewer),
        (950, Verdict::Same),
        (1000, Verdict::Same),
        (1050, Verdict::Same),
        (1051, Verdict::More),
        (1060, Verdict::More),
    ] {
        assert_eq!(
            Verdict::from_counts(counted, Some(1000)),
            verdict,
            "{counted}"
        );
    }
    // of the committed number, not of the new one: 1000 is 5 % below neither 1053 nor 1055
    assert_eq!(Verdict::from_counts(1000, Some(1053)), Verdict::Fewer);
    assert_eq!(Verdict::from_counts(1000, None), Verdict::NotCommitted);
    let huge = u64::MAX;
    assert_eq!(
        Verdict::from_counts(huge, Some(huge / 100 * 96)),
        Verdict::Same
    );
    assert_eq!(
        Verdict::from_counts(huge, Some(huge / 100 * 94)),
        Verdict::More
    );
}

#[test]
fn what_is_not_as_committed_is_named_with_its_numbers() {
    let committed: BTreeMap<String, u64> = [
        ("near", 1000),
        ("slow", 1000),
        ("fast", 1000),
        ("gone", 1000),
        ("unasked", 7),
    ]
    .into_iter()
    .map(|(name, count)| (name.to_owned(), count))
    .collect();
    let counts = [("near", 1050), ("slow", 1060), ("fast", 940), ("new", 5)];
    let known = ["near", "slow", "fast", "new", "unasked"];
    let failures = Comparison::new(&counts, &committed, &known).failures();
    let said: Vec<bool> = [
        ("slow", "+6.0 % of the committed 1000"),
        ("fast", "-6.0 % of the committed 1000"),
        ("new", "none committed"),
        ("gone", "no such workload"),
    ]
    .iter()
    .zip(&failures)
    .map(|((name, what), said)| said.starts_with(&format!("{name}: ")) && said.contains(what))
    .collect();
    assert_eq!(said, [true; 4], "{failures:#?}");
    assert_eq!(failures.len(), 4, "{failures:#?}");
    let good = Comparison::new(&counts[..1], &committed, &[&known[..], &["gone"]].concat());
    assert!(good.failures().is_empty());
}

#[test]
fn recorded_counts_are_found_again_in_the_same_environment_alone() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let known = ["a", "b"];
    let why = |environment: &Environment| match find(folder, environment).unwrap() {
        Ok(_) => String::new(),
        Err(why) => why,
    };
    assert!(why(&here()).contains("1.95.0") && why(&here()).contains("none is"));
    let counts = [("a", 10), ("b", 20)];
    let path = record(folder, &here(), &counts, &known, false).unwrap();
    assert!(path.ends_with("1.95.0.toml"));
    assert_eq!(why(&here()), "");

    let newer = Environment {
        release: "1.96.0".to_owned(),
        rustc: "rustc 1.96.0".to_owned(),
        ..here()
    };
    assert!(why(&newer).contains("rustc 1.96.0") && why(&newer).contains("committed: 1.95.0"));
    let without_lanes = Environment {
        lanes: "SSE2".to_owned(),
        ..here()
    };
    assert!(why(&without_lanes).contains("`SSE2`"));
    let other_build = Environment {
        rustc: "rustc 1.95.0 (1234 2026-05-01)".to_owned(),
        ..here()
    };
    assert!(why(&other_build).starts_with("compiler"));
    let other_valgrind = Environment {
        valgrind: "valgrind-3.25.0".to_owned(),
        ..here()
    };
    assert_eq!(why(&other_valgrind), "");

    // a part leaves the others' counts, of known workloads, and mixes no environments
    record(folder, &here(), &[("b", 30)], &["b"], true).unwrap();
    let Ok(committed) = find(folder, &here()).unwrap() else {
        panic!("nothing found");
    };
    assert_eq!(
        committed.instructions,
        BTreeMap::from([("b".to_owned(), 30)])
    );
    let refused = record(folder, &without_lanes, &[("a", 1)], &known, true);
    assert!(refused.unwrap_err().to_string().contains("without --only"));

    std::fs::write(&path, "rustc = 1\n").unwrap();
    let error = format!("{:#}", find(folder, &here()).unwrap_err());
    assert!(error.contains("1.95.0.toml"), "{error}");
    record(folder, &here(), &[("a", 0)], &known, false).unwrap();
    let error = find(folder, &here()).unwrap_err().to_string();
    assert!(error.contains("`a` is 0"), "{error}");
}

#[test]
fn committed_files_are_of_the_workloads_that_there_are() {
    let known: BTreeSet<String> = all().map(|workload| workload.name.to_owned()).collect();
    assert_eq!(known.len(), all().count(), "a name twice");
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let file: super::committed::Committed = toml::from_str(&text).unwrap();
        let committed: BTreeSet<String> = file.instructions.keys().cloned().collect();
        assert_eq!(committed, known, "{}", path.display());
    }
}

#[test]
fn every_workload_runs() {
    for workload in all() {
        let outcome = workload.prepare().and_then(|mut job| job());
        assert!(outcome.is_ok(), "{}: {outcome:?}", workload.name);
        assert!(workload.units > 0, "{}", workload.name);
    }
}

#[test]
fn an_unknown_workload_is_refused_with_the_known_ones() {
    let error = chosen(&["joint-fits".to_owned()]).unwrap_err().to_string();
    assert!(
        error.contains("`joint-fits`") && error.contains("joint-fit,"),
        "{error}"
    );
    let one = chosen(&["csv-rows".to_owned()]).unwrap();
    assert_eq!((one.len(), one[0].name), (1, "csv-rows"));
}

#[test]
fn json_says_whether_anything_was_compared() {
    let workloads = chosen(&["csv-rows".to_owned()]).unwrap();
    let counts = [("csv-rows", 12_000)];
    let committed = BTreeMap::from([("csv-rows".to_owned(), 10_000)]);
    let comparison = Comparison::new(&counts, &committed, &["csv-rows"]);
    let (environment, why) = (here(), "another compiler".to_owned());
    let results = Results {
        environment: &environment,
        workloads: &workloads,
        counts: &counts,
        comparison: Ok(&comparison),
    };
    let value = results.to_json();
    assert_eq!(value["compared"], true);
    let row = &value["workloads"][0];
    assert_eq!(
        (&row["ratio"], &row["verdict"]),
        (&1.2.into(), &"more".into())
    );
    assert_eq!(row["instructions_per_unit"], 2.0);
    let value = Results {
        comparison: Err(&why),
        ..results
    }
    .to_json();
    assert_eq!(
        (&value["compared"], &value["why_not"]),
        (&false.into(), &why.into())
    );
    assert!(value["workloads"][0]["verdict"].is_null());
}

#[test]
fn words_of_valgrind_and_rustc_are_understood() {
    let said = "==12== Callgrind\n==12== Events    : Ir\n==12== Collected : 3123456\n==12== \n";
    assert_eq!(collected(said), Some(3_123_456));
    assert_eq!(collected("==12== Events : Ir"), None);
    let verbose = "rustc 1.95.0 (59807616e 2026-04-14)\nbinary: rustc\ncommit-hash: 5\nhost: x86_64-unknown-linux-gnu\n\
                   release: 1.95.0\nLLVM version: 22.1\n";
    let (rustc, release, target) = compiler(verbose).unwrap();
    assert_eq!(rustc, here().rustc);
    assert_eq!((release, target), (here().release, here().target));
    assert!(compiler("rustc 1.95.0").is_none());
}
