//! Rows of bars: lengths, connections, words apart, bad input refused.

use haptical_report::{BarRow, BarRows, ReportError};

use crate::picture::Picture;

fn row(name: &str, from: f64, to: f64, colour: usize) -> BarRow {
    BarRow {
        name: name.to_owned(),
        from,
        to,
        colour,
        value: format!("{:.2} mrad", (to - from).abs()),
    }
}

fn waterfall() -> BarRows {
    let mut bars = BarRows::new("Gap of out2", "root mean square residual [mrad]");
    bars.rows = vec![
        row("before", 0.0, 1.2, 0),
        row("capstan-compliance, joint 2", 1.2, 0.4, 2),
        row("left", 0.0, 0.4, 1),
    ];
    bars.connected = true;
    bars
}

const BLUE: &str = "#0072B2";
const VERMILION: &str = "#D55E00";
const GREEN: &str = "#009E73";

#[test]
fn bars_are_as_long_as_their_values_and_hang_on_the_axis() {
    let picture = Picture::read(&waterfall().to_svg(700).unwrap());
    let only = |colour| {
        let found = picture.rectangles_of(colour);
        assert_eq!(found.len(), 1, "{colour}");
        found[0]
    };
    let (before, step, left) = (only(BLUE), only(GREEN), only(VERMILION));
    let plot = picture.plot();
    let px_per_mrad = (before.right - before.left) / 1.2;
    // Places are rounded to a tenth of a px.
    for (bar, from, to) in [(before, 0.0, 1.2), (step, 0.4, 1.2), (left, 0.0, 0.4)] {
        assert!((bar.left - plot.left - px_per_mrad * from).abs() < 0.2);
        assert!((bar.right - plot.left - px_per_mrad * to).abs() < 0.2);
        assert!(bar.top > plot.top && bar.bottom < plot.bottom);
    }
    assert!(before.bottom < step.top && step.bottom < left.top);
    assert!(before.right <= plot.right);
}

#[test]
fn a_waterfall_is_connected_where_a_bar_ends() {
    let vertical = |bars: &BarRows| -> Vec<f64> {
        let picture = Picture::read(&bars.to_svg(700).unwrap());
        let plot = picture.plot();
        picture
            .lines_of("#555555")
            .iter()
            .filter(|line| line.points.len() == 2 && line.points[1].1 <= plot.bottom)
            .map(|line| line.points[0].0)
            .collect()
    };
    let bars = waterfall();
    let picture = Picture::read(&bars.to_svg(700).unwrap());
    let step = picture.rectangles_of(GREEN)[0];
    let found = vertical(&bars);
    assert_eq!(found.len(), 2);
    // The first bar ends where the step begins (at its right), the step ends at its left.
    assert!((found[0] - step.right).abs() < 0.2 && (found[1] - step.left).abs() < 0.2);
    let loose = BarRows {
        connected: false,
        ..bars
    };
    assert_eq!(vertical(&loose), [0.0; 0]);
}

#[test]
fn all_words_are_there_and_apart() {
    let mut bars = waterfall();
    for index in 0..12 {
        let name =
            format!("external-encoder-eccentricity of joint {index} or something longer still");
        bars.rows.push(row(&name, 0.0, 0.1 * f64::from(index), 4));
    }
    for width in [360, 700, 1200] {
        let picture = Picture::read(&bars.to_svg(width).unwrap());
        assert!(
            picture.has("Gap of out2") && picture.has("0.80 mrad"),
            "{width}"
        );
        picture.assert_texts_apart();
        assert!(picture.words.iter().all(|words| words.size_px >= 12.9));
    }
    let narrow = Picture::read(&waterfall().to_svg(700).unwrap());
    assert!(narrow.has("capstan-compliance, joint 2"));
    assert_eq!(narrow.size.0, 700.0);
}

#[test]
fn bad_rows_are_refused() {
    let mut bars = BarRows::new("T", "");
    let refused = |bars: &BarRows| bars.to_svg(600).unwrap_err();
    assert!(matches!(refused(&bars), ReportError::Empty { .. }));
    bars.rows.push(row("one", 0.0, f64::NAN, 0));
    assert!(matches!(
        refused(&bars),
        ReportError::NonFinite { index: 0, .. }
    ));
    bars.rows[0].to = 1.0;
    assert!(matches!(
        bars.to_svg(120),
        Err(ReportError::TooSmall { .. })
    ));
    assert!(bars.to_svg(600).is_ok());
    assert_eq!(bars.to_svg(600).unwrap(), bars.to_svg(600).unwrap());
}

#[test]
fn bars_of_zero_and_below_zero_are_drawn() {
    let mut bars = BarRows::new("T", "");
    bars.rows = vec![row("none", 0.0, 0.0, 0), row("below", 0.0, -1.0, 2)];
    let picture = Picture::read(&bars.to_svg(600).unwrap());
    assert_eq!(picture.rectangles_of(BLUE).len(), 1);
    let below = picture.rectangles_of(GREEN)[0];
    assert!(below.right - below.left > 100.0);
    bars.rows.truncate(1);
    assert!(bars.to_svg(600).is_ok());
}

/// A long name of the axis is neither cut nor in the way, and a name of a bar is broken behind a hyphen.
#[test]
fn words_stay_within_a_narrow_picture() {
    let mut bars = waterfall();
    bars.x_label = "root mean square of the residual, in multiples of the noise".to_owned();
    bars.rows[1].name = "device-encoder-eccentricity at joint 2".to_owned();
    for width in [360, 460, 576] {
        let picture = Picture::read(&bars.to_svg(width).unwrap());
        picture.assert_texts_apart();
        let whole = picture
            .words
            .iter()
            .all(|words| words.area.left >= 0.0 && words.area.right <= f64::from(width));
        assert!(whole, "{width}: {:?}", picture.words);
        assert!(!picture.has("device-encoder-eccentrici"), "{width}");
    }
}
