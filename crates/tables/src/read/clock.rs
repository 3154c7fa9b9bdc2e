//! A cell of a text as a time of a clock: a date and a time (ISO 8601, RFC 3339), or a time of the day.

use chrono::{DateTime, NaiveDateTime, NaiveTime, Timelike};

/// Dates with a time, year first; of others day and month could be mistaken for each other.
const DATES: [&str; 4] = [
    "%Y-%m-%d %H:%M:%S%.f",
    "%Y-%m-%dT%H:%M:%S%.f",
    "%Y/%m/%d %H:%M:%S%.f",
    "%Y%m%dT%H%M%S%.f",
];
/// The same with a distance from UTC.
const WITH_ZONE: [&str; 2] = ["%Y-%m-%d %H:%M:%S%.f%#z", "%Y-%m-%dT%H:%M:%S%.f%#z"];

/// Seconds since 1970, in UTC where the cell says its zone, or since midnight.
pub(super) fn seconds(cell: &str) -> Option<f64> {
    let begins = cell.as_bytes().first().is_some_and(u8::is_ascii_digit);
    if !begins || cell.len() < 6 {
        return None;
    }
    // of a spreadsheet or a database with a decimal comma
    let cell = cell.replacen(',', ".", 1);
    let bare = cell.strip_suffix(['Z', 'z']).unwrap_or(&cell);
    let of = |whole: i64, nanoseconds: u32| whole as f64 + 1e-9 * f64::from(nanoseconds);
    let plain = DATES
        .iter()
        .find_map(|form| NaiveDateTime::parse_from_str(bare, form).ok());
    if let Some(time) = plain.map(|time| time.and_utc()) {
        return Some(of(time.timestamp(), time.timestamp_subsec_nanos()));
    }
    let with_zone = WITH_ZONE
        .iter()
        .find_map(|form| DateTime::parse_from_str(&cell, form).ok());
    if let Some(time) = with_zone {
        return Some(of(time.timestamp(), time.timestamp_subsec_nanos()));
    }
    let of_day = NaiveTime::parse_from_str(&cell, "%H:%M:%S%.f").ok()?;
    Some(of(
        i64::from(of_day.num_seconds_from_midnight()),
        of_day.nanosecond(),
    ))
}

/// The seconds of a column whose filled cells are all times; none where one is not, or where none is filled.
pub(super) fn column<'c>(cells: impl Iterator<Item = &'c str>) -> Option<Vec<f64>> {
    let mut is_filled = false;
    let seconds: Option<Vec<f64>> = cells
        .map(|cell| {
            if super::number::is_missing(cell) {
                return Some(f64::NAN);
            }
            is_filled = true;
            seconds(cell)
        })
        .collect();
    seconds.filter(|_| is_filled)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against `datetime.fromisoformat(...).timestamp()` of Python.
    #[test]
    fn clocks_are_read_as_python_reads_them() {
        for (cell, wanted) in [
            ("2026-11-27T12:00:00.250Z", 1_795_780_800.25),
            ("2026-11-27 12:00:00.250", 1_795_780_800.25),
            ("2026-11-27T14:30:00.250+02:30", 1_795_780_800.25),
            ("2026-11-27 12:00:00+00:00", 1_795_780_800.0),
            ("2024/02/29 23:59:59.999", 1_709_251_199.999),
            ("20261127T120000.5", 1_795_780_800.5),
            ("1970-01-01 00:00:01", 1.0),
            ("12:00:00,125", 43_200.125),
        ] {
            let found = seconds(cell).unwrap_or_else(|| panic!("{cell}"));
            assert!((found - wanted).abs() < 1e-6, "{cell}: {found}");
        }
        for cell in [
            "",
            "12:00",
            "27.11.2026 12:00:00",
            "2026-13-01 00:00:00",
            "1795780800",
        ] {
            assert_eq!(seconds(cell), None, "{cell}");
        }
        assert_eq!(column(["nan", ""].into_iter()), None);
    }
}
