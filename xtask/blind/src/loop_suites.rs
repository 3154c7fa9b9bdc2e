//! Clean recordings of which an effect is asked that is not there.

use anyhow::{Result, bail};

use crate::effects::{Group, Kind};
use crate::random::Random;
use crate::suites::{clean, of_group};
use crate::trial::{Asked, Trial, TrialId};

/// What happens at an instant has no form to be fitted before the instant is known: parts of names.
const EVENTS: [&str; 2] = ["count-loss", "slip"];

/// A clean recording, with an effect that it could show.
pub(crate) fn absent(id: TrialId, random: &mut Random) -> Result<Trial> {
    let (mut trial, _) = clean(id.index, random)?.make(id, random)?;
    let mut kinds = of_group(Group::Single);
    let is_event = |kind: &Kind| EVENTS.iter().any(|part| kind.name.contains(part));
    kinds.retain(|kind| !is_event(kind) && !kind.needs_two_runs());
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
    bail!(
        "`an effect to ask for` has no place on device `{}`",
        trial.device.name
    )
}
