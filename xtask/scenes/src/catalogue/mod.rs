//! All scenes: every rig and every view once at least.

mod arms;
mod hand;
mod motors;
mod rigs;
mod servos;
mod torques;

use crate::scene::Scene;

/// Noise of a tracker \[m\], and the tracker as a sensor of a device.
pub(crate) const TRACKER_SD_M: f64 = 1e-4;
pub(crate) const TRACKER: &str =
    "[tracker]\nbase = \"known\"\ntool = \"known\"\nposition_sd_m = 1e-4\n";

const LISTS: [&[Scene]; 6] = [
    rigs::SCENES,
    arms::SCENES,
    hand::SCENES,
    torques::SCENES,
    servos::SCENES,
    motors::SCENES,
];

pub(crate) static SCENES: std::sync::LazyLock<Vec<Scene>> =
    std::sync::LazyLock::new(|| LISTS.concat());

/// Scenes whose name contains a text.
pub(crate) fn named(part: &str) -> Vec<Scene> {
    let scenes = SCENES.iter().filter(|scene| scene.name.contains(part));
    scenes.copied().collect()
}
