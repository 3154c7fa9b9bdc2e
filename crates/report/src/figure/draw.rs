//! Drawing the marks of a series in a plot.

use std::collections::BTreeSet;

use crate::canvas::{Canvas, Point, Rectangle, Stroke};
use crate::colour::Colour;
use crate::figure::axis::Axis;
use crate::figure::clip::{clip_path, clip_polygon, dashes, thin_path};
use crate::figure::series::{Mark, Series};

/// Width of curves and error bars.
pub(crate) const LINE_WIDTH_PX: f64 = 1.8;
/// Share of the distance between positions that a group of bars takes.
const BAR_GROUP_SHARE: f64 = 0.8;
/// The same for the only bar series over numbers, such as a histogram.
const SINGLE_BAR_SHARE: f64 = 0.94;
/// Share of the distance between categories over which symbols of several series are spread.
const SYMBOL_GROUP_SHARE: f64 = 0.6;
/// Series with more points than this have smaller symbols, drawn once for each half px.
const MANY_POINTS: usize = 400;

/// A plot area with its axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plot {
    pub(crate) area: Rectangle,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
}

impl Plot {
    pub(crate) fn x_px(&self, x: f64) -> f64 {
        self.area.left + self.x.share(x) * self.area.width()
    }

    pub(crate) fn y_px(&self, y: f64) -> f64 {
        self.area.bottom - self.y.share(y) * self.area.height()
    }

    fn map(&self, points: &[(f64, f64)]) -> Vec<Point> {
        points
            .iter()
            .map(|&(x, y)| (self.x_px(x), self.y_px(y)))
            .collect()
    }

    fn holds(&self, point: Point) -> bool {
        (self.area.left - 0.5..=self.area.right + 0.5).contains(&point.0)
            && (self.area.top - 0.5..=self.area.bottom + 0.5).contains(&point.1)
    }
}

/// Place of the bars and symbols of one series among those of the others, in units of x.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Slot {
    offset: f64,
    width: f64,
}

/// The slot of each series.
///
/// Bar series share the distance between positions. Over categories, symbols and error bars of
/// several series are spread too; if there are as many of them as bar series, they are drawn on the bars.
pub(crate) fn slots(series: &[Series], categories: bool) -> Vec<Slot> {
    let spacing = if categories { 1.0 } else { bar_spacing(series) };
    let is_bar = |s: &&Series| s.mark == Mark::Bars;
    let is_symbol =
        |s: &&Series| categories && matches!(s.mark, Mark::Points | Mark::Rings | Mark::Intervals);
    let bars = series.iter().filter(is_bar).count();
    let symbols = series.iter().filter(is_symbol).count();
    let single = bars == 1 && !categories;
    let share = if single {
        SINGLE_BAR_SHARE
    } else {
        BAR_GROUP_SHARE
    };
    let group = spacing * share;
    let symbol_group = if bars == symbols {
        group
    } else if bars == 0 && symbols > 1 {
        spacing * SYMBOL_GROUP_SHARE
    } else {
        0.0
    };
    let slot = |index: usize, count: usize, group: f64| {
        let width = group / count as f64;
        Slot {
            offset: (index as f64 + 0.5) * width - 0.5 * group,
            width,
        }
    };
    let (mut bar, mut symbol) = (0, 0);
    series
        .iter()
        .map(|s| {
            if is_bar(&s) {
                bar += 1;
                slot(bar - 1, bars, group)
            } else if is_symbol(&s) {
                symbol += 1;
                slot(symbol - 1, symbols, symbol_group)
            } else {
                Slot::default()
            }
        })
        .collect()
}

/// Smallest distance between two positions of bars; 1 when there is only one position.
pub(crate) fn bar_spacing(series: &[Series]) -> f64 {
    let bars = series.iter().filter(|s| s.mark == Mark::Bars);
    let mut positions: Vec<f64> = bars.flat_map(|s| s.points.iter().map(|p| p.0)).collect();
    positions.sort_by(f64::total_cmp);
    let ends = positions.last().zip(positions.first());
    let reach = ends.map_or(0.0, |(last, first)| last - first);
    // Positions that differ by rounding only are one position.
    let apart = positions
        .windows(2)
        .map(|p| p[1] - p[0])
        .filter(|d| *d > 1e-9 * reach);
    let smallest = apart.fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest } else { 1.0 }
}

/// Draws one series.
pub(crate) fn draw_series(canvas: &mut Canvas, plot: &Plot, series: &Series, slot: Slot) {
    let colour = Colour::palette(series.colour);
    let dash = series.mark.dash_px();
    let stroke = Stroke::new(colour, LINE_WIDTH_PX);
    let mut line = |points| draw_line(canvas, plot, points, stroke, dash);
    match series.mark {
        Mark::Line | Mark::DashedLine => line(plot.map(&series.points)),
        Mark::Reference => {
            for &(_, y) in series.points.iter().take(1) {
                let y = plot.y_px(y);
                line(vec![(plot.area.left, y), (plot.area.right, y)]);
            }
        }
        Mark::Band => {
            let outline = clip_polygon(&plot.map(&series.points), &plot.area);
            if outline.len() > 2 {
                canvas.polygon(&outline, colour.with_opacity(0.25));
            }
        }
        Mark::Points | Mark::Rings => draw_points(canvas, plot, series, slot),
        Mark::Bars => draw_bars(canvas, plot, series, slot),
        Mark::Intervals => draw_intervals(canvas, plot, series, slot),
    }
}

fn draw_line(
    canvas: &mut Canvas,
    plot: &Plot,
    points: Vec<Point>,
    stroke: Stroke,
    dash: Option<(f64, f64)>,
) {
    for part in clip_path(&thin_path(points), &plot.area) {
        match dash {
            None => canvas.path(&part, stroke),
            Some((dash_px, gap_px)) => {
                for dash in dashes(&part, dash_px, gap_px) {
                    canvas.path(&dash, stroke);
                }
            }
        }
    }
}

fn draw_points(canvas: &mut Canvas, plot: &Plot, series: &Series, slot: Slot) {
    let many = series.points.len() > MANY_POINTS;
    let mut drawn = BTreeSet::new();
    for &(x, y) in &series.points {
        let at = (plot.x_px(x + slot.offset), plot.y_px(y));
        let place = ((2.0 * at.0).round() as i64, (2.0 * at.1).round() as i64);
        if plot.holds(at) && (!many || drawn.insert(place)) {
            let radius = if many { 2.0 } else { 4.0 };
            match series.mark {
                Mark::Rings => ring(canvas, at, series.colour, radius),
                _ => marker(canvas, at, series.colour, radius),
            }
        }
    }
}

fn draw_bars(canvas: &mut Canvas, plot: &Plot, series: &Series, slot: Slot) {
    let colour = Colour::palette(series.colour);
    let area = plot.area;
    let foot = if plot.y.low() > 0.0 {
        area.bottom
    } else {
        plot.y_px(0.0).max(area.top)
    };
    for &(x, y) in &series.points {
        let centre = x + slot.offset;
        let ends = [centre - 0.5 * slot.width, centre + 0.5 * slot.width];
        let [left, right] = ends.map(|x| plot.x_px(x).clamp(area.left, area.right));
        let end = plot.y_px(y).clamp(area.top, area.bottom);
        if right > left {
            let bar = Rectangle::new(left, end.min(foot), right, end.max(foot));
            canvas.fill(bar, colour);
        }
    }
}

fn draw_intervals(canvas: &mut Canvas, plot: &Plot, series: &Series, slot: Slot) {
    let stroke = Stroke::new(Colour::palette(series.colour), LINE_WIDTH_PX);
    for interval in series.points.chunks_exact(3) {
        let x = plot.x_px(interval[0].0 + slot.offset);
        let [low, mid, high] = [0, 1, 2].map(|index: usize| plot.y_px(interval[index].1));
        draw_line(canvas, plot, vec![(x, low), (x, high)], stroke, None);
        for end in [low, high] {
            if plot.holds((x, end)) {
                canvas.path(&[(x - 4.0, end), (x + 4.0, end)], stroke);
            }
        }
        if plot.holds((x, mid)) {
            marker(canvas, (x, mid), series.colour, 3.5);
        }
    }
}

/// An open circle of a colour.
pub(crate) fn ring(canvas: &mut Canvas, at: Point, index: usize, radius: f64) {
    let stroke = Stroke::new(Colour::palette(index), 1.2);
    canvas.ring(at, radius, stroke);
}

/// The symbol of a colour: circle, square, triangle or diamond, so that print without colour tells
/// neighbours apart.
pub(crate) fn marker(canvas: &mut Canvas, (x, y): Point, index: usize, radius: f64) {
    let colour = Colour::palette(index);
    match index % 4 {
        0 => canvas.circle((x, y), radius, colour),
        1 => {
            let half = 0.88 * radius;
            let square = Rectangle::new(x - half, y - half, x + half, y + half);
            canvas.fill(square, colour);
        }
        2 => {
            let (half, foot) = (1.08 * radius, y + 0.75 * radius);
            canvas.polygon(
                &[(x, y - 1.2 * radius), (x + half, foot), (x - half, foot)],
                colour,
            );
        }
        _ => {
            let half = 1.25 * radius;
            canvas.polygon(
                &[(x, y - half), (x + half, y), (x, y + half), (x - half, y)],
                colour,
            );
        }
    }
}
