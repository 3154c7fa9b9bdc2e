//! Drives that give way: a gear that twists, a gear with play.

use super::{Draw, Drawn};
use crate::moving::motion::specimen::{Soft, Specimen};

fn yielding(soft: Soft) -> Drawn {
    let build = move |specimen: &mut Specimen| specimen.soft = Some(soft);
    Drawn::new(|drawn| drawn.build = Box::new(build)).at(soft.joint)
}

/// A gear that the range of its drive twists by 10 to 20 mrad, and that stiffens with load. Source of the shape: the measured
/// gears of Taghirad & Belanger, "Modeling and parameter identification of harmonic drive systems", Journal of Dynamic
/// Systems, Measurement and Control 120, 1998, a cubic.
pub(crate) fn elastic(draw: &mut Draw<'_>) -> Drawn {
    let axis = &draw.arm.axes[draw.joint];
    let twist_rad = draw.size * draw.random.uniform(0.01, 0.02);
    let stiffness = axis.range / twist_rad;
    yielding(Soft {
        joint: draw.joint,
        stiffness,
        hardens_rad: 1.5 * twist_rad,
        damping: 0.06 * libm::sqrt(stiffness * axis.armature),
        play_rad: 0.0,
    })
    .with("stiffness", stiffness)
}

/// A gear with play, stiff beyond it.
pub(crate) fn backlash(draw: &mut Draw<'_>) -> Drawn {
    let axis = &draw.arm.axes[draw.joint];
    let play_rad = draw.size * draw.random.uniform(0.004, 0.01);
    let stiffness = axis.range / 0.002;
    yielding(Soft {
        joint: draw.joint,
        stiffness,
        hardens_rad: 0.1,
        damping: 0.25 * libm::sqrt(stiffness * axis.armature),
        play_rad,
    })
    .with("play_rad", play_rad)
}
