//! Series of a figure: points with a mark and a name.

/// How the points of a series are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Mark {
    /// Straight segments from point to point.
    Line,
    /// Dashed segments from point to point.
    DashedLine,
    /// One symbol for each point; the symbol depends on the colour.
    Points,
    /// One open circle for each point.
    Rings,
    /// One bar for each point, from 0 (or the foot of a logarithmic axis); bar series that share
    /// positions are drawn side by side.
    Bars,
    /// A shaded band; see [`Series::band`].
    Band,
    /// Error bars; see [`Series::intervals`].
    Intervals,
    /// A horizontal dashed line across the plot; see [`Series::reference`].
    Reference,
}

impl Mark {
    /// Length of a dash and of the gap behind it.
    pub(crate) fn dash_px(self) -> Option<(f64, f64)> {
        match self {
            Self::DashedLine => Some((7.0, 4.0)),
            Self::Reference => Some((3.0, 3.0)),
            _ => None,
        }
    }
}

/// A named set of points of a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend; a series with an empty name is left out of the legend.
    pub label: String,
    /// How the points are drawn.
    pub mark: Mark,
    /// Index into the palette of Okabe and Ito, which people with colour-blindness can tell apart:
    /// 0 blue, 1 vermilion, 2 green, 3 purple, 4 orange, 5 sky blue, 6 black, 7 yellow, 8 again
    /// blue.
    pub colour: usize,
    /// Points `(x, y)` in the units of the axes, in drawing order.
    pub points: Vec<(f64, f64)>,
}

impl Series {
    /// Colour of what is before: measured by the device as given, vermilion with square symbols.
    pub const BEFORE: usize = 1;
    /// Colour of what is after: the identified or corrected device, blue with round symbols.
    pub const AFTER: usize = 0;

    /// A series drawn with `mark`.
    pub fn new(
        label: impl Into<String>,
        mark: Mark,
        colour: usize,
        points: Vec<(f64, f64)>,
    ) -> Self {
        Self {
            label: label.into(),
            mark,
            colour,
            points,
        }
    }

    /// A shaded band between two curves given as `(x, low, high)`.
    ///
    /// `points` then holds the lower curve forwards and the upper curve backwards.
    pub fn band(label: impl Into<String>, colour: usize, curves: &[(f64, f64, f64)]) -> Self {
        let lower = curves.iter().map(|&(x, low, _)| (x, low));
        let upper = curves.iter().rev().map(|&(x, _, high)| (x, high));
        Self::new(label, Mark::Band, colour, lower.chain(upper).collect())
    }

    /// Error bars given as `(x, low, mid, high)`, with a symbol at `mid`.
    ///
    /// `points` then holds three points for each: low, mid and high.
    pub fn intervals(
        label: impl Into<String>,
        colour: usize,
        intervals: &[(f64, f64, f64, f64)],
    ) -> Self {
        let points = intervals
            .iter()
            .flat_map(|&(x, low, mid, high)| [(x, low), (x, mid), (x, high)]);
        Self::new(label, Mark::Intervals, colour, points.collect())
    }

    /// A horizontal reference line at `y`, across the whole plot.
    ///
    /// `points` then holds one point, of which only `y` counts.
    pub fn reference(label: impl Into<String>, colour: usize, y: f64) -> Self {
        Self::new(label, Mark::Reference, colour, vec![(0.0, y)])
    }
}

/// Counts of the values in `bins` bins of one width, as `(centre, count)` for [`Mark::Bars`].
///
/// The bins reach from the smallest to the largest value; a value between two bins belongs to the
/// upper one, the largest value to the last bin. When all values are equal the bins have width 1 in
/// total around them. Values that are not finite are not counted; without values or bins the result
/// is empty.
///
/// # Examples
/// ```
/// let counts = haptical_report::histogram(&[0.0, 0.1, 0.2, 1.0], 2);
/// assert_eq!(counts, [(0.25, 3.0), (0.75, 1.0)]);
/// ```
pub fn histogram(values: &[f64], bins: usize) -> Vec<(f64, f64)> {
    let finite: Vec<f64> = values
        .iter()
        .copied()
        .filter(|value| value.is_finite())
        .collect();
    if finite.is_empty() || bins == 0 {
        return Vec::new();
    }
    let mut low = finite.iter().copied().fold(f64::INFINITY, f64::min);
    let mut high = finite.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if low == high {
        (low, high) = (low - 0.5, high + 0.5);
    }
    // Halved before subtracting: the width of a range over all floats is itself not a float.
    let width = (high / bins as f64) - (low / bins as f64);
    let mut counts = vec![0.0; bins];
    for value in finite {
        // Not finite or beyond the end for the largest value; the cast saturates.
        let bin = ((value - low) / width).floor() as usize;
        counts[bin.min(bins - 1)] += 1.0;
    }
    let centre = |bin: usize| low + (bin as f64 + 0.5) * width;
    counts
        .into_iter()
        .enumerate()
        .map(|(bin, count)| (centre(bin), count))
        .collect()
}
