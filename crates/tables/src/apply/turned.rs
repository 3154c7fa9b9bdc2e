//! Orientations of a table as quaternions, and poses as positions and quaternions.

use super::cells::number_of;
use super::matched::Matched;
use super::{Source, source};
use crate::error::TableError;
use crate::mapping::{Axes, Layout, Orientation, Representation};
use crate::rotation::{from_euler, from_matrix, from_rotation_vector, inverse};
use crate::table::{Cells, Table};

/// Deviation of a pose's last row from 0, 0, 0, 1.
const LAST_ROW: f64 = 1e-6;

/// Deviation of a quaternion's norm from 1, as in a log.
const LARGEST_NORM_ERROR: f64 = 1e-3;

/// Adds `qw`, `qx`, `qy`, `qz`, of a 4 x 4 matrix also `x_m`, `y_m`, `z_m`; inverts the pose where that is said.
pub(super) fn add(
    run: &[Table],
    orientation: &Orientation,
    matched: &Matched,
    columns: &mut Vec<(String, Cells)>,
) -> Result<(), TableError> {
    let sources = orientation
        .from
        .iter()
        .map(|from| source(run, orientation.file, from));
    let sources: Vec<Source> = sources.collect::<Result<_, _>>()?;
    let file = sources.first().map_or(0, |(file, _)| *file);
    let table = &run[file];
    let mut position: [Vec<f64>; 3] = Default::default();
    let mut quaternion: [Vec<f64>; 4] = Default::default();
    for row in matched.of(file) {
        let Some(row) = row else {
            position.iter_mut().for_each(|part| part.push(f64::NAN));
            quaternion.iter_mut().for_each(|part| part.push(f64::NAN));
            continue;
        };
        let cells = sources
            .iter()
            .map(|&(file, column)| number_of(&run[file], column, row));
        let cells: Vec<f64> = cells.collect::<Result<_, _>>()?;
        let pose = pose(&cells, orientation).map_err(|what| {
            let next = "correct the row, or [orientation] in the mapping file: kind, order, layout";
            TableError::new("no-rotation", what, &table.file, next).at(table.line(row), None)
        })?;
        position
            .iter_mut()
            .zip(pose.0)
            .for_each(|(part, own)| part.push(own));
        quaternion
            .iter_mut()
            .zip(pose.1)
            .for_each(|(part, own)| part.push(own));
    }
    if orientation.kind == Representation::Pose {
        let named = ["x_m", "y_m", "z_m"].into_iter().zip(position);
        columns.extend(named.map(|(name, cells)| (name.to_owned(), Cells::Numbers(cells))));
    }
    let named = ["qw", "qx", "qy", "qz"].into_iter().zip(quaternion);
    columns.extend(named.map(|(name, cells)| (name.to_owned(), Cells::Numbers(cells))));
    if orientation.invert {
        invert(columns).map_err(|what| {
            let next = "give x_m, y_m and z_m too: the inverse of a pose needs both";
            TableError::new("bad-mapping", what, &table.file, next)
        })?;
    }
    Ok(())
}

/// Position \[m\] of a 4 x 4 matrix, else `NaN`; quaternion w, x, y, z. `NaN` where no cell has a reading.
fn pose(cells: &[f64], rule: &Orientation) -> Result<([f64; 3], [f64; 4]), String> {
    let missing = cells.iter().filter(|cell| cell.is_nan()).count();
    if missing == cells.len() {
        return Ok(([f64::NAN; 3], [f64::NAN; 4]));
    }
    if missing > 0 {
        return Err(format!(
            "{missing} of {} cells of the orientation are empty",
            cells.len()
        ));
    }
    let factor = rule.factor();
    let scaled = || [0, 1, 2].map(|part| factor * cells[part]);
    let turned = match rule.kind {
        Representation::Quaternion => {
            let norm = cells.iter().map(|part| part * part).sum::<f64>().sqrt();
            if (norm - 1.0).abs() > LARGEST_NORM_ERROR {
                return Err(format!("the quaternion has norm {norm:.4}, not 1"));
            }
            match rule.order.as_deref() {
                Some("xyzw") => [cells[3], cells[0], cells[1], cells[2]],
                _ => [cells[0], cells[1], cells[2], cells[3]],
            }
        }
        Representation::Euler => {
            let order = rule.order.as_deref().unwrap_or("xyz");
            from_euler(scaled(), order, rule.axes == Some(Axes::Intrinsic))
        }
        Representation::RotationVector => from_rotation_vector(scaled()),
        Representation::Matrix => from_matrix(element(cells, 3, rule.layout))?,
        Representation::Pose => return matrix_pose(cells, rule),
    };
    Ok(([f64::NAN; 3], turned))
}

/// The first three rows and columns of a matrix of so many columns.
fn element(cells: &[f64], width: usize, layout: Option<Layout>) -> [[f64; 3]; 3] {
    std::array::from_fn(|row| {
        std::array::from_fn(|column| match layout {
            Some(Layout::Column) => cells[column * width + row],
            _ => cells[row * width + column],
        })
    })
}

fn matrix_pose(cells: &[f64], rule: &Orientation) -> Result<([f64; 3], [f64; 4]), String> {
    let at = |row: usize, column: usize| match rule.layout {
        Some(Layout::Column) => cells[column * 4 + row],
        _ => cells[row * 4 + column],
    };
    if cells.len() == 16 {
        let last = [at(3, 0), at(3, 1), at(3, 2), at(3, 3) - 1.0];
        if last.iter().any(|part| part.abs() > LAST_ROW) {
            let other = match rule.layout {
                Some(Layout::Column) => "row",
                _ => "column",
            };
            return Err(format!(
                "the matrix has no last row 0, 0, 0, 1; with layout = \"{other}\" it may"
            ));
        }
    }
    let position = [0, 1, 2].map(|row| rule.factor() * at(row, 3));
    Ok((position, from_matrix(element(cells, 4, rule.layout))?))
}

/// Turns the pose of the target in the camera into that of the camera in the target.
fn invert(columns: &mut [(String, Cells)]) -> Result<(), String> {
    let mut places = [0; 7];
    for (place, name) in places
        .iter_mut()
        .zip(["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"])
    {
        let found = columns.iter().position(|(own, _)| own == name);
        *place = found.ok_or_else(|| format!("invert = true without `{name}`"))?;
    }
    let numbers = |place: usize| columns[place].1.numbers().unwrap_or_default().to_vec();
    let mut parts = places.map(numbers);
    for row in 0..parts[0].len() {
        let [x, y, z, w, i, j, k] = std::array::from_fn(|part| parts[part][row]);
        let (position, turned) = inverse([x, y, z], [w, i, j, k]);
        let [w, i, j, k] = turned;
        let [x, y, z] = position;
        for (part, value) in parts.iter_mut().zip([x, y, z, w, i, j, k]) {
            part[row] = value;
        }
    }
    for (place, part) in places.into_iter().zip(parts) {
        columns[place].1 = Cells::Numbers(part);
    }
    Ok(())
}
