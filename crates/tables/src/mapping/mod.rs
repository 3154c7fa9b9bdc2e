//! The mapping file `columns.toml`: how files are read, which of their columns are which of a log, in what units.

mod orientation;
mod unit;

use serde::Deserialize;

pub use self::orientation::{Axes, Layout, Orientation, Representation};
pub use self::unit::{Dimension, Unit, dimension_of};
use crate::error::TableError;

/// A mapping file.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Mapping {
    /// How the files are read; what is not said is found by looking.
    pub table: Reading,
    /// Which rows of which files belong together.
    pub rows: RowRules,
    /// The columns of the log.
    pub column: Vec<ColumnRule>,
    /// The handle's orientation, or its pose as a matrix.
    pub orientation: Option<Orientation>,
}

/// How files are read.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Reading {
    /// `,`, `;`, `|`, `tab` or `space`.
    pub separator: Option<String>,
    /// `.` or `,`.
    pub decimal: Option<String>,
    /// `utf-8` or `latin-1`.
    pub encoding: Option<String>,
    /// Sign that a line of comment begins with; without it `#` and `%`.
    pub comment: Option<String>,
    /// Lines before everything that are not read.
    pub skip_lines: Option<usize>,
    /// Whether a line has the columns' names.
    pub header: Option<bool>,
    /// Whether the line below the names has units.
    pub units_row: Option<bool>,
    /// Sheet of a spreadsheet; without it the first.
    pub sheet: Option<String>,
    /// Whether an array's last axis is the row; without it as its shape suggests.
    pub transpose: Option<bool>,
}

/// Which rows belong together.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RowRules {
    /// Files side by side that make a run; without it each file is a run.
    pub files_per_run: Option<usize>,
    /// How rows of files side by side are matched.
    #[serde(rename = "match")]
    pub matching: Matching,
    /// The column of time of each file, for `match = "time"`.
    pub time: OneOrMany,
    /// Its unit, one for all files or one for each; without it seconds.
    pub time_unit: OneOrMany,
    /// Largest distance in time \[s\]; without it half the usual distance of the first file's rows.
    pub within_s: Option<f64>,
    /// First row that is taken, counted from 1.
    pub first: Option<usize>,
    /// Every so many rows one is taken.
    pub every: Option<usize>,
    /// Rows a second, where there is no column of time: `t_s` counts the rows of each run from 0.
    pub rate_hz: Option<f64>,
}

/// How rows of files side by side are matched.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Matching {
    /// The first with the first, the second with the second.
    #[default]
    Row,
    /// A row of a shorter file stands for several successive rows of the longest: for 3 where it has a third of the rows.
    Repeat,
    /// Each row of the first file with the row of the others that is nearest in time.
    Time,
}

/// One name or several.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum OneOrMany {
    /// One.
    One(String),
    /// Several.
    Many(Vec<String>),
}

impl Default for OneOrMany {
    fn default() -> Self {
        Self::Many(Vec::new())
    }
}

impl OneOrMany {
    /// The names.
    pub fn names(&self) -> &[String] {
        match self {
            Self::One(name) => std::slice::from_ref(name),
            Self::Many(names) => names,
        }
    }
}

/// Columns of the log, and where their cells come from.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ColumnRule {
    /// Names in the log.
    pub log: OneOrMany,
    /// Names in the files, or `#3` for the third column; as many as in `log`.
    pub from: OneOrMany,
    /// Which of the files side by side, counted from 1; without it the one that has the column.
    pub file: Option<usize>,
    /// Unit of the file's numbers; without it that of the log.
    pub unit: Option<String>,
    /// Factor on the number in the log's unit.
    pub factor: Option<f64>,
    /// What is added then, in the log's unit.
    pub offset: Option<f64>,
    /// A second column of the same file and unit that is added, as often as `plus_factor` says (once without it): of a controller whose
    /// number of a joint counts from another joint's link.
    pub plus: Option<String>,
    /// See [`ColumnRule::plus`].
    pub plus_factor: Option<f64>,
    /// Counts of an encoder for a turn of the joint.
    pub counts_per_turn: Option<f64>,
    /// Count at the joint's zero.
    pub zero_counts: Option<f64>,
    /// The same cell in each row, or cells that repeat in this order.
    pub value: Option<Value>,
    /// Such a value for each run.
    pub by_run: Option<Vec<Value>>,
}

/// Cells that no file has.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// One for all rows.
    One(Scalar),
    /// In turn, from each run's first row on.
    InTurn(Vec<Scalar>),
}

/// A number or a text.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Scalar {
    /// A number, in the log's unit.
    Number(f64),
    /// A text.
    Text(String),
}

/// Columns of a log whose cells are names.
pub const TEXTS: [&str; 4] = ["hand", "contact", "plane", "tool"];

impl Mapping {
    /// Reads a mapping file that messages call `file`.
    ///
    /// # Errors
    /// It is no TOML, has an unknown key, or contradicts itself.
    ///
    /// # Examples
    /// ```
    /// use haptical_tables::Mapping;
    ///
    /// let text = "[[column]]\nlog = 'theta1_rad'\nfrom = 'q1'\nunit = 'deg'\n";
    /// assert_eq!(Mapping::from_toml(text, "columns.toml")?.column.len(), 1);
    /// let wrong = Mapping::from_toml(&text.replace("deg", "mm"), "columns.toml").unwrap_err();
    /// assert!(wrong.what.contains("`mm` is no unit of `theta1_rad`"), "{wrong}");
    /// # Ok::<(), haptical_tables::TableError>(())
    /// ```
    pub fn from_toml(text: &str, file: &str) -> Result<Self, TableError> {
        let next = "correct it; `haptical import --guess FILE` writes one to begin with";
        let read: Result<Self, _> = toml::from_str(text);
        let mapping = read.map_err(|error| {
            let refusal = TableError::new("bad-mapping", error.message(), file, next);
            let line = error
                .span()
                .map(|span| text[..span.start.min(text.len())].matches('\n').count() as u64 + 1);
            match line {
                Some(line) => refusal.at(line, None),
                None => refusal,
            }
        })?;
        let checked = mapping.check();
        checked.map_err(|what| TableError::new("bad-mapping", what, file, next))?;
        Ok(mapping)
    }

    /// What contradicts itself, in words.
    ///
    /// # Errors
    /// A name twice, lists of unequal length, a unit of another kind than the log's, a count that is not above 0.
    pub fn check(&self) -> Result<(), String> {
        let mut names: Vec<&str> = Vec::new();
        for rule in &self.column {
            rule.check()?;
            names.extend(rule.log.names().iter().map(String::as_str));
        }
        if let Some(orientation) = &self.orientation {
            orientation.check()?;
            names.extend(orientation.outputs());
        }
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(format!("`{}` is given twice", pair[0]));
        }
        let rows = &self.rows;
        if [rows.files_per_run, rows.first, rows.every].contains(&Some(0)) {
            return Err("files_per_run, first and every in [rows] count from 1".to_owned());
        }
        let positive = |name: &str, value: Option<f64>| match value {
            Some(value) if !(value > 0.0 && value.is_finite()) => {
                Err(format!("{name} in [rows] is a number above 0"))
            }
            _ => Ok(()),
        };
        positive("within_s", rows.within_s)?;
        positive("rate_hz", rows.rate_hz)?;
        for unit in rows.time_unit.names() {
            factor(unit, "t_s")?;
        }
        if rows.rate_hz.is_some() && names.contains(&"t_s") {
            return Err(
                "both rate_hz and a column `t_s` say the time; keep one of them".to_owned(),
            );
        }
        self.table
            .separator()
            .and(self.table.decimal())
            .map_err(|error| error.what)?;
        match self.table.encoding.as_deref() {
            None | Some("utf-8" | "latin-1") => Ok(()),
            Some(other) => Err(format!(
                "encoding `{other}` in [table] is neither utf-8 nor latin-1"
            )),
        }
    }
}

/// Factor and zero that take a unit's numbers to a log's column.
pub(crate) fn factor(unit: &str, log: &str) -> Result<(f64, f64), String> {
    let known = Unit::parse(unit).ok_or_else(|| {
        format!("`{unit}` is no unit that is known; write the factor as `factor = 0.001`")
    })?;
    match dimension_of(log) {
        Some(dimension) if dimension == known.dimension => Ok((known.factor, known.zero)),
        _ => Err(format!("`{unit}` is no unit of `{log}`")),
    }
}

impl ColumnRule {
    fn check(&self) -> Result<(), String> {
        let names = self.log.names();
        let first = names
            .first()
            .ok_or("a [[column]] without `log`, its name in the log")?;
        let sources = [
            !self.from.names().is_empty(),
            self.value.is_some(),
            self.by_run.is_some(),
        ];
        if sources.iter().filter(|is_given| **is_given).count() != 1 {
            return Err(format!("`{first}` needs one of from, value and by_run"));
        }
        if sources[0] && self.from.names().len() != names.len() {
            let (own, from) = (names.len(), self.from.names().len());
            return Err(format!(
                "`{first}`: {own} names in `log` and {from} in `from`"
            ));
        }
        let is_scaled = [
            self.factor,
            self.offset,
            self.counts_per_turn,
            self.zero_counts,
        ]
        .iter()
        .any(Option::is_some);
        if (is_scaled || self.unit.is_some()) && !sources[0] {
            return Err(format!(
                "`{first}` has a value, which is in the log's own unit: leave out unit and factor"
            ));
        }
        if self.plus.is_some()
            && (names.len() != 1 || !sources[0] || TEXTS.contains(&first.as_str()))
        {
            return Err(format!(
                "`{first}` has a column `plus`, which is added to one column of numbers: give each its own [[column]]"
            ));
        }
        if self.plus_factor.is_some() && self.plus.is_none() {
            return Err(format!(
                "`{first}` has plus_factor and no `plus`, the column that it is of"
            ));
        }
        for name in names {
            if let Some(unit) = &self.unit {
                factor(unit, name)?;
            }
            if (is_scaled || self.unit.is_some()) && TEXTS.contains(&name.as_str()) {
                return Err(format!("`{name}` holds names, which have no unit"));
            }
            if self.counts_per_turn.is_some() && dimension_of(name) != Some(Dimension::Angle) {
                return Err(format!(
                    "`{name}` is no angle, and counts_per_turn are counts of one turn"
                ));
            }
        }
        if self.counts_per_turn.is_some() && self.unit.is_some() {
            return Err(format!(
                "`{first}` has both unit and counts_per_turn; keep one of them"
            ));
        }
        if self.zero_counts.is_some() && self.counts_per_turn.is_none() {
            return Err(format!("`{first}` has zero_counts without counts_per_turn"));
        }
        if self.counts_per_turn == Some(0.0) {
            return Err(format!(
                "`{first}` needs its counts_per_turn: how many counts of the encoder are a turn of the joint, with the gear's ratio"
            ));
        }
        let given = [self.factor, self.counts_per_turn];
        if given
            .iter()
            .flatten()
            .any(|number| *number == 0.0 || !number.is_finite())
        {
            return Err(format!(
                "`{first}`: factor and counts_per_turn are numbers other than 0"
            ));
        }
        match [self.offset, self.zero_counts]
            .iter()
            .flatten()
            .all(|number| number.is_finite())
        {
            true => Ok(()),
            false => Err(format!(
                "`{first}`: offset and zero_counts are finite numbers"
            )),
        }
    }

    /// Whether it leaves units to the file.
    pub(crate) fn is_silent_on_units(&self) -> bool {
        let is_scaled = self.factor.is_some() || self.offset.is_some();
        self.unit.is_none() && self.counts_per_turn.is_none() && !is_scaled
    }

    /// Factor and zero on a column's numbers: `factor * number + zero` is in the log's unit.
    pub(crate) fn scale(&self, log: &str) -> Result<(f64, f64), String> {
        let (unit, unit_zero) = match (&self.unit, self.counts_per_turn) {
            (Some(unit), _) => factor(unit, log)?,
            (None, Some(counts)) => {
                let unit = std::f64::consts::TAU / counts;
                (unit, -unit * self.zero_counts.unwrap_or(0.0))
            }
            (None, None) => (1.0, 0.0),
        };
        let own = self.factor.unwrap_or(1.0);
        Ok((own * unit, own * unit_zero + self.offset.unwrap_or(0.0)))
    }
}

impl Reading {
    fn refuse<T>(what: String, next: &str) -> Result<T, TableError> {
        Err(TableError::new(
            "bad-mapping",
            what,
            "[table] of the mapping file",
            next,
        ))
    }

    /// The separator that is said.
    pub(crate) fn separator(&self) -> Result<Option<char>, TableError> {
        Ok(Some(match self.separator.as_deref() {
            None => return Ok(None),
            Some("tab" | "\t") => '\t',
            Some("space" | " ") => ' ',
            Some(",") => ',',
            Some(";") => ';',
            Some("|") => '|',
            Some(other) => {
                let what = format!("separator `{other}` is none that is known");
                return Self::refuse(what, "write \",\", \";\", \"|\", \"tab\" or \"space\"");
            }
        }))
    }

    /// The decimal sign that is said.
    pub(crate) fn decimal(&self) -> Result<Option<char>, TableError> {
        match self.decimal.as_deref() {
            None => Ok(None),
            Some(".") => Ok(Some('.')),
            Some(",") => Ok(Some(',')),
            Some(other) => Self::refuse(
                format!("decimal `{other}` is no decimal sign"),
                "write \".\" or \",\"",
            ),
        }
    }
}
