//! The column `hand` of devices with several hands.

use haptical_data::{Fault, LogShape, write_log_to};

use crate::support::{clean, read, refused, single};

fn two_hands() -> LogShape {
    LogShape {
        hands: vec!["left".to_owned(), "right".to_owned()],
        ..single()
    }
}

#[test]
fn each_row_names_a_hand() {
    let text = "theta1_rad,hand,x_m,y_m,z_m\n0.5,left,1,2,3\n0.5, right ,4,5,6\n";
    let recording = clean(text, &two_hands()).recording;
    assert_eq!(recording.hand.as_ref().unwrap(), &["left", "right"]);
    assert_eq!(recording.select(&[1]).hand.unwrap(), ["right"]);
    let mut written = Vec::new();
    write_log_to(&mut written, &recording, &two_hands()).unwrap();
    let again = read(&String::from_utf8(written).unwrap(), &two_hands()).unwrap();
    assert_eq!(again.recording, recording);
}

#[test]
fn other_hands_are_refused_with_their_place() {
    let text = "theta1_rad,hand\n0,left\n0,foot\n";
    let error = refused(
        text,
        &two_hands(),
        "unknown-hand",
        Some(3),
        Some((2, "hand")),
    );
    assert!(
        error
            .to_string()
            .contains("no hand `foot`; name `left`, `right` in each row"),
        "{error}"
    );
    let text = "theta1_rad,hand\n0,left\n0,\n";
    refused(
        text,
        &two_hands(),
        "unknown-hand",
        Some(3),
        Some((2, "hand")),
    );
    let text = "theta1_rad,hand\n0,\n0,\n";
    refused(
        text,
        &two_hands(),
        "unknown-hand",
        Some(2),
        Some((2, "hand")),
    );
    let error = refused(
        "theta1_rad\n0\n0\n",
        &two_hands(),
        "no-hand-column",
        Some(1),
        None,
    );
    assert!(matches!(&error.fault, Fault::NoHandColumn { hands } if hands.len() == 2));
    let text = "theta1_rad,hand\n0,left\n0,left\n";
    let error = refused(text, &single(), "hand-column", Some(1), Some((2, "hand")));
    assert!(
        error
            .to_string()
            .contains("the device file has no [[hand]]"),
        "{error}"
    );
}
