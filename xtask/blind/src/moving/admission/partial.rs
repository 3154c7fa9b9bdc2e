//! A strong effect on an arm whose friction has a law of its own in two or three joints.

use anyhow::{Context, Result};

use super::{Tale, effect, plan};
use crate::moving::kinds::{Kind, OWN_FRICTION};
use crate::moving::laws::Drawn;
use crate::moving::scene::{Scene, placed_on};
use crate::moving::trial::{Built, build};
use crate::planted::Planted;
use crate::random::Random;
use crate::trial::{Trial, TrialId};

/// The friction is at least so far above the filtered noise, root mean square, worst joint.
pub(crate) const LEAST_OVER_NOISE: f64 = 3.0;
/// Draws of friction until it does.
const DRAWS: usize = 20;

/// Friction that was drawn, and how far it is above the noise.
type Friction = (Vec<Drawn>, f64);

pub(super) fn draw(number: usize, id: TrialId, random: &mut Random) -> Result<Trial> {
    let kind = effect(number)?;
    let law = &OWN_FRICTION[(number + number / super::EFFECTS.len()) % OWN_FRICTION.len()];
    let plan = plan(Some(kind));
    let (scene, joints) = placed_on(&super::ARMS, &plan, 0.0, random)?;
    let mut built = build(&plan, (scene, joints.clone()), random)?;
    let (friction, over_noise) = friction(&built.scene, law, &joints, random)
        .with_context(|| format!("`{}` is no more than noise", law.label))?;
    let mut planted = built.planted(Some(kind));
    planted.extend(friction.iter().map(|drawn| beside(law, drawn, over_noise)));
    built.add(friction, random);
    let logs = built.logs(random);
    let tale = Tale {
        label: format!("partial-{}", kind.label),
        planted,
        ..Tale::default()
    };
    tale.trial(id, &built.scene, logs)
}

/// Friction of one law in two or three joints that the effect is not at.
fn friction(
    scene: &Scene,
    law: &'static Kind,
    taken: &[usize],
    random: &mut Random,
) -> Option<Friction> {
    for _ in 0..DRAWS {
        let mut free = scene.joints(law);
        free.retain(|joint| !taken.contains(joint));
        let mut joints = Vec::new();
        for _ in 0..2 + random.index(2) {
            let joint = random.choose(&free)?;
            free.retain(|other| *other != joint);
            joints.push(joint);
        }
        let kinds = vec![law; joints.len()];
        let drawn = scene.effects(&joints, &kinds, 1.0, random);
        let (_, changes) = scene.record(&drawn, random);
        let over_noise = changes.arm.over_noise;
        if over_noise >= LEAST_OVER_NOISE {
            return Some((drawn, over_noise));
        }
    }
    None
}

/// What has no name and stands beside.
fn beside(law: &Kind, drawn: &Drawn, over_noise: f64) -> Planted {
    let mut numbers = drawn.numbers.clone();
    numbers.insert("friction_over_noise".to_owned(), over_noise);
    Planted {
        name: law.label,
        joint: drawn.joint,
        law: numbers,
        ..Planted::default()
    }
}

impl Built {
    /// Records once more, with further effects.
    fn add(&mut self, further: Vec<Drawn>, random: &mut Random) {
        self.effects.extend(further);
        (self.recorded, _) = self.scene.record(&self.effects, random);
    }
}
