//! Effects that add a deviation to one signal.

use crate::effects::{Act, Effect, Facts, Info, Stage};
use crate::rig::scene::Scene;

impl Effect {
    /// Adds what `law` says, sample by sample, to the signal of the effect's joint, or to the cable's reading, in the signal's
    /// unit. Upstream the law is given the output angle, and a positive deviation lets the motor lead.
    pub(crate) fn added(
        info: Info,
        stage: Stage,
        facts: impl Fn(&Scene<'_>) -> Facts + Send + Sync + 'static,
        law: impl Fn(&Scene<'_>, &[f64]) -> Vec<f64> + Send + Sync + 'static,
    ) -> Self {
        let column = info.joint.unwrap_or(0);
        let add = move |scene: &Scene<'_>, columns: &mut [Vec<f64>]| {
            let deviation = match stage {
                Stage::Upstream => law(scene, &scene.motion.angle_rad[column]),
                _ => law(scene, &columns[column]),
            };
            for (value, extra) in columns[column].iter_mut().zip(deviation) {
                *value += extra;
            }
        };
        Self::new(info, facts, Act::Columns(stage, Box::new(add)))
    }
}
