//! Every command that writes, with every place that it writes to: nothing that it reads and nothing that another hand wrote is touched.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::{Command as Definition, CommandFactory, ValueHint};

use crate::arguments::Arguments;
use crate::failure::Failure;
use crate::flags::OUTPUTS;

/// A command line, and what it may write.
struct Case {
    /// `{1}`, `{2}`, ... are files that are read, `{dir}` is a folder that is read, `{out}` is what is written to.
    words: &'static str,
    /// Ends of the paths that are written, behind `{out}`; those of a folder begin with a stroke.
    ends: &'static [&'static str],
    /// Content of the files that are read; it matters only where the run must get as far as writing.
    content: &'static str,
}

const fn case(words: &'static str, ends: &'static [&'static str]) -> Case {
    let content = "input";
    Case {
        words,
        ends,
        content,
    }
}

const IDENTIFIED: &[&str] = &[
    "/identified.toml",
    "/identified.json",
    "/identify.html",
    "/rejected.toml",
    "/report.html",
];
const DIAGNOSED: &[&str] = &[
    "/gap.json",
    "/gap.html",
    "/predictions.csv",
    "/corrected.toml",
    "/repaired.csv",
    "/repaired.csv.gz",
    "/repaired.json",
    "/report.html",
];
const ALARMED: &[&str] = &[
    "/alarm.csv",
    "/alarm.csv.provenance.json",
    "/gap.json",
    "/gap.html",
    "/predictions.csv",
    "/corrected.toml",
    "/report.html",
];

const CASES: &[Case] = &[
    case(
        "identify --device {1} --log {2} --rig {3} --with {4} --validate {5} --out {out}",
        IDENTIFIED,
    ),
    case(
        "diagnose --device {1} --log {2} --log {3} --rig {4} --model {5} --validate {6} --out {out}",
        DIAGNOSED,
    ),
    case(
        "doctor {1} --out {out}",
        &["/doctor.html", "/doctor.json", "/comment.md"],
    ),
    case(
        "plan --device {1} --rig {2} --log {3} --settle {4} --out {out}",
        &[
            "/plan.json",
            "/plan.html",
            "/rigs.svg",
            "/poses.csv",
            "/report.html",
        ],
    ),
    case(
        "simulate --device {1} --rig {2} --effects {3} --truth {4} --out {out}",
        &["", ".provenance.json"],
    ),
    case(
        "simulate --device {1} --deviate 0.1 --out {out}",
        &["", ".provenance.json", ".truth.toml"],
    ),
    case(
        "simulate --device {1} --poses {2} --measure out --out {out}",
        &["", ".provenance.json", ".truth.toml", ".rig.toml"],
    ),
    case(
        "simulate --device {1} --replay {2} --out {out}",
        &["", ".provenance.json", ".residuals.csv"],
    ),
    case(
        "simulate --forward --device {1} --log {2} --with {3} --controller {4} --out {out}",
        &["", ".provenance.json", ".html"],
    ),
    case(
        "export --device {1} --rig {2} --format urdf --urdf {3} --out {out}",
        &[""],
    ),
    case(
        "export --device {1} --format mjcf --mjcf {2} --out {out}",
        &[""],
    ),
    case(
        "correct --device {1} --rig {2} --model {3} --waypoints {4} --out {out}",
        &["", ".provenance.json"],
    ),
    case(
        "play --device {1} --rig {2} --model {3} --log {4} --out {out}",
        &[""],
    ),
    case(
        "report {1} --budget {2} --poses {3} --device {4} --rig {5} --log {6} --out {out}",
        &["/budget.json", "/budget.html"],
    ),
    case(
        "watch --device {1} --rig {2} --reference {3} --once --page {out} {4}",
        &[""],
    ),
    case(
        "watch --device {1} --reference {2} --once --out {out} {3}",
        ALARMED,
    ),
    case("watch --device {1} --once --page {out} {dir}", &[""]),
    case("init {out}", &["/device.toml", "/log.csv"]),
    case("import mukca {dir} --out {out}.csv", &[".csv", ".rig.toml"]),
    case(
        "import --columns {1} --device {2} --rig {3} {4} --out {out}",
        &[""],
    ),
    case(
        "import bag {1} --device {2} --rig {3} --out {out}.csv",
        &[".csv"],
    ),
    case(
        "import lerobot {1} --device {2} --rig {3} --out {out}.csv",
        &[".csv"],
    ),
    Case {
        words: "import --guess {1} --out {out}",
        ends: &[""],
        content: "t,q\n0,0.1\n1,0.2\n2,0.3\n",
    },
    Case {
        words: "import poses {1} --map theta1_rad=q --out {out}.csv",
        ends: &[".csv"],
        content: "q\n0.1\n0.2\n",
    },
];

/// Imports read before they know what they would write: a log with the same content may be there.
fn is_checked_at_the_end(case: &Case) -> bool {
    case.words.starts_with("import") && case.content == "input"
}

/// A folder with the files of a case.
struct Scene<'c> {
    folder: tempfile::TempDir,
    case: &'c Case,
}

impl<'c> Scene<'c> {
    fn new(case: &'c Case) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let scene = Self { folder, case };
        for number in scene.inputs() {
            std::fs::write(scene.input(number), case.content).unwrap();
        }
        std::fs::create_dir(scene.folder.path().join("read")).unwrap();
        scene
    }

    fn inputs(&self) -> impl Iterator<Item = usize> + use<'c> {
        let words = self.case.words;
        (1..10).filter(move |number| words.contains(&format!("{{{number}}}")))
    }

    fn input(&self, number: usize) -> PathBuf {
        // `identify --with` takes a gap.json, `import` asks the name what a table is
        let end = match self.case.words.contains(&format!("--with {{{number}}}")) {
            true => "json",
            false => "csv",
        };
        self.folder.path().join(format!("in{number}.{end}"))
    }

    fn output(&self, end: &str) -> PathBuf {
        let path = format!("{}{end}", self.folder.path().join("out").display());
        std::fs::create_dir_all(Path::new(&path).parent().unwrap()).unwrap();
        path.into()
    }

    /// Runs the command with paths in the place of inputs; it must refuse, and no byte of the folder may change.
    fn refuse(&self, replaced: &[(&str, &Path)], force: bool) -> Failure {
        let mut words = vec![OsString::from("haptical")];
        for word in self.case.words.split(' ') {
            let mut word = word.replace(
                "{out}",
                &self.folder.path().join("out").display().to_string(),
            );
            for (name, path) in replaced {
                word = word.replace(name, &path.display().to_string());
            }
            for number in self.inputs() {
                let path = self.input(number).display().to_string();
                word = word.replace(&format!("{{{number}}}"), &path);
            }
            let read = self.folder.path().join("read").display().to_string();
            words.push(word.replace("{dir}", &read).into());
        }
        if force {
            words.push("--force".into());
        }
        let before = contents(self.folder.path());
        let parsed =
            crate::parsed(words).unwrap_or_else(|error| panic!("{}: {error}", self.case.words));
        let done = crate::run_command(parsed.command.unwrap());
        let after = contents(self.folder.path());
        assert_eq!(before, after, "{}", self.case.words);
        done.expect_err(self.case.words)
    }
}

/// All files below a folder.
fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => found.extend(contents(&path)),
            false => found.push((path.clone(), std::fs::read(&path).unwrap())),
        }
    }
    found.sort();
    found
}

/// Refusals are of one process, which keeps the inputs of one command line: one test after the other.
#[test]
fn no_command_replaces_an_input_or_a_file_of_another_hand() {
    every_path_of_every_command_is_in_a_case();
    for case in CASES {
        for end in case.ends {
            for force in [false, true] {
                inputs_stay(case, end, force);
            }
            if !is_checked_at_the_end(case) {
                foreign_files_stay(case, end);
            }
        }
    }
    outputs_have_different_places();
}

fn inputs_stay(case: &Case, end: &str, force: bool) {
    type Link = fn(&Path, &Path) -> std::io::Result<()>;
    let same: Link = |from, to| std::fs::write(to, std::fs::read(from)?);
    let mut links: Vec<(Link, bool)> = vec![
        (same, true),
        (|from, to| std::fs::hard_link(from, to), false),
    ];
    #[cfg(unix)]
    links.push((|from, to| std::os::unix::fs::symlink(from, to), false));
    for number in Scene::new(case).inputs() {
        for (link, is_named) in &links {
            let scene = Scene::new(case);
            let (input, output) = (scene.input(number), scene.output(end));
            link(&input, &output).unwrap();
            let name = format!("{{{number}}}");
            let named: &[(&str, &Path)] = &[(&name, &output)];
            let refused = scene.refuse(if *is_named { named } else { &[] }, force);
            let what = refused.what();
            assert!(
                what.ends_with("is an input of this run"),
                "{} {end} {number}: {what}",
                case.words
            );
            assert_eq!(refused.place().file, output.display().to_string());
        }
    }
    if case.words.contains("{dir}") {
        let scene = Scene::new(case);
        let output = scene.output(end);
        std::fs::write(&output, "read too").unwrap();
        let above = scene.folder.path().to_owned();
        let refused = scene.refuse(&[("{dir}", &above)], force);
        assert!(
            refused.what().ends_with("is an input of this run"),
            "{}",
            refused.what()
        );
    }
}

fn foreign_files_stay(case: &Case, end: &str) {
    for content in ["mine", "<!-- Written by `haptical` -->\n", "{}"] {
        let scene = Scene::new(case);
        let output = scene.output(end);
        std::fs::write(&output, content).unwrap();
        let refused = scene.refuse(&[], false);
        assert_eq!(
            refused.name(),
            "exists",
            "{} {end}: {}",
            case.words,
            refused.what()
        );
        assert!(
            refused.what().contains("no earlier `haptical "),
            "{}",
            refused.what()
        );
        assert!(refused.next_step().contains("--force"));
        assert_eq!(refused.place().file, output.display().to_string());
    }
}

/// A page among the files of an alarm would take the place of one of them.
fn outputs_have_different_places() {
    let case = case(
        "watch --device {1} --once --page {out}/gap.html --out {out} {2}",
        &[],
    );
    let refused = Scene::new(&case).refuse(&[], true);
    assert!(refused.what().contains("two outputs"), "{}", refused.what());
}

/// A flag that takes a path and is in no case fails here: it is an input or an output, and must be looked at.
fn every_path_of_every_command_is_in_a_case() {
    let mut command = Arguments::command();
    command.build();
    let mut outputs = 0;
    for (name, command) in below("", &command) {
        let paths = command
            .get_arguments()
            .filter(|argument| argument.get_value_hint() == ValueHint::AnyPath);
        let paths: Vec<_> = paths.collect();
        let is_output = |name: &str| OUTPUTS.contains(&name);
        if !paths.iter().any(|path| is_output(path.get_id().as_str())) {
            continue;
        }
        outputs += 1;
        let own: Vec<&Case> = CASES
            .iter()
            .filter(|case| {
                let words: Vec<&str> = case.words.split(' ').collect();
                let named: Vec<&str> = name.split(' ').collect();
                words.starts_with(&named) && (name != "import" || words[1].starts_with('-'))
            })
            .collect();
        for path in paths {
            let flag = path.get_long().map(|long| format!("--{long} "));
            let is_used = |case: &&Case| match &flag {
                Some(flag) => format!("{} ", case.words).contains(flag),
                None => true,
            };
            assert!(
                own.iter().any(is_used),
                "`haptical {name}`: {} is a path in no case of this test",
                path.get_id()
            );
        }
    }
    assert!(outputs >= 14, "{outputs} commands write");
}

/// A command with those below it, by their names.
fn below<'d>(name: &str, command: &'d Definition) -> Vec<(String, &'d Definition)> {
    let mut found = vec![(name.to_owned(), command)];
    for inner in command
        .get_subcommands()
        .filter(|own| own.get_name() != "help")
    {
        let name = format!("{name} {}", inner.get_name());
        found.extend(below(name.trim(), inner));
    }
    found
}
