//! What is said of a refused log.

use haptical_data::DataError;
use haptical_model::Device;

use super::equipment::listed;
use super::{Failure, Place, split_advice};
use crate::STATUS_BAD_INPUT;

impl Failure {
    /// A refused log of a device: the joints that it has no columns of are named.
    pub(crate) fn log(error: DataError, device: &Device) -> Self {
        let names: Vec<String> = match &error {
            DataError::MissingColumn {
                missing, required, ..
            } => {
                let joints = required.iter().zip(&device.joints);
                let joints = joints.filter(|(column, _)| missing.contains(column));
                // a file that names no joints numbers them
                let named = joints.filter(|(_, joint)| joint.name.parse::<f64>().is_err());
                named.map(|(_, joint)| joint.name.clone()).collect()
            }
            _ => Vec::new(),
        };
        let mut failure = Self::from(error);
        match names.as_slice() {
            [] => {}
            [name] => failure.what += &format!(" (joint `{name}`)"),
            _ => failure.what += &format!(" (joints {})", listed(&names)),
        }
        failure
    }
}

impl From<DataError> for Failure {
    fn from(error: DataError) -> Self {
        let at = error.place();
        let text = error.to_string();
        let text = text.strip_prefix(&format!("{at}: ")).unwrap_or(&text);
        let (what, next) = split_advice(text);
        let joint_columns = match &error {
            DataError::MissingColumn {
                missing,
                required,
                near_misses,
                ..
            } if near_misses.is_empty() && required.ends_with(missing) => {
                Some(required.len() - missing.len())
            }
            _ => None,
        };
        Self {
            kind: error.kind(),
            what,
            place: Box::new(Place {
                file: at.file.clone(),
                line: at.line,
                column: at.column_number.map(|column| column as u64),
                column_name: at.column.clone(),
                section: None,
                joint_columns,
            }),
            next,
            status: STATUS_BAD_INPUT,
        }
    }
}
