//! A device for a control loop (Rust, C, JSON), a simulator or planner (URDF, MJCF), ROS 2, or as a device file.

mod c_effects;
mod c_header;
mod compensation;
mod described;
mod description;
mod flat_json;
mod not_held;
mod rust_module;

use std::path::Path;

use haptical_urdf::{BaseAndTip, Loader};

use self::described::Described;
use crate::device::Device;
use crate::error::Error;
use crate::files::{VERSION, file_name, sealed_text};

/// Name of the command.
const COMMAND: &str = "export";

/// Forms of an export.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A module with the device as a constant of `haptical-runtime`.
    Rust,
    /// A C99 header.
    CHeader,
    /// Flat arrays with names and units.
    Json,
    /// A device file.
    Toml,
    /// A URDF, corrected or new.
    Urdf,
    /// An MJCF, corrected or new.
    Mjcf,
    /// A xacro macro with a ros2_control block.
    Ros2Control,
    /// Corrected origins as parameters of a xacro.
    KinematicsYaml,
}

impl Form {
    /// Beginning and end of a comment; none for JSON, which holds its own hash.
    fn comment(self) -> Option<[&'static str; 2]> {
        match self {
            Self::Rust => Some(["// ", ""]),
            Self::CHeader => Some(["/* ", " */"]),
            Self::Json => None,
            Self::Toml | Self::KinematicsYaml => Some(["# ", ""]),
            Self::Urdf | Self::Mjcf | Self::Ros2Control => Some(["<!-- ", " -->"]),
        }
    }
}

/// What is asked of an export.
#[derive(Debug, Clone, Copy)]
pub struct Export<'e> {
    /// What to write.
    pub form: Form,
    /// URDF that the device came from, whose text is corrected.
    pub urdf: Option<&'e Path>,
    /// MJCF that the device came from.
    pub mjcf: Option<&'e Path>,
    /// Where its chain ran in them.
    pub ends: BaseAndTip<'e>,
    /// Whether springs, plays and couplings become joints of the MJCF.
    pub new_joints: bool,
    /// Program that reads the URDF.
    pub loader: Option<Loader>,
}

impl Export<'_> {
    /// A form without further wishes.
    pub fn new(form: Form) -> Self {
        Self {
            form,
            urdf: None,
            mjcf: None,
            ends: BaseAndTip::default(),
            new_joints: false,
            loader: None,
        }
    }
}

/// A device in a form.
#[derive(Debug, Clone, PartialEq)]
pub struct Exported {
    /// The text, with its own SHA-256 in a comment at its end (in JSON: `result_sha256`).
    pub text: String,
    /// What the form does not hold, and what is odd about the device.
    pub warnings: Vec<String>,
    /// SHA-256 of the device file.
    pub device_sha256: String,
}

/// The origin of an export.
#[derive(Debug, Clone, PartialEq)]
struct Provenance {
    /// Name of the device.
    device: String,
    /// Name of the device file, without its folder.
    file: String,
    /// SHA-256 of the device file.
    sha256: String,
}

/// Writes a device in a form.
///
/// ```
/// use haptical::{Device, Export, Form, export};
/// let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n[[link]]\na_m = 0.3\nalpha_rad = 0.0\nd_m = 0.0\n[[joint]]\n";
/// let device = Device::from_toml(text, "lever.toml")?;
/// let header = export(&device, &Export::new(Form::CHeader))?.text;
/// assert!(header.contains("#ifndef"));
/// # Ok::<(), haptical::Error>(())
/// ```
///
/// # Errors
/// A device that the form cannot hold, or a URDF or MJCF that it is not of.
pub fn export(device: &Device, request: &Export<'_>) -> Result<Exported, Error> {
    description::check(request)?;
    let path = device.source().path.as_path();
    let provenance = Provenance {
        device: device.model.name.clone(),
        file: file_name(path),
        sha256: device.source().fingerprint_text(device.to_toml()).sha256,
    };
    let mut warnings = device.warnings.clone();
    if matches!(request.form, Form::Urdf | Form::Mjcf | Form::KinematicsYaml) {
        warnings.extend(device.relative_to_tracker());
    }
    let mut described = || {
        device.refuse_hands("this form")?;
        let described = Described::new(&device.model, path)?;
        warnings.extend(described.compensation.warnings());
        Ok::<_, Error>(described)
    };
    let content = match request.form {
        Form::Rust => rust_module::text(&described()?, &provenance),
        Form::CHeader => c_header::text(&described()?, &provenance)?,
        Form::Json => flat_json::text(&described()?, &provenance)?,
        Form::Toml => device.to_toml().to_owned(),
        Form::Urdf | Form::Mjcf | Form::Ros2Control | Form::KinematicsYaml => {
            let own = (&device.model, path);
            let (text, said) = description::text(own, request, &provenance.sha256)?;
            warnings.extend(said);
            text
        }
    };
    let text = match request.form.comment() {
        Some(comment) => sealed_text(&content, &format!("haptical {COMMAND}"), comment),
        None => content,
    };
    Ok(Exported {
        text,
        warnings,
        device_sha256: provenance.sha256,
    })
}

/// Neither a control character nor one that changes the direction of text, which rustc refuses.
fn is_plain(c: char) -> bool {
    ['\'', '"', '\\'].contains(&c) || c.escape_debug().eq([c])
}

/// A name as part of one line of a comment, in which it can end nothing.
fn one_line(text: &str) -> String {
    text.chars()
        .map(|c| if is_plain(c) { c } else { ' ' })
        .collect::<String>()
        .replace("*/", "* /")
        .replace("/*", "/ *")
}
