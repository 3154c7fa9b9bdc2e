//! Figures and grids of figures: what is drawn, apart from how.

pub(crate) mod axis;
pub(crate) mod clip;
pub(crate) mod draw;
pub(crate) mod layout;
pub(crate) mod legend;
pub(crate) mod panel;
pub(crate) mod series;

use crate::canvas::{Canvas, Rectangle};
use crate::error::ReportError;
use crate::figure::layout::{MARGIN_PX, PAGE_TITLE_PX, TITLE_LINE_PX};
use crate::figure::panel::draw_panel;
use crate::figure::series::{Mark, Series};
use crate::text::{BOLD_FACTOR, wrap};

/// A plot with two axes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figure {
    /// What the figure shows.
    pub title: String,
    /// Name of the horizontal axis with its unit: `joint angle [deg]`.
    pub x_label: String,
    /// Name of the vertical axis with its unit.
    pub y_label: String,
    /// Ends of the horizontal axis; `None` fits the points.
    pub x_range: Option<(f64, f64)>,
    /// Ends of the vertical axis; `None` fits the points in the horizontal range.
    pub y_range: Option<(f64, f64)>,
    /// Logarithmic vertical axis.
    pub y_log: bool,
    /// Names under the horizontal positions 0, 1, 2 and so on, instead of numbers.
    pub categories: Option<Vec<String>>,
    /// What is drawn: bands first, then bars, then the other marks in this order.
    pub series: Vec<Series>,
    /// Draws a legend above the plot.
    pub legend: bool,
}

impl Figure {
    /// A figure without series, with linear axes that fit the points and with a legend.
    ///
    /// # Examples
    /// ```
    /// use haptical_report::Figure;
    /// let mut figure = Figure::new("Capstan 1", "joint angle [deg]", "error [mrad]");
    /// let points = (-40..=40).map(|k| (f64::from(k), 0.1 * f64::from(k))).collect();
    /// figure.line("measured", 0, points);
    /// let svg = figure.to_svg(640, 400)?;
    /// assert!(svg.starts_with("<svg ") && svg.contains("joint angle [deg]"));
    /// # Ok::<(), haptical_report::ReportError>(())
    /// ```
    pub fn new(
        title: impl Into<String>,
        x_label: impl Into<String>,
        y_label: impl Into<String>,
    ) -> Self {
        Self {
            title: title.into(),
            x_label: x_label.into(),
            y_label: y_label.into(),
            legend: true,
            ..Self::default()
        }
    }

    /// Draws segments from point to point: a series of [`Mark::Line`].
    pub fn line(&mut self, label: impl Into<String>, colour: usize, points: Vec<(f64, f64)>) {
        self.series
            .push(Series::new(label, Mark::Line, colour, points));
    }

    /// Draws a symbol at each point: a series of [`Mark::Points`].
    pub fn points(&mut self, label: impl Into<String>, colour: usize, points: Vec<(f64, f64)>) {
        self.series
            .push(Series::new(label, Mark::Points, colour, points));
    }

    /// The figure as an SVG picture; the same figure gives the same bytes.
    ///
    /// # Errors
    /// [`ReportError::NonFinite`] for a NaN or infinite point, [`ReportError::NotPositive`] for a
    /// point that a logarithmic axis cannot show, [`ReportError::EmptyRange`],
    /// [`ReportError::Empty`], [`ReportError::PointCount`], [`ReportError::TooSmall`] when the
    /// labels leave no room for the plot, and [`ReportError::PictureSize`].
    pub fn to_svg(&self, width_px: u32, height_px: u32) -> Result<String, ReportError> {
        let mut canvas = Canvas::new(width_px, height_px)?;
        let page = canvas.page();
        draw_panel(&mut canvas, self, page)?;
        Ok(canvas.finish(&self.title))
    }
}

/// Several figures in one picture, row by row.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FigureGrid {
    /// Title above all panels; may be empty.
    pub title: String,
    /// Number of panels side by side; 0 is read as 1.
    pub columns: usize,
    /// The panels.
    pub figures: Vec<Figure>,
}

impl FigureGrid {
    /// A grid of figures.
    pub fn new(title: impl Into<String>, columns: usize, figures: Vec<Figure>) -> Self {
        Self {
            title: title.into(),
            columns,
            figures,
        }
    }

    /// The grid as one SVG picture of the given size; the same grid gives the same bytes.
    ///
    /// # Errors
    /// As [`Figure::to_svg`]; [`ReportError::Empty`] for a grid without figures.
    pub fn to_svg(&self, width_px: u32, height_px: u32) -> Result<String, ReportError> {
        if self.figures.is_empty() {
            return Err(ReportError::empty(&self.title, "panels"));
        }
        let mut canvas = Canvas::new(width_px, height_px)?;
        let page = canvas.page();
        let mut top = page.top;
        let inner = page.width() - 2.0 * MARGIN_PX;
        for line in wrap(&self.title, PAGE_TITLE_PX * BOLD_FACTOR, inner) {
            let at = (page.left + MARGIN_PX, top + MARGIN_PX + 0.5 * TITLE_LINE_PX);
            canvas.heading(&line, at, PAGE_TITLE_PX);
            top += TITLE_LINE_PX;
        }
        if top > page.top {
            top += MARGIN_PX;
        }
        let columns = self.columns.clamp(1, self.figures.len());
        let rows = self.figures.len().div_ceil(columns);
        let width = page.width() / columns as f64;
        let height = (page.bottom - top) / rows as f64;
        for (index, figure) in self.figures.iter().enumerate() {
            let (row, column) = ((index / columns) as f64, (index % columns) as f64);
            let (x, y) = (|n: f64| page.left + n * width, |n: f64| top + n * height);
            let area = Rectangle::new(x(column), y(row), x(column + 1.0), y(row + 1.0));
            draw_panel(&mut canvas, figure, area)?;
        }
        Ok(canvas.finish(&self.title))
    }
}
