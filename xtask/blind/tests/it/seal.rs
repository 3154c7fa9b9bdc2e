//! Seals open with what was sealed, and with nothing else.

use xtask_blind::{Random, Sealed, Suite, seal};

#[test]
fn a_seal_opens_with_its_truth_alone() {
    let truth = Suite::Singles.draw(0, 5).expect("a trial").truth;
    let sealed = seal(&truth, &mut Random::new(1, 2)).expect("a seal");
    let published = sealed.commitment.clone();
    assert_eq!(published.len(), 64);
    let opened = sealed.open(&published).expect("the truth");
    assert_eq!((&opened.right, opened.joint), (&truth.right, truth.joint));

    let mut altered = sealed.clone();
    altered.truth_json = sealed
        .truth_json
        .replacen("true", "false", 1)
        .replacen('1', "2", 1);
    assert_ne!(altered.truth_json, sealed.truth_json);
    assert!(altered.open(&published).is_err());
    let mut salted = sealed.clone();
    let digit = if sealed.salt.starts_with('0') {
        "1"
    } else {
        "0"
    };
    salted.salt.replace_range(0..1, digit);
    assert!(salted.open(&published).is_err());
}

/// SHA-256 of "salt\ntruth": `printf 'abc\n{}' | sha256sum`.
#[test]
fn a_commitment_can_be_checked_by_hand() {
    let sealed = Sealed {
        commitment: String::new(),
        salt: "abc".to_owned(),
        truth_json: "{}".to_owned(),
    };
    let by_hand = "b4157e40dd21db67528800eb46fe6641eaa5e321734b6890e43e9ce6ed37d91b";
    let error = sealed.open(by_hand).expect_err("no truth in there");
    assert!(
        error.to_string().contains("JSON"),
        "{error}: the hash itself is right"
    );
    assert!(sealed.open(&by_hand.replace('a', "b")).is_err());
}

/// Two seals of one truth have nothing in common: the commitment does not betray a guess.
#[test]
fn the_salt_hides_the_truth() {
    let truth = Suite::Clean.draw(0, 5).expect("a trial").truth;
    let mut random = Random::new(1, 2);
    let first = seal(&truth, &mut random).expect("a seal");
    let second = seal(&truth, &mut random).expect("a seal");
    assert_ne!(first.commitment, second.commitment);
}

#[test]
fn a_seal_opens_after_a_round_trip_through_a_file() {
    for index in 0..10 {
        let truth = Suite::Unknown.draw(index, 8).expect("a trial").truth;
        let sealed = seal(&truth, &mut Random::new(4, 4)).expect("a seal");
        let text = serde_json::to_string_pretty(&sealed).expect("JSON");
        let read: Sealed = serde_json::from_str(&text).expect("a seal");
        assert!(read.open(&sealed.commitment).is_ok());
    }
}
