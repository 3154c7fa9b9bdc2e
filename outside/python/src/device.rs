//! Devices: from a file (TOML or URDF), the text of a TOML file, a dictionary, or read before.

use std::path::PathBuf;

use haptical::files::Source;
use haptical::{Device as Read, Equipment, InputDrumDenominators, is_mjcf, is_urdf};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::failure::Failure;
use crate::plain::toml_text;

/// Links of a URDF at which the chain begins and ends: base, tip or tips.
pub(crate) type Ends<'n> = (Option<&'n str>, Option<Tips>);

/// One link, or one for each hand.
#[derive(Debug, Clone, FromPyObject)]
pub(crate) enum Tips {
    One(String),
    Several(Vec<String>),
}

impl Tips {
    /// All of them.
    pub(crate) fn all(self) -> Vec<String> {
        match self {
            Self::One(tip) => vec![tip],
            Self::Several(tips) => tips,
        }
    }
}

/// A device, read once and used many times.
#[pyclass(frozen, module = "haptical")]
#[derive(Debug, Clone)]
pub(crate) struct Device {
    pub(crate) read: Read,
}

#[pymethods]
impl Device {
    #[new]
    #[pyo3(signature = (source, *, base=None, tip=None, rig=None))]
    fn new(
        source: &Bound<'_, PyAny>,
        base: Option<&str>,
        tip: Option<Tips>,
        rig: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        read(read_source(source, "the device")?, (base, tip), rig)
    }

    /// Name of the device.
    #[getter]
    fn name(&self) -> &str {
        &self.read.model.name
    }

    /// Number of joints.
    #[getter]
    fn joints(&self) -> usize {
        self.read.model.joints.len()
    }

    /// Columns of the joints' readings in a log.
    #[getter]
    fn columns(&self) -> Vec<String> {
        let joints = self.read.model.joints.iter().enumerate();
        let name = |(index, joint): (usize, &haptical::model::Joint)| {
            format!("theta{}_{}", index + 1, joint.unit())
        };
        joints.map(name).collect()
    }

    /// What was odd about the device file.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.read.warnings.clone()
    }

    /// The text of a device file of this device.
    fn to_toml(&self) -> &str {
        self.read.to_toml()
    }

    fn __repr__(&self) -> String {
        format!(
            "<haptical.Device {:?}, {} joints>",
            self.read.model.name,
            self.read.model.joints.len()
        )
    }

    /// As a text, so that other processes can be given it.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((slf.get_type().into_any(), (slf.get().to_toml().to_owned(),)))
    }
}

/// A device from whatever was given.
pub(crate) fn device_of(
    source: &Bound<'_, PyAny>,
    ends: Ends<'_>,
    rig: Option<&Bound<'_, PyAny>>,
) -> PyResult<Device> {
    if let Some(device) = read_before(source)? {
        if let Some(keyword) = named(&ends) {
            return Err(Failure::value(format!(
                "{keyword} names a link of a URDF; give it where the device is read"
            ))
            .into());
        }
        return match rig {
            None => Ok(device),
            Some(_) => {
                let label = &device.read.source().label;
                let text = Source::text(device.to_toml(), label);
                read(text, Ends::default(), rig)
            }
        };
    }
    read(read_source(source, "the device")?, ends, rig)
}

/// A device that was read before, or that of a result.
fn read_before(source: &Bound<'_, PyAny>) -> PyResult<Option<Device>> {
    if let Ok(device) = source.cast::<Device>() {
        return Ok(Some(device.get().clone()));
    }
    // a device in a dictionary has such a key, and no such attribute
    let Ok(of_result) = source.getattr("device") else {
        return Ok(None);
    };
    if of_result.is_none() {
        let text = "the result names no cause that is part of a device; give the device itself";
        return Err(Failure::value(text).into());
    }
    let device = of_result.cast::<Device>().ok();
    Ok(device.map(|device| device.get().clone()))
}

/// The device with other input drum denominators than its file's.
pub(crate) fn with_denominators(
    device: Device,
    denominators: InputDrumDenominators,
) -> Result<Device, Failure> {
    if denominators == InputDrumDenominators::Stated {
        return Ok(device);
    }
    let label = &device.read.source().label;
    let equipment = Equipment {
        denominators,
        ..Equipment::default()
    };
    let read = Read::open(&Source::text(device.read.to_toml(), label), &equipment)?;
    Ok(Device { read })
}

/// A model of a device from whatever was given; the chain of a URDF runs between the same links as the device's.
pub(crate) fn model_of(source: &Bound<'_, PyAny>, device: &Device) -> PyResult<Device> {
    if let Some(model) = read_before(source)? {
        return Ok(model);
    }
    let source = read_source(source, "the model")?;
    let read = device.read.open_model(&source).map_err(Failure::from)?;
    Ok(Device { read })
}

/// A path, the text of a TOML file (recognised by a line break or a bracket), or a dictionary.
pub(crate) fn read_source(source: &Bound<'_, PyAny>, what: &str) -> PyResult<Source> {
    if let Ok(dictionary) = source.cast::<PyDict>() {
        return Ok(Source::text(toml_text(dictionary)?, what));
    }
    if let Ok(text) = source.cast::<PyString>() {
        let text = text.to_string();
        let is_text = text.contains('\n') || text.trim_start().starts_with('[');
        return Ok(if is_text {
            Source::text(text, what)
        } else {
            Source::by_path(&PathBuf::from(text))
        });
    }
    match source.extract::<PathBuf>() {
        Ok(path) => Ok(Source::by_path(&path)),
        Err(_) => {
            let kind = source.get_type().name()?;
            let text = format!(
                "{what} is of the type {kind}; give a path, the text of a TOML file or a dictionary"
            );
            Err(Failure::value(text).into())
        }
    }
}

/// The first keyword that names a link.
fn named(ends: &Ends<'_>) -> Option<&'static str> {
    match ends {
        (Some(_), _) => Some("base"),
        (None, Some(_)) => Some("tip"),
        (None, None) => None,
    }
}

fn read(source: Source, ends: Ends<'_>, rig: Option<&Bound<'_, PyAny>>) -> PyResult<Device> {
    let is_description = is_urdf(&source.path) || is_mjcf(&source.path);
    let is_table = source.text.is_some() || !is_description;
    if let Some(keyword) = named(&ends).filter(|_| is_table) {
        return Err(Failure::value(format!(
            "{keyword} names a link of a URDF, and this device is none; leave it out"
        ))
        .into());
    }
    let mut tips = ends.1.map_or_else(Vec::new, Tips::all).into_iter();
    let equipment = Equipment {
        base: ends.0.map(str::to_owned),
        tip: tips.next(),
        further_tips: tips.collect(),
        rig: rig.map(|rig| read_source(rig, "the rig")).transpose()?,
        ..Equipment::default()
    };
    let read = Read::open(&source, &equipment).map_err(Failure::from)?;
    Ok(Device { read })
}
