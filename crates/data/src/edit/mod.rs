//! Cells of a log that get other numbers, or are emptied; all others stay as they are.

mod text;

use std::collections::BTreeMap;

use haptical_model::Recording;

use crate::column::Role;
use crate::shape::LogShape;

pub use self::text::edit_log;

/// A column of a log that can be edited; indices count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LogColumn {
    /// Motor-side reading of a joint.
    Joint(usize),
    /// External encoder of a joint.
    Output(usize),
    /// Distance of a cable.
    Cable(usize),
    /// x, y or z of the tracker's position.
    Position(usize),
    /// w, x, y or z of the tracker's orientation.
    Orientation(usize),
    /// Identifier of the touched point.
    Contact,
    /// Identifier of the touched plane.
    Plane,
}

impl LogColumn {
    fn role(self) -> Role {
        match self {
            Self::Joint(joint) => Role::Joint(joint),
            Self::Output(joint) => Role::Output(joint),
            Self::Cable(cable) => Role::Cable(cable),
            Self::Position(axis) => Role::Position(axis),
            Self::Orientation(part) => Role::Orientation(part),
            Self::Contact => Role::Contact,
            Self::Plane => Role::Plane,
        }
    }

    /// Its name in a log of a device of this shape.
    ///
    /// ```
    /// use haptical_data::{LogColumn, LogShape};
    /// let shape = LogShape { joints: Vec::new(), cable_count: 2, hands: Vec::new() };
    /// assert_eq!(LogColumn::Cable(1).name(&shape), "cable2_m");
    /// ```
    pub fn name(self, shape: &LogShape) -> String {
        self.role().name(shape)
    }

    /// Its unit, `m` or `rad`; empty for parts of an orientation and for text.
    pub fn unit(self, shape: &LogShape) -> &'static str {
        match self {
            Self::Joint(joint) | Self::Output(joint) => {
                shape.joints.get(joint).map_or("rad", |joint| joint.unit())
            }
            Self::Cable(_) | Self::Position(_) => "m",
            Self::Orientation(_) | Self::Contact | Self::Plane => "",
        }
    }

    /// Its readings; none where the recording has no such column, or it holds text.
    pub fn readings(self, recording: &Recording) -> Option<&[f64]> {
        let column = match self {
            Self::Joint(joint) => recording.joint.get(joint),
            Self::Output(joint) => recording.output.get(joint)?.as_ref(),
            Self::Cable(cable) => recording.cable_m.get(cable)?.as_ref(),
            Self::Position(axis) => recording.position_m.as_ref()?.get(axis),
            Self::Orientation(part) => recording.orientation_wxyz.as_ref()?.get(part),
            Self::Contact | Self::Plane => None,
        };
        column.map(Vec::as_slice)
    }

    /// The same to be changed.
    pub fn readings_mut(self, recording: &mut Recording) -> Option<&mut Vec<f64>> {
        match self {
            Self::Joint(joint) => recording.joint.get_mut(joint),
            Self::Output(joint) => recording.output.get_mut(joint)?.as_mut(),
            Self::Cable(cable) => recording.cable_m.get_mut(cable)?.as_mut(),
            Self::Position(axis) => recording.position_m.as_mut()?.get_mut(axis),
            Self::Orientation(part) => recording.orientation_wxyz.as_mut()?.get_mut(part),
            Self::Contact | Self::Plane => None,
        }
    }

    fn texts_mut(self, recording: &mut Recording) -> Option<&mut Vec<String>> {
        match self {
            Self::Contact => recording.contact.as_mut(),
            Self::Plane => recording.plane.as_mut(),
            _ => None,
        }
    }
}

/// New contents of cells, by column and row from 0; none empties the cell.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LogEdits {
    cells: BTreeMap<LogColumn, BTreeMap<usize, Option<f64>>>,
}

impl LogEdits {
    /// Gives a cell another number; what was said of it before is forgotten.
    pub fn set(&mut self, column: LogColumn, row: usize, value: f64) {
        self.cells
            .entry(column)
            .or_default()
            .insert(row, Some(value));
    }

    /// Empties a cell.
    pub fn empty(&mut self, column: LogColumn, row: usize) {
        self.cells.entry(column).or_default().insert(row, None);
    }

    /// Whether nothing is edited.
    pub fn is_empty(&self) -> bool {
        self.cells.values().all(BTreeMap::is_empty)
    }

    /// The edited cells, column by column.
    pub fn columns(&self) -> impl Iterator<Item = (LogColumn, &BTreeMap<usize, Option<f64>>)> {
        self.cells.iter().map(|(column, cells)| (*column, cells))
    }

    /// A recording with the edits made. Cells that it does not have are left out.
    ///
    /// ```
    /// use haptical_data::{LogColumn, LogEdits};
    /// use haptical_model::Recording;
    /// let recording = Recording { joint: vec![vec![0.1, 0.2]], ..Recording::default() };
    /// let mut edits = LogEdits::default();
    /// edits.set(LogColumn::Joint(0), 1, 0.3);
    /// assert_eq!(edits.made_in(&recording).joint[0], [0.1, 0.3]);
    /// ```
    #[must_use]
    pub fn made_in(&self, recording: &Recording) -> Recording {
        let mut edited = recording.clone();
        for (column, cells) in self.columns() {
            for (&row, value) in cells {
                let readings = column.readings_mut(&mut edited);
                if let Some(cell) = readings.and_then(|readings| readings.get_mut(row)) {
                    *cell = value.unwrap_or(f64::NAN);
                }
                let texts = column.texts_mut(&mut edited);
                if let (Some(cell), None) = (texts.and_then(|texts| texts.get_mut(row)), value) {
                    cell.clear();
                }
            }
        }
        edited
    }
}
