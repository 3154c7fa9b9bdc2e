//! Devices: from a file (TOML or URDF), the text of a TOML file, a dictionary, or read before.

use std::path::{Path, PathBuf};

use haptical_model::{Device as Model, JointType, read_toml_text};
use haptical_urdf::{BaseAndTip, device_from_urdf, read_urdf_text};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::failure::Failure;
use crate::plain::toml_text;

/// A device, read once and used many times.
#[pyclass(frozen, module = "haptical")]
#[derive(Debug, Clone)]
pub(crate) struct Device {
    pub(crate) model: Model,
    /// Text of a device file: what is identified is written into it.
    pub(crate) text: String,
    /// Name in messages.
    pub(crate) label: String,
    pub(crate) warnings: Vec<String>,
}

/// Where a device or a rig stands.
#[derive(Debug)]
enum Source {
    File(PathBuf),
    Text(String),
}

#[pymethods]
impl Device {
    #[new]
    #[pyo3(signature = (source, *, base=None, tip=None, rig=None))]
    fn new(
        source: &Bound<'_, PyAny>,
        base: Option<&str>,
        tip: Option<&str>,
        rig: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let source = read_source(source, "the device")?;
        let rig = rig.map(|rig| read_source(rig, "the rig")).transpose()?;
        Ok(read(source, BaseAndTip { base, tip }, rig)?)
    }

    /// Name of the device.
    #[getter]
    fn name(&self) -> &str {
        &self.model.name
    }

    /// Number of joints.
    #[getter]
    fn joints(&self) -> usize {
        self.model.joints.len()
    }

    /// Columns of the joints' readings in a log.
    #[getter]
    fn columns(&self) -> Vec<String> {
        let joints = self.model.joints.iter().enumerate();
        let name = |(index, joint): (usize, &haptical_model::Joint)| {
            let unit = if joint.joint_type == JointType::Prismatic {
                "m"
            } else {
                "rad"
            };
            format!("theta{}_{unit}", index + 1)
        };
        joints.map(name).collect()
    }

    /// What was odd about the device file.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// The text of a device file of this device.
    fn to_toml(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        format!(
            "<haptical.Device {:?}, {} joints>",
            self.model.name,
            self.model.joints.len()
        )
    }

    /// As a text, so that other processes can be given it.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((slf.get_type().into_any(), (slf.get().text.clone(),)))
    }
}

/// A device from whatever was given.
pub(crate) fn device_of(
    source: &Bound<'_, PyAny>,
    ends: BaseAndTip<'_>,
    rig: Option<&Bound<'_, PyAny>>,
) -> PyResult<Device> {
    if let Ok(device) = source.cast::<Device>() {
        let device = device.get();
        if let Some(keyword) = named(ends) {
            return Err(Failure::value(format!(
                "{keyword} names a link of a URDF; give it where the device is read"
            ))
            .into());
        }
        return match rig {
            None => Ok(device.clone()),
            Some(rig) => {
                let text = Source::Text(device.text.clone());
                Ok(read(
                    text,
                    BaseAndTip::default(),
                    Some(read_source(rig, "the rig")?),
                )?)
            }
        };
    }
    let rig = rig.map(|rig| read_source(rig, "the rig")).transpose()?;
    Ok(read(read_source(source, "the device")?, ends, rig)?)
}

/// A path, the text of a TOML file (told by a line break or a bracket), or a dictionary.
fn read_source(source: &Bound<'_, PyAny>, what: &str) -> PyResult<Source> {
    if let Ok(dictionary) = source.cast::<PyDict>() {
        return toml_text(dictionary).map(Source::Text);
    }
    if let Ok(text) = source.cast::<PyString>() {
        let text = text.to_string();
        let is_text = text.contains('\n') || text.trim_start().starts_with('[');
        return Ok(if is_text {
            Source::Text(text)
        } else {
            Source::File(PathBuf::from(text))
        });
    }
    match source.extract::<PathBuf>() {
        Ok(path) => Ok(Source::File(path)),
        Err(_) => {
            let kind = source.get_type().name()?;
            let text = format!(
                "{what} is of the type {kind}; give a path, the text of a TOML file or a dictionary"
            );
            Err(Failure::value(text).into())
        }
    }
}

fn is_urdf(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("urdf"))
}

/// The first keyword that names a link.
fn named(ends: BaseAndTip<'_>) -> Option<&'static str> {
    match (ends.base, ends.tip) {
        (Some(_), _) => Some("base"),
        (None, Some(_)) => Some("tip"),
        (None, None) => None,
    }
}

fn read(source: Source, ends: BaseAndTip<'_>, rig: Option<Source>) -> Result<Device, Failure> {
    let mut warnings = Vec::new();
    let is_table = !matches!(&source, Source::File(path) if is_urdf(path));
    if let Some(keyword) = named(ends).filter(|_| is_table) {
        return Err(Failure::value(format!(
            "{keyword} names a link of a URDF, and this device is none; leave it out"
        )));
    }
    let (mut text, label) = match &source {
        Source::File(path) if is_urdf(path) => {
            let label = path.display().to_string();
            let read = device_from_urdf(&read_urdf_text(path)?, &label, ends)?;
            warnings.extend(read.warnings);
            (read.device.to_new_toml()?, label)
        }
        Source::File(path) => (read_toml_text(path)?, path.display().to_string()),
        Source::Text(text) => (text.clone(), "the device".to_owned()),
    };
    if let Some(rig) = rig {
        let (rig_text, rig_label) = match rig {
            Source::File(path) => (read_toml_text(&path)?, path.display().to_string()),
            Source::Text(text) => (text, "the rig".to_owned()),
        };
        // its own faults first, at its own places
        Model::from_toml(&text, &label)?;
        let (merged, odd) = Model::with_rig(&text, &label, &rig_text, &rig_label)?;
        text = merged;
        warnings.extend(odd);
    }
    let loaded = Model::from_toml(&text, &label)?;
    warnings.extend(loaded.warnings);
    Ok(Device {
        model: loaded.device,
        text,
        label,
        warnings,
    })
}
