//! A grid of shaded cells with a text in each, under column names and behind row names.

use crate::canvas::{Anchor, Canvas, Rectangle};
use crate::colour::Colour;
use crate::error::ReportError;
use crate::figure::layout::{
    LINE_PX, MARGIN_PX, TEXT_PX, TITLE_LINE_PX, TITLE_PX, draw_name, draw_title,
};
use crate::text::{BOLD_FACTOR, widest_px, width_px, wrap};

/// Height of a row.
const ROW_PX: f64 = 28.0;
/// Largest and smallest width of a cell.
const CELL_PX: (f64, f64) = (110.0, 24.0);
/// Largest share of the picture's width for the row names.
const NAME_SHARE: f64 = 0.5;
/// Space between a row's name and its first cell.
const GAP_PX: f64 = 8.0;
/// Free space around a cell.
const SEAM_PX: f64 = 1.0;

/// One cell.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatCell {
    /// From 0, nearly the page's, to 1, the full colour; values outside count as the nearer end.
    pub shade: f64,
    /// Text in the cell.
    pub text: String,
}

/// A grid of shaded cells.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HeatMap {
    /// What the picture shows.
    pub title: String,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Names of the rows, each with one cell per column; `None` is a cell without a value.
    pub rows: Vec<(String, Vec<Option<HeatCell>>)>,
}

impl HeatMap {
    /// A grid without rows.
    ///
    /// # Examples
    /// ```
    /// use haptical_report::{HeatCell, HeatMap};
    /// let mut map = HeatMap::new("Candidates", vec!["joint 1".to_owned(), "joint 2".to_owned()]);
    /// let cell = HeatCell { shade: 1.0, text: "98 %".to_owned() };
    /// map.rows.push(("backlash".to_owned(), vec![None, Some(cell)]));
    /// assert!(map.to_svg(640)?.contains("98 %"));
    /// # Ok::<(), haptical_report::ReportError>(())
    /// ```
    pub fn new(title: impl Into<String>, columns: Vec<String>) -> Self {
        Self {
            title: title.into(),
            columns,
            rows: Vec::new(),
        }
    }

    /// The picture as SVG, as high as its rows need; the same grid gives the same bytes.
    ///
    /// # Errors
    /// [`ReportError::RowWidth`] for a row with more or fewer cells than columns,
    /// [`ReportError::NonFinite`] for a shade that is not finite, [`ReportError::Empty`] without rows
    /// or columns, [`ReportError::TooSmall`] when the names leave no room for the cells, and
    /// [`ReportError::PictureSize`].
    ///
    /// [`HeatMap::width_px`] is a width that fits.
    pub fn to_svg(&self, width_px: u32) -> Result<String, ReportError> {
        self.check()?;
        let width = f64::from(width_px);
        let title = wrap(&self.title, TITLE_PX * BOLD_FACTOR, width - 2.0 * MARGIN_PX);
        let names = self.rows.iter();
        let names = names.map(|(name, _)| wrap(name, TEXT_PX, NAME_SHARE * width));
        let names: Vec<Vec<String>> = names.collect();
        let name_px = widest_px(names.iter().flatten(), TEXT_PX);
        let left = MARGIN_PX + name_px + GAP_PX;
        let cell = ((width - MARGIN_PX - left) / self.columns.len() as f64).min(CELL_PX.0);
        let heads = self.columns.iter();
        let heads = heads.map(|name| wrap(name, TEXT_PX, cell - 4.0 * SEAM_PX));
        let heads: Vec<Vec<String>> = heads.collect();
        let head_lines = heads.iter().map(Vec::len).max().unwrap_or(0) as f64;
        let top = MARGIN_PX + title.len() as f64 * TITLE_LINE_PX + head_lines * LINE_PX + 6.0;
        let height = |lines: &Vec<String>| ROW_PX.max(lines.len() as f64 * LINE_PX + 6.0);
        let bottom = top + names.iter().map(height).sum::<f64>() + MARGIN_PX;
        if cell < CELL_PX.1 {
            let count = self.columns.len() as f64;
            let (left, needed) = ((cell * count, bottom - top), (CELL_PX.1 * count, ROW_PX));
            return Err(ReportError::too_small(&self.title, left, needed));
        }
        let mut canvas = Canvas::new(width_px, bottom.ceil() as u32)?;
        draw_title(&mut canvas, &title, (0.0, 0.0));
        for (column, lines) in heads.iter().enumerate() {
            let x = left + (column as f64 + 0.5) * cell;
            for (place, line) in lines.iter().rev().enumerate() {
                let y = top - 4.0 - (place as f64 + 0.5) * LINE_PX;
                canvas.text(line, (x, y), TEXT_PX, Anchor::Middle);
            }
        }
        let mut upper = top;
        for ((_, cells), lines) in self.rows.iter().zip(&names) {
            let lower = upper + height(lines);
            let middle = 0.5 * (upper + lower);
            draw_name(&mut canvas, lines, (left - GAP_PX, middle));
            for (column, content) in cells.iter().enumerate() {
                let start = left + column as f64 * cell;
                let (x, y) = (start + SEAM_PX, upper + SEAM_PX);
                let area = Rectangle::new(x, y, start + cell - SEAM_PX, lower - SEAM_PX);
                draw_cell(&mut canvas, area, content.as_ref());
            }
            upper = lower;
        }
        Ok(canvas.finish(&self.title))
    }

    /// The least width at which every cell's text is in its cell, at least `least_px`.
    pub fn width_px(&self, least_px: u32) -> u32 {
        let cells = self.rows.iter().flat_map(|(_, cells)| cells).flatten();
        let texts = widest_px(cells.map(|cell| &cell.text), TEXT_PX);
        // a column's name is broken between its words
        let words = self.columns.iter().flat_map(|name| name.split_whitespace());
        let words = words.map(|word| width_px(word, TEXT_PX));
        let cell = (words.fold(texts, f64::max) + 6.0 * SEAM_PX).clamp(CELL_PX.1, CELL_PX.0);
        let names = self.rows.iter().map(|(name, _)| width_px(name, TEXT_PX));
        let names = names.fold(0.0, f64::max);
        let all = 2.0 * MARGIN_PX + names + GAP_PX + cell * self.columns.len() as f64;
        all.max(f64::from(least_px)).ceil() as u32
    }

    fn check(&self) -> Result<(), ReportError> {
        for (is_empty, missing) in [
            (self.columns.is_empty(), "columns"),
            (self.rows.is_empty(), "rows"),
        ] {
            if is_empty {
                return Err(ReportError::empty(&self.title, missing));
            }
        }
        for (index, (name, cells)) in self.rows.iter().enumerate() {
            if cells.len() != self.columns.len() {
                return Err(ReportError::RowWidth {
                    table: self.title.clone(),
                    expected: self.columns.len(),
                    got: cells.len(),
                });
            }
            let odd = cells.iter().flatten().find(|cell| !cell.shade.is_finite());
            if let Some(cell) = odd {
                return Err(ReportError::NonFinite {
                    place: format!("figure \"{}\", row \"{name}\"", self.title),
                    index,
                    value: cell.shade,
                });
            }
        }
        Ok(())
    }
}

fn draw_cell(canvas: &mut Canvas, area: Rectangle, content: Option<&HeatCell>) {
    let middle = (
        0.5 * (area.left + area.right),
        0.5 * (area.top + area.bottom),
    );
    match content {
        None => canvas.circle(middle, 1.2, Colour::AXIS),
        Some(cell) => {
            let colour = Colour::SHADE.with_opacity(cell.shade.clamp(0.0, 1.0));
            canvas.fill(area, colour);
            if !cell.text.is_empty() {
                canvas.text(&cell.text, middle, TEXT_PX, Anchor::Middle);
            }
        }
    }
}
