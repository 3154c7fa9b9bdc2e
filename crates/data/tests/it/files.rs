//! Files that cannot be opened or written, and files that are replaced.

use std::io::{self, Read, Write};

use haptical_data::{DataError, LogFile, read_log, read_log_from, write_log, write_log_to};
use haptical_model::Recording;

use crate::support::{clean, single};

const TEXT: &str = "t_s,theta1_rad\n0,0.1\n1,0.2\n";

struct Broken;

impl Read for Broken {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        Err(io::Error::other("unplugged"))
    }
}

impl Write for Broken {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        Err(io::Error::other("disk full"))
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_missing_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("missing.csv");
    let error = read_log(&path, &single()).unwrap_err();
    assert_eq!(
        (error.kind(), error.line(), error.column()),
        ("not-found", None, None)
    );
    assert!(error.to_string().starts_with(&path.display().to_string()));
}

#[test]
fn folders_and_broken_readers_are_unreadable() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(
        read_log(folder.path(), &single()).unwrap_err().kind(),
        "unreadable"
    );
    let error = read_log_from(Broken, "log.csv", &single()).unwrap_err();
    assert_eq!(
        (error.kind(), error.line(), error.column()),
        ("unreadable", None, None)
    );
    assert!(error.to_string().contains("unplugged"));
}

#[test]
fn the_name_chooses_gzip_for_writing_and_the_bytes_for_reading() {
    let folder = tempfile::tempdir().unwrap();
    let log = clean(TEXT, &single());
    let (plain, packed) = (
        folder.path().join("log.csv"),
        folder.path().join("log.csv.gz"),
    );
    write_log(&plain, &log.recording, &single()).unwrap();
    write_log(&packed, &log.recording, &single()).unwrap();
    assert_eq!(std::fs::read_to_string(&plain).unwrap(), TEXT);
    assert_eq!(std::fs::read(&packed).unwrap()[..2], [0x1f, 0x8b]);
    assert_eq!(read_log(&plain, &single()).unwrap(), log);
    assert_eq!(read_log(&packed, &single()).unwrap(), log);
    let misnamed = folder.path().join("misnamed.csv");
    std::fs::rename(&packed, &misnamed).unwrap();
    assert_eq!(read_log(&misnamed, &single()).unwrap(), log);
}

#[test]
fn a_log_written_in_pieces_has_the_bytes_of_one_written_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let whole = clean(TEXT, &single()).recording;
    for name in ["log.csv", "log.csv.gz"] {
        let (at_once, pieces) = (
            folder.path().join(name),
            folder.path().join(format!("p{name}")),
        );
        write_log(&at_once, &whole, &single()).unwrap();
        let mut log = LogFile::create(&pieces, &whole.select(&[]), &single()).unwrap();
        for row in 0..whole.len() {
            log.write_rows(&whole.select(&[row])).unwrap();
        }
        assert!(!pieces.exists());
        log.finish().unwrap();
        let bytes = |path| std::fs::read(path).unwrap();
        assert_eq!(bytes(&pieces), bytes(&at_once));
    }
}

#[test]
fn a_log_that_is_given_up_leaves_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    std::fs::write(&path, "old").unwrap();
    let whole = clean(TEXT, &single()).recording;
    let mut log = LogFile::create(&path, &whole, &single()).unwrap();
    log.write_rows(&whole).unwrap();
    drop(log);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_failed_write_leaves_the_old_file_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let log = clean(TEXT, &single());
    for name in ["log.csv", "log.csv.gz"] {
        let path = folder.path().join(name);
        write_log(&path, &log.recording, &single()).unwrap();
        let before = std::fs::read(&path).unwrap();
        let mut faulty = log.recording.clone();
        faulty.joint[0][1] = f64::NAN;
        let error = write_log(&path, &faulty, &single()).unwrap_err();
        assert_eq!((error.kind(), error.line()), ("invalid-recording", Some(3)));
        assert_eq!(std::fs::read(&path).unwrap(), before);
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn a_missing_folder_and_a_full_disk_are_unwritable() {
    let folder = tempfile::tempdir().unwrap();
    let log = clean(TEXT, &single()).recording;
    let error = write_log(&folder.path().join("no/log.csv"), &log, &single()).unwrap_err();
    assert_eq!(
        (error.kind(), error.line(), error.column()),
        ("unwritable", None, None)
    );
    let error = write_log_to(Broken, &log, &single()).unwrap_err();
    assert_eq!(error.kind(), "unwritable");
    assert!(error.to_string().contains("disk full"));
    // A recording without rows is a header only, still to be flushed.
    let empty = Recording {
        joint: vec![Vec::new()],
        ..Recording::default()
    };
    assert_eq!(
        write_log_to(Broken, &empty, &single()).unwrap_err().kind(),
        "unwritable"
    );
}

#[cfg(unix)]
#[test]
fn a_written_log_has_the_permissions_of_any_new_file() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    let (log, other) = (folder.path().join("log.csv"), folder.path().join("other"));
    write_log(&log, &clean(TEXT, &single()).recording, &single()).unwrap();
    std::fs::write(&other, "").unwrap();
    let mode = |path| std::fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&log), mode(&other));
}

#[test]
fn errors_can_cross_threads() {
    fn crosses<T: Send + Sync + 'static>() {}
    crosses::<DataError>();
}
