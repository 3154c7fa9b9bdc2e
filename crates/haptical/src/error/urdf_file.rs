//! Refusals of URDFs and MJCFs.

use std::path::Path;

use haptical_urdf::UrdfError;

use super::Error;
use crate::device::is_mjcf;

impl Error {
    /// A refused URDF, or a device that is not of it.
    pub fn urdf(error: &UrdfError, path: &Path) -> Self {
        let file = path.display().to_string();
        let mut text = error.to_string();
        let (kind, next) = match error {
            UrdfError::File(error) => return Self::device_file(error, path),
            UrdfError::Xml { .. } => (
                "syntax",
                "correct the XML at this place; a document type (DTD) must be removed",
            ),
            UrdfError::NotUrdf { at, found, advice } => {
                text = format!("{at}: the outermost element is <{found}>, not <robot>");
                ("shape", *advice)
            }
            UrdfError::NotMjcf { at, found, advice } => {
                text = format!("{at}: the outermost element is <{found}>, not <mujoco>");
                ("shape", *advice)
            }
            UrdfError::Missing { what, .. } => ("missing-key", &*format!("add its {what}")),
            UrdfError::Value {
                at,
                place,
                what,
                found,
                allowed,
            } => {
                text = format!("{at}: {place}: {what} is {found}");
                ("value", &*format!("correct it: {allowed}"))
            }
            UrdfError::Tree { .. } if is_mjcf(path) => (
                "shape",
                "correct this element, or name other ends of the chain with --base and --tip",
            ),
            UrdfError::Tree { .. } => (
                "shape",
                "correct links and joints: one root, one parent for each link, no joint that follows \
                 itself",
            ),
            UrdfError::Includes { at } => {
                text = format!(
                    "{at}: the model includes other files, and a corrected one is one file"
                );
                (
                    "not-supported",
                    "write a new MJCF without --mjcf, or save the model as one file, as MuJoCo's mj_saveLastXML does",
                )
            }
            UrdfError::UnknownLink { .. } => (
                "chain",
                "correct the name that is given with --base or --tip",
            ),
            UrdfError::TipMissing { base, ends, .. } => {
                text = format!("--base {base} needs --tip too");
                (
                    "chain",
                    &*format!("name the tip with --tip; branches end at {ends}"),
                )
            }
            UrdfError::SameLink { .. } | UrdfError::Unmoved { base: Some(_), .. } => (
                "chain",
                "name links with a joint that moves between them with --base and --tip",
            ),
            UrdfError::Chain { .. } | UrdfError::Unmoved { .. } => {
                ("chain", "name a link behind a joint that moves with --tip")
            }
            UrdfError::Device { .. } => (
                "other-device",
                "give --urdf or --mjcf, --base and --tip as the device came from them",
            ),
            _ => ("shape", "correct the file"),
        };
        let Some(at) = error.position() else {
            let what = text.strip_prefix(&format!("{file}: ")).unwrap_or(&text);
            return Self::bad_input(kind, what, file, next);
        };
        let what = text.strip_prefix(&format!("{at}: ")).unwrap_or(&text);
        // a file that the description includes has its own name
        let path = Path::new(&at.file);
        Self::placed(kind, what, path, (at.line as u64, at.column as u64), next)
    }
}
