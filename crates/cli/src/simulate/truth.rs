//! The true device of a simulated log.

use std::path::Path;

use haptical::files::{InputFile, Source};
use haptical::{Device, Equipment, Truth};
use haptical_model::Device as Model;

use super::SimulateArguments;
use crate::failure::Failure;

impl SimulateArguments {
    /// The device of --truth, whose logs the device must be able to read.
    pub(super) fn read_truth(
        &self,
        device: &mut Device,
        files: &mut Vec<InputFile>,
    ) -> Result<Option<Device>, Failure> {
        let Some(path) = &self.truth else {
            return Ok(None);
        };
        let truth = Device::open(&Source::given(path), &Equipment::default())?;
        files.extend(truth.inputs("truth"));
        check_likeness(&device.model, &truth.model, path)?;
        device.warnings.extend(truth.warnings.iter().cloned());
        Ok(Some(truth))
    }

    /// The true device, `other` that of --truth.
    pub(super) fn truth<'t>(&self, other: Option<&'t Device>) -> Truth<'t> {
        match (other, self.deviate) {
            (Some(other), _) => Truth::Of(other),
            (None, Some(share)) => Truth::Drawn(share),
            (None, None) => Truth::Nominal,
        }
    }
}

/// A true device as a file.
pub(super) fn truth_text(truth: &Model) -> Result<String, Failure> {
    truth.to_new_toml().map_err(Failure::internal)
}

/// Refuses a true device whose logs the device cannot read.
fn check_likeness(device: &Model, truth: &Model, path: &Path) -> Result<(), Failure> {
    let kinds = |of: &Model| -> Vec<_> { of.joints.iter().map(|joint| joint.joint_type).collect() };
    let is_alike = kinds(device) == kinds(truth)
        && device.cables.len() >= truth.cables.len()
        && device.has_links() == truth.has_links();
    if is_alike {
        return Ok(());
    }
    Err(Failure::in_file(
        "truth",
        format!(
            "the true device has {} joints and {} cables, the device {} and {}, or joints or links of \
             another kind",
            truth.joints.len(),
            truth.cables.len(),
            device.joints.len(),
            device.cables.len()
        ),
        path,
        "take a copy of the device file with other numbers, such as an identified.toml",
    ))
}
