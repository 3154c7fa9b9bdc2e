//! Reads a device file (TOML): every key checked, every complaint with line and column.

use std::path::Path;

use haptical_kinematics::{Convention, Link};
use haptical_transmission::CapstanError;
use toml::de::DeTable;

use crate::DeviceFileError;
use crate::device::{Body, Cable, ContactPair, Device, Tracker};
use crate::joint::{Joint, JointType, TransmissionError, TransmissionKind};
use crate::reader::{Section, Source};

type Result<T> = std::result::Result<T, DeviceFileError>;

/// A device and what is odd about its file.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedDevice {
    /// The device.
    pub device: Device,
    /// Unknown keys and the like.
    pub warnings: Vec<String>,
}

/// Largest angle that a single turn needs; an angle beyond it is taken for degrees.
const LARGEST_ANGLE_RAD: f64 = std::f64::consts::TAU + 1e-6;
/// Largest joint limit taken for radians: nearly five turns. Thirty and more are degrees.
const LARGEST_LIMIT_RAD: f64 = 29.0;

impl Device {
    /// Reads a device file.
    ///
    /// # Errors
    /// [`DeviceFileError`] with file, line and column.
    pub fn load(path: &Path) -> Result<LoadedDevice> {
        let text = std::fs::read_to_string(path).map_err(|source| DeviceFileError::Unreadable {
            path: path.to_owned(),
            source,
        })?;
        Self::from_toml(&text, &path.display().to_string())
    }

    /// Reads a device from TOML text; `file` names it in errors.
    ///
    /// # Errors
    /// [`DeviceFileError`] with line and column.
    pub fn from_toml(text: &str, file: &str) -> Result<LoadedDevice> {
        let source = Source { file, text };
        let document = DeTable::parse(text).map_err(|error| {
            let (line, column) = source.position(error.span().map_or(0, |span| span.start));
            DeviceFileError::Syntax {
                file: file.to_owned(),
                line,
                column,
                message: error.message().to_owned(),
            }
        })?;
        let mut warnings = Vec::new();
        let root = Section::new(source, document.get_ref(), "", 0);
        let device = read_device(&root, file, &mut warnings)?;
        root.unknown_keys(&mut warnings);
        Ok(LoadedDevice { device, warnings })
    }
}

fn read_device(root: &Section<'_, '_>, file: &str, warnings: &mut Vec<String>) -> Result<Device> {
    let head = root.table("device")?;
    let (mut name, mut convention, mut dof) = (file.to_owned(), Convention::Standard, None);
    if let Some(head) = &head {
        name = head.text("name")?.unwrap_or(file).to_owned();
        convention = match head.text("convention")? {
            None | Some("standard") => Convention::Standard,
            Some("modified") => Convention::Modified,
            Some(other) => {
                let allowed = "it must be \"standard\" or \"modified\"";
                return Err(head.refuse("convention", format!("\"{other}\""), allowed));
            }
        };
        dof = head.number("dof")?;
        head.unknown_keys(warnings);
    }
    let joints = root
        .tables("joint", 1)?
        .iter()
        .enumerate()
        .map(|(index, section)| read_joint(section, index, warnings))
        .collect::<Result<Vec<Joint>>>()?;
    let rows = root.tables("link", 0)?;
    let links = rows.iter().map(read_link).collect::<Result<Vec<Link>>>()?;
    let bodies = rows
        .iter()
        .map(read_body)
        .collect::<Result<Vec<Option<Body>>>>()?;
    rows.iter().for_each(|row| row.unknown_keys(warnings));
    let nominal_links = match root.table("nominal")? {
        None => None,
        Some(nominal) => Some(
            nominal
                .tables("link", 0)?
                .iter()
                .map(read_link)
                .collect::<Result<Vec<Link>>>()?,
        ),
    };
    let device = Device {
        name,
        convention,
        links,
        bodies,
        joints,
        cables: read_cables(root, warnings)?,
        tracker: read_tracker(root, warnings)?,
        contact_pairs: read_contact_pairs(root, warnings)?,
        gravity_mps2: match root.table("gravity")? {
            Some(gravity) => gravity.vector("vector_mps2")?,
            None => None,
        },
        nominal_links,
    };
    check_counts(&device, dof, file)?;
    Ok(device)
}

fn check_counts(device: &Device, dof: Option<f64>, file: &str) -> Result<()> {
    let shape = |message: String| {
        Err(DeviceFileError::Shape {
            file: file.to_owned(),
            message,
        })
    };
    let joints = device.joints.len();
    if joints == 0 {
        return shape("there is no [[joint]]: add one table for each joint".to_owned());
    }
    if let Some(dof) = dof
        && dof != joints as f64
    {
        return shape(format!(
            "[device] dof is {dof}, but there are {joints} [[joint]] tables: make them agree"
        ));
    }
    let links = device.links.len();
    if links != 0 && links != joints + 1 {
        return shape(format!(
            "{joints} joints need {} [[link]] rows (row 0 carries frame (-1) to the base), \
             but there are {links}",
            joints + 1
        ));
    }
    match &device.nominal_links {
        Some(nominal) if nominal.len() != links => shape(format!(
            "[nominal] has {} link rows, but the device has {links}",
            nominal.len()
        )),
        _ => Ok(()),
    }
}

/// An angle of the geometry: refused where it can only be degrees.
fn angle(section: &Section<'_, '_>, key: &str, largest: f64) -> Result<Option<f64>> {
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

fn read_link(section: &Section<'_, '_>) -> Result<Link> {
    let advice = "give the Denavit-Hartenberg row in full";
    Ok(Link {
        a_m: section.required("a_m", advice)?,
        alpha_rad: angle(section, "alpha_rad", LARGEST_ANGLE_RAD)?
            .ok_or_else(|| section.missing("alpha_rad", advice))?,
        d_m: section.required("d_m", advice)?,
        theta_rad: angle(section, "theta_offset_rad", LARGEST_ANGLE_RAD)?.unwrap_or(0.0),
        beta_rad: angle(section, "beta_rad", LARGEST_ANGLE_RAD)?.unwrap_or(0.0),
    })
}

fn read_body(section: &Section<'_, '_>) -> Result<Option<Body>> {
    let mass = section.number("mass_kg")?;
    let centre = section.vector("centre_of_mass_m")?;
    match mass {
        Some(mass) if mass < 0.0 => {
            Err(section.refuse("mass_kg", mass.to_string(), "a mass is not negative"))
        }
        Some(mass_kg) => Ok(Some(Body {
            mass_kg,
            centre_of_mass_m: centre.unwrap_or([0.0; 3]),
        })),
        None => Ok(None),
    }
}

fn read_joint(
    section: &Section<'_, '_>,
    index: usize,
    warnings: &mut Vec<String>,
) -> Result<Joint> {
    let joint_type = match section.text("type")? {
        None | Some("revolute") => JointType::Revolute,
        Some("prismatic") => JointType::Prismatic,
        Some(other) => {
            let allowed = "it must be \"revolute\" or \"prismatic\"";
            return Err(section.refuse("type", format!("\"{other}\""), allowed));
        }
    };
    let transmission = match section.text("transmission")? {
        None | Some("direct") => TransmissionKind::Direct,
        Some("capstan") => TransmissionKind::Capstan,
        Some("parallelogram") => TransmissionKind::Parallelogram,
        Some(other) => {
            let allowed = "it must be \"capstan\", \"parallelogram\" or \"direct\"";
            return Err(section.refuse("transmission", format!("\"{other}\""), allowed));
        }
    };
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
        return Err(section.refuse("lower_rad", lower.to_string(), &allowed));
    }
    let transmission_ratio = match section.number("transmission_ratio")? {
        Some(0.0) => {
            let allowed = "the ratio of motor to joint angle cannot be zero";
            return Err(section.refuse("transmission_ratio", "0".to_owned(), allowed));
        }
        Some(ratio) => ratio,
        None if transmission == TransmissionKind::Direct => 1.0,
        None => {
            let advice = "give the ratio of motor to joint angle";
            return Err(section.missing("transmission_ratio", advice));
        }
    };
    let drum_distance_m = section.positive("drum_distance_m")?;
    if transmission == TransmissionKind::Capstan && drum_distance_m.is_none() {
        let advice = "give the distance between the drums' centres";
        return Err(section.missing("drum_distance_m", advice));
    }
    let mut joint = Joint {
        name: section
            .text("name")?
            .map_or_else(|| (index + 1).to_string(), str::to_owned),
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
        torque_scale_sd: section.positive("torque_scale_sd")?.unwrap_or(0.03),
        parallelogram_lengths_m: section.vector("parallelogram_lengths_m")?,
        transmission_error: TransmissionError::default(),
    };
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

fn read_cables(root: &Section<'_, '_>, warnings: &mut Vec<String>) -> Result<Vec<Cable>> {
    let mut sections = Vec::new();
    sections.extend(root.table("cable_encoder")?);
    let further = root.tables("cable", 2)?;
    if sections.is_empty() && !further.is_empty() {
        let advice = "the first cable is [cable_encoder]; further ones are [[cable]]";
        return Err(root.missing("cable_encoder", advice));
    }
    sections.extend(further);
    sections
        .iter()
        .enumerate()
        .map(|(index, section)| {
            let anchor = section.vector("anchor_m")?;
            if index > 0 && anchor.is_none() {
                let advice = "give the point in frame (-1) where this cable leaves its guide";
                return Err(section.missing("anchor_m", advice));
            }
            let cable = Cable {
                anchor_m: anchor.unwrap_or([0.0; 3]),
                drum_radius_m: section.positive("drum_radius_m")?,
                counts_per_rev: section.positive("counts_per_rev")?,
                distance_sd_m: section.positive("distance_sd_m")?,
                exit_axis: section.vector("exit_axis")?,
            };
            section.unknown_keys(warnings);
            Ok(cable)
        })
        .collect()
}

fn read_tracker(root: &Section<'_, '_>, warnings: &mut Vec<String>) -> Result<Option<Tracker>> {
    let Some(section) = root.table("tracker")? else {
        return Ok(None);
    };
    let known = |key: &str| match section.text(key)? {
        None | Some("known") => Ok(true),
        Some("unknown") => Ok(false),
        Some(other) => {
            let allowed = "it must be \"known\" or \"unknown\"";
            Err(section.refuse(key, format!("\"{other}\""), allowed))
        }
    };
    let tracker = Tracker {
        base_known: known("base")?,
        tool_known: known("tool")?,
        position_sd_m: section.positive("position_sd_m")?,
        rotation_sd_rad: section.positive("rotation_sd_rad")?,
    };
    section.unknown_keys(warnings);
    Ok(Some(tracker))
}

fn read_contact_pairs(
    root: &Section<'_, '_>,
    warnings: &mut Vec<String>,
) -> Result<Vec<ContactPair>> {
    root.tables("contact_pair", 1)?
        .iter()
        .map(|section| {
            let id = |key: &str| match section.text(key)? {
                Some(text) => Ok(text.to_owned()),
                None => Err(section.missing(key, "give the contact's id")),
            };
            let missing = |key: &str| section.missing(key, "give it in m");
            let pair = ContactPair {
                a: id("a")?,
                b: id("b")?,
                distance_m: section
                    .positive("distance_m")?
                    .ok_or_else(|| missing("distance_m"))?,
                sd_m: section.positive("sd_m")?.ok_or_else(|| missing("sd_m"))?,
            };
            section.unknown_keys(warnings);
            Ok(pair)
        })
        .collect()
}
