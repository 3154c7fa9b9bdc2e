//! Figures: all words present and apart, well-formed, the same bytes twice, bad input refused.

use haptical_report::{Figure, FigureGrid, Mark, ReportError, Series, histogram};
use proptest::prelude::*;

use crate::picture::Picture;

fn names(count: usize) -> Vec<String> {
    (0..count).map(|index| format!("theta{index}")).collect()
}

fn eight_series() -> Figure {
    let mut figure = Figure::new("Errors & <limits>", "joint angle [deg]", "error [mrad]");
    for index in 0..8_u32 {
        let curve = (0..50)
            .map(|k| (f64::from(k), f64::from(k * index).sin()))
            .collect();
        let label = format!("joint {} \"x\"", index + 1);
        figure
            .series
            .push(Series::new(label, Mark::Line, index as usize, curve));
    }
    figure
}

fn simple(mark: Mark, points: &[(f64, f64)]) -> Figure {
    let mut figure = Figure::new("Simple", "x [m]", "y [m]");
    figure
        .series
        .push(Series::new("series", mark, 0, points.to_vec()));
    figure
}

#[test]
fn all_words_are_there_and_apart() {
    let picture = Picture::read(&eight_series().to_svg(700, 420).unwrap());
    for text in ["Errors & <limits>", "joint angle [deg]", "error [mrad]"] {
        assert!(picture.has(text), "{text}");
    }
    for index in 1..=8 {
        assert!(picture.has(&format!("joint {index} \"x\"")), "{index}");
    }
    picture.assert_texts_apart();
    let plot = picture.plot();
    assert!(
        picture
            .words
            .iter()
            .all(|words| !words.area.overlaps(&plot)),
        "a text in the plot"
    );
    assert!(
        picture.words.iter().all(|words| words.size_px >= 12.9),
        "a text below 13 px"
    );
}

#[test]
fn the_same_figure_gives_the_same_bytes() {
    assert_eq!(
        eight_series().to_svg(800, 500).unwrap(),
        eight_series().to_svg(800, 500).unwrap()
    );
    let grid = || FigureGrid::new("Grid", 2, vec![eight_series(), eight_series()]);
    assert_eq!(
        grid().to_svg(1200, 600).unwrap(),
        grid().to_svg(1200, 600).unwrap()
    );
}

#[test]
fn categories_turn_upward_and_then_thin_out() {
    let bars = |count: usize| {
        let points = (0..count).map(|k| (k as f64, 1.0 + k as f64)).collect();
        let mut figure = Figure::new("Bars", "", "improvement [%]");
        figure.categories = Some(names(count));
        figure
            .series
            .push(Series::new("bars", Mark::Bars, 0, points));
        let picture = Picture::read(&figure.to_svg(640, 400).unwrap());
        picture.assert_texts_apart();
        names(count).iter().filter(|name| picture.has(name)).count()
    };
    assert_eq!(bars(4), 4);
    assert_eq!(bars(28), 28);
    let thinned = bars(200);
    assert!((20..=40).contains(&thinned), "{thinned}");
}

#[test]
fn axes_have_a_few_ticks() {
    for (low, high) in [
        (0.0, 1.0),
        (-90.0, 90.0),
        (0.0, 3e-5),
        (1e6, 1.5e6),
        (99.2, 99.9),
    ] {
        let picture = Picture::read(
            &simple(Mark::Line, &[(low, low), (high, high)])
                .to_svg(700, 500)
                .unwrap(),
        );
        picture.assert_texts_apart();
        let plot = picture.plot();
        let below = picture
            .words
            .iter()
            .filter(|w| w.area.top > plot.bottom && w.text != "x [m]");
        let beside = picture.words.iter().filter(|w| {
            w.area.right < plot.left && w.text != "y [m]" && w.area.top > plot.top - 10.0
        });
        let counts = (below.count(), beside.count());
        assert!(
            (3..=7).contains(&counts.0) && (3..=7).contains(&counts.1),
            "{low}: {counts:?}"
        );
    }
}

#[test]
fn logarithmic_axis_labels_decades() {
    let mut figure = simple(Mark::Line, &[(0.0, 1e-8), (1.0, 1e-2)]);
    figure.y_log = true;
    let picture = Picture::read(&figure.to_svg(500, 400).unwrap());
    assert!(
        picture.has("10⁻⁸") && picture.has("10⁻⁴"),
        "{:?}",
        picture.words
    );
    // Equal ratios are equal distances.
    let y = |text| picture.find(text).anchor_point.1;
    assert!(((y("10⁻⁸") - y("10⁻⁶")) - (y("10⁻⁶") - y("10⁻⁴"))).abs() < 0.3);
    assert!(y("10⁻⁸") > y("10⁻⁴"));
    figure.series[0].points.push((2.0, 0.0));
    let error = figure.to_svg(500, 400).unwrap_err();
    assert!(
        matches!(error, ReportError::NotPositive { index: 2, .. }),
        "{error}"
    );
}

#[test]
fn grid_draws_all_panels_apart() {
    let mut panels = vec![
        eight_series(),
        simple(Mark::Points, &[(0.0, 1.0), (2.0, 4.0)]),
    ];
    panels.push(simple(Mark::Line, &[(0.0, 1e-7), (2.0, 4e-7)]));
    for (index, panel) in panels.iter_mut().enumerate() {
        panel.title = format!("Panel {index}");
    }
    let svg = FigureGrid::new("All panels", 2, panels)
        .to_svg(1100, 800)
        .unwrap();
    let picture = Picture::read(&svg);
    picture.assert_texts_apart();
    let corner = |text| picture.find(text).area;
    assert!(picture.has("All panels"));
    assert!(corner("Panel 1").left > 550.0 && corner("Panel 0").left < 50.0);
    assert!(corner("Panel 2").top > corner("Panel 0").top + 300.0);
    let error = FigureGrid::new("None", 2, vec![])
        .to_svg(400, 400)
        .unwrap_err();
    assert!(
        matches!(
            error,
            ReportError::Empty {
                missing: "panels",
                ..
            }
        ),
        "{error}"
    );
}

#[test]
fn bad_figures_are_refused() {
    for bad in [(f64::NAN, 0.0), (0.0, f64::INFINITY)] {
        let error = simple(Mark::Points, &[(0.0, 0.0), bad])
            .to_svg(400, 300)
            .unwrap_err();
        assert!(
            matches!(&error, ReportError::NonFinite { index: 1, .. }),
            "{error}"
        );
        assert!(error.to_string().contains("series"), "{error}");
    }
    let empty = Figure::new("Nothing", "x", "y")
        .to_svg(400, 300)
        .unwrap_err();
    assert!(matches!(empty, ReportError::Empty { .. }), "{empty}");
    let mut backwards = simple(Mark::Line, &[(0.0, 0.0), (1.0, 1.0)]);
    backwards.y_range = Some((1.0, 0.0));
    assert!(matches!(
        backwards.to_svg(400, 300),
        Err(ReportError::EmptyRange { axis: "y", .. })
    ));
    let mut figure = simple(Mark::Intervals, &[(0.0, 0.0), (1.0, 1.0)]);
    assert!(matches!(
        figure.to_svg(400, 300),
        Err(ReportError::PointCount { got: 2, .. })
    ));
    figure.series[0].mark = Mark::Line;
    figure.categories = Some(Vec::new());
    assert!(matches!(
        figure.to_svg(400, 300),
        Err(ReportError::Empty { .. })
    ));
    let small = simple(Mark::Line, &[(0.0, 0.0), (1.0, 1.0)]);
    assert!(matches!(
        small.to_svg(90, 90),
        Err(ReportError::TooSmall { .. })
    ));
    assert!(matches!(
        small.to_svg(0, 90),
        Err(ReportError::PictureSize { .. })
    ));
    assert!(matches!(
        small.to_svg(500, 1_000_000),
        Err(ReportError::PictureSize { .. })
    ));
}

#[test]
fn an_empty_figure_with_ranges_and_one_point_figures_are_drawn() {
    let mut figure = Figure::new("Frame", "x", "y");
    (figure.x_range, figure.y_range) = (Some((0.0, 1.0)), Some((0.0, 1.0)));
    Picture::read(&figure.to_svg(400, 300).unwrap()).assert_texts_apart();
    for value in [0.0, 7.0, -1e-12, 1e15] {
        let picture = Picture::read(
            &simple(Mark::Points, &[(value, value)])
                .to_svg(400, 300)
                .unwrap(),
        );
        picture.assert_texts_apart();
        assert_eq!(
            picture.circles.len(),
            2,
            "one symbol in the plot, one in the legend"
        );
    }
}

#[test]
fn narrow_pictures_keep_two_ticks_on_each_axis() {
    let figure = simple(Mark::Line, &[(-1992.98, -1992.98), (-1992.65, -1992.65)]);
    let picture = Picture::read(&figure.to_svg(260, 200).unwrap());
    picture.assert_texts_apart();
    let labels = picture
        .words
        .iter()
        .filter(|words| words.text.starts_with("-1992."));
    assert!(labels.count() >= 3, "{:?}", picture.words);
}

#[test]
fn ticks_at_quarters_show_two_digits() {
    let mut figure = simple(Mark::Line, &[(0.0, 0.0), (1.0, 1.0)]);
    figure.x_range = Some((0.0, 1.7));
    let picture = Picture::read(&figure.to_svg(700, 400).unwrap());
    let ratio = |text: &str, share: f64| {
        let plot = picture.plot();
        let x = picture.find(text).anchor_point.0;
        assert!(
            (x - plot.left - share * (plot.right - plot.left)).abs() < 0.2,
            "{text}: {x}"
        );
    };
    ratio("0.25", 0.25 / 1.7);
    ratio("1.25", 1.25 / 1.7);
    figure.x_range = Some((0.0, 1.7e-7));
    let picture = Picture::read(&figure.to_svg(700, 400).unwrap());
    assert!(
        picture.has("2.5×10⁻⁸") || picture.has("0.25×10⁻⁷"),
        "{:?}",
        picture.words
    );
}

#[test]
fn the_ends_of_the_number_range_are_drawn() {
    for (low, high) in [
        (f64::MIN, f64::MAX),
        (1.4e308, 1.4e308),
        (5e-324, 1e-300),
        (0.0, f64::MAX),
    ] {
        for mark in [Mark::Line, Mark::Bars] {
            let svg = simple(mark, &[(low, low), (high, high)])
                .to_svg(520, 360)
                .unwrap();
            Picture::read(&svg).assert_texts_apart();
        }
    }
    let mut figure = simple(Mark::Line, &[(0.0, 1.2e-289), (0.0, 1.9e125)]);
    figure.y_log = true;
    Picture::read(&figure.to_svg(520, 360).unwrap()).assert_texts_apart();
}

#[test]
fn thinning_keeps_single_spikes() {
    let value = |k: i32| {
        if k == 40_000 {
            5.0
        } else if k == 70_001 {
            -3.0
        } else {
            0.0
        }
    };
    let points: Vec<_> = (0..100_000).map(|k| (f64::from(k), value(k))).collect();
    let mut figure = simple(Mark::Line, &points);
    figure.y_range = Some((-10.0, 10.0));
    let picture = Picture::read(&figure.to_svg(600, 300).unwrap());
    let plot = picture.plot();
    let y = |value: f64| plot.bottom - (value + 10.0) / 20.0 * (plot.bottom - plot.top);
    let curve = picture
        .lines_of("#0072B2")
        .into_iter()
        .max_by_key(|line| line.points.len())
        .unwrap();
    for (value, share) in [(5.0, 0.4), (-3.0, 0.7)] {
        let at = curve
            .points
            .iter()
            .find(|p| (p.1 - y(value)).abs() < 0.2)
            .unwrap();
        let found = (at.0 - plot.left) / (plot.right - plot.left);
        assert!((found - share).abs() < 0.02, "{found}");
    }
}

#[test]
fn long_recordings_stay_small() {
    let noise = |k: i32| (f64::from(k) * 12.9898).sin() * 43_758.545;
    let curve = |mark| {
        let points: Vec<_> = (0..100_000)
            .map(|k| (f64::from(k), noise(k).fract()))
            .collect();
        simple(mark, &points).to_svg(600, 300).unwrap()
    };
    let line = curve(Mark::Line);
    assert!(line.len() < 100_000, "{}", line.len());
    // Thinning keeps the extremes of each px column, so the noise still fills its range.
    let picture = Picture::read(&line);
    let plot = picture.plot();
    let curves = picture.lines_of("#0072B2");
    let longest = curves.iter().max_by_key(|line| line.points.len()).unwrap();
    let top = longest
        .points
        .iter()
        .map(|p| p.1)
        .fold(f64::INFINITY, f64::min);
    let bottom = longest.points.iter().map(|p| p.1).fold(0.0, f64::max);
    assert!(bottom - top > 0.85 * (plot.bottom - plot.top));
}

#[test]
fn histogram_counts_every_value_once() {
    let counts = histogram(&[0.0, 0.5, 1.0, 1.0, 4.0], 4);
    assert_eq!(counts, [(0.5, 2.0), (1.5, 2.0), (2.5, 0.0), (3.5, 1.0)]);
    assert_eq!(
        histogram(&[2.0, 2.0, f64::NAN], 2),
        [(1.75, 0.0), (2.25, 2.0)]
    );
    assert!(histogram(&[], 3).is_empty() && histogram(&[1.0], 0).is_empty());
}

#[test]
fn a_logarithmic_axis_at_the_end_of_the_number_range_has_no_infinite_tick() {
    let mut figure = simple(Mark::Line, &[(0.0, 1.690_813e308)]);
    figure.y_log = true;
    Picture::read(&figure.to_svg(520, 360).unwrap()).assert_texts_apart();
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_finite_points_give_a_readable_picture(
        points in prop::collection::vec(
            (prop::num::f64::NORMAL | prop::num::f64::ZERO, prop::num::f64::NORMAL), 1..8),
        bars in any::<bool>(), log in any::<bool>(),
    ) {
        let height = |y: f64| if log { y.abs() } else { y };
        let points: Vec<_> = points.into_iter().map(|(x, y)| (x, height(y))).collect();
        let mut figure = simple(if bars { Mark::Bars } else { Mark::Line }, &points);
        figure.y_log = log;
        let svg = figure.to_svg(520, 360).unwrap();
        prop_assert!(!svg.contains("NaN") && !svg.contains("inf"));
        Picture::read(&svg).assert_texts_apart();
    }

    #[test]
    fn everyday_ranges_have_labelled_ticks_that_stay_apart(
        low in -1e4..1e4_f64, exponent in -6.0..5.0_f64, width in 260_u32..900, height in 200_u32..700,
    ) {
        let high = low + 10.0_f64.powf(exponent) * low.abs().max(1.0);
        let figure = simple(Mark::Line, &[(low, low), (high, high)]);
        let picture = Picture::read(&figure.to_svg(width, height).unwrap());
        picture.assert_texts_apart();
        // Title, legend, two axis labels, two ticks on the vertical axis and at least one below.
        prop_assert!(picture.words.len() >= 7, "{:?}", picture.words);
    }

    #[test]
    fn histogram_is_complete(values in prop::collection::vec(-1e3..1e3_f64, 1..100), bins in 1_usize..20) {
        let counts = histogram(&values, bins);
        prop_assert_eq!(counts.len(), bins);
        prop_assert_eq!(counts.iter().map(|c| c.1).sum::<f64>(), values.len() as f64);
    }
}
