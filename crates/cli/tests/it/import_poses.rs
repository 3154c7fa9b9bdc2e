//! `haptical import poses`: columns renamed and scaled, and what it refuses.

use std::process::Output;

use haptical_data::{JointShape, LogShape, read_log};

use crate::{haptical, names_in, text};

const TABLE: &str =
    "time,q2,q1,px,note,place\n0,90,180,250,a,left\n10,-45,0,,b,right\n20,30,60,260.5,c,left\n";

/// The table, and the folder of the log.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new(table: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("table.csv"), table).unwrap();
        Self(folder)
    }

    fn import(&self, flags: &[&str]) -> Output {
        let mut command = haptical();
        command
            .args(["import", "poses"])
            .arg(self.0.path().join("table.csv"));
        command.arg("--out").arg(self.0.path().join("out/log.csv"));
        command.args(flags).output().unwrap()
    }

    #[track_caller]
    fn refused(&self, flags: &[&str], words: &[&str]) {
        let output = self.import(flags);
        assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
        let said = text(&output.stderr);
        for word in words {
            assert!(said.contains(word), "{word}: {said}");
        }
        assert_eq!(names_in(self.0.path()), ["table.csv"]);
    }
}

fn joint(name: &str) -> JointShape {
    JointShape {
        name: name.to_owned(),
        prismatic: false,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
    }
}

#[test]
fn columns_are_renamed_and_scaled() {
    let bench = Bench::new(TABLE);
    let output = bench.import(&[
        "--map",
        "t_s=time,theta1_rad=q1,theta2_rad=q2",
        "--map",
        "cable_m=#4,contact=place",
        "--scale",
        "theta*=deg,cable_m=mm,t_s=ms",
    ]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let shape = LogShape {
        joints: vec![joint("1"), joint("2")],
        cable_count: 1,
        hands: Vec::new(),
    };
    let log = read_log(&bench.0.path().join("out/log.csv"), &shape).unwrap();
    assert_eq!(log.warnings, Vec::<String>::new());
    let recording = log.recording;
    let degree = std::f64::consts::PI / 180.0;
    assert_eq!(recording.joint[0], [180.0 * degree, 0.0, 60.0 * degree]);
    assert_eq!(
        recording.joint[1],
        [90.0 * degree, -45.0 * degree, 30.0 * degree]
    );
    assert_eq!(recording.time_s.unwrap(), [0.0, 0.01, 0.02]);
    let cable = recording.cable_m[0].as_ref().unwrap();
    assert!(cable[1].is_nan());
    assert!((cable[0] - 0.25).abs() < 1e-15 && (cable[2] - 0.2605).abs() < 1e-15);
    assert_eq!(recording.contact.unwrap(), ["left", "right", "left"]);
}

#[test]
fn without_a_header_columns_are_numbers_and_no_digit_is_lost() {
    let bench = Bench::new("1.2345678901234567e-1,0.5\n0.3,0.25\n");
    let output = bench.import(&["--no-header", "--map", "theta1_rad=#2,out1_rad=#1"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let written = std::fs::read_to_string(bench.0.path().join("out/log.csv")).unwrap();
    assert_eq!(
        written,
        format!(
            "theta1_rad,out1_rad\n0.5,{}\n0.25,0.3\n",
            1.2345678901234567e-1
        )
    );
}

#[test]
fn what_cannot_be_a_log_is_refused_and_nothing_is_written() {
    let bench = Bench::new(TABLE);
    let map = "theta1_rad=q1,theta2_rad=q2";
    bench.refused(
        &["--map", "theta1_rad=q3"],
        &["no column `q3`", "time, q2, q1, px"],
    );
    bench.refused(
        &["--map", "theta1_rad=#7"],
        &["no column #7, the table has 6"],
    );
    bench.refused(&["--map", "theta1_rad=#0"], &["no column #0"]);
    bench.refused(
        &["--map", "theta1_rad=note"],
        &["table.csv:2:5", "expected a number, found `a`"],
    );
    bench.refused(&["--map", "x_m=px"], &["names no theta1_rad"]);
    bench.refused(
        &["--map", map, "--map", "theta1_rad=px"],
        &["`theta1_rad` twice"],
    );
    bench.refused(
        &["--map", map, "--scale", "x_m=mm"],
        &["`x_m`, which --map does not"],
    );
    bench.refused(
        &["--map", map, "--scale", "theta1_rad=inch"],
        &["TARGET=FACTOR"],
    );
    bench.refused(&["--map", "theta1_rad"], &["NAME=VALUE"]);
    bench.refused(
        &["--map", &format!("{map},cabel_m=px")],
        &["`cabel_m`", "no column of a log"],
    );
    bench.refused(
        &["--map", &format!("{map},theta4_rad=px")],
        &["`theta4_rad`", "not mapped"],
    );
    bench.refused(
        &["--map", &format!("{map},x_m=px")],
        &["given without `y_m`, `z_m`"],
    );
    bench.refused(
        &["--map", &format!("{map},theta3_rad=px")],
        &["column `theta3_rad`", "empty"],
    );
    bench.refused(&["--map", map, "--no-header"], &["`q1`", "#1"]);
    let twice = Bench::new("q,q\n1,2\n3,4\n");
    twice.refused(
        &["--map", "theta1_rad=q"],
        &["two columns are called `q`", "#1 or #2"],
    );
    let ragged = Bench::new("q,w\n1,2\n3\n4,5\n");
    ragged.refused(
        &["--map", "theta1_rad=q"],
        &["1 cells where most rows have 2", "table.csv:3"],
    );
    let infinite = Bench::new("q\n1\ninf\n");
    infinite.refused(
        &["--map", "theta1_rad=q"],
        &["`inf` is not a finite number"],
    );
    Bench::new("").refused(&["--map", "theta1_rad=q"], &["the table has no rows"]);
}

/// The same flags on tables that are no CSV of commas.
#[test]
fn other_tables_take_the_same_flags() {
    let names = "theta1_rad=q,x_m=x,y_m=y,z_m=z";
    let scales = "x_m=mm,y_m=mm,z_m=mm,theta1_rad=deg";
    let map = ["--map", names, "--scale", scales];
    let bench = Bench::new("q;x;y;z\n90,0;1,5;2;3\n45,0;2,5;3;4\n");
    let output = bench.import(&map);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let shape = LogShape {
        joints: vec![joint("1")],
        cable_count: 0,
        hands: Vec::new(),
    };
    let log = read_log(&bench.0.path().join("out/log.csv"), &shape)
        .unwrap()
        .recording;
    assert_eq!(log.position_m.unwrap()[0], [0.0015, 0.0025]);
    assert_eq!(log.joint[0][0], std::f64::consts::FRAC_PI_2);
}
