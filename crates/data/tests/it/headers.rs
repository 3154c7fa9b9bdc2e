//! Headers that are refused.

use haptical_data::{Fault, LogShape};

use crate::support::{device, read, refused, single};

#[test]
fn an_empty_file_has_no_header() {
    for text in ["", "\n\n", "  \r\n"] {
        refused(text, &single(), "no-header", Some(1), None);
    }
}

#[test]
fn numbers_are_no_header() {
    let error = refused(
        "\n1.4e+00,-0.9\n1.6,-0.9\n",
        &single(),
        "no-header",
        Some(2),
        None,
    );
    assert!(error.to_string().contains("1.4e+00"), "{error}");
}

#[test]
fn other_separators_are_named() {
    let cases = [
        ("t_s;theta1_rad\n0,5;0,1\n", "semicolons"),
        ("t_s\ttheta1_rad\n0\t0.1\n", "tabs"),
        ("t_s|theta1_rad\n0|0.1\n", "bars"),
        ("t_s theta1_rad\n0 0.1\n", "spaces"),
        ("0;1;0,2\n", "semicolons"),
    ];
    for (text, words) in cases {
        let error = refused(text, &single(), "wrong-separator", Some(1), None);
        assert!(error.to_string().contains(words), "{error}");
    }
}

#[test]
fn duplicate_columns_are_refused() {
    let text = "t_s,theta1_rad, t_s ,theta1_rad\n0,0,0,0\n";
    let error = refused(
        text,
        &single(),
        "duplicate-column",
        Some(1),
        Some((3, "t_s")),
    );
    assert!(
        matches!(error.fault, Fault::DuplicateColumn { first: 1, .. }),
        "{error}"
    );
}

#[test]
fn missing_joints_are_named_with_their_near_misses() {
    let text = "t_s,theta1,theta_2_deg,slide\n0,1,2,3\n";
    let error = read(text, &device()).unwrap_err();
    assert_eq!((error.kind(), error.line()), ("missing-column", Some(1)));
    assert_eq!(
        (error.column(), error.column_number()),
        (Some("theta1_rad"), None)
    );
    let message = error.to_string();
    assert!(
        message.contains("missing `theta1_rad`, `theta2_rad`, `theta3_m`;"),
        "{message}"
    );
    assert!(message.contains("rename column 2 `theta1` to `theta1_rad` if it is in rad"));
    assert!(message.contains("convert column 3 `theta_2_deg` to rad and rename it `theta2_rad`"));
    let Fault::MissingColumn {
        near_misses,
        required,
        ..
    } = &error.fault
    else {
        panic!("another variant");
    };
    assert_eq!(*required, ["theta1_rad", "theta2_rad", "theta3_m"]);
    let found: Vec<(usize, bool)> = near_misses
        .iter()
        .map(|miss| (miss.column_number, miss.convert))
        .collect();
    assert_eq!(found, [(2, false), (3, true)]);
}

#[test]
fn near_misses_understand_other_spellings() {
    let spellings = [
        "Theta1_rad",
        "theta01_rad",
        "joint1",
        "q1",
        "theta1 [rad]",
        "# theta1_rad",
    ];
    for name in spellings {
        let error = read(&format!("run,{name}\n0,1\n"), &single()).unwrap_err();
        let Fault::MissingColumn { near_misses, .. } = &error.fault else {
            panic!("another variant for {name}: {error}");
        };
        let found: Vec<(&str, bool)> = near_misses
            .iter()
            .map(|miss| (miss.found.as_str(), miss.convert))
            .collect();
        assert_eq!(found, [(name, false)]);
    }
}

#[test]
fn joints_counted_from_zero_are_told_to_shift() {
    let shape = LogShape {
        joints: device().joints[..2].to_vec(),
        cable_count: 0,
        hands: Vec::new(),
    };
    let error = read("theta0_rad,theta1_rad\n0,0\n0,0\n", &shape).unwrap_err();
    let message = error.to_string();
    assert_eq!(error.column(), Some("theta2_rad"));
    assert!(
        message.contains("rename column 1 `theta0_rad` to `theta1_rad`"),
        "{message}"
    );
    assert!(
        message.contains("rename column 2 `theta1_rad` to `theta2_rad`"),
        "{message}"
    );
}

#[test]
fn units_of_the_other_type_of_joint_are_refused() {
    let cases = [
        (
            "theta1_rad,theta2_rad,theta3_rad\n",
            3,
            "theta3_rad",
            "theta3_m",
        ),
        (
            "theta1_rad,theta2_m,theta3_m\n",
            2,
            "theta2_m",
            "theta2_rad",
        ),
        (
            "theta1_rad,theta2_rad,theta3_m,out3_rad\n",
            4,
            "out3_rad",
            "out3_m",
        ),
        (
            "theta1_rad,theta2_rad,theta3_m,out1_m\n",
            4,
            "out1_m",
            "out1_rad",
        ),
        (
            "theta1_rad,theta2_rad,theta3_m,out1_deg\n",
            4,
            "out1_deg",
            "out1_rad",
        ),
        (
            "theta1_rad,theta2_rad,theta3_m,out3_mm\n",
            4,
            "out3_mm",
            "out3_m",
        ),
    ];
    for (text, number, name, wanted) in cases {
        let error = refused(text, &device(), "wrong-unit", Some(1), Some((number, name)));
        let Fault::WrongUnit { expected, .. } = &error.fault else {
            panic!("another variant: {error}");
        };
        assert_eq!(expected, wanted);
    }
}

#[test]
fn another_unit_beside_the_right_one_is_a_covariate() {
    let text = "theta1_rad,out1_rad,out1_deg\n0.1,0.1,5.7\n0.2,0.2,11.5\n";
    let log = read(text, &single()).unwrap();
    assert_eq!(log.recording.covariates[0].0, "out1_deg");
}

#[test]
fn a_part_of_a_vector_is_refused() {
    let cases = [
        ("theta1_rad,x_m,z_m\n", (2, "x_m"), vec!["y_m"]),
        ("qz,qw,theta1_rad\n", (1, "qz"), vec!["qx", "qy"]),
        ("theta1_rad,fy_n\n", (2, "fy_n"), vec!["fx_n", "fz_n"]),
    ];
    for (text, place, names) in cases {
        let error = refused(text, &single(), "incomplete-group", Some(1), Some(place));
        let Fault::IncompleteGroup { missing, .. } = &error.fault else {
            panic!("another variant: {error}");
        };
        assert_eq!(*missing, names);
        assert!(names.iter().all(|name| error.to_string().contains(name)));
    }
}

#[test]
fn a_device_without_joints_is_refused() {
    let shape = LogShape {
        joints: Vec::new(),
        cable_count: 1,
        hands: Vec::new(),
    };
    refused(
        "t_s,cable_m\n0,1\n1,1\n",
        &shape,
        "invalid-shape",
        None,
        None,
    );
}
