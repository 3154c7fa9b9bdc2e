//! Files of postures with the ball in one socket: numbers without a header.

use std::fs::File;
use std::path::Path;

use crate::failure::Failure;

/// Most postures of one file: more are no postures put in by hand.
const MOST_ROWS: usize = 1_000_000;
/// An angle beyond this is in degrees, or is none \[rad\].
const LARGEST_ANGLE_RAD: f64 = 8.0 * std::f64::consts::PI;

/// Reads the joint angles of a file, one posture in each row; every row has as many numbers as the first.
pub(super) fn read_angles(path: &Path) -> Result<Vec<Vec<f64>>, Failure> {
    let unreadable = |error: &dyn std::fmt::Display| {
        let next = "give the folder that holds <position of the tool>/hole_0.csv";
        let what = format!("cannot be read: {error}");
        Failure::in_file("unreadable", what, path, next)
    };
    let file = File::open(path).map_err(|error| unreadable(&error))?;
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(file);
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| unreadable(&error))?;
        let line = record.position().map_or(1, csv::Position::line);
        let mut row = Vec::with_capacity(record.len());
        for (index, cell) in record.iter().enumerate() {
            let place = (line, index as u64 + 1);
            let refuse = |(what, next)| Failure::placed("not-an-angle", what, path, place, next);
            row.push(angle(cell).map_err(refuse)?);
        }
        if rows.first().is_some_and(|first| first.len() != row.len()) {
            let (own, first) = (row.len(), rows[0].len());
            let what = format!("{own} numbers where the first row has {first}");
            let next = "delete or complete the row";
            return Err(Failure::placed("cell-count", what, path, (line, 0), next));
        }
        if rows.len() == MOST_ROWS {
            let what = format!("more than {MOST_ROWS} rows");
            let next = "give postures, one for each time that the ball was put in";
            return Err(Failure::placed("too-large", what, path, (line, 0), next));
        }
        rows.push(row);
    }
    if rows.is_empty() {
        let next = "delete the file, or record postures";
        return Err(Failure::in_file("no-rows", "no postures", path, next));
    }
    Ok(rows)
}

/// The angle in a cell, or what is wrong with it and what to do.
fn angle(cell: &str) -> Result<f64, (String, &'static str)> {
    let what = || format!("expected an angle in rad, found `{}`", shortened(cell));
    let refuse = |next| Err((what(), next));
    match cell.parse::<f64>() {
        Ok(angle) if angle.abs() <= LARGEST_ANGLE_RAD => Ok(angle),
        Ok(_) => refuse("write angles in rad, not in degrees"),
        Err(_) => refuse("give files without a header, with joint angles alone"),
    }
}

fn shortened(text: &str) -> String {
    const MOST: usize = 40;
    if text.chars().count() <= MOST {
        return text.to_owned();
    }
    text.chars().take(MOST).collect::<String>() + "..."
}
