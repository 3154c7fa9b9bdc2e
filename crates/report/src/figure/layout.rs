//! The places of the parts of a panel: title, legend, axis labels, tick labels and the plot itself.

use crate::canvas::{Anchor, Canvas, Point, Rectangle};
use crate::error::ReportError;
use crate::figure::Figure;
use crate::figure::axis::{Axis, MOST_TICKS, Tick};
use crate::figure::legend::Legend;
use crate::text::{BOLD_FACTOR, widest_px, width_px, wrap};

/// Size of the title of a grid.
pub(crate) const PAGE_TITLE_PX: f64 = 17.0;
/// Size of the title of a panel.
pub(crate) const TITLE_PX: f64 = 15.0;
/// Height of a line of a title.
pub(crate) const TITLE_LINE_PX: f64 = 21.0;
/// Size of axis labels, tick labels and legends.
pub(crate) const TEXT_PX: f64 = 13.0;
/// Height of a line of text.
pub(crate) const LINE_PX: f64 = 17.0;
/// Length of a tick.
pub(crate) const TICK_PX: f64 = 5.0;
/// Free space at the edge of a panel.
pub(crate) const MARGIN_PX: f64 = 12.0;
/// Smallest plot that can be read.
const SMALLEST_PLOT_PX: (f64, f64) = (80.0, 60.0);
/// Bound on the rounds in which margins and labels settle; two or three are usual.
const SETTLING_ROUNDS: usize = 20;
/// Free space between neighbouring tick labels.
const LABEL_GAP_PX: f64 = 14.0;

/// Labels under the horizontal axis.
#[derive(Debug, Clone)]
pub(crate) struct XTicks {
    pub(crate) ticks: Vec<Tick>,
    /// Labels read upwards because they would overlap otherwise.
    pub(crate) upward: bool,
    /// Height that the labels take.
    height_px: f64,
    /// How far labels reach beyond the left and the right end of the plot.
    overhang_px: (f64, f64),
}

/// Places of all parts of a panel.
#[derive(Debug, Clone)]
pub(crate) struct Layout {
    pub(crate) plot: Rectangle,
    pub(crate) title: Vec<String>,
    pub(crate) legend: Legend,
    pub(crate) legend_top: f64,
    pub(crate) x_ticks: XTicks,
    pub(crate) y_ticks: Vec<Tick>,
    pub(crate) x_label: Vec<String>,
    pub(crate) x_label_top: f64,
    pub(crate) y_label: Vec<String>,
}

/// Draws the lines of a title below the margin of an area with this upper left corner.
pub(crate) fn draw_title(canvas: &mut Canvas, lines: &[String], (left, top): Point) {
    for (index, line) in lines.iter().enumerate() {
        let y = top + MARGIN_PX + (index as f64 + 0.5) * TITLE_LINE_PX;
        canvas.heading(line, (left + MARGIN_PX, y), TITLE_PX);
    }
}

/// Draws the lines of a row's name, which end at the point.
pub(crate) fn draw_name(canvas: &mut Canvas, lines: &[String], (right, middle): Point) {
    for (index, line) in lines.iter().enumerate() {
        let y = middle + (index as f64 - 0.5 * (lines.len() as f64 - 1.0)) * LINE_PX;
        canvas.text(line, (right, y), TEXT_PX, Anchor::End);
    }
}

impl Layout {
    /// Places the parts of a figure in an area.
    pub(crate) fn new(
        figure: &Figure,
        area: Rectangle,
        x: &Axis,
        y: &Axis,
    ) -> Result<Self, ReportError> {
        let inner = area.width() - 2.0 * MARGIN_PX;
        let title = wrap(&figure.title, TITLE_PX * BOLD_FACTOR, inner);
        let legend_top = area.top + MARGIN_PX + title.len() as f64 * TITLE_LINE_PX;
        let legend = Legend::new(figure, inner);
        let gap = if title.is_empty() && legend.height_px() == 0.0 {
            4.0
        } else {
            10.0
        };
        let top = legend_top + legend.height_px() + gap;
        let mut plot = area;
        (plot.left, plot.top) = (area.left + MARGIN_PX, top);
        (plot.right, plot.bottom) = (area.right - MARGIN_PX, area.bottom - MARGIN_PX);
        // The margins depend on the labels, and the number of labels on the margins. Margins only
        // grow from round to round, so they settle.
        let mut parts = Self::parts(figure, &plot, x, y);
        for _ in 0..SETTLING_ROUNDS {
            let previous = plot;
            let (y_ticks, x_ticks, x_label, y_label) = &parts;
            let block = |lines: &[String]| match lines.len() {
                0 => MARGIN_PX,
                count => MARGIN_PX + count as f64 * LINE_PX + 4.0,
            };
            let widest = widest_px(y_ticks.iter().map(|tick| &tick.label), TEXT_PX);
            let left =
                (block(y_label) + widest + TICK_PX + 4.0).max(MARGIN_PX + x_ticks.overhang_px.0);
            let right = MARGIN_PX + x_ticks.overhang_px.1.max(4.0);
            let bottom = block(x_label) + x_ticks.height_px + TICK_PX + 3.0;
            plot.left = plot.left.max(area.left + left);
            plot.right = plot.right.min(area.right - right);
            plot.bottom = plot.bottom.min(area.bottom - bottom);
            check_room(figure, &plot)?;
            parts = Self::parts(figure, &plot, x, y);
            if plot == previous {
                break;
            }
        }
        let (y_ticks, x_ticks, x_label, y_label) = parts;
        let x_label_top = area.bottom - MARGIN_PX - x_label.len() as f64 * LINE_PX;
        Ok(Self {
            plot,
            title,
            legend,
            legend_top,
            x_ticks,
            y_ticks,
            x_label,
            x_label_top,
            y_label,
        })
    }

    fn parts(
        figure: &Figure,
        plot: &Rectangle,
        x: &Axis,
        y: &Axis,
    ) -> (Vec<Tick>, XTicks, Vec<String>, Vec<String>) {
        let rows = (plot.height() / (1.6 * LINE_PX))
            .floor()
            .clamp(2.0, MOST_TICKS as f64);
        let x_ticks = match &figure.categories {
            Some(names) => category_ticks(names, plot, x),
            None => number_ticks(plot, x),
        };
        let x_label = wrap(&figure.x_label, TEXT_PX, plot.width());
        // A long vertical label may use the whole height of the panel, not of the plot only.
        let y_label = wrap(&figure.y_label, TEXT_PX, plot.height().max(60.0));
        (y.ticks(rows as usize), x_ticks, x_label, y_label)
    }
}

fn check_room(figure: &Figure, plot: &Rectangle) -> Result<(), ReportError> {
    let (needed, left) = (SMALLEST_PLOT_PX, (plot.width(), plot.height()));
    if left.0 >= needed.0 && left.1 >= needed.1 {
        return Ok(());
    }
    Err(ReportError::too_small(&figure.title, left, needed))
}

/// As many number labels as fit side by side without touching.
pub(crate) fn number_ticks(plot: &Rectangle, x: &Axis) -> XTicks {
    let mut most = MOST_TICKS;
    loop {
        let mut ticks = x.ticks(most);
        let widths: Vec<f64> = ticks.iter().map(|t| width_px(&t.label, TEXT_PX)).collect();
        let apart = ticks
            .windows(2)
            .zip(widths.windows(2))
            .all(|(pair, widths)| {
                let distance = (x.share(pair[1].value) - x.share(pair[0].value)) * plot.width();
                distance >= 0.5 * (widths[0] + widths[1]) + LABEL_GAP_PX
            });
        if apart || most <= 2 {
            if !apart {
                ticks.truncate(1);
            }
            let overhang = |from_end: fn(f64) -> f64| {
                let beyond = |(tick, width): (&Tick, &f64)| {
                    0.5 * width - from_end(x.share(tick.value)) * plot.width()
                };
                ticks.iter().zip(&widths).map(beyond).fold(0.0, f64::max)
            };
            let overhang_px = (overhang(|share| share), overhang(|share| 1.0 - share));
            return XTicks {
                ticks,
                upward: false,
                height_px: LINE_PX,
                overhang_px,
            };
        }
        most -= 1;
    }
}

/// Category names: level when they fit, else upward, else upward with some left out.
fn category_ticks(names: &[String], plot: &Rectangle, x: &Axis) -> XTicks {
    let visible = |index: &usize| (x.low()..=x.high()).contains(&(*index as f64));
    let shown: Vec<usize> = (0..names.len()).filter(visible).collect();
    let widest = widest_px(shown.iter().map(|&index| &names[index]), TEXT_PX);
    let spacing = (x.share(1.0) - x.share(0.0)) * plot.width();
    let upward = widest + 0.6 * LABEL_GAP_PX > spacing;
    let stride = if upward {
        (LINE_PX / spacing).ceil().max(1.0) as usize
    } else {
        1
    };
    let ticks = shown
        .iter()
        .step_by(stride)
        .map(|&index| Tick {
            value: index as f64,
            label: names[index].clone(),
        })
        .collect();
    let height_px = if upward { widest + 4.0 } else { LINE_PX };
    let beyond = if upward {
        0.0
    } else {
        (0.5 * (widest - spacing)).max(0.0)
    };
    let overhang_px = (beyond, beyond);
    XTicks {
        ticks,
        upward,
        height_px,
        overhang_px,
    }
}
