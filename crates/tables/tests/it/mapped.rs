//! The mapping file: units, counts, values, names; what contradicts itself.

use haptical_tables::Mapping;

use crate::support::{close, column, log, texts};

const TABLE: &str = "q;count;x;who\n90;5096;10;a\n-45;0;20;b\n0;1000;30;c\n";

#[test]
fn units_counts_and_signs_are_applied_once() {
    let rules = "
[[column]]
log = 'theta1_rad'
from = 'q'
unit = 'deg'
factor = -1
offset = 0.1
[[column]]
log = 'theta2_rad'
from = 'count'
counts_per_turn = 4096
zero_counts = 1000
[[column]]
log = 'x_m'
from = 'x'
unit = 'in'
[[column]]
log = 'contact'
from = 'who'
";
    let log = log(&[TABLE], rules).unwrap();
    let quarter = std::f64::consts::FRAC_PI_2;
    close(
        &column(&log, "theta1_rad"),
        &[0.1 - quarter, 0.1 + quarter / 2.0, 0.1],
        1e-15,
    );
    let turn = std::f64::consts::TAU;
    close(
        &column(&log, "theta2_rad"),
        &[turn, -turn * 1000.0 / 4096.0, 0.0],
        1e-15,
    );
    close(&column(&log, "x_m"), &[0.254, 0.508, 0.762], 1e-15);
    assert_eq!(texts(&log, "contact"), ["a", "b", "c"]);
}

#[test]
fn values_stand_in_turn_and_by_run() {
    let rules = "
[[column]]
log = ['theta1_rad', 'x_m']
from = ['q', '#3']
[[column]]
log = 'contact'
value = ['left', 'right']
[[column]]
log = 'plane'
by_run = ['top', ['a', 'b', 'c']]
[[column]]
log = 'torque1_nm'
value = 2
";
    let log = log(&[TABLE, TABLE], rules).unwrap();
    assert_eq!(
        texts(&log, "contact"),
        ["left", "right", "left", "left", "right", "left"]
    );
    assert_eq!(texts(&log, "plane"), ["top", "top", "top", "a", "b", "c"]);
    assert_eq!(column(&log, "run"), [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    assert_eq!(column(&log, "torque1_nm"), [2.0; 6]);
    assert_eq!(column(&log, "x_m")[3..], [10.0, 20.0, 30.0]);
}

#[test]
fn rows_are_taken_and_counted() {
    let rules = "
[rows]
first = 2
every = 2
rate_hz = 200
[[column]]
log = 'theta1_rad'
from = '#1'
";
    let log = log(&["0\n1\n2\n3\n4\n5\n"], rules).unwrap();
    assert_eq!(column(&log, "theta1_rad"), [1.0, 3.0, 5.0]);
    // the time is that of the file's rows, not of those that are left
    close(&column(&log, "t_s"), &[0.005, 0.015, 0.025], 1e-15);
}

#[test]
fn mappings_that_contradict_themselves_are_refused() {
    let joint = "[[column]]\nlog = 'theta1_rad'\nfrom = 'q'\n";
    for (text, word) in [
        ("[[column]]\nfrom = 'q'\n", "without `log`"),
        ("[[column]]\nlog = 'x_m'\n", "one of from, value"),
        (
            "[[column]]\nlog = 'x_m'\nfrom = 'x'\nvalue = 1\n",
            "one of from, value",
        ),
        (
            "[[column]]\nlog = ['x_m', 'y_m']\nfrom = 'x'\n",
            "2 names in `log` and 1",
        ),
        (&format!("{joint}{joint}"), "`theta1_rad` is given twice"),
        (
            &format!("{joint}unit = 'mm'\n"),
            "`mm` is no unit of `theta1_rad`",
        ),
        (&format!("{joint}unit = 'grad'\n"), "no unit that is known"),
        (
            &format!("{joint}unit = 'deg'\ncounts_per_turn = 10\n"),
            "both unit and counts",
        ),
        (
            &format!("{joint}counts_per_turn = 0\n"),
            "needs its counts_per_turn",
        ),
        (
            &format!("{joint}zero_counts = 4\n"),
            "without counts_per_turn",
        ),
        (&format!("{joint}factor = nan\n"), "other than 0"),
        (
            "[[column]]\nlog = 'contact'\nfrom = 'q'\nfactor = 2\n",
            "holds names",
        ),
        (
            "[[column]]\nlog = 'x_m'\nfrom = 'q'\ncounts_per_turn = 2\n",
            "no angle",
        ),
        ("[rows]\nfirst = 0\n", "count from 1"),
        ("[rows]\nrate_hz = 0\n", "above 0"),
        (
            "[rows]\nrate_hz = 1\n[[column]]\nlog = 't_s'\nfrom = 't'\n",
            "keep one",
        ),
        ("[rows]\nmatch = 'nearest'\n", "unknown variant"),
        ("[table]\nseparator = ':'\n", "none that is known"),
        ("[table]\ndecimal = \"'\"\n", "no decimal sign"),
        ("[table]\nencoding = 'ebcdic'\n", "neither utf-8"),
        (
            "[orientation]\nkind = 'euler'\nfrom = ['a', 'b', 'c']\naxes = 'intrinsic'\n",
            "need an order",
        ),
        (
            "[orientation]\nkind = 'euler'\nfrom = ['a', 'b', 'c']\norder = 'xyz'\n",
            "moved",
        ),
        (
            "[orientation]\nkind = 'euler'\nfrom = ['a', 'b']\n",
            "2 columns",
        ),
        (
            "[orientation]\nkind = 'quaternion'\nfrom = ['a', 'b', 'c', 'd']\n",
            "wxyz",
        ),
        (
            "[orientation]\nkind = 'rotation_vector'\nfrom = ['a', 'b', 'c']\nunit = 'mm'\n",
            "no unit of it",
        ),
        ("[orientation]\nkind = 'pose'\nfrom = ['a']\n", "1 columns"),
        ("colums = 1\n", "unknown field"),
        ("[[column]\n", ""),
    ] {
        let error = Mapping::from_toml(text, "columns.toml").unwrap_err();
        assert!(
            error.what.contains(word) && error.kind == "bad-mapping",
            "{text}: {error}"
        );
    }
}

#[test]
fn what_the_files_do_not_have_is_refused() {
    let one =
        |log_name: &str, from: &str| format!("[[column]]\nlog = '{log_name}'\nfrom = '{from}'\n");
    for (rules, word) in [
        (one("theta1_rad", "z"), "the table has: q, count, x, who"),
        (one("theta1_rad", "#9"), "the table has 4"),
        (one("theta1_rad", "who"), "expected a number, found `a`"),
        (one("theta1_rad", "q") + "file = 2\n", "a run has 1"),
        (one("run", "q") + "factor = 1\n", ""),
        (
            "[[column]]\nlog = 'x_m'\nvalue = 'a'\n".to_owned(),
            "a text",
        ),
        (
            "[[column]]\nlog = 'x_m'\nvalue = []\n".to_owned(),
            "empty list",
        ),
        (
            "[[column]]\nlog = 'x_m'\nby_run = []\n".to_owned(),
            "this is run 1",
        ),
        (
            "[rows]\nfirst = 9\n".to_owned() + &one("theta1_rad", "q"),
            "no row is taken",
        ),
        (
            "[rows]\nfiles_per_run = 2\n".to_owned() + &one("theta1_rad", "q"),
            "1 files, and files_per_run is 2",
        ),
    ] {
        match log(&[TABLE], &rules) {
            Err(error) => assert!(error.to_string().contains(word), "{rules}: {error}"),
            Ok(_) => assert_eq!(word, "", "{rules}"),
        }
    }
    let error = log(&["q\n1.5\n2\n"], "[[column]]\nlog = 'run'\nfrom = 'q'\n").unwrap_err();
    assert!(
        error.what.contains("whole number") && error.line == Some(2),
        "{error}"
    );
}

/// Where the mapping is silent the file's unit counts; where they contradict, it is said which was taken.
#[test]
fn a_unit_that_the_file_says_is_not_passed_over() {
    let text = "q1 [deg],x [mm],y [mm],z [mm]\n90,1,2,3\n45,1,2,3\n";
    let rules = |unit: &str| {
        let own =
            |log: &str, from: &str| format!("[[column]]\nlog = \"{log}\"\nfrom = \"{from}\"\n");
        format!(
            "{}{unit}{}",
            own("theta1_rad", "q1 [deg]"),
            own("x_m", "x [mm]")
        )
    };
    let silent = log(&[text], &rules("")).unwrap();
    assert!((column(&silent, "theta1_rad")[1] - std::f64::consts::FRAC_PI_4).abs() < 1e-12);
    assert_eq!(column(&silent, "x_m"), [1e-3, 1e-3]);
    assert!(silent.warnings.is_empty());
    let other = log(&[text], &rules("unit = \"rad\"\n")).unwrap();
    assert_eq!(column(&other, "theta1_rad")[0], 90.0);
    assert!(other.warnings[0].contains("says deg") && other.warnings[0].contains("rad was taken"));
}
