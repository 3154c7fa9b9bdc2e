//! Inputs that are made to fill the memory: answered in seconds, within a limit on memory.
#![cfg(target_os = "linux")]

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::{Sandbox, names_in, text};

/// Address space of the command \[KiB\]: a tenth of what the inputs would need.
const MEMORY_KIB: u64 = 1 << 20;
/// Far above what is needed, on a machine that does other work too.
const LONGEST: Duration = Duration::from_secs(30);
const MEBIBYTE: usize = 1 << 20;

/// The command below a limit on memory, in a folder.
fn limited(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new("sh");
    let script = format!("ulimit -v {MEMORY_KIB}; exec \"$@\"");
    command
        .current_dir(folder)
        .args(["-c", &script, "sh", env!("CARGO_BIN_EXE_haptical")]);
    command.args(arguments);
    command
}

fn refused(output: &Output, wanted: &[&str], since: Instant) {
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    for wanted in wanted {
        assert!(said.contains(wanted), "`{wanted}` is not in: {said}");
    }
    assert!(since.elapsed() < LONGEST, "{:?}", since.elapsed());
}

/// A gzip file of this start and then of 10 GiB of one byte.
fn bomb(start: &str, byte: u8) -> Vec<u8> {
    let member = |content: &[u8]| {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(content).unwrap();
        encoder.finish().unwrap()
    };
    let mut bytes = member(start.as_bytes());
    let piece = member(&vec![byte; 8 * MEBIBYTE]);
    for _ in 0..10 * 1024 / 8 {
        bytes.extend_from_slice(&piece);
    }
    bytes
}

const IDENTIFY: [&str; 6] = [
    "identify",
    "--device",
    "device.toml",
    "--out",
    "result",
    "--log",
];

#[test]
fn a_small_file_that_decompresses_to_ten_gibibytes() {
    let sandbox = Sandbox::new();
    let log = sandbox.log_text();
    let cases: [(u8, &[&str]); 4] = [
        (0, &["log.csv.gz:402", "is zero (NUL)"]),
        (
            b'1',
            &["log.csv.gz:402", "longer than 1 MiB", "one row per line"],
        ),
        (
            b'\n',
            &["log.csv.gz", "no row ends within 2 MiB", "blank lines"],
        ),
        (b'"', &["log.csv.gz:402", "1 MiB"]),
    ];
    for (byte, wanted) in cases {
        let bytes = bomb(&log, byte);
        assert!(bytes.len() < 100 * MEBIBYTE, "{}", bytes.len());
        sandbox.write("log.csv.gz", bytes);
        let start = Instant::now();
        let output = limited(
            &sandbox.path("."),
            &[&IDENTIFY[..], &["log.csv.gz"]].concat(),
        )
        .output()
        .unwrap();
        refused(&output, wanted, start);
        assert!(!sandbox.path("result").exists());
    }
}

#[test]
fn a_line_of_one_gibibyte() {
    let sandbox = Sandbox::new();
    let start = Instant::now();
    let mut child = limited(
        &sandbox.path("."),
        &[&IDENTIFY[..], &["/dev/stdin"]].concat(),
    )
    .stdin(Stdio::piped())
    .stderr(Stdio::piped())
    .spawn()
    .unwrap();
    let mut pipe = child.stdin.take().unwrap();
    let piece = vec![b'7'; MEBIBYTE];
    let written = (0..1024)
        .take_while(|_| pipe.write_all(&piece).is_ok())
        .count();
    drop(pipe);
    let output = child.wait_with_output().unwrap();
    refused(&output, &["/dev/stdin:1", "longer than 1 MiB"], start);
    assert!(written < 4, "{written} MiB were read");
    assert_eq!(names_in(&sandbox.path("result")), Vec::<String>::new());
}

#[test]
fn a_device_file_without_end() {
    let sandbox = Sandbox::new();
    let start = Instant::now();
    let cases: [&[&str]; 3] = [
        &["check", "/dev/zero"],
        &[
            "diagnose",
            "--device",
            "device.toml",
            "--log",
            "log.csv",
            "--model",
            "/dev/zero",
            "--out",
            "result",
        ],
        &[
            "simulate",
            "--device",
            "device.toml",
            "--effects",
            "/dev/zero",
            "--out",
            "new.csv",
        ],
    ];
    for arguments in cases {
        let output = limited(&sandbox.path("."), arguments).output().unwrap();
        refused(&output, &["/dev/zero", "larger than 1 MiB"], start);
    }
    assert_eq!(names_in(&sandbox.path(".")), ["device.toml", "log.csv"]);
}

/// Device files of the largest size that cost the most to read.
#[test]
fn a_device_file_full_of_tables() {
    let sandbox = Sandbox::new();
    let repeat = |text: &str| text.repeat(MEBIBYTE / text.len() - 20);
    let joints = repeat("[[joint]]\n");
    let chain = format!(
        "{}{}",
        "[[link]]\na_m=1\nalpha_rad=0\nd_m=1\n".repeat(15_001),
        "[[joint]]\n".repeat(15_000)
    );
    let keys: String = (0..60_000).map(|key| format!("key{key} = 1\n")).collect();
    let numbers = format!(
        "[[joint]]\n[joint.transmission_error]\nrange_rad=[-1,1]\nchebyshev = [{}0]\n",
        repeat("1e-9,")
    );
    for content in [joints, chain, keys, numbers] {
        assert!(content.len() <= MEBIBYTE, "{}", content.len());
        sandbox.write("large.toml", &content);
        let start = Instant::now();
        let output = limited(&sandbox.path("."), &["check", "large.toml", "log.csv"])
            .output()
            .unwrap();
        refused(&output, &["large.toml"], start);
        assert!(output.stderr.len() < 2000, "{}", output.stderr.len());
    }
}
