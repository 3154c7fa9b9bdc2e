//! Refusals of logs.

use std::path::Path;

use haptical_data::{DataError, Fault};

use super::equipment::listed;
use super::{Error, ErrorKind, Place, split_advice};
use crate::device::Device;

impl Error {
    /// A refused log of a device: the joints that it has no columns of are named.
    pub(crate) fn log(error: DataError, device: &Device) -> Self {
        let names: Vec<String> = match &error.fault {
            Fault::MissingColumn {
                missing, required, ..
            } => {
                let joints = required.iter().zip(&device.model.joints);
                let joints = joints.filter(|(column, _)| missing.contains(column));
                let named = joints.filter(|(_, joint)| joint.has_own_name());
                named.map(|(_, joint)| joint.name.clone()).collect()
            }
            _ => Vec::new(),
        };
        let mut refused = Self::from(error);
        match names.as_slice() {
            [] => {}
            [name] => refused.what += &format!(" (joint `{name}`)"),
            _ => refused.what += &format!(" (joints {})", listed(&names)),
        }
        refused.with_equipment(device)
    }
}

impl From<DataError> for Error {
    fn from(error: DataError) -> Self {
        let at = &error.at;
        let (what, mut next) = split_advice(&error.fault.to_string());
        if is_foreign(&error.fault) && Path::new(&at.file).is_file() {
            next += &format!(
                "; or let `haptical import --guess {}` read the table as it is",
                at.file
            );
        }
        Self {
            kind: match &error.fault {
                Fault::NotFound => ErrorKind::NotFound,
                Fault::Unreadable { .. } => ErrorKind::Io,
                _ => ErrorKind::BadInput,
            },
            name: error.kind(),
            what,
            place: Box::new(Place {
                file: at.file.clone(),
                line: at.line,
                column: at.column_number.map(|column| column as u64),
                column_name: at.column.clone(),
                section: None,
                joint_columns: match &error.fault {
                    Fault::MissingColumn {
                        missing,
                        required,
                        near_misses,
                        ..
                    } if near_misses.is_empty() && required.ends_with(missing) => {
                        Some(required.len() - missing.len())
                    }
                    _ => None,
                },
            }),
            next,
        }
    }
}

/// Whether a file looks like a table of another maker, not like a log with a fault.
fn is_foreign(fault: &Fault) -> bool {
    match fault {
        Fault::WrongSeparator { .. } | Fault::NoHeader { .. } | Fault::DecimalComma { .. } => true,
        Fault::MissingColumn {
            missing, required, ..
        } => missing.len() == required.len(),
        _ => false,
    }
}
