//! Heat maps: cells in their places with their shades, words apart, bad input refused.

use haptical_report::{HeatCell, HeatMap, ReportError};

use crate::picture::Picture;

fn cell(shade: f64, text: &str) -> Option<HeatCell> {
    Some(HeatCell {
        shade,
        text: text.to_owned(),
    })
}

fn map() -> HeatMap {
    let columns = ["joint 1", "joint 2", "device"].map(str::to_owned).to_vec();
    let mut map = HeatMap::new("Candidates", columns);
    let rows = [
        (
            "capstan-compliance",
            [cell(0.1, "41"), cell(1.0, "0"), None],
        ),
        ("cable-latency", [None, None, cell(0.5, "4.6")]),
    ];
    for (name, cells) in rows {
        map.rows.push((name.to_owned(), cells.to_vec()));
    }
    map
}

#[test]
fn cells_stand_under_their_columns_and_behind_their_rows() {
    let picture = Picture::read(&map().to_svg(640).unwrap());
    picture.assert_texts_apart();
    for (text, column, row) in [
        ("41", "joint 1", "capstan-compliance"),
        ("0", "joint 2", "capstan-compliance"),
        ("4.6", "device", "cable-latency"),
    ] {
        let at = picture.find(text).anchor_point;
        assert!(
            (at.0 - picture.find(column).anchor_point.0).abs() < 0.2,
            "{text}"
        );
        assert!(
            (at.1 - picture.find(row).anchor_point.1).abs() < 0.2,
            "{text}"
        );
    }
    assert_eq!(picture.rectangles_of("#5AB4E8").len(), 3);
    // A cell without a value is a dot.
    assert_eq!(picture.circles.len(), 3);
}

#[test]
fn the_shade_is_the_opacity() {
    let svg = map().to_svg(640).unwrap();
    for opacity in ["0.1", "0.5", "1"] {
        let wanted = format!("opacity=\"{opacity}\" fill=\"#5AB4E8\"");
        assert_eq!(svg.matches(&wanted).count(), 1, "{opacity}: {svg}");
    }
    assert_eq!(svg, map().to_svg(640).unwrap());
}

#[test]
fn long_names_are_broken() {
    let mut map = map();
    map.columns = vec!["the whole device and its base".to_owned(); 3];
    map.rows[0].0 = "an effect with a name that is far too long for half a picture".to_owned();
    let picture = Picture::read(&map.to_svg(420).unwrap());
    picture.assert_texts_apart();
    assert!(picture.words.iter().all(|words| words.area.right <= 420.0));
}

#[test]
fn bad_grids_are_refused() {
    let refused = |map: &HeatMap| map.to_svg(640).unwrap_err();
    let empty = HeatMap::new("T", vec!["a".to_owned()]);
    assert!(matches!(
        refused(&empty),
        ReportError::Empty {
            missing: "rows",
            ..
        }
    ));
    assert!(matches!(
        refused(&HeatMap::new("T", Vec::new())),
        ReportError::Empty {
            missing: "columns",
            ..
        }
    ));
    let mut short = map();
    short.rows[1].1.pop();
    assert!(matches!(
        refused(&short),
        ReportError::RowWidth {
            expected: 3,
            got: 2,
            ..
        }
    ));
    let mut odd = map();
    odd.rows[1].1[2] = cell(f64::NAN, "");
    assert!(matches!(
        refused(&odd),
        ReportError::NonFinite { index: 1, .. }
    ));
    assert!(matches!(
        map().to_svg(150),
        Err(ReportError::TooSmall { .. })
    ));
}
