//! Ctrl-C and a full disk while files are written: nothing half-written, nothing left over.
#![cfg(unix)]

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::{Sandbox, haptical, names_in, text};

/// Far above what is needed, on a machine that does other work too.
const LONGEST: Duration = Duration::from_secs(30);

/// Waits for something that must happen.
fn wait_for(what: &str, mut happened: impl FnMut() -> bool) {
    let start = Instant::now();
    while !happened() {
        assert!(start.elapsed() < LONGEST, "still not: {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn press_ctrl_c(child: &Child) {
    let sent = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(sent.unwrap().success());
}

/// A command that runs on; it is ended if the test fails.
struct Running(Option<Child>);

impl Running {
    fn child(&mut self) -> &mut Child {
        self.0.as_mut().unwrap()
    }

    fn output(mut self) -> std::process::Output {
        self.0.take().unwrap().wait_with_output().unwrap()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if let Some(child) = &mut self.0 {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

fn start(sandbox: &Sandbox, arguments: &[&str]) -> Running {
    let child = Command::new(env!("CARGO_BIN_EXE_haptical"))
        .current_dir(sandbox.folder.path())
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    Running(Some(child))
}

#[test]
fn ctrl_c_while_a_log_is_written_leaves_what_was_there() {
    for (out, before) in [("new/log.csv", None), ("log.csv.gz", Some("an older log"))] {
        let sandbox = Sandbox::new();
        if let Some(content) = before {
            sandbox.write(out, content);
        }
        let folder = sandbox.path(out).parent().unwrap().to_owned();
        let is_temporary = |name: &String| name.starts_with(".haptical-log-");
        let long = [
            "simulate",
            "--device",
            "device.toml",
            "--seconds",
            "1000",
            "--rate-hz",
            "10000",
            "--out",
            out,
            "--force",
        ];
        let mut child = start(&sandbox, &long);
        wait_for("a temporary file", || {
            names_in(&folder).iter().any(is_temporary)
        });
        press_ctrl_c(child.child());
        let output = child.output();
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(130), "{said}");
        assert!(
            said.contains("error: interrupted before the end; nothing was written"),
            "{said}"
        );
        assert!(!names_in(&folder).iter().any(is_temporary));
        match before {
            Some(content) => {
                assert_eq!(std::fs::read_to_string(sandbox.path(out)).unwrap(), content);
            }
            None => assert!(!folder.exists()),
        }
    }
}

#[test]
fn ctrl_c_while_a_log_is_read_ends_at_once() {
    let sandbox = Sandbox::new();
    let arguments = [
        "identify",
        "--device",
        "device.toml",
        "--log",
        "/dev/stdin",
        "--out",
        "result",
    ];
    let mut child = start(&sandbox, &arguments);
    let pipe = child.child().stdin.take();
    std::thread::sleep(Duration::from_millis(300));
    assert!(
        child.child().try_wait().unwrap().is_none(),
        "it waits for the log"
    );
    press_ctrl_c(child.child());
    wait_for("its end", || child.child().try_wait().unwrap().is_some());
    assert_eq!(child.child().wait().unwrap().code(), Some(130));
    drop(pipe);
    assert_eq!(names_in(&sandbox.path(".")), ["device.toml", "log.csv"]);
}

/// A command whose files may not grow beyond 10 KiB, as on a full disk.
fn on_a_full_disk(folder: &Path, arguments: &[&str]) -> std::process::Output {
    Command::new("sh")
        .current_dir(folder)
        .args(["-c", "trap '' XFSZ; ulimit -f 20; exec \"$@\"", "sh"])
        .arg(env!("CARGO_BIN_EXE_haptical"))
        .args(arguments)
        .output()
        .unwrap()
}

#[test]
fn a_full_disk_is_said_and_leaves_nothing() {
    let sandbox = Sandbox::new();
    let cases: [&[&str]; 6] = [
        &[
            "simulate",
            "--device",
            "device.toml",
            "--seconds",
            "10",
            "--out",
            "new/log.csv",
        ],
        &[
            "simulate",
            "--device",
            "device.toml",
            "--seconds",
            "10",
            "--out",
            "new/log.csv.gz",
        ],
        &[
            "identify",
            "--device",
            "device.toml",
            "--log",
            "log.csv",
            "--out",
            "new/result",
        ],
        &[
            "play",
            "--device",
            "device.toml",
            "--log",
            "log.csv",
            "--out",
            "new/pages/page.html",
        ],
        &[
            "export",
            "--device",
            "device.toml",
            "--format",
            "c-header",
            "--out",
            "new/model.h",
        ],
        &["init", "new"],
    ];
    for arguments in cases {
        let output = on_a_full_disk(&sandbox.path("."), arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains("File too large"), "{arguments:?}: {said}");
        assert!(
            said.contains("where: new") && said.contains("room"),
            "{arguments:?}: {said}"
        );
        assert_eq!(
            names_in(&sandbox.path(".")),
            ["device.toml", "log.csv"],
            "{arguments:?}"
        );
    }
}

#[test]
fn a_full_disk_leaves_the_older_files() {
    let sandbox = Sandbox::new();
    std::fs::create_dir(sandbox.path("result")).unwrap();
    for name in [
        "identified.toml",
        "identified.json",
        "identify.html",
        "report.html",
    ] {
        sandbox.write(&format!("result/{name}"), "older");
    }
    let arguments = [
        "identify",
        "--device",
        "device.toml",
        "--log",
        "log.csv",
        "--out",
        "result",
        "--force",
    ];
    let output = on_a_full_disk(&sandbox.path("."), &arguments);
    assert_eq!(output.status.code(), Some(2));
    let said = text(&output.stderr);
    assert!(said.contains("File too large"), "{said}");
    let names = names_in(&sandbox.path("result"));
    assert_eq!(
        names,
        [
            "identified.json",
            "identified.toml",
            "identify.html",
            "report.html"
        ]
    );
    for name in names {
        let content = std::fs::read_to_string(sandbox.path("result").join(name)).unwrap();
        assert_eq!(content, "older");
    }
}

#[test]
fn output_that_cannot_be_printed_is_said() {
    let Ok(full) = std::fs::OpenOptions::new().write(true).open("/dev/full") else {
        println!("skipped: no /dev/full");
        return;
    };
    let sandbox = Sandbox::new();
    let output = Command::new(env!("CARGO_BIN_EXE_haptical"))
        .arg("check")
        .arg(sandbox.path("device.toml"))
        .stdout(full)
        .stderr(Stdio::piped())
        .output()
        .unwrap();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(
        said.contains("where: standard output") && said.contains("No space left"),
        "{said}"
    );
}

/// A file renamed onto a pipe or a device would take its place.
#[test]
fn what_is_no_file_is_not_replaced() {
    use std::os::unix::fs::FileTypeExt as _;
    let sandbox = Sandbox::new();
    let pipe = sandbox.path("pipe");
    assert!(
        Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    let cases: [&[&str]; 3] = [
        &[
            "simulate",
            "--device",
            "device.toml",
            "--seconds",
            "10",
            "--out",
            "pipe",
        ],
        &[
            "play",
            "--device",
            "device.toml",
            "--log",
            "log.csv",
            "--out",
            "pipe",
        ],
        &[
            "export",
            "--device",
            "device.toml",
            "--format",
            "json",
            "--out",
            "pipe",
        ],
    ];
    for arguments in cases {
        let output = haptical()
            .current_dir(sandbox.folder.path())
            .args(arguments)
            .output()
            .unwrap();
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains("no regular file"), "{arguments:?}: {said}");
        assert!(std::fs::metadata(&pipe).unwrap().file_type().is_fifo());
    }
}

#[test]
fn an_input_is_not_overwritten_by_any_name() {
    let sandbox = Sandbox::new();
    std::fs::create_dir(sandbox.path("result")).unwrap();
    let device = sandbox.device_text();
    sandbox.write("result/identified.toml", &device);
    std::os::unix::fs::symlink("result/identified.toml", sandbox.path("link.toml")).unwrap();
    for given in [
        "result/identified.toml",
        "./result/../result/identified.toml",
        "link.toml",
    ] {
        let output = haptical()
            .current_dir(sandbox.folder.path())
            .args([
                "identify", "--device", given, "--log", "log.csv", "--out", "result",
            ])
            .output()
            .unwrap();
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("is an input of this run"), "{said}");
        assert_eq!(names_in(&sandbox.path("result")), ["identified.toml"]);
    }
}
