//! A readable log in memory.

use haptical_data::LogShape;

use crate::support::{clean, device, read, revolute, single};

const FULL: &str = "\
t_s,run,theta1_rad,theta2_rad,theta3_m,out2_rad,out3_m,cable_m,cable2_m,x_m,y_m,z_m,qw,qx,qy,qz,\
contact,plane,torque1_nm,torque3_nm,fx_n,fy_n,fz_n,temp_degc,humidity
0.0,1,0.1,0.2,0.3,0.21,0.31,0.5,0.6,1,2,3,1,0,0,0,ball,,7,9,10,11,12,22.5,40
0.1,1,0.4,0.5,0.6,,0.61,,0.7,4,5,6,0,0,0,-1,,floor,8,,13,14,15,,41
0.0,2,0.7,0.8,0.9,0.81,,0.8,,,,,,,,,,,,,,,,22.7,
";

#[test]
fn each_column_goes_to_its_field() {
    let recording = clean(FULL, &device()).recording;
    assert_eq!(recording.line, [2, 3, 4]);
    assert_eq!(recording.time_s, Some(vec![0.0, 0.1, 0.0]));
    assert_eq!(recording.run, Some(vec![1, 1, 2]));
    assert_eq!(
        recording.joint,
        [[0.1, 0.4, 0.7], [0.2, 0.5, 0.8], [0.3, 0.6, 0.9]]
    );
    assert_eq!(recording.output.len(), 3);
    assert_eq!(recording.output[0], None);
    let second = recording.output[1].as_deref().unwrap();
    assert_eq!(
        (second[0], second[1].is_nan(), second[2]),
        (0.21, true, 0.81)
    );
    assert_eq!(recording.output[2].as_deref().unwrap()[..2], [0.31, 0.61]);
    assert_eq!(recording.cable_m[0].as_deref().unwrap()[2], 0.8);
    assert_eq!(recording.cable_m[1].as_deref().unwrap()[..2], [0.6, 0.7]);
    let position = recording.position_m.unwrap();
    assert_eq!(position.each_ref().map(|axis| axis[1]), [4.0, 5.0, 6.0]);
    assert!(position.iter().all(|axis| axis[2].is_nan()));
    let orientation = recording.orientation_wxyz.unwrap();
    assert_eq!(
        orientation.each_ref().map(|part| part[0]),
        [1.0, 0.0, 0.0, 0.0]
    );
    assert_eq!(
        orientation.each_ref().map(|part| part[1]),
        [0.0, 0.0, 0.0, -1.0]
    );
    assert_eq!(recording.contact.unwrap(), ["ball", "", ""]);
    assert_eq!(recording.plane.unwrap(), ["", "floor", ""]);
    assert_eq!(recording.torque_nm[0].as_deref().unwrap()[..2], [7.0, 8.0]);
    assert_eq!(recording.torque_nm[1], None);
    assert_eq!(recording.torque_nm[2].as_deref().unwrap()[0], 9.0);
    assert_eq!(
        recording.force_n.unwrap().map(|axis| axis[1]),
        [13.0, 14.0, 15.0]
    );
    assert_eq!(recording.temperature_degc.unwrap()[2], 22.7);
    assert_eq!(recording.covariates[0].0, "humidity");
    assert_eq!(recording.covariates[0].1[..2], [40.0, 41.0]);
}

#[test]
fn byte_order_mark_carriage_returns_blanks_and_blank_lines_change_only_the_lines() {
    let plain = clean("t_s,theta1_rad\n0,0.1\n1,0.2\n2,0.3\n", &single()).recording;
    let odd = "\u{feff}\r\n t_s ,\ttheta1_rad \r\n\r\n  \r\n 0, 0.1 \r\n1,0.2\r\n\r\n2,+3e-1";
    let mut read = clean(odd, &single()).recording;
    assert_eq!(read.line, [5, 6, 8]);
    read.line.clone_from(&plain.line);
    assert_eq!(read, plain);
    let old = clean("t_s,theta1_rad\r\r0,0.1\r1,0.2\r2,0.3\r", &single()).recording;
    assert_eq!((old.line, old.joint), (vec![3, 4, 5], plain.joint));
}

#[test]
fn quoted_cells_are_unquoted() {
    let text = "\"theta1_rad\",contact\n\"0.1\",\"left, \"\"low\"\"\"\n0.2,right\n";
    let recording = clean(text, &single()).recording;
    assert_eq!(recording.contact.unwrap(), ["left, \"low\"", "right"]);
}

#[test]
fn covariates_come_by_name_whatever_their_order_in_the_file() {
    let one = clean("theta1_rad,b,a\n0.1,1,2\n0.2,3,4\n", &single()).recording;
    let other = clean("a,theta1_rad,b\n2,0.1,1\n4,0.2,3\n", &single()).recording;
    assert_eq!(one, other);
    assert_eq!(one.covariates[0], ("a".to_owned(), vec![2.0, 4.0]));
}

#[test]
fn a_cable_the_device_does_not_have_is_a_covariate_with_a_warning() {
    let text = "theta1_rad,cable_m,cable2_m\n0.1,1,2\n0.2,3,4\n";
    let log = read(text, &single()).unwrap();
    assert_eq!(log.recording.cable_m, [Some(vec![1.0, 3.0])]);
    assert_eq!(
        log.recording.covariates,
        [("cable2_m".to_owned(), vec![2.0, 4.0])]
    );
    assert_eq!(log.warnings.len(), 1);
    assert!(log.warnings[0].starts_with("log.csv, line 1, column 3 `cable2_m`: the device file"));

    let without = LogShape {
        cable_count: 0,
        ..single()
    };
    let log = read(text, &without).unwrap();
    assert_eq!(log.recording.cable_m, []);
    assert_eq!((log.recording.covariates.len(), log.warnings.len()), (2, 2));
}

#[test]
fn joints_the_device_does_not_have_are_covariates_with_a_warning() {
    let text = "theta1_rad,theta2_rad,torque2_nm,out2_rad\n0.1,1,2,3\n0.2,3,4,5\n";
    let log = read(text, &single()).unwrap();
    assert_eq!((log.recording.covariates.len(), log.warnings.len()), (3, 3));
}

#[test]
fn columns_that_are_close_to_a_known_name_are_covariates_with_advice() {
    let text = "theta1_rad,cable_mm,Temp_C,tau1,time\n0.1,1,2,3,4\n0.2,3,4,5,6\n";
    let log = read(text, &single()).unwrap();
    assert_eq!(log.recording.covariates.len(), 4);
    let advice: Vec<&str> = log
        .warnings
        .iter()
        .map(|text| text.rsplit(", ").next().unwrap())
        .collect();
    assert_eq!(
        advice,
        [
            "convert column 2 `cable_mm` to m and rename it `cable_m`",
            "rename column 3 `Temp_C` to `temp_degc` if it is in degc",
            "rename column 4 `tau1` to `torque1_nm` if it is in nm",
            "rename column 5 `time` to `t_s` if it is in s",
        ]
    );
}

#[test]
fn text_and_nameless_columns_are_left_out_with_a_warning() {
    let log = read(",theta1_rad,operator,\n0,0.1,7,\n1,0.2,Ada,\n", &single()).unwrap();
    assert_eq!(log.recording.covariates, []);
    assert_eq!(log.warnings.len(), 3, "{:?}", log.warnings);
    assert_eq!(
        log.warnings[2],
        "log.csv, line 3, column 3 `operator`: `Ada` is no number; the column is left out"
    );
}

#[test]
fn columns_without_one_reading_are_absent_with_a_warning() {
    let text = "t_s,theta1_rad,out1_rad,cable_m,contact,temp_degc,spare,x_m,y_m,z_m\n\
                ,0.1,,,,,,,,\n,0.2,,,,,,,,\n";
    let log = read(text, &single()).unwrap();
    assert_eq!(log.warnings.len(), 7, "{:?}", log.warnings);
    let recording = log.recording;
    assert_eq!((recording.time_s, recording.contact), (None, None));
    assert_eq!(
        (recording.output, recording.cable_m),
        (vec![None], vec![None])
    );
    assert_eq!(
        (recording.temperature_degc, recording.position_m),
        (None, None)
    );
    assert_eq!(recording.covariates, []);
}

#[test]
fn a_row_with_a_part_of_a_position_has_no_position() {
    let text = "theta1_rad,x_m,y_m,z_m\n0.1,1,2,3\n0.2,4,,6\n0.3,7,8,9\n0.4,,,12\n0.5,,,\n";
    let log = read(text, &single()).unwrap();
    let position = log.recording.position_m.unwrap();
    for axis in &position {
        let given: Vec<bool> = axis.iter().map(|value| !value.is_nan()).collect();
        assert_eq!(given, [true, false, true, false, false]);
    }
    assert_eq!(log.warnings.len(), 1);
    assert!(log.warnings[0].starts_with("log.csv, line 3: only a part of x_m, y_m, z_m"));
    assert!(
        log.warnings[0].contains("in 1 further rows"),
        "{}",
        log.warnings[0]
    );
}

#[test]
fn orientations_are_scaled_to_norm_one() {
    // (0.6, 0, 0.8, 0) times 1.0005, within the allowed 0.001.
    let text = "theta1_rad,qw,qx,qy,qz\n0.1,0.6003,0,0.8004,0\n0.2,0.6,0,0.8,0\n";
    let orientation = clean(text, &single()).recording.orientation_wxyz.unwrap();
    // One rounding of the quotient.
    const ROUNDING: f64 = 4.0 * f64::EPSILON;
    assert!((orientation[0][0] - 0.6).abs() < ROUNDING);
    assert!((orientation[2][0] - 0.8).abs() < ROUNDING);
    assert_eq!(orientation.map(|part| part[1]), [0.6, 0.0, 0.8, 0.0]);
}

#[test]
fn a_hundred_columns_of_joints_keep_their_order() {
    let joints: Vec<_> = (1..=100)
        .map(|joint| revolute(&joint.to_string()))
        .collect();
    let shape = LogShape {
        joints,
        cable_count: 0,
        hands: Vec::new(),
    };
    let header: Vec<String> = (1..=100)
        .rev()
        .map(|joint| format!("theta{joint}_rad"))
        .collect();
    let row: Vec<String> = (1..=100)
        .rev()
        .map(|joint| format!("{}", f64::from(joint) / 100.0))
        .collect();
    let text = format!(
        "{}\n{}\n{}\n",
        header.join(","),
        row.join(","),
        row.join(",")
    );
    let recording = clean(&text, &shape).recording;
    for (joint, column) in recording.joint.iter().enumerate() {
        assert_eq!(column[1], (joint + 1) as f64 / 100.0);
    }
}
