//! The legend: entries in rows above the plot, where no point can be.

use crate::canvas::{Anchor, Canvas, Rectangle, Stroke};
use crate::colour::Colour;
use crate::figure::Figure;
use crate::figure::clip::dashes;
use crate::figure::draw::{LINE_WIDTH_PX, marker, ring};
use crate::figure::layout::{LINE_PX, TEXT_PX};
use crate::figure::series::Mark;
use crate::text::{widest_px, wrap};

/// Width of the sample before a name.
const SAMPLE_PX: f64 = 26.0;
/// Space between a sample and its name.
const NAME_GAP_PX: f64 = 6.0;
/// Space between two entries.
const ENTRY_GAP_PX: f64 = 20.0;

#[derive(Debug, Clone)]
struct Entry {
    lines: Vec<String>,
    mark: Mark,
    colour: usize,
    left: f64,
    row: usize,
}

/// Entries with their places relative to the upper left corner of the legend.
#[derive(Debug, Clone)]
pub(crate) struct Legend {
    entries: Vec<Entry>,
    rows: usize,
}

impl Legend {
    /// Fills rows of the given width with the named series, in their order.
    pub(crate) fn new(figure: &Figure, width: f64) -> Self {
        let mut legend = Self {
            entries: Vec::new(),
            rows: 0,
        };
        if !figure.legend {
            return legend;
        }
        let (mut left, mut row, mut row_lines) = (0.0, 0, 0);
        for series in figure
            .series
            .iter()
            .filter(|series| !series.label.trim().is_empty())
        {
            let lines = wrap(&series.label, TEXT_PX, width - SAMPLE_PX - NAME_GAP_PX);
            let entry_width = SAMPLE_PX + NAME_GAP_PX + widest_px(lines.iter(), TEXT_PX);
            if left > 0.0 && left + entry_width > width {
                (left, row, row_lines) = (0.0, row + row_lines, 0);
            }
            row_lines = row_lines.max(lines.len());
            legend.entries.push(Entry {
                lines,
                mark: series.mark,
                colour: series.colour,
                left,
                row,
            });
            left += entry_width + ENTRY_GAP_PX;
        }
        legend.rows = row + row_lines;
        legend
    }

    /// Height of the legend; 0 without entries.
    pub(crate) fn height_px(&self) -> f64 {
        self.rows as f64 * (LINE_PX + 2.0)
    }

    /// Draws the legend with its upper left corner at the point.
    pub(crate) fn draw(&self, canvas: &mut Canvas, left: f64, top: f64) {
        for entry in &self.entries {
            let x = left + entry.left;
            let y = top + (entry.row as f64 + 0.5) * (LINE_PX + 2.0);
            entry.draw_sample(canvas, x, y);
            for (index, line) in entry.lines.iter().enumerate() {
                let at = (
                    x + SAMPLE_PX + NAME_GAP_PX,
                    y + index as f64 * (LINE_PX + 2.0),
                );
                canvas.text(line, at, TEXT_PX, Anchor::Start);
            }
        }
    }
}

impl Entry {
    fn draw_sample(&self, canvas: &mut Canvas, x: f64, y: f64) {
        let colour = Colour::palette(self.colour);
        let stroke = Stroke::new(colour, LINE_WIDTH_PX);
        let line = [(x, y), (x + SAMPLE_PX, y)];
        let middle = x + 0.5 * SAMPLE_PX;
        let block = Rectangle::new(x + 4.0, y - 6.0, x + SAMPLE_PX - 4.0, y + 6.0);
        match self.mark {
            Mark::Line => canvas.path(&line, stroke),
            Mark::DashedLine | Mark::Reference => {
                let (dash_px, gap_px) = self.mark.dash_px().unwrap_or_default();
                for dash in dashes(&line, dash_px, gap_px) {
                    canvas.path(&dash, stroke);
                }
            }
            Mark::Rings => ring(canvas, (middle, y), self.colour, 4.0),
            Mark::Points => marker(canvas, (middle, y), self.colour, 4.0),
            Mark::Bars => canvas.fill(block, colour),
            Mark::Band => canvas.fill(block, colour.with_opacity(0.25)),
            Mark::Intervals => {
                canvas.path(&[(middle, y - 7.0), (middle, y + 7.0)], stroke);
                for end in [y - 7.0, y + 7.0] {
                    canvas.path(&[(middle - 4.0, end), (middle + 4.0, end)], stroke);
                }
                marker(canvas, (middle, y), self.colour, 3.5);
            }
        }
    }
}
