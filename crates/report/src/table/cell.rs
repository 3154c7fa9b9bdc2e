//! Columns and cells of a table, and how one cell reads as text.

/// Magnitude from which a number with fixed decimals is written with an exponent instead.
const LONGEST_FIXED: f64 = 1e15;
/// Text of a cell without a value.
pub(crate) const MISSING: &str = "–";

/// Head of a column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// What the column holds.
    pub name: String,
    /// Its unit, empty for none.
    pub unit: String,
}

impl Column {
    /// A column; `unit` is empty for text and for numbers without a unit.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
        }
    }

    /// Name and unit on one line: `position error [mm]`.
    pub(crate) fn heading(&self) -> String {
        self.heading_of_end("")
    }

    /// The same with a word behind the name: `position error low [mm]`.
    pub(crate) fn heading_of_end(&self, end: &str) -> String {
        match self.unit.as_str() {
            "" => format!("{}{end}", self.name),
            unit => format!("{}{end} [{unit}]", self.name),
        }
    }
}

/// One cell of a table: the value and how many digits of it people see.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number with fixed decimals.
    Number {
        /// The number, not rounded.
        value: f64,
        /// Digits after the point shown to people.
        decimals: usize,
    },
    /// A number with an exponent.
    Scientific {
        /// The number, not rounded.
        value: f64,
        /// Significant digits shown to people.
        digits: usize,
    },
    /// An interval with fixed decimals.
    Interval {
        /// Lower end, not rounded.
        low: f64,
        /// Upper end, not rounded.
        high: f64,
        /// Digits after the point shown to people.
        decimals: usize,
    },
    /// No value.
    Missing,
}

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Self::Text(text.into())
    }
}

impl Cell {
    /// A number shown with `decimals` digits after the point.
    pub fn number(value: f64, decimals: usize) -> Self {
        Self::Number { value, decimals }
    }

    /// A number shown with `digits` significant digits and an exponent.
    pub fn scientific(value: f64, digits: usize) -> Self {
        Self::Scientific { value, digits }
    }

    /// An interval shown with `decimals` digits after the point.
    pub fn interval(low: f64, high: f64, decimals: usize) -> Self {
        Self::Interval {
            low,
            high,
            decimals,
        }
    }

    /// The interval when there is one and `Missing` when it is not known.
    pub fn interval_or_missing(ends: Option<[f64; 2]>, decimals: usize) -> Self {
        ends.map_or(Self::Missing, |[low, high]| {
            Self::interval(low, high, decimals)
        })
    }

    /// The number when there is one and `None` when the value is not known.
    pub fn number_or_missing(value: Option<f64>, decimals: usize) -> Self {
        value.map_or(Self::Missing, |value| Self::number(value, decimals))
    }

    /// The cell as people read it.
    pub(crate) fn display(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Number { value, decimals } => fixed(*value, *decimals),
            Self::Scientific { value, digits } => scientific(*value, *digits),
            Self::Interval {
                low,
                high,
                decimals,
            } => {
                format!("{} to {}", fixed(*low, *decimals), fixed(*high, *decimals))
            }
            Self::Missing => MISSING.to_owned(),
        }
    }

    /// True for cells at the right edge of their column.
    pub(crate) fn is_numeric(&self) -> bool {
        !self.numbers().is_empty()
    }

    /// The numbers in the cell.
    pub(crate) fn numbers(&self) -> Vec<f64> {
        match self {
            Self::Number { value, .. } | Self::Scientific { value, .. } => vec![*value],
            Self::Interval { low, high, .. } => vec![*low, *high],
            Self::Text(_) | Self::Missing => Vec::new(),
        }
    }
}

/// Fixed decimals, without a minus before a number that rounds to zero.
fn fixed(value: f64, decimals: usize) -> String {
    if value.abs() >= LONGEST_FIXED {
        return scientific(value, decimals + 1);
    }
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|byte| byte == b'0' || byte == b'.') => {
            digits.to_owned()
        }
        _ => text,
    }
}

fn scientific(value: f64, digits: usize) -> String {
    let after_point = digits.saturating_sub(1);
    format!("{value:.after_point$e}")
}

/// All digits of a number, for programs: the shortest text that reads back as the same number.
pub(crate) fn raw(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude == 0.0 {
        "0".to_owned()
    } else if (1e-5..LONGEST_FIXED).contains(&magnitude) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}
