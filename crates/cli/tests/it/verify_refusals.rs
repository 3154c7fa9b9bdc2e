//! What `haptical verify` cannot tell: inputs that changed or are gone, results that are none.

use crate::{Sandbox, haptical, text};

/// Runs verify in the sandbox; it must refuse, with these texts in the three lines.
fn refused(sandbox: &Sandbox, words: &[&str], wanted: &[&str]) {
    let run = |further: &[&str]| {
        haptical()
            .current_dir(sandbox.folder.path())
            .arg("verify")
            .args(words)
            .args(further)
            .output()
            .unwrap()
    };
    let output = run(&[]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{words:?}: {said}");
    assert!(output.stdout.is_empty());
    assert_eq!(said.lines().count(), 3, "{said}");
    for wanted in wanted {
        assert!(
            said.contains(wanted),
            "{words:?}: `{wanted}` is not in: {said}"
        );
    }
    let json = run(&["--json"]);
    let object: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert!(!object["error"]["next"].as_str().unwrap().is_empty());
}

fn identified() -> Sandbox {
    let sandbox = Sandbox::new();
    assert!(sandbox.identify(&[]).status.success());
    sandbox
}

#[test]
fn a_changed_log_is_named_and_not_read() {
    let sandbox = identified();
    let log = sandbox.log_text();
    // One digit; and what could not be read as a log at all.
    for changed in [log.replacen("0.1", "0.2", 1), "no log".to_owned()] {
        assert_ne!(changed, log);
        sandbox.write("log.csv", &changed);
        refused(
            &sandbox,
            &["result"],
            &[
                "not the file that the result was made from as --log",
                "where: log.csv",
                "give the one that was called log.csv",
                "SHA-256",
            ],
        );
        refused(
            &sandbox,
            &["result", "--log", "log.csv"],
            &["as --log", "where: log.csv"],
        );
    }
}

#[test]
fn a_changed_device_is_named_even_by_a_comment() {
    let sandbox = identified();
    sandbox.write("device.toml", sandbox.device_text() + "# a comment\n");
    refused(
        &sandbox,
        &["result"],
        &["as --device", "where: device.toml"],
    );
}

#[test]
fn a_missing_log_is_named_with_the_places_and_its_flag() {
    let sandbox = identified();
    std::fs::remove_file(sandbox.path("log.csv")).unwrap();
    refused(
        &sandbox,
        &["result"],
        &[
            "made from as --log is not there",
            "where: log.csv, result/log.csv",
            "give its place with --log",
        ],
    );
    refused(
        &sandbox,
        &["result", "--log", "nowhere.csv"],
        &["where: nowhere.csv", "cannot be read"],
    );
}

#[test]
fn an_input_that_is_no_file_is_refused_and_not_read_for_ever() {
    let sandbox = identified();
    refused(
        &sandbox,
        &["result", "--device", "result"],
        &["no regular file"],
    );
    #[cfg(target_os = "linux")]
    {
        refused(
            &sandbox,
            &["result", "--log", "/dev/zero"],
            &["no regular file"],
        );
        refused(
            &sandbox,
            &["/dev/zero"],
            &["where: /dev/zero", "no regular file"],
        );
    }
}

#[test]
fn a_flag_for_an_input_that_the_result_has_not_is_refused() {
    let sandbox = identified();
    refused(
        &sandbox,
        &["result", "--validate", "log.csv"],
        &["made without --validate", "leave --validate out"],
    );
}

#[test]
fn a_folder_or_file_that_is_no_result_is_refused() {
    let sandbox = identified();
    refused(
        &sandbox,
        &["nothing"],
        &["where: nothing", "give the folder"],
    );
    std::fs::create_dir_all(sandbox.path("empty/inner")).unwrap();
    refused(
        &sandbox,
        &["empty"],
        &["none of identified.json, gap.json, plan.json"],
    );
    for name in ["identified.toml", "report.html"] {
        let path = format!("result/{name}");
        refused(&sandbox, &[&path], &["not JSON", &path, "give the folder"]);
    }
}

#[test]
fn a_result_that_was_cut_off_is_placed() {
    let sandbox = identified();
    let json = std::fs::read_to_string(sandbox.path("result/identified.json")).unwrap();
    sandbox.write("result/identified.json", &json[..json.len() / 2]);
    refused(
        &sandbox,
        &["result"],
        &[
            "not JSON",
            "where: result/identified.json:",
            "cut off or changed",
        ],
    );
}

/// A result of 1 GiB in one line: the file has a hole in it, so it takes no room.
#[test]
fn a_result_of_one_gibibyte_is_refused_at_once() {
    let sandbox = identified();
    let file = std::fs::OpenOptions::new()
        .write(true)
        .open(sandbox.path("result/identified.json"))
        .unwrap();
    file.set_len(1 << 30).unwrap();
    refused(&sandbox, &["result"], &["larger than 64 MiB"]);
}

#[test]
fn a_file_beside_the_result_may_be_huge_or_no_text() {
    let sandbox = identified();
    let path = sandbox.path("result/identified.toml");
    let file = std::fs::OpenOptions::new().write(true).open(&path).unwrap();
    file.set_len(1 << 30).unwrap();
    let run = || {
        haptical()
            .current_dir(sandbox.folder.path())
            .args(["verify", "result"])
            .output()
            .unwrap()
    };
    for content in [None, Some(&b"\xff\xfe"[..]), Some(b"a = ["), Some(b"")] {
        if let Some(content) = content {
            std::fs::write(&path, content).unwrap();
        }
        let output = run();
        let said = text(&output.stdout);
        assert_eq!(
            output.status.code(),
            Some(1),
            "{said}{}",
            text(&output.stderr)
        );
        assert!(said.contains("identified.toml  differs"), "{said}");
        assert!(said.len() < 4000, "{}", said.len());
    }
    #[cfg(target_os = "linux")]
    {
        std::fs::remove_file(&path).unwrap();
        std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
        assert_eq!(run().status.code(), Some(1));
    }
}
