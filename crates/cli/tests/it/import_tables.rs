//! `haptical import --guess` and `--columns`: what is written, and what is refused.

use std::path::Path;
use std::process::Output;

use crate::{haptical, names_in, text};

/// A folder with a table and a mapping file.
struct Bench(tempfile::TempDir);

const TABLE: &str = "q1,q2,x,y,z\n10,20,100,0,5\n170,-90,110,1,6\n30,5,120,2,7\n";
const DEVICE: &str = "[device]\ndof = 2\n[[joint]]\nlower_rad = -1.6\nupper_rad = 3.2\n[[joint]]\nlower_rad = -1.6\nupper_rad = 1.6\n";
const MAPPING: &str = "[[column]]\nlog = ['theta1_rad', 'theta2_rad']\nfrom = ['q1', 'q2']\nunit = 'deg'\n\
                       [[column]]\nlog = ['x_m', 'y_m', 'z_m']\nfrom = ['x', 'y', 'z']\nunit = 'mm'\n";

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in [
            ("table.csv", TABLE),
            ("columns.toml", MAPPING),
            ("device.toml", DEVICE),
        ] {
            std::fs::write(folder.path().join(name), content).unwrap();
        }
        Self(folder)
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn import(&self, words: &str) -> Output {
        haptical()
            .current_dir(self.path())
            .arg("import")
            .args(words.split_whitespace())
            .output()
            .unwrap()
    }

    #[track_caller]
    fn refused(&self, words: &str, said: &[&str]) {
        let before = names_in(self.path());
        let output = self.import(words);
        assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
        let error = text(&output.stderr);
        for word in said {
            assert!(error.contains(word), "{word}: {error}");
        }
        assert_eq!(names_in(self.path()), before);
    }
}

#[test]
fn a_proposal_is_printed_or_written_and_works_as_it_is() {
    let bench = Bench::new();
    let printed = bench.import("--guess table.csv");
    assert!(printed.status.success(), "{}", text(&printed.stderr));
    let written = bench.import("--guess table.csv --out new/proposal.toml");
    assert!(written.status.success(), "{}", text(&written.stderr));
    let file = std::fs::read_to_string(bench.path().join("new/proposal.toml")).unwrap();
    assert_eq!(text(&printed.stdout), file);
    let output = bench.import("--columns new/proposal.toml table.csv --out log.csv");
    assert!(output.status.success(), "{}", text(&output.stderr));
    let by_hand = bench.import("--columns columns.toml table.csv --out same.csv --json");
    assert!(by_hand.status.success(), "{}", text(&by_hand.stderr));
    assert!(
        text(&by_hand.stdout).contains("\"rows\": 3"),
        "{}",
        text(&by_hand.stdout)
    );
    let read = |name: &str| std::fs::read_to_string(bench.path().join(name)).unwrap();
    assert_eq!(read("log.csv"), read("same.csv"));
    // nothing of a person's is lost
    std::fs::write(bench.path().join("new/proposal.toml"), "# mine\n").unwrap();
    bench.refused(
        "--guess table.csv --out new/proposal.toml",
        &["no earlier `haptical import` wrote it", "--force"],
    );
}

/// Degrees that are taken for radians do not fit the device.
#[test]
fn a_device_s_limits_are_looked_at() {
    let bench = Bench::new();
    let wrong = MAPPING.replacen("unit = 'deg'\n", "", 1);
    std::fs::write(bench.path().join("wrong.toml"), wrong).unwrap();
    bench.refused(
        "--columns wrong.toml table.csv --device device.toml --out log.csv",
        &["looks like degrees"],
    );
    let output =
        bench.import("--columns columns.toml table.csv --device device.toml --out log.csv");
    assert!(output.status.success(), "{}", text(&output.stderr));
}

/// A log of angles alone is one, but the next command would have nothing to compare them with.
#[test]
fn a_log_of_joints_alone_is_written_with_a_warning() {
    let bench = Bench::new();
    let joints = format!("[[column]]{}", MAPPING.split("[[column]]").nth(1).unwrap());
    let beside = |name: &str| format!("{joints}[[column]]\nlog = '{name}'\nfrom = 'x'\n");
    for (mapping, warns) in [
        (joints.clone(), true),
        (beside("velocity1_rad_per_s"), true),
        (beside("command1_rad"), false),
        (MAPPING.to_owned(), false),
    ] {
        std::fs::write(bench.path().join("own.toml"), mapping).unwrap();
        let output = bench.import("--columns own.toml table.csv --out log.csv --force");
        assert!(output.status.success(), "{}", text(&output.stderr));
        let said = text(&output.stderr);
        assert_eq!(
            said.contains("nothing that was measured besides"),
            warns,
            "{said}"
        );
    }
}

#[test]
fn what_cannot_be_imported_is_refused_and_nothing_is_written() {
    let bench = Bench::new();
    let columns = "--columns columns.toml --out log.csv";
    std::fs::write(bench.path().join("old.bag"), "#ROSBAG V2.0\n").unwrap();
    std::fs::write(bench.path().join("bad.toml"), "[[column]]\nlog = 'x_m'\n").unwrap();
    std::fs::write(
        bench.path().join("part.toml"),
        "[[column]]\nlog = 'theta1_rad'\nfrom = 'q1'\n[[column]]\nlog = 'x_m'\nfrom = 'x'\n",
    )
    .unwrap();
    std::fs::write(
        bench.path().join("none.toml"),
        "[[column]]\nlog = 'x_m'\nfrom = 'x'\n",
    )
    .unwrap();
    bench.refused("", &["no files to import", "--guess"]);
    bench.refused("table.csv --out log.csv", &["--columns columns.toml"]);
    bench.refused("--columns columns.toml table.csv", &["--out log.csv"]);
    bench.refused("--guess none.csv", &["none.csv", "cannot be read"]);
    bench.refused("--guess old.bag", &["ROS 1 bag", "rosbags-convert"]);
    bench.refused(
        "--guess table.csv --columns columns.toml",
        &["cannot be used with"],
    );
    bench.refused(
        &format!("{columns} --columns none table.csv"),
        &["--columns"],
    );
    bench.refused(
        "--columns none.csv table.csv --out log.csv",
        &["none.csv", "--guess"],
    );
    bench.refused(
        "--columns bad.toml table.csv --out log.csv",
        &["bad.toml", "one of from, value"],
    );
    bench.refused(
        "--columns part.toml table.csv --out log.csv",
        &["given without `y_m`, `z_m`"],
    );
    bench.refused(
        "--columns none.toml table.csv --out log.csv",
        &["no column is theta1_rad"],
    );
    bench.refused(
        "--columns columns.toml table.csv --out table.csv",
        &["table.csv"],
    );
    bench.refused(
        "--columns columns.toml table.csv --out log.xlsx.gz",
        &[".csv"],
    );
}
