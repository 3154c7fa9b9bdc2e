//! Clean recordings of which an effect is asked that is not there.

use crate::effects::{Group, Kind};
use crate::error::BlindError;
use crate::random::Random;
use crate::suites::{clean, of_group};
use crate::trial::{Asked, Trial};

/// Parts of names that nobody can ask for by name and joint: what happens at an instant, what another joint does, and a
/// number of the base model.
const NOT_ASKED: [&str; 4] = ["count-loss", "slip", "cross-coupling", "joint-compliance"];

/// A clean recording, with an effect that it could show.
pub(crate) fn absent(
    suite: &str,
    index: u64,
    batch_seed: u64,
    random: &mut Random,
) -> Result<Trial, BlindError> {
    let mut trial = clean(index, random)?.make(suite, index, batch_seed, random)?;
    let mut kinds = of_group(Group::Single);
    let is_out = |kind: &Kind| NOT_ASKED.iter().any(|part| kind.name.contains(part));
    kinds.retain(|kind| !is_out(kind) && !kind.needs_two_runs());
    for _ in 0..100 {
        let Some(kind) = random.choose(&kinds) else {
            break;
        };
        if let Some(joint) = random.choose(&kind.joints(&trial.device)) {
            trial.asked = Some(Asked {
                effect: kind.name,
                joint: (!kind.is_whole()).then_some(joint + 1),
            });
            return Ok(trial);
        }
    }
    Err(BlindError::NoPlace {
        effect: "an effect to ask for".to_owned(),
        device: trial.device.name,
    })
}
