//! The haptic device of the paper with each rig of the guides; logs of fixtures/logs, single postures without time.

use anyhow::Result;

use crate::scene::{DeviceFile, Made, Scene, fixture, root, scenes};
use crate::table::Table;

pub(crate) const SCENES: &[Scene] = scenes! {
    "rig-cable" [] haptic7("haptic7-sample.csv", None);
    "rig-two-cables" [] haptic7("two-cables.csv.gz", Some("two-cables"));
    "rig-tracker-unknown" [] haptic7("tracker.csv.gz", Some("tracker"));
    "rig-stands" [] haptic7("stands.csv.gz", Some("stands"));
    "rig-reflectors" [] haptic7("reflectors.csv.gz", Some("reflectors"));
    "rig-homing" [] Ok(haptic7("homing.csv.gz", Some("homing"))?.folds(5));
    "rig-planes" [] Ok(haptic7("planes.csv.gz", Some("planes"))?.folds(5));
    "rig-balls" [] haptic7("balls.csv.gz", Some("balls"));
};

/// Text of the device of the paper.
pub(crate) fn haptic7_toml() -> Result<String> {
    fixture("fixtures/devices/haptic7.toml")
}

fn haptic7(log: &str, rig: Option<&str>) -> Result<Made> {
    let mut device = DeviceFile::toml(haptic7_toml()?);
    if let Some(rig) = rig {
        device = device.rigged(fixture(&format!("fixtures/rigs/{rig}.toml"))?);
    }
    let log = Table::read(root("fixtures/logs").join(log))?;
    Ok(Made::new(device, log))
}
