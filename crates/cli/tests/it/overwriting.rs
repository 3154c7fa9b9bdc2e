//! Files that are there before a run: its own are replaced, stale ones removed, others never touched unasked.

use std::process::Output;

use crate::moving_log::moving_log;
use crate::{Sandbox, haptical, names_in, text};

fn read(sandbox: &Sandbox, name: &str) -> String {
    std::fs::read_to_string(sandbox.path("result").join(name)).unwrap()
}

fn run(sandbox: &Sandbox, words: &str) -> Output {
    haptical()
        .current_dir(sandbox.folder.path())
        .args(words.split(' '))
        .output()
        .unwrap()
}

/// The run must refuse, naming the file and `--force`.
fn refused(output: &Output, file: &str) {
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{file}: {said}");
    for wanted in [&format!("where: {file}\n"), "earlier `haptical ", "--force"] {
        assert!(said.contains(wanted), "{file}, {wanted}: {said}");
    }
}

fn done(output: &Output) -> String {
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    said
}

#[test]
fn a_file_that_no_run_wrote_is_refused_before_any_work_and_kept() {
    let sandbox = Sandbox::new();
    std::fs::create_dir(sandbox.path("result")).unwrap();
    let log = sandbox.log_text();
    let cases = [
        ("identify", "identified.toml"),
        ("identify", "identified.json"),
        ("identify", "identify.html"),
        ("identify", "rejected.toml"),
        ("identify", "report.html"),
        ("diagnose", "gap.json"),
        ("diagnose", "gap.html"),
        ("diagnose", "predictions.csv"),
        ("plan", "plan.json"),
        ("plan", "plan.html"),
        ("plan", "rigs.svg"),
        ("plan", "poses.csv"),
    ];
    for (command, name) in cases {
        let path = format!("result/{name}");
        sandbox.write(&path, "mine");
        // a log that cannot be read: the refusal comes before it
        sandbox.write("log.csv", "no log");
        let output = match command {
            "plan" => run(
                &sandbox,
                "plan --device device.toml --log log.csv --out result",
            ),
            _ => sandbox.run(command, &[]),
        };
        refused(&output, &path);
        assert_eq!(read(&sandbox, name), "mine");
        assert_eq!(names_in(&sandbox.path("result")), [name]);
        std::fs::remove_file(sandbox.path(&path)).unwrap();
    }
    sandbox.write("log.csv", log);
    sandbox.write("result/identified.toml", "mine");
    sandbox.write("result/rejected.toml", "mine too");
    let said = done(&sandbox.identify(&["--force"]));
    assert_ne!(read(&sandbox, "identified.toml"), "mine");
    // nothing took its place
    assert_eq!(read(&sandbox, "rejected.toml"), "mine too");
    assert!(
        said.contains("warning: result/rejected.toml is not of this result"),
        "{said}"
    );
}

#[test]
fn an_earlier_run_of_the_same_command_is_replaced() {
    let sandbox = Sandbox::new();
    done(&sandbox.identify(&[]));
    let first = read(&sandbox, "identified.toml");
    let said = done(&sandbox.identify(&["--held-out", "0.3"]));
    assert!(!said.contains("removed"), "{said}");
    assert_ne!(read(&sandbox, "identified.toml"), first);
}

#[test]
fn a_file_that_was_changed_after_it_was_written_is_refused() {
    let sandbox = Sandbox::new();
    done(&sandbox.identify(&[]));
    for name in names_in(&sandbox.path("result")) {
        let written = read(&sandbox, &name);
        let path = format!("result/{name}");
        // in JSON the space means nothing, but somebody wrote it
        sandbox.write(&path, format!("{written} "));
        refused(&sandbox.identify(&[]), &path);
        assert_eq!(read(&sandbox, &name), format!("{written} "));
        sandbox.write(&path, written);
    }
    done(&sandbox.identify(&[]));
    sandbox.write("result/identified.json", "{}");
    done(&sandbox.identify(&["--force"]));
    done(&sandbox.identify(&[]));
}

#[test]
fn what_a_run_does_not_write_again_is_removed_and_said() {
    let sandbox = Sandbox::new();
    let device = sandbox.device_text();
    for (part, name) in [(1, "log.csv"), (2, "log2.csv")] {
        sandbox.write(name, moving_log(&device, 1e-3, part));
    }
    done(&sandbox.diagnose(&["--validate", "log2.csv"]));
    assert!(sandbox.path("result/predictions.csv").is_file());
    let said = done(&sandbox.diagnose(&["--json"]));
    assert!(
        said.contains(
            "removed: result/predictions.csv, which an earlier `haptical diagnose` wrote"
        ),
        "{said}"
    );
    assert_eq!(
        names_in(&sandbox.path("result")),
        ["corrected.toml", "gap.html", "gap.json", "report.html"]
    );
    let plan = "plan --device device.toml --measure out,cable --out result";
    done(&run(&sandbox, &format!("{plan} --poses 60")));
    let said = done(&run(&sandbox, plan));
    assert!(said.contains("removed: result/poses.csv"), "{said}");
    assert!(!sandbox.path("result/poses.csv").exists());
}

#[test]
fn a_result_of_another_command_under_the_name_is_foreign() {
    let sandbox = Sandbox::new();
    done(&sandbox.identify(&[]));
    let other = read(&sandbox, "identified.json");
    sandbox.write("result/gap.json", &other);
    refused(&sandbox.diagnose(&[]), "result/gap.json");
    assert_eq!(read(&sandbox, "gap.json"), other);
}

#[test]
fn the_index_links_every_result_of_the_folder_with_its_answer() {
    let sandbox = Sandbox::new();
    done(&sandbox.identify(&[]));
    let alone = read(&sandbox, "report.html");
    done(&sandbox.diagnose(&[]));
    let plan = "plan --device device.toml --measure out,cable --out result";
    done(&run(&sandbox, plan));
    let page = read(&sandbox, "report.html");
    for (json, html) in [
        ("identified.json", "identify.html"),
        ("gap.json", "gap.html"),
        ("plan.json", "plan.html"),
    ] {
        let result: serde_json::Value = serde_json::from_str(&read(&sandbox, json)).unwrap();
        let answer = result["answer"].as_str().unwrap();
        assert!(!answer.contains('\n') && answer.len() > 20, "{answer}");
        for wanted in [
            answer,
            &format!("href=\"{html}\""),
            &format!("href=\"{json}\""),
        ] {
            assert!(page.contains(wanted), "{wanted}: {page}");
        }
        let own = json == "identified.json";
        assert_eq!(alone.contains(html), own, "{html}");
    }
    // nothing from outside
    assert!(!page.contains("<svg") && !page.contains("://"));
    done(&sandbox.identify(&[]));
    assert_eq!(read(&sandbox, "report.html"), page);
}

/// Runs a command that writes one file: again, after a change of its input, over a changed file.
fn own_until_changed(sandbox: &Sandbox, words: &str, file: &str, change: impl Fn()) {
    done(&run(sandbox, words));
    done(&run(sandbox, words));
    change();
    let first = std::fs::read(sandbox.path(file)).unwrap();
    done(&run(sandbox, words));
    let mut content = std::fs::read(sandbox.path(file)).unwrap();
    assert_ne!(content, first, "{words}");
    content.push(b' ');
    sandbox.write(file, &content);
    refused(&run(sandbox, words), file);
    assert_eq!(std::fs::read(sandbox.path(file)).unwrap(), content);
    done(&run(sandbox, &format!("{words} --force")));
    done(&run(sandbox, words));
    sandbox.write(file, "mine");
    refused(&run(sandbox, words), file);
}

#[test]
fn exports_pages_and_simulated_logs_are_replaced_until_they_are_changed() {
    for format in ["rust", "c-header", "json", "toml", "urdf", "mjcf"] {
        let sandbox = Sandbox::new();
        let words = format!("export --device device.toml --format {format} --out model");
        let device = sandbox.device_text();
        let longer = device.replace("a_m = 0.", "a_m = 0.0");
        assert_ne!(longer, device);
        own_until_changed(&sandbox, &words, "model", || {
            sandbox.write("device.toml", &longer);
        });
    }
    let sandbox = Sandbox::new();
    let shorter = sandbox.log_text();
    let shorter = &shorter[..shorter.trim_end().rfind('\n').unwrap() + 1];
    let words = "play --device device.toml --log log.csv --out page.html";
    own_until_changed(&sandbox, words, "page.html", || {
        sandbox.write("log.csv", shorter);
    });
    // a page is no export
    let words = "export --device device.toml --format json --out page.html";
    refused(&run(&sandbox, words), "page.html");
    let sandbox = Sandbox::new();
    let device = sandbox.device_text();
    let words = "simulate --device device.toml --seconds 6 --rate-hz 100 --out new.csv";
    own_until_changed(&sandbox, words, "new.csv", || {
        let longer = device.replace("a_m = 0.", "a_m = 0.0");
        sandbox.write("device.toml", longer);
    });
    let record = "new.csv.provenance.json";
    done(&run(&sandbox, &format!("{words} --force")));
    sandbox.write(record, "{}");
    refused(&run(&sandbox, words), &format!("./{record}"));
    std::fs::remove_file(sandbox.path(record)).unwrap();
    refused(&run(&sandbox, words), "new.csv");
}

#[test]
fn an_import_replaces_what_is_the_same_and_nothing_else() {
    let sandbox = Sandbox::new();
    let words = "import poses table.csv --map theta1_rad=q --out new.csv";
    sandbox.write("table.csv", "q\n0.1\n0.2\n");
    done(&run(&sandbox, words));
    done(&run(&sandbox, words));
    sandbox.write("table.csv", "q\n0.1\n0.3\n");
    let before = std::fs::read_to_string(sandbox.path("new.csv")).unwrap();
    let output = run(&sandbox, words);
    assert_eq!(output.status.code(), Some(2));
    let said = text(&output.stderr);
    assert!(
        said.contains("where: new.csv") && said.contains("--force"),
        "{said}"
    );
    assert_eq!(
        std::fs::read_to_string(sandbox.path("new.csv")).unwrap(),
        before
    );
    done(&run(&sandbox, &format!("{words} --force")));
    assert_ne!(
        std::fs::read_to_string(sandbox.path("new.csv")).unwrap(),
        before
    );
}
