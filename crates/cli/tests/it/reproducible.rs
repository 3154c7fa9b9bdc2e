//! The same bytes on any number of threads and in any folder, and nothing of the machine in them.

use std::collections::BTreeMap;
use std::path::Path;

use crate::moving_log::moving_log;
use crate::{Sandbox, haptical, names_in, text};

/// Threads that are tried.
const THREADS: [&str; 2] = ["1", "3"];

/// Device, two logs and effects, all by absolute paths in a folder of their own.
fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    let device = sandbox.device_text();
    for (part, name) in [(1, "moving.csv"), (2, "moving2.csv")] {
        sandbox.write(name, moving_log(&device, 1e-3, part));
    }
    sandbox.write(
        "effects.toml",
        "[[effect]]\nname = \"cable-latency\"\ndelay_s = 0.004\n",
    );
    sandbox
}

/// Runs a command in which `@name` stands for the absolute path of a file of the sandbox.
fn run(sandbox: &Sandbox, threads: &str, words: &str) {
    let words = words.split(' ').map(|word| match word.strip_prefix('@') {
        Some(name) => sandbox.path(name).into_os_string(),
        None => word.into(),
    });
    let output = haptical()
        .env("RAYON_NUM_THREADS", threads)
        .args(words)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
}

/// Every command that writes something, into folders and files of `out`.
fn run_all(sandbox: &Sandbox, threads: &str) {
    for words in [
        "identify --device @device.toml --log @log.csv --out @out/joint",
        "identify --device @device.toml --log @moving.csv --out @out/steps --method two-step",
        "diagnose --device @device.toml --log @moving.csv --validate @moving2.csv --out @out/gap",
        "diagnose --device @device.toml --log @moving.csv --model @out/joint/identified.toml --out @out/model",
        "export --device @out/joint/identified.toml --format c-header --out @out/export/model.h",
        "export --device @out/joint/identified.toml --format rust --out @out/export/model.rs",
        "export --device @out/joint/identified.toml --format json --out @out/export/model.json",
        "play --device @device.toml --model @out/joint/identified.toml --log @moving.csv --out @out/play/page.html",
        "simulate --device @device.toml --truth @out/joint/identified.toml --effects @effects.toml --seconds 6 \
         --rate-hz 100 --out @out/log/log.csv.gz",
    ] {
        run(sandbox, threads, words);
    }
}

/// Names and contents of all files in the folders of a folder.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for inner in names_in(folder) {
        for name in names_in(&folder.join(&inner)) {
            let content = std::fs::read(folder.join(&inner).join(&name)).unwrap();
            found.insert(format!("{inner}/{name}"), content);
        }
    }
    found
}

/// Each run is another folder too, and later.
#[test]
fn every_file_is_the_same_on_any_number_of_threads_in_any_folder() {
    let mut first: Option<BTreeMap<String, Vec<u8>>> = None;
    for threads in THREADS {
        let sandbox = sandbox();
        run_all(&sandbox, threads);
        let found = contents(&sandbox.path("out"));
        assert_eq!(found.len(), 4 + 4 + 5 + 4 + 3 + 1 + 2, "{:?}", found.keys());
        for (name, content) in &found {
            says_nothing_of_the_machine(&sandbox, name, content);
            let before = first.as_ref().map(|first| &first[name]);
            assert!(
                before.is_none_or(|before| before == content),
                "{name}, {threads} threads"
            );
        }
        first.get_or_insert(found);
    }
}

fn says_nothing_of_the_machine(sandbox: &Sandbox, name: &str, content: &[u8]) {
    let content = String::from_utf8_lossy(content);
    let folder = sandbox.folder.path();
    let program = Path::new(env!("CARGO_BIN_EXE_haptical"));
    let host = std::fs::read_to_string("/etc/hostname").unwrap_or_default();
    let private = [
        folder.to_string_lossy(),
        folder.file_name().unwrap().to_string_lossy(),
        std::env::temp_dir().to_string_lossy().into_owned().into(),
        program.parent().unwrap().to_string_lossy(),
        env!("CARGO_MANIFEST_DIR").into(),
        host.trim().into(),
    ];
    // A short name may be part of a word.
    for private in private.iter().filter(|text| text.len() > 3) {
        assert!(!content.contains(&**private), "{name} holds {private}");
    }
    let is_date = |bytes: &[u8]| {
        let form = b"dddd-dd-dd";
        bytes.iter().zip(form).all(|(byte, form)| match form {
            b'd' => byte.is_ascii_digit(),
            other => byte == other,
        })
    };
    assert!(
        !content.as_bytes().windows(10).any(is_date),
        "{name} holds a date"
    );
}

/// Every file but the plain tables names the version and the SHA-256 of its inputs.
#[test]
fn every_file_says_what_it_was_made_from() {
    let sandbox = sandbox();
    run_all(&sandbox, "2");
    let device = crate::resealed::sha256_of(&sandbox.path("device.toml"));
    let calibrated = crate::resealed::sha256_of(&sandbox.path("out/joint/identified.toml"));
    for (name, content) in contents(&sandbox.path("out")) {
        if name.ends_with(".csv") || name.ends_with(".csv.gz") {
            continue;
        }
        let content = String::from_utf8(content).unwrap();
        let wanted = if name.starts_with("export/") {
            &calibrated
        } else {
            &device
        };
        assert!(content.contains(wanted.as_str()), "{name}");
        assert!(content.contains(env!("CARGO_PKG_VERSION")), "{name}");
    }
    let text = std::fs::read_to_string(sandbox.path("out/log/log.csv.gz.provenance.json")).unwrap();
    let truth: serde_json::Value = serde_json::from_str(&text).unwrap();
    let provenance = &truth["provenance"];
    assert_eq!(truth["effects"][0]["name"], "cable-latency");
    assert_eq!(provenance["seeds"]["simulation"], 1);
    let flags: Vec<&str> = provenance["inputs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|input| input["flag"].as_str().unwrap())
        .collect();
    assert_eq!(flags, ["device", "truth", "effects"]);
    let log = crate::resealed::sha256_of(&sandbox.path("out/log/log.csv.gz"));
    assert_eq!(provenance["outputs"][0]["sha256"], log);
}
