//! Noise that is not what the device file states: louder on one channel, or with outliers.

use crate::effects::{Draw, Effect, Facts, Info};
use crate::rig::noise::NoisePlan;
use crate::rig::scene::Scene;

/// Noise of one channel, or of all.
#[derive(Debug)]
struct Pathology {
    info: Info,
    /// Joint of the external encoder; `None` for the cable.
    channel: Option<usize>,
    speed_ratio: f64,
    outlier_share: f64,
}

impl Effect for Pathology {
    fn info(&self) -> &Info {
        &self.info
    }

    fn facts(&self, _scene: &Scene<'_>) -> Facts {
        let facts = Facts::default().law("speed_ratio", self.speed_ratio);
        if self.outlier_share > 0.0 {
            facts.with("share", self.outlier_share)
        } else {
            facts
        }
    }

    fn noise(&self, _scene: &Scene<'_>, plan: &mut NoisePlan) {
        if self.outlier_share > 0.0 {
            for channel in plan.output.iter_mut().chain([&mut plan.cable]) {
                channel.outlier_share = self.outlier_share;
            }
        } else {
            let channel = match self.channel {
                Some(joint) => &mut plan.output[joint],
                None => &mut plan.cable,
            };
            channel.speed_ratio = self.speed_ratio;
        }
    }
}

/// A channel that is 2 to 5 times as noisy in motion as the file states.
pub(crate) fn noise_level(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let channel = (draw.random.unit() < 0.7).then_some(draw.joint);
    let speed_ratio = 1.0 + draw.size * draw.random.uniform(1.5, 4.0);
    let info = if channel.is_some() {
        draw.at_joint("noise-level", &["noise-level"])
    } else {
        draw.anywhere("noise-level", &["noise-level"])
    };
    Box::new(Pathology {
        info,
        channel,
        speed_ratio,
        outlier_share: 0.0,
    })
}

/// Readings that are far off, on every channel.
pub(crate) fn outliers(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let outlier_share = draw.size * draw.random.uniform(0.01, 0.04);
    Box::new(Pathology {
        info: draw.anywhere("outliers", &["outliers", "noise-level"]),
        channel: None,
        speed_ratio: 1.0,
        outlier_share,
    })
}
