//! Refusals: kind, place and next step, whatever was wrong.

use haptical::identification::Interrupt;
use haptical::prelude::*;

const DEVICE: &str = "[[joint]]\nexternal_encoder_counts_per_rev = 20000\n";

fn log_of(text: &str) -> Result<Log, Error> {
    let device = Device::from_toml(DEVICE, "device.toml")?;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    std::fs::write(&path, text).unwrap();
    Log::read(path, &device)
}

#[test]
fn a_cell_that_is_no_number_is_named_by_line_and_column() {
    let refused = log_of("theta1_rad,out1_rad\n0.1,0.1\n0.2,abc\n").unwrap_err();
    assert_eq!(refused.kind(), ErrorKind::BadInput);
    assert_eq!(refused.place().line, Some(3));
    assert_eq!(refused.place().column_name.as_deref(), Some("out1_rad"));
    assert!(refused.what().contains("`abc`"), "{refused}");
    assert!(!refused.next_step().is_empty());
    assert!(refused.to_string().contains("log.csv:3:"), "{refused}");
}

#[test]
fn a_table_of_another_maker_is_sent_to_import_and_a_log_with_a_fault_is_not() {
    for foreign in ["t;q1\n0;0,1\n0;0,2\n", "time,q1\n0,0.1\n1,0.2\n"] {
        let refused = log_of(foreign).unwrap_err();
        let next = refused.next_step();
        assert!(
            next.contains("haptical import --guess ") && next.contains("log.csv"),
            "{next}"
        );
    }
    let refused = log_of("theta1_rad,out1_rad\n0.1,0.1\n0.2,abc\n").unwrap_err();
    assert!(!refused.next_step().contains("import"), "{refused}");
}

#[test]
fn a_file_that_is_not_there_is_not_found() {
    for refused in [
        Device::load("no-such.toml").unwrap_err(),
        Log::read(
            "no-such.csv",
            &Device::from_toml(DEVICE, "device.toml").unwrap(),
        )
        .unwrap_err(),
    ] {
        assert_eq!(refused.kind(), ErrorKind::NotFound, "{refused}");
        assert!(refused.place().file.starts_with("no-such"), "{refused}");
    }
}

#[test]
fn a_log_at_one_pose_identifies_nothing() {
    let device = Device::from_toml(DEVICE, "device.toml").unwrap();
    let log = log_of(&format!("theta1_rad,out1_rad\n{}", "0.1,0.1\n".repeat(60))).unwrap();
    let refused = identify(&device, &log, &Identify::default()).unwrap_err();
    assert_eq!(refused.kind(), ErrorKind::Unidentifiable);
    assert_eq!(refused.name(), "no-motion");
}

#[test]
fn the_log_of_the_fit_is_no_second_log() {
    let device = Device::from_toml(DEVICE, "device.toml").unwrap();
    let rows: String = (0..80)
        .map(|row| format!("{0},{0}\n", 0.01 * f64::from(row)))
        .collect();
    let log = log_of(&format!("theta1_rad,out1_rad\n{rows}")).unwrap();
    let request = Diagnose {
        validate: Some(&log),
        ..Diagnose::default()
    };
    let refused = diagnose(&device, &log, &request).unwrap_err();
    assert_eq!(refused.name(), "same-log");
}

#[test]
fn what_is_asked_to_stop_gives_no_result() {
    let device = Device::from_toml(DEVICE, "device.toml").unwrap();
    let row = |row: i32| format!("{0},{0}\n", 0.01 * f64::from(row));
    let rows: String = (0..80).map(row).collect();
    let log = log_of(&format!("theta1_rad,out1_rad\n{rows}")).unwrap();
    let interrupt = Interrupt::default();
    let mut asked = Identify::default();
    asked.options.search.interrupt = interrupt.clone();
    let request = Diagnose {
        interrupt: interrupt.clone(),
        ..Diagnose::default()
    };
    assert!(identify(&device, &log, &asked).is_ok() && diagnose(&device, &log, &request).is_ok());
    interrupt.request();
    let refused = identify(&device, &log, &asked).unwrap_err();
    assert_eq!(refused.kind(), ErrorKind::Interrupted, "{refused}");
    let refused = diagnose(&device, &log, &request).unwrap_err();
    assert_eq!(refused.kind(), ErrorKind::Interrupted, "{refused}");
}

#[test]
fn a_number_without_its_unit_is_told_its_name() {
    let refuse = |key: &str| {
        let text = format!("{DEVICE}[[effect]]\nname = \"backlash\"\njoint = 1\n{key} = 2e-3\n");
        Device::from_toml(&text, "device.toml").unwrap_err()
    };
    let refused = refuse("width");
    assert!(
        refused
            .what()
            .ends_with("`width`: the name of a number ends in its unit"),
        "{refused}"
    );
    assert!(
        refused
            .next_step()
            .starts_with("write `width_rad`. Its parameters are: width_rad"),
        "{refused}"
    );
    let refused = refuse("widht_rad");
    assert!(
        refused.what().ends_with("no parameter `widht_rad`"),
        "{refused}"
    );
    assert!(
        refused
            .next_step()
            .starts_with("did you mean `width_rad`? Its parameters are: "),
        "{refused}"
    );
}
