//! One panel: checks a figure, chooses its axes, lays it out and draws it.

use crate::canvas::{Anchor, Canvas, Point, Rectangle, Stroke};
use crate::colour::Colour;
use crate::error::ReportError;
use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::draw::{Plot, bar_spacing, draw_series, slots};
use crate::figure::layout::{LINE_PX, Layout, MARGIN_PX, TEXT_PX, TICK_PX, draw_title};
use crate::figure::series::Mark;

/// Free space left and right of the points, as a share of their range.
const X_MARGIN: f64 = 0.02;
/// Free space above and below the points, as a share of their range.
const Y_MARGIN: f64 = 0.06;

/// Draws a figure into an area of the canvas.
pub(crate) fn draw_panel(
    canvas: &mut Canvas,
    figure: &Figure,
    area: Rectangle,
) -> Result<(), ReportError> {
    check(figure)?;
    let x = x_axis(figure)?;
    let y = y_axis(figure, &x)?;
    let layout = Layout::new(figure, area, &x, &y)?;
    let plot = Plot {
        area: layout.plot,
        x,
        y,
    };

    draw_title(canvas, &layout.title, (area.left, area.top));
    layout
        .legend
        .draw(canvas, area.left + MARGIN_PX, layout.legend_top);
    draw_grid(canvas, &plot, &layout, figure.categories.is_some());
    let slots = slots(&figure.series, figure.categories.is_some());
    let mut all: Vec<_> = figure.series.iter().zip(slots).collect();
    all.sort_by_key(|(series, _)| layer(series.mark));
    for (series, slot) in all {
        draw_series(canvas, &plot, series, slot);
    }
    draw_frame(canvas, &plot);
    draw_labels(canvas, &plot, &layout, area);
    Ok(())
}

/// Layer of a mark, from the lowest.
fn layer(mark: Mark) -> usize {
    match mark {
        Mark::Band => 0,
        Mark::Bars => 1,
        _ => 2,
    }
}

fn check(figure: &Figure) -> Result<(), ReportError> {
    for series in &figure.series {
        let place = || format!("figure \"{}\", series \"{}\"", figure.title, series.label);
        for (index, &(x, y)) in series.points.iter().enumerate() {
            if let Some(value) = [x, y].into_iter().find(|value| !value.is_finite()) {
                return Err(ReportError::NonFinite {
                    place: place(),
                    index,
                    value,
                });
            }
            if figure.y_log && y <= 0.0 {
                return Err(ReportError::NotPositive {
                    place: place(),
                    index,
                    value: y,
                });
            }
        }
        let got = series.points.len();
        let needed = match series.mark {
            Mark::Intervals if got % 3 != 0 => "three for each interval",
            Mark::Band if got % 2 != 0 => "an even number",
            Mark::Reference if got != 1 => "one",
            _ => continue,
        };
        return Err(ReportError::PointCount {
            figure: figure.title.clone(),
            series: series.label.clone(),
            got,
            needed,
        });
    }
    if figure.categories.as_ref().is_some_and(Vec::is_empty) {
        return Err(ReportError::empty(&figure.title, "categories"));
    }
    for (axis, range) in [("x", figure.x_range), ("y", figure.y_range)] {
        let Some((low, high)) = range else { continue };
        // The range must also be wide enough for its ends to differ on the axis.
        let apart = high - low > 1e-12 * low.abs().max(high.abs()) && (high - low).is_finite();
        if !apart || !low.is_finite() || (axis == "y" && figure.y_log && low <= 0.0) {
            return Err(ReportError::EmptyRange {
                figure: figure.title.clone(),
                axis,
                low,
                high,
            });
        }
    }
    Ok(())
}

fn x_axis(figure: &Figure) -> Result<Axis, ReportError> {
    if let Some((low, high)) = figure.x_range {
        return Ok(Axis::new(low, high, false));
    }
    if let Some(names) = &figure.categories {
        return Ok(Axis::new(-0.5, names.len() as f64 - 0.5, false));
    }
    let half = 0.5 * bar_spacing(&figure.series);
    let mut values = Vec::new();
    let all = figure.series.iter();
    for series in all.filter(|series| series.mark != Mark::Reference) {
        let reach = if series.mark == Mark::Bars { half } else { 0.0 };
        let points = series.points.iter();
        values.extend(points.flat_map(|&(x, _)| [x - reach, x + reach]));
    }
    let empty = || ReportError::empty(&figure.title, "points");
    Axis::around(&values, false, X_MARGIN, None).ok_or_else(empty)
}

fn y_axis(figure: &Figure, x: &Axis) -> Result<Axis, ReportError> {
    if let Some((low, high)) = figure.y_range {
        return Ok(Axis::new(low, high, figure.y_log));
    }
    let inside = |x_value: f64| (x.low()..=x.high()).contains(&x_value);
    let visible = |everything: bool| -> Vec<f64> {
        let points = figure.series.iter().flat_map(|series| {
            let always = everything || series.mark == Mark::Reference;
            series
                .points
                .iter()
                .filter(move |point| always || inside(point.0))
        });
        points.map(|point| point.1).collect()
    };
    let bars = figure
        .series
        .iter()
        .any(|s| s.mark == Mark::Bars && !s.points.is_empty());
    let foot = (bars && !figure.y_log).then_some(0.0);
    // A line may cross the range without a point in it; then all points count.
    Axis::around(&visible(false), figure.y_log, Y_MARGIN, foot)
        .or_else(|| Axis::around(&visible(true), figure.y_log, Y_MARGIN, foot))
        .ok_or_else(|| ReportError::empty(&figure.title, "points"))
}

fn draw_grid(canvas: &mut Canvas, plot: &Plot, layout: &Layout, categories: bool) {
    let stroke = Stroke::new(Colour::GRID, 1.0);
    let area = plot.area;
    for tick in &layout.y_ticks {
        let y = plot.y_px(tick.value);
        canvas.path(&[(area.left, y), (area.right, y)], stroke);
    }
    if categories {
        return;
    }
    for tick in &layout.x_ticks.ticks {
        let x = plot.x_px(tick.value);
        canvas.path(&[(x, area.top), (x, area.bottom)], stroke);
    }
}

fn draw_frame(canvas: &mut Canvas, plot: &Plot) {
    let stroke = Stroke::new(Colour::AXIS, 1.0);
    let area = plot.area;
    let corner = (area.left, area.bottom);
    canvas.path(
        &[(area.left, area.top), corner, (area.right, area.bottom)],
        stroke,
    );
    if plot.y.low() < 0.0 && plot.y.high() > 0.0 {
        let zero = plot.y_px(0.0);
        canvas.path(&[(area.left, zero), (area.right, zero)], stroke);
    }
}

fn draw_labels(canvas: &mut Canvas, plot: &Plot, layout: &Layout, area: Rectangle) {
    let stroke = Stroke::new(Colour::AXIS, 1.0);
    let (left, bottom) = (plot.area.left, plot.area.bottom);
    let tick = |canvas: &mut Canvas, from: Point, to: Point| canvas.path(&[from, to], stroke);
    for minor in plot.y.minor_ticks() {
        let y = plot.y_px(minor);
        tick(canvas, (left, y), (left - 0.6 * TICK_PX, y));
    }
    for label in &layout.y_ticks {
        let y = plot.y_px(label.value);
        tick(canvas, (left, y), (left - TICK_PX, y));
        canvas.text(
            &label.label,
            (left - TICK_PX - 3.0, y),
            TEXT_PX,
            Anchor::End,
        );
    }
    for label in &layout.x_ticks.ticks {
        let x = plot.x_px(label.value);
        tick(canvas, (x, bottom), (x, bottom + TICK_PX));
        let under = bottom + TICK_PX + 3.0;
        if layout.x_ticks.upward {
            canvas.upward_text(&label.label, (x, under), TEXT_PX, Anchor::End);
        } else {
            canvas.text(
                &label.label,
                (x, under + 0.5 * LINE_PX),
                TEXT_PX,
                Anchor::Middle,
            );
        }
    }
    let (middle, centre) = (
        0.5 * (left + plot.area.right),
        0.5 * (plot.area.top + bottom),
    );
    for (index, line) in layout.x_label.iter().enumerate() {
        let y = layout.x_label_top + (index as f64 + 0.5) * LINE_PX;
        canvas.text(line, (middle, y), TEXT_PX, Anchor::Middle);
    }
    for (index, line) in layout.y_label.iter().enumerate() {
        let x = area.left + MARGIN_PX + (index as f64 + 0.5) * LINE_PX;
        canvas.upward_text(line, (x, centre), TEXT_PX, Anchor::Middle);
    }
}
