//! Figures: every point is where its axes say.

use haptical_report::{Figure, Mark, Series};

use crate::picture::{Area, Picture};

/// Coordinates are written in tenths of a px.
const ROUNDING_PX: f64 = 0.11;
const BLUE: &str = "#0072B2";
const VERMILION: &str = "#D55E00";
const GREEN: &str = "#009E73";

fn unit_figure(mark: Mark, points: &[(f64, f64)]) -> Figure {
    let mut figure = Figure::new("", "", "");
    (figure.x_range, figure.y_range) = (Some((0.0, 10.0)), Some((0.0, 1.0)));
    figure
        .series
        .push(Series::new("", mark, 0, points.to_vec()));
    figure
}

fn read(figure: &Figure) -> (Picture, Area) {
    let picture = Picture::read(&figure.to_svg(600, 400).unwrap());
    let plot = picture.plot();
    (picture, plot)
}

fn place(plot: &Area, x_share: f64, y_share: f64) -> (f64, f64) {
    (
        plot.left + x_share * (plot.right - plot.left),
        plot.bottom - y_share * (plot.bottom - plot.top),
    )
}

fn assert_near(found: (f64, f64), expected: (f64, f64)) {
    let distance = (found.0 - expected.0)
        .abs()
        .max((found.1 - expected.1).abs());
    assert!(distance <= ROUNDING_PX, "{found:?} / {expected:?}");
}

#[test]
fn points_stand_where_the_axes_say() {
    let (picture, plot) = read(&unit_figure(
        Mark::Line,
        &[(0.0, 0.25), (5.0, 0.75), (10.0, 0.5)],
    ));
    let line = picture.lines_of(BLUE)[0];
    for (found, (x, y)) in line
        .points
        .iter()
        .zip([(0.0, 0.25), (0.5, 0.75), (1.0, 0.5)])
    {
        assert_near(*found, place(&plot, x, y));
    }
    // Tick labels are next to the values that they name.
    assert!((picture.find("0.4").anchor_point.1 - place(&plot, 0.0, 0.4).1).abs() <= ROUNDING_PX);
    assert!((picture.find("6").anchor_point.0 - place(&plot, 0.6, 0.0).0).abs() <= ROUNDING_PX);
}

#[test]
fn lines_are_cut_at_the_ends_of_given_ranges() {
    let (picture, plot) = read(&unit_figure(Mark::Line, &[(-10.0, 0.0), (20.0, 1.5)]));
    let line = picture.lines_of(BLUE)[0];
    assert_eq!(line.points.len(), 2);
    assert_near(line.points[0], place(&plot, 0.0, 0.5));
    assert_near(line.points[1], place(&plot, 1.0, 1.0));
    let (picture, _) = read(&unit_figure(Mark::Line, &[(0.0, 2.0), (10.0, 3.0)]));
    assert!(picture.lines_of(BLUE).is_empty());
    let mut figure = unit_figure(Mark::Line, &[]);
    figure
        .series
        .push(Series::band("", 1, &[(-5.0, -3.0, 3.0), (15.0, -3.0, 3.0)]));
    let (picture, plot) = read(&figure);
    let band = &picture
        .polygons
        .iter()
        .find(|p| p.colour == VERMILION)
        .unwrap()
        .points;
    for corner in band {
        assert!(corner.0 >= plot.left - ROUNDING_PX && corner.0 <= plot.right + ROUNDING_PX);
        assert!(corner.1 >= plot.top - ROUNDING_PX && corner.1 <= plot.bottom + ROUNDING_PX);
    }
    assert_eq!(band.len(), 4);
}

#[test]
fn a_band_covers_the_space_between_its_curves() {
    let mut figure = unit_figure(Mark::Line, &[]);
    figure.series.push(Series::band(
        "",
        1,
        &[(0.0, 0.25, 0.5), (5.0, 0.25, 0.75), (10.0, 0.5, 0.75)],
    ));
    let (picture, plot) = read(&figure);
    let band = &picture
        .polygons
        .iter()
        .find(|p| p.colour == VERMILION)
        .unwrap()
        .points;
    let twice: f64 = (0..band.len())
        .map(|k| (band[k], band[(k + 1) % band.len()]))
        .map(|(p, q)| p.0 * q.1 - q.0 * p.1)
        .sum();
    // Mean heights of the two halves: (0.25 + 0.5) / 2 and (0.5 + 0.25) / 2.
    let share = 0.5 * twice.abs() / ((plot.right - plot.left) * (plot.bottom - plot.top));
    assert!((share - 0.375).abs() < 1e-3, "{share}");
}

#[test]
fn dashes_cover_a_share_of_the_line() {
    let (picture, plot) = read(&unit_figure(Mark::DashedLine, &[(0.0, 0.5), (10.0, 0.5)]));
    let dashes = picture.lines_of(BLUE);
    let drawn: f64 = dashes.iter().map(|d| d.points[1].0 - d.points[0].0).sum();
    let share = drawn / (plot.right - plot.left);
    assert!(
        dashes.len() > 20 && (share - 7.0 / 11.0).abs() < 0.03,
        "{share}"
    );
}

#[test]
fn bars_stand_side_by_side_from_zero() {
    let mut figure = Figure::new("", "", "");
    figure.categories = Some(vec!["a".to_owned(), "b".to_owned(), "c".to_owned()]);
    let heights = [[1.0, -2.0, 3.0], [2.0, 2.0, 1.0], [0.5, 1.0, -1.0]];
    for (colour, heights) in heights.iter().enumerate() {
        let points = heights
            .iter()
            .enumerate()
            .map(|(k, &y)| (k as f64, y))
            .collect();
        figure
            .series
            .push(Series::new("", Mark::Bars, colour, points));
    }
    let (picture, _) = read(&figure);
    let zero = picture.find("0").anchor_point.1;
    let per_unit = zero - picture.find("1").anchor_point.1;
    let mut all = Vec::new();
    for (colour, heights) in [BLUE, VERMILION, GREEN].iter().zip(heights) {
        let bars = picture.rectangles_of(colour);
        assert_eq!(bars.len(), 3);
        for (bar, height) in bars.iter().zip(heights) {
            let (top, bottom) = (
                zero - height.max(0.0) * per_unit,
                zero - height.min(0.0) * per_unit,
            );
            assert!(
                (bar.top - top).abs() < 0.3 && (bar.bottom - bottom).abs() < 0.3,
                "{bar:?}"
            );
        }
        all.extend(bars);
    }
    for (index, bar) in all.iter().enumerate() {
        assert!(
            all[index + 1..].iter().all(|other| !bar.overlaps(other)),
            "{bar:?}"
        );
    }
    // The group of three is centred on its name.
    let centre = 0.5 * (all[0].left + all[6].right);
    assert!((picture.find("a").anchor_point.0 - centre).abs() < 0.3);
}

#[test]
fn bars_are_as_wide_as_their_positions_are_apart() {
    let mut figure = Figure::new("", "", "");
    let points = [(0.25, 3.0), (0.75, 1.0), (1.75, 2.0)];
    figure
        .series
        .push(Series::new("", Mark::Bars, 0, points.to_vec()));
    let (picture, plot) = read(&figure);
    let bars = picture.rectangles_of(BLUE);
    let distance = 0.5 * (bars[1].left + bars[1].right) - 0.5 * (bars[0].left + bars[0].right);
    assert!(((bars[0].right - bars[0].left) / distance - 0.94).abs() < 0.01);
    assert!(
        bars[0].left >= plot.left && bars[2].right <= plot.right,
        "the outer bars are whole"
    );
    assert!(
        (bars[0].bottom - plot.bottom).abs() <= ROUNDING_PX,
        "bars stand on the axis"
    );
}

#[test]
fn intervals_keep_their_order_and_stand_apart_over_categories() {
    let mut figure = Figure::new("", "", "");
    figure.categories = Some(vec!["a".to_owned()]);
    figure.y_range = Some((0.0, 1.0));
    figure
        .series
        .push(Series::intervals("", 0, &[(0.0, 0.2, 0.3, 0.6)]));
    figure
        .series
        .push(Series::intervals("", 1, &[(0.0, 0.2, 0.3, 0.6)]));
    let (picture, plot) = read(&figure);
    let bar = &picture.lines_of(BLUE)[0].points;
    assert!((bar[0].1 - place(&plot, 0.0, 0.2).1).abs() <= ROUNDING_PX);
    assert!((bar[1].1 - place(&plot, 0.0, 0.6).1).abs() <= ROUNDING_PX);
    assert!((picture.circles[0].1 - place(&plot, 0.0, 0.3).1).abs() <= ROUNDING_PX);
    let other = &picture.lines_of(VERMILION)[0].points;
    assert!(other[0].0 - bar[0].0 > 20.0, "{other:?}");
    assert!((0.5 * (other[0].0 + bar[0].0) - place(&plot, 0.5, 0.0).0).abs() <= ROUNDING_PX);
}

#[test]
fn reference_lines_cross_the_plot_and_widen_the_axis() {
    let mut figure = Figure::new("", "", "");
    figure.series.push(Series::new(
        "",
        Mark::Points,
        0,
        vec![(5.0, 1.0), (6.0, 2.0)],
    ));
    figure.series.push(Series::reference("", 1, 4.0));
    let (picture, plot) = read(&figure);
    let dashes = picture.lines_of(VERMILION);
    let y = picture.find("4.0").anchor_point.1;
    assert!(
        dashes
            .iter()
            .all(|d| (d.points[0].1 - y).abs() <= ROUNDING_PX)
    );
    assert!((dashes[0].points[0].0 - plot.left).abs() <= ROUNDING_PX);
    assert!(plot.right - dashes[dashes.len() - 1].points[1].0 < 3.5);
    assert!(
        picture.find("5.0").area.left < plot.left + 60.0,
        "the line does not widen x"
    );
}
