//! Noise that is not what the device file states: louder on one channel, or with outliers.

use crate::effects::{Act, Draw, Effect, Facts, fixed};
use crate::rig::noise::NoisePlan;
use crate::rig::scene::Scene;

/// A channel that is 2 to 5 times as noisy in motion as the file states: the joint's external encoder, or the cable.
pub(crate) fn noise_level(draw: &mut Draw<'_>) -> Effect {
    let joint = (draw.random.unit() < 0.7).then_some(draw.joint);
    let speed_ratio = 1.0 + draw.size * draw.random.uniform(1.5, 4.0);
    let info = match joint {
        Some(_) => draw.at_joint("noise-level", &["noise-level"]),
        None => draw.anywhere("noise-level", &["noise-level"]),
    };
    let act = move |_: &Scene<'_>, plan: &mut NoisePlan| {
        let channel = match joint {
            Some(joint) => &mut plan.output[joint],
            None => &mut plan.cable,
        };
        channel.speed_ratio = speed_ratio;
    };
    let facts = Facts::default().law("speed_ratio", speed_ratio);
    Effect::new(info, fixed(facts), Act::Noise(Box::new(act)))
}

/// Readings that are far off, on every channel.
pub(crate) fn outliers(draw: &mut Draw<'_>) -> Effect {
    let share = draw.size * draw.random.uniform(0.01, 0.04);
    let act = move |_: &Scene<'_>, plan: &mut NoisePlan| {
        for channel in plan.output.iter_mut().chain([&mut plan.cable]) {
            channel.outlier_share = share;
        }
    };
    let info = draw.anywhere("outliers", &["outliers", "noise-level"]);
    let facts = Facts::default()
        .law("speed_ratio", 1.0)
        .with("share", share);
    Effect::new(info, fixed(facts), Act::Noise(Box::new(act)))
}
