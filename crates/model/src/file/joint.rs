//! Reads `[[joint]]` tables of a device file, transmission errors included.

use haptical_transmission::CapstanError;

use crate::device::joint::{
    Joint, JointType, TORQUE_SCALE_SD, TransmissionError, TransmissionKind,
};
use crate::file::reader::{SMALLEST, Section};
use crate::file::{JOINT_TYPES, TRANSMISSIONS};
use crate::sizes::{LARGEST_ANGLE_RAD, LARGEST_LIMIT_RAD};
use crate::{DeviceFileError, DriveNumber};

type Result<T> = std::result::Result<T, DeviceFileError>;

/// An angle of the geometry: refused where it can only be degrees.
pub(crate) fn angle(section: &Section<'_, '_>, key: &str, largest: f64) -> Result<Option<f64>> {
    match section.number(key)? {
        Some(value) if value.abs() > largest => Err(section.refuse(
            key,
            value.to_string(),
            &format!(
                "an angle in rad is expected; this looks like degrees ({value} deg is {:.6} rad)",
                value / 180.0 * std::f64::consts::PI
            ),
        )),
        other => Ok(other),
    }
}

/// Whether a name could be the number of a joint that has none.
pub(crate) fn is_number(name: &str) -> bool {
    name.parse::<f64>().is_ok()
}

pub(crate) fn read_joint(
    section: &Section<'_, '_>,
    index: usize,
    warnings: &mut Vec<String>,
) -> Result<Joint> {
    let joint_type = section.word("type", JOINT_TYPES)?;
    let joint_type = joint_type.unwrap_or(JointType::Revolute);
    let transmission = section.word("transmission", TRANSMISSIONS)?;
    let transmission = transmission.unwrap_or(TransmissionKind::Direct);
    let [home, lower, upper] = match joint_type {
        JointType::Revolute => [
            angle(section, "home_rad", LARGEST_ANGLE_RAD)?,
            angle(section, "lower_rad", LARGEST_LIMIT_RAD)?,
            angle(section, "upper_rad", LARGEST_LIMIT_RAD)?,
        ],
        JointType::Prismatic => [
            section.number("home_m")?.or(section.number("home_rad")?),
            section.number("lower_m")?.or(section.number("lower_rad")?),
            section.number("upper_m")?.or(section.number("upper_rad")?),
        ],
    };
    let (lower, upper) = (
        lower.unwrap_or(f64::NEG_INFINITY),
        upper.unwrap_or(f64::INFINITY),
    );
    if lower >= upper {
        let allowed = format!("it must be below the upper limit {upper}");
        let key = match joint_type {
            JointType::Prismatic if section.has("lower_m") => "lower_m",
            _ => "lower_rad",
        };
        return Err(section.refuse(key, lower.to_string(), &allowed));
    }
    let transmission_ratio = match section.number("transmission_ratio")? {
        Some(0.0) => {
            let allowed = "the ratio of motor to joint angle cannot be zero";
            return Err(section.refuse("transmission_ratio", "0".to_owned(), allowed));
        }
        Some(ratio) if ratio.abs() < SMALLEST => {
            let allowed = format!("at least {SMALLEST:e} is expected");
            return Err(section.refuse("transmission_ratio", ratio.to_string(), &allowed));
        }
        Some(ratio) => ratio,
        None if transmission == TransmissionKind::Direct => 1.0,
        None => {
            let advice = "give the ratio of motor to joint angle";
            return Err(section.missing("transmission_ratio", advice));
        }
    };
    let drum_distance_m = section.positive("drum_distance_m")?;
    section.warn_of_millimetres("drum_distance_m", warnings)?;
    if transmission == TransmissionKind::Capstan && drum_distance_m.is_none() {
        let advice = "give the distance between the drums' centres";
        return Err(section.missing("drum_distance_m", advice));
    }
    let parallelogram_lengths_m = section.vector("parallelogram_lengths_m")?;
    if let Some(lengths_m) = parallelogram_lengths_m
        && let Some(length_m) = lengths_m
            .into_iter()
            .find(|length_m: &f64| *length_m <= 0.0)
    {
        let allowed = "all four must be above zero";
        return Err(section.refuse("parallelogram_lengths_m", length_m.to_string(), allowed));
    }
    let mut joint = Joint {
        name: section
            .text("name")?
            .map_or_else(|| (index + 1).to_string(), str::to_owned),
        has_numeric_name: section.text("name")?.is_some_and(is_number),
        joint_type,
        home_rad: home.unwrap_or(0.0),
        lower_rad: lower,
        upper_rad: upper,
        sampling_sd_rad: section.positive("sampling_sd_rad")?,
        transmission,
        transmission_ratio,
        drum_distance_m,
        input_drum_denominator_m: section.positive("input_drum_denominator_m")?,
        encoder_counts_per_rev: section.positive("encoder_counts_per_rev")?,
        external_encoder_counts_per_rev: section.positive("external_encoder_counts_per_rev")?,
        external_encoder_sd_rad: section.positive("external_encoder_sd_rad")?,
        torque_scale_sd: section
            .positive("torque_scale_sd")?
            .unwrap_or(TORQUE_SCALE_SD),
        parallelogram_lengths_m,
        ..Joint::default()
    };
    for number in DriveNumber::ALL {
        let stated = read_drive(section, number, joint_type)?;
        number.set(&mut joint, stated);
    }
    if let Some(error) = section.table("transmission_error")? {
        joint.transmission_error = read_transmission_error(&error)?;
        error.unknown_keys(warnings);
        if let Err(reason) = joint.error_rad(0.0) {
            return Err(section.refuse(
                "transmission_error",
                "not usable".to_owned(),
                &format!("{reason}"),
            ));
        }
    }
    section.unknown_keys(warnings);
    Ok(joint)
}

/// A number of the drive by the key of its unit; a prismatic joint's may have that of a revolute one.
fn read_drive(
    section: &Section<'_, '_>,
    number: DriveNumber,
    joint_type: JointType,
) -> Result<Option<f64>> {
    for key in [number.key(joint_type), number.key(JointType::Revolute)] {
        let found = match number {
            DriveNumber::Armature => section.not_negative(key, "an inertia")?,
            DriveNumber::TorqueLimit => section.positive(key)?,
            DriveNumber::TorqueOffset | DriveNumber::TorqueDelay => section.number(key)?,
        };
        if found.is_some() {
            return Ok(found);
        }
    }
    Ok(None)
}

fn read_transmission_error(section: &Section<'_, '_>) -> Result<TransmissionError> {
    if let Some(coefficients) = section.numbers("chebyshev")? {
        let range_rad: [f64; 2] = section.vector("range_rad")?.ok_or_else(|| {
            section.missing("range_rad", "give the range [low, high] of `chebyshev`")
        })?;
        if range_rad[0] >= range_rad[1] {
            let found = format!("{range_rad:?}");
            return Err(section.refuse("range_rad", found, "the first must be below the second"));
        }
        if coefficients.is_empty() {
            let allowed = "at least one coefficient is needed";
            return Err(section.refuse("chebyshev", "empty".to_owned(), allowed));
        }
        return Ok(TransmissionError::Chebyshev {
            range_rad,
            coefficients,
        });
    }
    let capstan = CapstanError {
        offset_rad: section
            .number("offset_rad")?
            .or(section.number("offset_m")?)
            .unwrap_or(0.0),
        ratio_deviation: section.number("ratio_deviation")?.unwrap_or(0.0),
        output_drum_xy_m: section.vector("output_drum_xy_m")?.unwrap_or([0.0; 2]),
        input_drum_xy_m: section.vector("input_drum_xy_m")?.unwrap_or([0.0; 2]),
    };
    match section.vector("length_deviations_m")? {
        Some(length_deviations_m) => Ok(TransmissionError::Parallelogram {
            capstan,
            length_deviations_m,
        }),
        None => Ok(TransmissionError::Capstan(capstan)),
    }
}
