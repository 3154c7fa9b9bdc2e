//! Reads a device file (TOML): every key checked, every complaint with line and column.

use std::path::Path;

use haptical_kinematics::{Convention, Link};
use toml::de::DeTable;

use crate::DeviceFileError;
use crate::device::Device;
use crate::device::joint::{Joint, JointType};
use crate::file::CONVENTIONS;
use crate::file::effect::read_effects;
use crate::file::joint::read_joint;
use crate::file::reader::{Section, Source};
use crate::file::row::{read_link, read_rows};
use crate::file::sensors::{read_cables, read_contact_pairs, read_gravity, read_tracker};
use crate::file::syntax::syntax_error;
use crate::file::text::read_toml_text;

type Result<T> = std::result::Result<T, DeviceFileError>;

/// Most joints of a device: more than any arm has, few enough that a file by mistake ends here.
const MOST_JOINTS: usize = 256;

/// A device and what is odd about its file.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedDevice {
    /// The device.
    pub device: Device,
    /// Unknown keys and the like.
    pub warnings: Vec<String>,
}

impl Device {
    /// Reads a device file.
    ///
    /// # Errors
    /// [`DeviceFileError`] with file, line and column.
    pub fn load(path: &Path) -> Result<LoadedDevice> {
        Self::from_toml(&read_toml_text(path)?, &path.display().to_string())
    }

    /// Reads a device from TOML text; `file` names it in errors.
    ///
    /// # Errors
    /// [`DeviceFileError`] with line and column.
    pub fn from_toml(text: &str, file: &str) -> Result<LoadedDevice> {
        let source = Source { file, text };
        let document = DeTable::parse(text)
            .map_err(|error| syntax_error(&source, error.span(), error.message()))?;
        let mut warnings = Vec::new();
        let root = Section::root(source, document.get_ref());
        let device = read_device(&root, file, &mut warnings)?;
        root.unknown_keys(&mut warnings);
        // what is calibrated for minutes must not turn out to be unwritable afterwards
        source.editable()?;
        Ok(LoadedDevice { device, warnings })
    }
}

fn read_device(root: &Section<'_, '_>, file: &str, warnings: &mut Vec<String>) -> Result<Device> {
    let head = root.table("device")?;
    let (mut name, mut convention) = (file.to_owned(), Convention::Standard);
    if let Some(head) = &head {
        name = head.text("name")?.unwrap_or(file).to_owned();
        convention = head.word("convention", CONVENTIONS)?.unwrap_or(convention);
    }
    let joints = root.tables("joint", 1)?;
    if joints.len() > MOST_JOINTS {
        let found = format!("a list of {} tables", joints.len());
        let allowed = format!("at most {MOST_JOINTS} joints are read");
        return Err(root.refuse("joint", found, &allowed));
    }
    // before the joints are read: they name every key that nobody asked for
    let mut compliance = crate::file::surroundings::read_compliance(&joints)?;
    let joints = joints
        .iter()
        .enumerate()
        .map(|(index, section)| read_joint(section, index, warnings))
        .collect::<Result<Vec<Joint>>>()?;
    if joints.is_empty() {
        return Err(DeviceFileError::Shape {
            file: file.to_owned(),
            message: "there is no [[joint]]: add one table for each joint".to_owned(),
        });
    }
    let types: Vec<JointType> = joints.iter().map(|joint| joint.joint_type).collect();
    let effects = read_effects(root, &types, &mut compliance)?;
    let rows = read_rows(root, head.as_ref(), &joints, warnings)?;
    let tracker = read_tracker(root, warnings)?;
    let surroundings =
        crate::file::surroundings::read_surroundings(root, tracker.as_ref(), compliance, warnings)?;
    if let Some(head) = &head {
        check_dof(head, joints.len())?;
        head.unknown_keys(warnings);
    }
    Ok(Device {
        name,
        convention,
        nominal_links: read_nominal(root, rows.links.len(), warnings)?,
        deviations: rows.deviations,
        links: rows.links,
        origins: rows.origins,
        drives: rows.drives,
        parents: rows.parents,
        hands: rows.hands,
        bodies: rows.bodies,
        joints,
        cables: read_cables(root, warnings)?,
        tracker,
        contact_pairs: read_contact_pairs(root, warnings)?,
        gravity_mps2: read_gravity(root, warnings)?,
        surroundings,
        effects,
    })
}

fn check_dof(head: &Section<'_, '_>, joints: usize) -> Result<()> {
    match head.number("dof")? {
        Some(dof) if dof != joints as f64 => {
            let allowed = format!("there are {joints} [[joint]] tables: make them agree");
            Err(head.refuse("dof", dof.to_string(), &allowed))
        }
        _ => Ok(()),
    }
}

fn read_nominal(
    root: &Section<'_, '_>,
    links: usize,
    warnings: &mut Vec<String>,
) -> Result<Option<Vec<Link>>> {
    root.within("nominal", warnings, |nominal, warnings| {
        let rows = nominal.tables("link", 0)?;
        let read = |row: &Section<'_, '_>| read_link(row, warnings);
        let nominal_links = rows.iter().map(read).collect::<Result<Vec<Link>>>()?;
        rows.iter().for_each(|row| row.unknown_keys(warnings));
        if nominal_links.len() == links {
            return Ok(nominal_links);
        }
        let found = format!("a list of {} rows", nominal_links.len());
        let allowed = format!("the device has {links} [[link]] rows");
        Err(nominal.refuse("link", found, &allowed))
    })
}
