//! Units of a data set that does not say them.

use clap::ValueEnum;

/// Units of a data set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Units {
    /// Degrees
    Degrees,
    /// -100 to 100 between the joint's limits; 0 to 100 for a gripper
    Percent,
    /// Radians
    Radians,
}

/// No joint turns by more percent.
pub(crate) const MOST_PERCENT: f64 = 101.0;
