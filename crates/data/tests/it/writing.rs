//! A recording as text, and recordings that are refused.

use haptical_data::{DataError, LogWriter, write_log_to};
use haptical_model::Recording;

use crate::support::{clean, device, single};

fn pair() -> Recording {
    Recording {
        joint: vec![vec![0.25, 0.5]],
        ..Recording::default()
    }
}

fn written(recording: &Recording) -> String {
    let mut bytes = Vec::new();
    write_log_to(&mut bytes, recording, &single()).unwrap();
    String::from_utf8(bytes).unwrap()
}

#[track_caller]
fn refused(recording: &Recording, line: Option<u64>, column: Option<(usize, &str)>) -> DataError {
    let error = write_log_to(Vec::new(), recording, &single()).unwrap_err();
    assert_eq!(
        (error.kind(), error.line()),
        ("invalid-recording", line),
        "{error}"
    );
    assert_eq!(error.column_number().zip(error.column()), column, "{error}");
    error
}

#[test]
fn columns_come_in_the_order_of_the_format() {
    let text = "t_s,run,theta1_rad,theta2_rad,theta3_m,out1_rad,out3_m,cable_m,cable2_m,\
                x_m,y_m,z_m,qw,qx,qy,qz,contact,plane,torque2_nm,fx_n,fy_n,fz_n,temp_degc,a,b\n\
                0,1,0.1,0.2,0.3,0.4,0.5,0.6,0.7,1,2,3,0,1,0,0,\"p,1\",q,4,5,6,7,22,8,9\n\
                1,1,0.1,0.2,0.3,,,,,,,,,,,,,,,,,,,,\n";
    let mut bytes = Vec::new();
    write_log_to(&mut bytes, &clean(text, &device()).recording, &device()).unwrap();
    assert_eq!(String::from_utf8(bytes).unwrap(), text);
}

#[test]
fn extreme_numbers_are_written_short() {
    let values = vec![
        1e-300,
        -0.0,
        1e22,
        0.1 + 0.2,
        f64::MIN_POSITIVE,
        f64::MAX,
        1e-5,
        1e15,
    ];
    let recording = Recording {
        joint: vec![values],
        ..Recording::default()
    };
    assert_eq!(
        written(&recording),
        "theta1_rad\n1e-300\n-0\n1e22\n0.30000000000000004\n2.2250738585072014e-308\n\
         1.7976931348623157e308\n0.00001\n1000000000000000\n"
    );
}

#[test]
fn chunks_follow_each_other_under_one_header() {
    let mut writer = LogWriter::new(Vec::new(), "log.csv", &pair(), &single()).unwrap();
    writer.write_rows(&pair()).unwrap();
    writer.write_rows(&pair()).unwrap();
    let mut other = pair();
    other.time_s = Some(vec![0.0, 1.0]);
    let error = writer.write_rows(&other).unwrap_err();
    assert!(
        error.to_string().contains("the header is `theta1_rad`"),
        "{error}"
    );
    let mut faulty = pair();
    faulty.joint[0][1] = f64::INFINITY;
    assert_eq!(writer.write_rows(&faulty).unwrap_err().line(), Some(7));
}

#[test]
fn readings_that_a_log_cannot_hold_are_refused() {
    let mut recording = pair();
    recording.joint[0][0] = f64::NAN;
    refused(&recording, Some(2), Some((1, "theta1_rad")));

    let mut recording = pair();
    recording.cable_m = vec![Some(vec![1.0, f64::NEG_INFINITY])];
    refused(&recording, Some(3), Some((2, "cable_m")));

    for text in ["two\nlines", " blank", "blank\t"] {
        let contact = Some(vec!["fine".to_owned(), text.to_owned()]);
        refused(
            &Recording { contact, ..pair() },
            Some(3),
            Some((2, "contact")),
        );
    }
    let short = Recording {
        temperature_degc: Some(vec![22.0]),
        ..pair()
    };
    refused(&short, None, Some((2, "temp_degc")));
}

#[test]
fn recordings_of_another_device_are_refused() {
    let two = || vec![vec![0.1, 0.2], vec![0.3, 0.4]];
    refused(
        &Recording {
            joint: two(),
            ..Recording::default()
        },
        None,
        None,
    );
    refused(&Recording::default(), None, None);
    refused(
        &Recording {
            output: vec![None, None],
            ..pair()
        },
        None,
        None,
    );
    refused(
        &Recording {
            torque_nm: vec![None, None],
            ..pair()
        },
        None,
        None,
    );
    let error = refused(
        &Recording {
            cable_m: vec![None, None],
            ..pair()
        },
        None,
        None,
    );
    assert!(
        error
            .to_string()
            .contains("2 cable columns and the device 1"),
        "{error}"
    );
}

#[test]
fn covariates_have_names_of_their_own() {
    for name in ["t_s", "theta1_rad", "theta1_m", "cable_m", "", " a", "a\nb"] {
        let covariates = vec![(name.to_owned(), vec![1.0, 2.0])];
        refused(
            &Recording {
                covariates,
                ..pair()
            },
            Some(1),
            Some((2, name)),
        );
    }
    let column = || ("a".to_owned(), vec![1.0, 2.0]);
    let twice = Recording {
        covariates: vec![column(), column()],
        ..pair()
    };
    refused(&twice, Some(1), Some((3, "a")));
}
