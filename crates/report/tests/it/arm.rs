//! Arms: both are drawn, at the stated factor, with words that do not cover each other.

use haptical_report::{ArmPicture, ReportError};

use crate::picture::Picture;

const AFTER: &str = "#0072B2";

fn arm() -> ArmPicture {
    let before = vec![
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 0.4],
        [0.3, 0.0, 0.4],
        [0.3, 0.0, 0.1],
    ];
    let mut after = before.clone();
    after[3][1] += 0.002;
    ArmPicture {
        title: "What moved".to_owned(),
        names: ["as given".to_owned(), "identified".to_owned()],
        up: [0.0, 0.0, 1.0],
        before,
        after,
        notes: vec![
            (1, "joint 1: 0.3 mm".to_owned()),
            (1, "joint 2: 0.2°".to_owned()),
            (3, "handle: 2 mm".to_owned()),
        ],
    }
}

#[test]
fn the_deviation_is_drawn_by_the_stated_factor() {
    let gain = arm().gain();
    // 15 % of 0.4 m are 60 mm, 30 times 2 mm: of 1, 2, 5 times a power of ten the next below
    assert_eq!(gain, 20.0);
    let picture = Picture::read(&arm().to_svg(440, 330).unwrap());
    assert!(picture.has("identified, its deviation drawn 20 times") && picture.has("as given"));
    let line = picture
        .lines_of(AFTER)
        .into_iter()
        .max_by_key(|line| line.points.len());
    let points = &line.unwrap().points;
    // the first link stands upright, seen from 0.42 rad above; the last one hangs down, and its end moved along y, which the
    // view of azimuth 0.9 rad shortens
    let px_per_m = (points[0].1 - points[1].1) / (0.4 * 0.42_f64.cos());
    let wanted = -px_per_m * gain * 0.002 * 0.9_f64.sin();
    assert!(
        (points[3].0 - points[2].0 - wanted).abs() < 0.3,
        "{points:?} {wanted}"
    );
    for (deviation_m, wanted) in [(0.001, 50.0), (0.004, 10.0), (0.05, 1.0), (0.1, 1.0)] {
        let mut own = arm();
        own.after[3][1] = deviation_m;
        assert_eq!(own.gain(), wanted, "{deviation_m}");
    }
}

#[test]
fn words_stand_apart_and_inside() {
    for width in [360, 440, 900] {
        let picture = Picture::read(&arm().to_svg(width, 330).unwrap());
        picture.assert_texts_apart();
        for words in [
            "joint 1: 0.3 mm",
            "joint 2: 0.2°",
            "handle: 2 mm",
            "What moved",
        ] {
            let lines: Vec<&str> = picture.words.iter().map(|own| own.text.as_str()).collect();
            assert!(lines.join(" ").contains(words), "{words}: {lines:?}");
        }
    }
}

#[test]
fn an_arm_that_did_not_move_is_drawn_as_it_is() {
    let mut arm = arm();
    arm.after = arm.before.clone();
    assert_eq!(arm.gain(), 1.0);
    assert!(!arm.to_svg(440, 330).unwrap().contains("times"));
}

#[test]
fn bad_arms_are_refused() {
    let mut short = arm();
    short.after.pop();
    assert!(matches!(
        short.to_svg(440, 330),
        Err(ReportError::PointCount { got: 3, .. })
    ));
    let mut odd = arm();
    odd.after[1][2] = f64::NAN;
    assert!(matches!(
        odd.to_svg(440, 330),
        Err(ReportError::NonFinite { index: 1, .. })
    ));
    let mut point = arm();
    point.before = vec![[1.0; 3]; 2];
    point.after = point.before.clone();
    assert!(matches!(
        point.to_svg(440, 330),
        Err(ReportError::Empty { .. })
    ));
    assert!(matches!(
        arm().to_svg(440, 120),
        Err(ReportError::TooSmall { .. })
    ));
}
