//! Atomic writing: content, replacement, no leftovers, errors.

use haptical_report::{ReportError, write_atomically};

fn entries(folder: &std::path::Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn writes_replaces_and_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deep/er/report.html");
    write_atomically(&path, b"a longer first version").unwrap();
    write_atomically(&path, b"second").unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"second");
    assert_eq!(entries(path.parent().unwrap()), ["report.html"]);
}

#[cfg(unix)]
#[test]
fn the_file_is_as_readable_as_any_other_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
    write_atomically(&ours, b"x").unwrap();
    std::fs::write(&plain, b"x").unwrap();
    let mode = |path| std::fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&ours), mode(&plain));
}

#[test]
fn a_failure_names_the_path_and_keeps_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let occupied = folder.path().join("folder");
    std::fs::create_dir(&occupied).unwrap();
    std::fs::write(occupied.join("kept"), b"x").unwrap();
    let error = write_atomically(&occupied, b"text").unwrap_err();
    assert!(
        matches!(&error, ReportError::Write { path, .. } if *path == occupied),
        "{error}"
    );
    assert_eq!(
        entries(folder.path()),
        ["folder"],
        "no temporary file is left"
    );
    let file = folder.path().join("folder/kept");
    assert!(write_atomically(&file.join("below"), b"text").is_err());
    assert_eq!(std::fs::read(&file).unwrap(), b"x");
}
