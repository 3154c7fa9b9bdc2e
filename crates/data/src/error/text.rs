//! Messages that depend on what was found; those of the other faults are attributes of their variants.

use std::fmt::{Formatter, Result};
use std::io;

use crate::error::near_miss::{NearMiss, advice, list};

pub(crate) fn corrupt_gzip(source: &io::Error, to: &mut Formatter<'_>) -> Result {
    let state = if source.kind() == io::ErrorKind::UnexpectedEof {
        "cut off"
    } else {
        "damaged"
    };
    write!(
        to,
        "the gzip data is {state} ({source}); copy or record the file again"
    )
}

pub(crate) fn no_header(found: &str, to: &mut Formatter<'_>) -> Result {
    let what = if found.is_empty() {
        "the file has no header, it is empty".to_owned()
    } else {
        format!("no header, the first line starts with the number `{found}`")
    };
    write!(
        to,
        "{what}; the first line must name the columns, such as `t_s,theta1_rad,cable_m`"
    )
}

pub(crate) fn missing_column(
    missing: &[String],
    required: &[String],
    near_misses: &[NearMiss],
    to: &mut Formatter<'_>,
) -> Result {
    write!(
        to,
        "missing {}; the device needs one column per joint: {}{}",
        list(missing),
        list(required),
        advice(near_misses)
    )
}

pub(crate) fn wrong_unit(
    joint: &str,
    prismatic: &bool,
    expected: &str,
    to: &mut Formatter<'_>,
) -> Result {
    let kind = if *prismatic { "prismatic" } else { "revolute" };
    write!(
        to,
        "joint {joint} is {kind} in the device file, so this column must be `{expected}`; \
         convert and rename it, or correct the joint's type"
    )
}

pub(crate) fn incomplete_group(
    present: &[String],
    missing: &[String],
    to: &mut Formatter<'_>,
) -> Result {
    write!(
        to,
        "{} given without {}; add the missing columns or delete the others",
        list(present),
        list(missing)
    )
}
