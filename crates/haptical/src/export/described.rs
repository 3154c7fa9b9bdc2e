//! A device as the runtime takes it: rows and joints as plain numbers, checked one by one.

use std::path::Path;

use haptical_model::{Device, Joint as ModelJoint, JointType, TransmissionError};
use haptical_runtime::{
    Capstan, Convention, GeneralRow, Joint, Motion, POLYNOMIAL_TERMS, Parallelogram, Pose,
    RowDrive, Transmission,
};

use super::compensation::Compensation;
use crate::error::Error as Failure;

/// The content of an export.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Described {
    pub(super) convention: Convention,
    /// Row 0.
    pub(super) base: GeneralRow,
    /// Rows 1 to n.
    pub(super) rows: Vec<GeneralRow>,
    /// From the last row's frame to the handle.
    pub(super) handle: Option<Pose>,
    /// The drives of rows 1 to n.
    pub(super) drives: Vec<RowDrive>,
    /// Whether each row has a joint of its own.
    pub(super) drives_are_plain: bool,
    /// Whether rows are their Denavit-Hartenberg numbers alone.
    pub(super) is_plain_table: bool,
    pub(super) joints: Vec<Joint>,
    /// Names of the joints.
    pub(super) names: Vec<String>,
    /// Readings within which each joint's transmission is known.
    pub(super) ranges: Vec<[f64; 2]>,
    /// Lowest and highest reading of each joint by the device file; infinite where it gives none.
    pub(super) limits: Vec<[f64; 2]>,
    pub(super) compensation: Compensation,
}

impl Described {
    /// Describes a device, or says what the runtime cannot hold.
    pub(super) fn new(device: &Device, path: &Path) -> Result<Self, Failure> {
        let refuse =
            |what: String, next: &str| Failure::in_file("not-exportable", what, path, next);
        if device.links.is_empty() {
            return Err(refuse(
                "the device has no [[link]] rows, so it has no handle".to_owned(),
                "add one [[link]] for the base and one for each joint",
            ));
        }
        let origins = device.chain_origins();
        let origin = |row: usize| origins.get(row).copied().flatten();
        let rows = device.links.iter().enumerate();
        let mut rows = rows.map(|(row, link)| GeneralRow {
            origin: origin(row),
            link: *link,
        });
        let mut described = Self {
            convention: device.convention,
            base: rows.next().unwrap_or(GeneralRow::IDENTITY),
            rows: rows.collect(),
            handle: origin(device.links.len()),
            drives: Vec::new(),
            drives_are_plain: device.drives_are_plain(),
            is_plain_table: device.is_plain_table(),
            joints: Vec::new(),
            names: Vec::new(),
            ranges: Vec::new(),
            limits: Vec::new(),
            compensation: Compensation::new(device, path)?,
        };
        let advice = "correct this number in the device file, or identify the device again";
        let rows = std::iter::once(&described.base).chain(&described.rows);
        for (index, row) in rows.enumerate() {
            row.check(index)
                .map_err(|error| refuse(error.to_string(), advice))?;
        }
        for row in 1..device.links.len() {
            let Some(drive) = device.drive(row) else {
                return Err(refuse(format!("no joint drives row {row}"), advice));
            };
            described.drives.push(RowDrive {
                motion: motion(drive.motion),
                joint: drive.joint,
                multiplier: drive.multiplier,
                offset: drive.offset,
            });
        }
        for (index, joint) in device.joints.iter().enumerate() {
            let transmission = transmission(joint)
                .map_err(|(what, next)| refuse(format!("joint {}: {what}", index + 1), &next))?;
            let exported = Joint {
                motion: motion(joint.joint_type),
                home: joint.home_rad,
                transmission,
            };
            let range = exported
                .range(index + 1)
                .map_err(|error| refuse(error.to_string(), advice))?;
            described.joints.push(exported);
            described.names.push(joint.name.clone());
            described.ranges.push(range);
            described.limits.push([joint.lower_rad, joint.upper_rad]);
        }
        Ok(described)
    }
}

fn motion(joint_type: JointType) -> Motion {
    match joint_type {
        JointType::Revolute => Motion::Revolute,
        JointType::Prismatic => Motion::Prismatic,
    }
}

/// Position and rotation as plain numbers, `rotation[row][column]`.
pub(super) fn row_by_row(pose: &Pose) -> ([f64; 3], [[f64; 3]; 3]) {
    // nalgebra's arrays are columns
    (pose.position_m.into(), pose.rotation.transpose().into())
}

/// What is wrong, and what to do.
type Refusal = (String, String);

fn transmission(joint: &ModelJoint) -> Result<Transmission, Refusal> {
    match &joint.transmission_error {
        TransmissionError::Capstan(error) if error.to_array() == [0.0; 6] => {
            Ok(Transmission::Exact)
        }
        TransmissionError::Capstan(error) => Ok(Transmission::Capstan(capstan(joint, error)?)),
        TransmissionError::Parallelogram {
            capstan: error,
            length_deviations_m,
        } => {
            let Some(mut lengths_m) = joint.parallelogram_lengths_m else {
                return Err((
                    "there are length_deviations_m, but no lengths".to_owned(),
                    "give parallelogram_lengths_m".to_owned(),
                ));
            };
            for (length_m, deviation_m) in lengths_m.iter_mut().zip(length_deviations_m) {
                *length_m += deviation_m;
            }
            Ok(Transmission::Parallelogram(Parallelogram {
                capstan: capstan(joint, error)?,
                lengths_m,
            }))
        }
        TransmissionError::Chebyshev {
            range_rad,
            coefficients,
        } => {
            let mut padded = [0.0; POLYNOMIAL_TERMS];
            let Some(room) = padded.get_mut(..coefficients.len()) else {
                return Err((
                    format!(
                        "its polynomial has {} terms; the runtime holds {POLYNOMIAL_TERMS}",
                        coefficients.len()
                    ),
                    format!("identify with --degree {} or less", POLYNOMIAL_TERMS - 1),
                ));
            };
            room.copy_from_slice(coefficients);
            Ok(Transmission::Polynomial {
                range: *range_rad,
                coefficients: padded,
            })
        }
    }
}

fn capstan(
    joint: &ModelJoint,
    error: &haptical_model::transmission::CapstanError,
) -> Result<Capstan, Refusal> {
    let drive = joint.capstan().map_err(|reason| {
        let next = "correct transmission_ratio and drum_distance_m of this joint";
        (reason.to_string(), next.to_owned())
    })?;
    Ok(Capstan {
        transmission_ratio: drive.transmission_ratio(),
        drum_distance_m: drive.drum_distance_m(),
        input_drum_denominator_m: drive.input_drum_denominator_m(),
        offset: error.offset_rad,
        ratio_deviation: error.ratio_deviation,
        output_drum_xy_m: error.output_drum_xy_m,
        input_drum_xy_m: error.input_drum_xy_m,
    })
}
