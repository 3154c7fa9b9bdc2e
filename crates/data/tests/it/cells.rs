//! Rows and cells that are refused.

use haptical_data::Fault;

use crate::support::{device, read, refused, single};

#[test]
fn a_log_needs_two_rows() {
    refused("\ntheta1_rad\n", &single(), "no-rows", Some(2), None);
    refused("theta1_rad", &single(), "no-rows", Some(1), None);
    refused(
        "theta1_rad\n\n0.1\n",
        &single(),
        "too-few-rows",
        Some(3),
        None,
    );
}

#[test]
fn rows_have_as_many_cells_as_the_header() {
    let cases = [
        ("t_s,theta1_rad\n0,0.1\n\n1\n", 4, 1, "cut off"),
        ("t_s,theta1_rad\n0,0.1\n0,5,0,2\n", 3, 4, "decimal sign"),
        ("t_s,theta1_rad\n0,0.1,\n", 2, 3, "a comma too many"),
    ];
    for (text, line, cells, advice) in cases {
        let error = refused(text, &single(), "cell-count", Some(line), None);
        assert!(matches!(error.fault, Fault::CellCount { got, expected: 2, .. } if got == cells));
        assert!(error.to_string().contains(advice), "{error}");
    }
}

#[test]
fn text_is_no_number() {
    for cell in [
        "abc",
        "1.2.3",
        "0x10",
        "1 2",
        "--1",
        "1e",
        "\u{2212}1",
        "NULL",
    ] {
        let text = format!("t_s,theta1_rad,cable_m\n0,0.1,1\n1,0.1,{cell}\n");
        let error = refused(
            &text,
            &single(),
            "not-a-number",
            Some(3),
            Some((3, "cable_m")),
        );
        assert!(
            error
                .to_string()
                .contains(&format!("expected a number, found `{cell}`"))
        );
    }
}

#[test]
fn long_text_is_shortened() {
    let text = format!("theta1_rad\n0.1\n{}\n", "\u{e9}".repeat(1000));
    let error = refused(
        &text,
        &single(),
        "not-a-number",
        Some(3),
        Some((1, "theta1_rad")),
    );
    assert!(error.to_string().chars().count() < 200, "{error}");
}

#[test]
fn a_decimal_comma_is_recognised() {
    let text = "theta1_rad,cable_m\n0.1,1\n\"0,25\",1\n";
    refused(
        text,
        &single(),
        "decimal-comma",
        Some(3),
        Some((1, "theta1_rad")),
    );
}

#[test]
fn numbers_are_finite() {
    let cells = [
        "nan",
        "NaN",
        "-inf",
        "Infinity",
        "1e999",
        "1.#QNAN",
        "-nan(ind)",
        "#DIV/0!",
    ];
    for cell in cells {
        for (column, name) in ["t_s", "theta1_rad", "cable_m", "humidity"]
            .iter()
            .enumerate()
        {
            let mut row = ["1", "0.1", "0.5", "40"];
            row[column] = cell;
            let text = format!(
                "t_s,theta1_rad,cable_m,humidity\n0,0.1,0.5,40\n{}\n",
                row.join(",")
            );
            refused(
                &text,
                &single(),
                "not-finite",
                Some(3),
                Some((column + 1, name)),
            );
        }
    }
}

#[test]
fn joint_readings_are_never_missing() {
    let text = "theta1_rad,theta2_rad,theta3_m\n0.1,0.1,0.1\n\n0.1,  ,0.1\n";
    refused(
        text,
        &device(),
        "missing-reading",
        Some(4),
        Some((2, "theta2_rad")),
    );
}

#[test]
fn an_open_quotation_mark_is_found_where_it_opens() {
    let text = "theta1_rad,contact\n0.1,a\n0.2,\"b\n0.3,c\n0.4,d\n";
    let error = read(text, &single()).unwrap_err();
    assert_eq!((error.kind(), error.line()), ("unclosed-quote", Some(3)));
    assert_eq!(error.column_number(), Some(2));
}

#[test]
fn runs_are_integers() {
    for cell in ["a", "1.5", "", "1e3", "99999999999999999999"] {
        let text = format!("run,theta1_rad\n1,0.1\n{cell},0.1\n");
        refused(
            &text,
            &single(),
            "run-not-integer",
            Some(3),
            Some((1, "run")),
        );
    }
    let log = read("run,theta1_rad\n-3.0,0.1\n-3,0.1\n", &single()).unwrap();
    assert_eq!(log.recording.run, Some(vec![-3, -3]));
}

#[test]
fn distances_are_not_negative() {
    let text = "theta1_rad,theta2_rad,theta3_m,cable_m,cable2_m\n\
                0,0,0,1,0\n0,0,0,1,\n0,0,0,1,-0.001\n";
    let error = refused(
        text,
        &device(),
        "negative-distance",
        Some(4),
        Some((5, "cable2_m")),
    );
    assert!(matches!(error.fault, Fault::NegativeDistance { value_m, .. } if value_m == -0.001));
}

#[test]
fn quaternions_are_neither_zero_nor_scaled() {
    let header = "qx,qy,theta1_rad,qz,qw\n0,0,0.1,0,1\n";
    let zero = format!("{header}0,0,0.1,-0,0\n");
    refused(
        &zero,
        &single(),
        "zero-quaternion",
        Some(3),
        Some((5, "qw")),
    );
    let long = format!("{header}0.6,0,0.1,0,0.802\n");
    let error = refused(
        &long,
        &single(),
        "quaternion-norm",
        Some(3),
        Some((5, "qw")),
    );
    let expected = (0.36_f64 + 0.802 * 0.802).sqrt();
    assert!(matches!(error.fault, Fault::QuaternionNorm { norm, .. } if norm == expected));
    // 0.0009 off is allowed, 0.0011 is not, on either side.
    for (norm, allowed) in [
        (0.9989, false),
        (0.9991, true),
        (1.0009, true),
        (1.0011, false),
    ] {
        let log = read(&format!("{header}0,0,0.1,{norm},0\n"), &single());
        assert_eq!(log.is_ok(), allowed, "norm {norm}");
    }
}

#[test]
fn readings_beyond_any_device_are_refused_where_they_are_squared() {
    let header = "theta1_rad,out1_rad,cable_m,torque1_nm,temp_degc,other";
    for (index, name) in header.split(',').enumerate() {
        let log = |cell: &str| {
            let mut cells = ["0.1"; 6];
            cells[index] = cell;
            format!("{header}\n0.1,0.1,0.1,0.1,0.1,0.1\n{}\n", cells.join(","))
        };
        assert!(read(&log("1e12"), &single()).is_ok(), "{name}");
        if index < 4 {
            let place = Some((index + 1, name));
            let error = refused(
                &log("1.1e12"),
                &single(),
                "reading-too-large",
                Some(3),
                place,
            );
            assert!(error.to_string().contains("`1.1e12`"), "{error}");
        } else {
            assert!(read(&log("1e300"), &single()).is_ok(), "{name}");
        }
    }
}
