//! A step builds without std and without an allocator, and its machine code calls nothing that panics.

use std::path::{Path, PathBuf};
use std::process::Command;

/// What the machine code of `outside/control-loop` needs from elsewhere; nothing, and a message, where
/// that cannot be seen.
fn needed_symbols(features: &[&str]) -> Option<Vec<String>> {
    let manifest =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../outside/control-loop/Cargo.toml");
    if !manifest.exists() {
        println!("skipped: outside/control-loop is not part of this package");
        return None;
    }
    if Command::new("nm").arg("--version").output().is_err() {
        println!("skipped: there is no nm to list symbols with");
        return None;
    }
    let target: PathBuf = Path::new(env!("CARGO_TARGET_TMPDIR")).join("control-loop");
    let built = Command::new(env!("CARGO"))
        .args([
            "build",
            "--release",
            "--locked",
            "--quiet",
            "--manifest-path",
        ])
        .arg(&manifest)
        .arg("--target-dir")
        .arg(&target)
        .args(["--features", &features.join(",")])
        // an incremental build keeps what nothing calls
        .env("CARGO_INCREMENTAL", "0")
        // as another project compiles it
        .env_remove("RUSTC_WORKSPACE_WRAPPER")
        .output()
        .unwrap();
    assert!(
        built.status.success(),
        "{}",
        String::from_utf8_lossy(&built.stderr)
    );
    let listed = Command::new("nm")
        .args(["--undefined-only", "--demangle"])
        .arg(target.join("release/libcontrol_loop.rlib"))
        .output()
        .unwrap();
    let text = String::from_utf8(listed.stdout).unwrap();
    Some(
        text.lines()
            .filter_map(|line| line.trim().strip_prefix("U ").map(str::to_owned))
            .collect(),
    )
}

/// Both builds in one test: they share a folder.
#[test]
fn a_step_needs_nothing_that_panics_or_allocates() {
    let Some(with_panic) = needed_symbols(&["panic-path"]) else {
        return;
    };
    let is_bad = |symbol: &String| {
        ["panic", "unwrap", "alloc", "begin_unwind", "fail"]
            .iter()
            .any(|part| symbol.contains(part))
    };
    assert!(
        with_panic.iter().any(is_bad),
        "the check sees no panic: {with_panic:?}"
    );
    let needed = needed_symbols(&[]).unwrap();
    assert!(!needed.iter().any(is_bad), "{needed:?}");
}
