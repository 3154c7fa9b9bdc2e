//! A device file that has a body's mass, centre or inertia wrong.

use anyhow::{Result, bail};

use super::felt::{FELT, largest_apart, needed};
use super::{Tale, any};
use crate::moving::arms::{Axis, device_toml_of};
use crate::moving::scene::Scene;
use crate::planted::Planted;
use crate::random::Random;
use crate::trial::{Trial, TrialId};
use crate::truth::{Besides, Said};

/// What is wrong of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Wrong {
    Centre,
    Twice,
    Half,
    Inertia,
}

/// In turn.
const ORDER: [Wrong; 4] = [Wrong::Centre, Wrong::Twice, Wrong::Half, Wrong::Inertia];
/// Arms that are drawn until one feels it.
const DRAWS: usize = 50;

impl Wrong {
    fn label(self) -> &'static str {
        match self {
            Self::Centre => "description-centre",
            Self::Twice => "description-mass-twice",
            Self::Half => "description-mass-half",
            Self::Inertia => "description-inertia",
        }
    }

    /// The body as the file has it.
    fn put(self, axis: &mut Axis, random: &mut Random) {
        match self {
            Self::Centre => {
                let mut largest = 0;
                for along in 1..3 {
                    if axis.centre_m[along].abs() > axis.centre_m[largest].abs() {
                        largest = along;
                    }
                }
                axis.centre_m[largest] *= -1.0;
            }
            Self::Twice => axis.mass_kg *= 2.0,
            Self::Half => axis.mass_kg *= 0.5,
            Self::Inertia => axis.inertia_kgm2[random.index(3)] *= -1.0,
        }
    }
}

/// A body (from 0), the axes as the file has them, and how much the torques feel of it.
type Described = (usize, Vec<Axis>, f64);

pub(super) fn draw(number: usize, id: TrialId, random: &mut Random) -> Result<Trial> {
    let wrong = ORDER[number % ORDER.len()];
    for _ in 0..DRAWS {
        let built = any(None, random)?;
        let Some((link, axes, felt)) = described(&built.scene, wrong, random) else {
            continue;
        };
        let scene = &built.scene;
        let is_last = link + 1 == scene.arm.count();
        let is_negative = wrong == Wrong::Inertia;
        let mut right = vec!["link-inertia"];
        right.extend(is_last.then_some("payload"));
        // rows of the file count the base as one
        let mut refusals = vec![format!("link {}", link + 1), format!("link {}", link + 2)];
        if is_negative {
            refusals.extend(["inertia".to_owned(), "credible_base".to_owned()]);
        }
        let tale = Tale {
            label: wrong.label().to_owned(),
            planted: vec![Planted {
                name: "link-inertia",
                joint: Some(link),
                right,
                law: [("felt".to_owned(), felt)].into(),
                ..Planted::default()
            }],
            besides: Besides {
                refusals,
                unknown: !is_negative,
                no_gap_with: Some(match is_negative {
                    true => Said::Impossible,
                    false => Said::Bodies,
                }),
                ..Besides::default()
            },
            ..Tale::default()
        };
        let device_toml = device_toml_of(scene.arm, &axes, scene.sensors.has_outputs);
        let logs = built.logs(random);
        let sound = tale.trial(id, scene, logs)?;
        // a reader may refuse what the file says: the trial's device is the sound one
        return Ok(Trial {
            device_toml,
            ..sound
        });
    }
    bail!("`{}` is felt on no arm", wrong.label())
}

/// A body whose wrong mass or centre shows in the torques; any body for an inertia that no body has.
fn described(scene: &Scene, wrong: Wrong, random: &mut Random) -> Option<Described> {
    let sound = needed(scene, &scene.arm.chain());
    let mut choices = Vec::new();
    for link in 0..scene.arm.count() {
        let mut axes = scene.arm.axes.to_vec();
        wrong.put(&mut axes[link], random);
        let own = needed(scene, &scene.arm.chain_of(&axes));
        let felt = largest_apart(scene.arm, &sound, &own);
        if felt >= FELT || wrong == Wrong::Inertia {
            choices.push((link, axes, felt));
        }
    }
    let place = random.index(choices.len());
    (!choices.is_empty()).then(|| choices.swap_remove(place))
}
