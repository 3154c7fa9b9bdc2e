//! Tables of other makers as columns of a calibration log.
//!
//! A file is read as it is ([`read_table`]), a mapping file says which of its columns are which of a log ([`Mapping`]), and
//! [`apply`] makes them: names, units, rotations, rows of several files. [`guess`] proposes a mapping file with its reasons.
//!
//! ```
//! use haptical_tables::{Cells, Mapping, Reading, apply, table_from_bytes};
//!
//! let table = table_from_bytes("q1 q2\n90 -45\n0 30\n".into(), "log.txt", &Reading::default())?;
//! let mapping = "[[column]]\nlog = ['theta1_rad', 'theta2_rad']\nfrom = ['q1', 'q2']\nunit = 'deg'\n";
//! let mapping = Mapping::from_toml(mapping, "columns.toml")?;
//! let log = apply(&[table], &mapping)?;
//! assert_eq!(log.columns[0].0, "theta1_rad");
//! assert_eq!(log.columns[0].1, Cells::Numbers(vec![std::f64::consts::FRAC_PI_2, 0.0]));
//! # Ok::<(), haptical_tables::TableError>(())
//! ```

mod apply;
mod arrays;
mod error;
mod guess;
mod mapping;
mod read;
pub mod rotation;
mod table;

pub use apply::{Applied, apply};
pub use error::TableError;
pub use guess::{Joint, guess};
pub use mapping::{
    Axes, ColumnRule, Dimension, Layout, Mapping, Matching, OneOrMany, Orientation, Reading,
    Representation, RowRules, Scalar, TEXTS, Unit, Value, dimension_of,
};
pub use read::{read_table, table_from_bytes};
pub use table::{Cells, Column, Dialect, Table};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
