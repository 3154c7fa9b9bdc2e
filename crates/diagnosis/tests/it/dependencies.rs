//! A diagnosis that has seen the simulator's effects cannot be judged on them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn crates() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Crates of ours in one table of a manifest; none where the workspace was not shipped.
fn ours(folder: &str, table: &str) -> Vec<String> {
    let Ok(text) = std::fs::read_to_string(crates().join(folder).join("Cargo.toml")) else {
        return Vec::new();
    };
    let manifest: toml::Table = toml::from_str(&text).unwrap();
    let names = manifest.get(table).and_then(toml::Value::as_table);
    let names = names.into_iter().flatten();
    names
        .filter_map(|(name, _)| name.strip_prefix("haptical-").map(str::to_owned))
        .collect()
}

#[test]
fn neither_simulator_nor_blind_trials_are_reached() {
    let mut waiting = ours("diagnosis", "dependencies");
    assert!(
        waiting.contains(&"model".to_owned()) || waiting.is_empty(),
        "{waiting:?}"
    );
    waiting.extend(ours("diagnosis", "dev-dependencies"));
    waiting.extend(ours("diagnosis", "build-dependencies"));
    let mut reached = BTreeSet::new();
    while let Some(name) = waiting.pop() {
        if reached.insert(name.clone()) {
            waiting.extend(ours(&name, "dependencies"));
        }
    }
    for forbidden in ["simulator", "blind"] {
        assert!(!reached.contains(forbidden), "{reached:?}");
    }
}
