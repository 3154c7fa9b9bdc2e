//! Rows of files side by side: by row, by repetition, by time.

use crate::support::{close, column, log};

const RULES: &str = "
[[column]]
log = 'theta1_rad'
from = 'q'
[[column]]
log = 'x_m'
from = 'x'
";

fn rules(rows: &str) -> String {
    format!("[rows]\nfiles_per_run = 2\n{rows}\n{RULES}")
}

#[test]
fn rows_stand_side_by_side() {
    let log = log(
        &["q\n1\n2\n", "x\n3\n4\n", "q\n5\n6\n7\n", "x\n8\n9\n10\n"],
        &rules(""),
    )
    .unwrap();
    assert_eq!(column(&log, "run"), [1.0, 1.0, 2.0, 2.0, 2.0]);
    assert_eq!(column(&log, "theta1_rad"), [1.0, 2.0, 5.0, 6.0, 7.0]);
    assert_eq!(column(&log, "x_m"), [3.0, 4.0, 8.0, 9.0, 10.0]);
}

/// A posture with three points: its row stands for three successive rows, not for every third.
#[test]
fn a_row_stands_for_several() {
    let files = ["q\n1\n2\n", "x\n1\n2\n3\n4\n5\n6\n"];
    let found = log(&files, &rules("match = 'repeat'")).unwrap();
    assert_eq!(column(&found, "theta1_rad"), [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    let error = log(&files, &rules("")).unwrap_err();
    assert!(
        error.what.contains("1.txt has 2, 2.txt has 6") && error.next.contains("repeat"),
        "{error}"
    );
    let error = log(&["q\n1\n2\n", "x\n1\n2\n3\n"], &rules("match = 'repeat'")).unwrap_err();
    assert_eq!(error.kind, "row-count");
}

/// Nearest in time, each of the second file once; a row too far away has none.
#[test]
fn rows_are_matched_by_time() {
    let joints = "t,q\n0,1\n100,2\n200,3\n300,4\n";
    // 0.104 s is nearer to row 2 than 0.09 s is; nothing is near row 4
    let places = "stamp,x\n0.01,10\n0.09,20\n0.104,21\n0.19,30\n0.36,40\n";
    let by_time = "match = 'time'\ntime = ['t', 'stamp']\ntime_unit = ['ms', 's']";
    let found = log(&[joints, places], &rules(by_time)).unwrap();
    close(&column(&found, "x_m"), &[10.0, 21.0, 30.0, f64::NAN], 0.0);
    assert!(
        found.warnings[0].contains("2 of 5 rows are left out"),
        "{:?}",
        found.warnings
    );
    assert!(
        found.warnings[1].contains("up to 0.01 s away"),
        "{:?}",
        found.warnings
    );
    let wide = log(
        &[joints, places],
        &rules(&format!("{by_time}\nwithin_s = 0.07")),
    )
    .unwrap();
    close(&column(&wide, "x_m"), &[10.0, 21.0, 30.0, 40.0], 0.0);
    // in one unit nothing is near
    let error = log(
        &[joints, places],
        &rules("match = 'time'\ntime = ['t', 'stamp']\ntime_unit = 'ms'\nwithin_s = 1e-6"),
    );
    assert!(error.is_err());
}

/// Clocks that count from 1970 in nanoseconds lose no more than a microsecond.
#[test]
fn times_since_1970_are_matched() {
    let joints = "t,q\n1700000000000000000,1\n1700000000010000000,2\n";
    let places = "s,x\n1700000000.011,20\n1700000000.001,10\n";
    let found = log(
        &[joints, places],
        &rules("match = 'time'\ntime = ['t', 's']\ntime_unit = ['ns', 's']"),
    )
    .unwrap();
    assert_eq!(column(&found, "x_m"), [10.0, 20.0]);
}

#[test]
fn times_that_do_not_increase_are_refused() {
    let by_time = rules("match = 'time'\ntime = 't'");
    let error = log(&["t,q\n0,1\n0,2\n", "t,x\n0,1\n"], &by_time).unwrap_err();
    assert!(
        error.what.contains("does not increase") && error.line == Some(3),
        "{error}"
    );
    let error = log(&["t,q\n0,1\n,2\n", "t,x\n0,1\n"], &by_time).unwrap_err();
    assert!(
        error.what.contains("without a time") && error.line == Some(3),
        "{error}"
    );
    let error = log(&["t,q\n0,1\n1,2\n", "t,x\n0,1\n"], &rules("match = 'time'")).unwrap_err();
    assert!(error.what.contains("0 columns of time"), "{error}");
}

#[test]
fn a_name_in_two_files_must_say_which() {
    let files = ["q,x\n1,2\n3,4\n", "q,x\n5,6\n7,8\n"];
    let error = log(&files, &rules("")).unwrap_err();
    assert!(
        error.what.contains("several of the files") && error.next.contains("file = 1"),
        "{error}"
    );
    let said = format!(
        "[rows]\nfiles_per_run = 2\n{}",
        RULES
            .replace("from = 'q'", "from = 'q'\nfile = 1")
            .replace("from = 'x'", "from = 'x'\nfile = 2")
    );
    let found = log(&files, &said).unwrap();
    assert_eq!(
        (column(&found, "theta1_rad"), column(&found, "x_m")),
        (vec![1.0, 3.0], vec![6.0, 8.0])
    );
}
