//! Rows of horizontal bars with a name before and a value behind each: waterfalls and shares.

use crate::canvas::{Anchor, Canvas, Rectangle, Stroke};
use crate::colour::Colour;
use crate::error::ReportError;
use crate::figure::axis::Axis;
use crate::figure::layout::{
    LINE_PX, MARGIN_PX, TEXT_PX, TICK_PX, TITLE_LINE_PX, TITLE_PX, draw_name, draw_title,
    number_ticks,
};
use crate::text::{BOLD_FACTOR, widest_px, wrap};

/// Height of a row whose name has one line.
const ROW_PX: f64 = 32.0;
/// Share of a row's height that its bar takes.
const BAR_SHARE: f64 = 0.62;
/// Largest share of the picture's width for the names.
const NAME_SHARE: f64 = 0.4;
/// Space between a name or a value and the bar.
const GAP_PX: f64 = 7.0;
/// Free space beyond the longest bar, as a share of the range.
const X_MARGIN: f64 = 0.03;
/// Smallest width of the plot.
const SMALLEST_PLOT_PX: f64 = 80.0;

/// One bar with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct BarRow {
    /// Name before the bar.
    pub name: String,
    /// Where the bar begins, in the unit of the axis.
    pub from: f64,
    /// Where it ends; may lie below `from`.
    pub to: f64,
    /// Index into the palette, as [`crate::Series::colour`].
    pub colour: usize,
    /// Text behind the bar; may be empty.
    pub value: String,
}

/// Bars under each other on one axis that begins at zero.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BarRows {
    /// What the picture shows.
    pub title: String,
    /// Name of the axis with its unit: `residual [mrad]`.
    pub x_label: String,
    /// The bars, from the top.
    pub rows: Vec<BarRow>,
    /// Draws a thin line from the end of each bar to the next one, as in a waterfall.
    pub connected: bool,
}

/// Places of the parts.
struct Layout {
    title: Vec<String>,
    names: Vec<Vec<String>>,
    /// Lines of the axis's name.
    x_label: Vec<String>,
    /// Upper edge of each row, and the lower edge of the last one.
    edges: Vec<f64>,
    plot: Rectangle,
    width: f64,
    height: f64,
}

impl BarRows {
    /// A picture without bars.
    ///
    /// # Examples
    /// ```
    /// use haptical_report::{BarRow, BarRows};
    /// let mut gap = BarRows::new("Gap", "residual [mrad]");
    /// let row = |name: &str, from, to| BarRow {
    ///     name: name.to_owned(),
    ///     from,
    ///     to,
    ///     colour: 0,
    ///     value: format!("{:.1}", to - from),
    /// };
    /// gap.rows = vec![row("before", 0.0, 1.2), row("backlash", 1.2, 0.2)];
    /// gap.connected = true;
    /// assert!(gap.to_svg(640)?.contains("backlash"));
    /// # Ok::<(), haptical_report::ReportError>(())
    /// ```
    pub fn new(title: impl Into<String>, x_label: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            x_label: x_label.into(),
            ..Self::default()
        }
    }

    /// The picture as SVG, as high as its rows need; the same rows give the same bytes.
    ///
    /// # Errors
    /// [`ReportError::NonFinite`] for a NaN or infinite end of a bar, [`ReportError::Empty`] without
    /// rows, [`ReportError::TooSmall`] when names and values leave no room for the bars, and
    /// [`ReportError::PictureSize`].
    pub fn to_svg(&self, width_px: u32) -> Result<String, ReportError> {
        for (index, row) in self.rows.iter().enumerate() {
            if let Some(value) = [row.from, row.to].into_iter().find(|end| !end.is_finite()) {
                return Err(ReportError::NonFinite {
                    place: format!("figure \"{}\", bar \"{}\"", self.title, row.name),
                    index,
                    value,
                });
            }
        }
        let ends = self.rows.iter().flat_map(|row| [row.from, row.to]);
        let ends: Vec<f64> = ends.collect();
        let empty = || ReportError::empty(&self.title, "bars");
        if self.rows.is_empty() {
            return Err(empty());
        }
        let axis = Axis::around(&ends, false, X_MARGIN, Some(0.0)).ok_or_else(empty)?;
        let layout = self.layout(f64::from(width_px))?;
        let mut canvas = Canvas::new(width_px, layout.height.ceil() as u32)?;
        self.draw(&mut canvas, &layout, &axis);
        Ok(canvas.finish(&self.title))
    }

    fn layout(&self, width: f64) -> Result<Layout, ReportError> {
        let inner = width - 2.0 * MARGIN_PX;
        let title = wrap(&self.title, TITLE_PX * BOLD_FACTOR, inner);
        let names = self.rows.iter();
        let names = names.map(|row| wrap(&row.name, TEXT_PX, NAME_SHARE * width));
        let names: Vec<Vec<String>> = names.collect();
        let name_px = widest_px(names.iter().flatten(), TEXT_PX);
        let value_px = widest_px(self.rows.iter().map(|row| &row.value), TEXT_PX);
        let top = MARGIN_PX + title.len() as f64 * TITLE_LINE_PX + 4.0;
        let mut edges = vec![top];
        let mut edge = top;
        for lines in &names {
            edge += ROW_PX.max(lines.len() as f64 * LINE_PX + 8.0);
            edges.push(edge);
        }
        let plot = Rectangle {
            left: MARGIN_PX + name_px + GAP_PX,
            top,
            right: width - MARGIN_PX - value_px - GAP_PX,
            bottom: edge,
        };
        if plot.width() < SMALLEST_PLOT_PX {
            let (left, needed) = ((plot.width(), plot.height()), (SMALLEST_PLOT_PX, ROW_PX));
            return Err(ReportError::too_small(&self.title, left, needed));
        }
        let x_label = wrap(&self.x_label, TEXT_PX, inner);
        let label_px = match x_label.len() {
            0 => 0.0,
            lines => lines as f64 * LINE_PX + 4.0,
        };
        let height = edge + TICK_PX + 3.0 + LINE_PX + label_px + MARGIN_PX;
        Ok(Layout {
            title,
            names,
            x_label,
            edges,
            plot,
            width,
            height,
        })
    }

    fn draw(&self, canvas: &mut Canvas, layout: &Layout, axis: &Axis) {
        let plot = layout.plot;
        draw_title(canvas, &layout.title, (0.0, 0.0));
        let x_px = |value: f64| plot.left + axis.share(value) * plot.width();
        let line = |colour| Stroke::new(colour, 1.0);
        let ticks = number_ticks(&plot, axis).ticks;
        for tick in &ticks {
            let x = x_px(tick.value);
            canvas.path(&[(x, plot.top), (x, plot.bottom)], line(Colour::GRID));
        }
        for (index, row) in self.rows.iter().enumerate() {
            let (top, bottom) = (layout.edges[index], layout.edges[index + 1]);
            let middle = 0.5 * (top + bottom);
            let half = 0.5 * BAR_SHARE * ROW_PX;
            let (left, right) = (x_px(row.from.min(row.to)), x_px(row.from.max(row.to)));
            // a bar of no length still shows its place
            let right = right.max(left + 1.0);
            let bar = Rectangle::new(left, middle - half, right, middle + half);
            canvas.fill(bar, Colour::palette(row.colour));
            if self.connected && index + 1 < self.rows.len() {
                let x = x_px(row.to);
                let next = 0.5 * (bottom + layout.edges[index + 2]) - half;
                canvas.path(&[(x, middle + half), (x, next)], line(Colour::AXIS));
            }
            if !row.value.is_empty() {
                let behind = (bar.right + GAP_PX, middle);
                canvas.text(&row.value, behind, TEXT_PX, Anchor::Start);
            }
            draw_name(canvas, &layout.names[index], (plot.left - GAP_PX, middle));
        }
        let corner = (plot.left, plot.bottom);
        let frame = [(plot.left, plot.top), corner, (plot.right, plot.bottom)];
        canvas.path(&frame, line(Colour::AXIS));
        let under = plot.bottom + TICK_PX + 3.0;
        for tick in &ticks {
            let x = x_px(tick.value);
            let ends = [(x, plot.bottom), (x, plot.bottom + TICK_PX)];
            canvas.path(&ends, line(Colour::AXIS));
            let place = (x, under + 0.5 * LINE_PX);
            canvas.text(&tick.label, place, TEXT_PX, Anchor::Middle);
        }
        // under the middle of the bars, as far as it fits there
        let half = 0.5 * widest_px(layout.x_label.iter(), TEXT_PX);
        let farthest = layout.width - MARGIN_PX - half;
        let middle = (0.5 * (plot.left + plot.right))
            .min(farthest)
            .max(MARGIN_PX + half);
        for (line, text) in layout.x_label.iter().enumerate() {
            let y = under + (1.5 + line as f64) * LINE_PX + 4.0;
            canvas.text(text, (middle, y), TEXT_PX, Anchor::Middle);
        }
    }
}
