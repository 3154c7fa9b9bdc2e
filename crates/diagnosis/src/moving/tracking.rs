//! Commands of a moving arm beside its torques, as `haptical-motion` examines them.

use haptical_effects::force::in_motion::COMMAND_LATENCY;
use haptical_model::{Device, Recording};
use haptical_motion::{Examined, Untracked, examine_tracking};

use super::words::Words;
use crate::answer::Untestable;
use crate::force::answer::ForceAnswer;

/// The torques' answer with what the commands show: a delay as a cause, or why none can be told.
pub(super) fn beside(
    device: &Device,
    logs: (&Recording, Option<&Recording>),
    torques: &Examined,
    without: &[String],
    mut answer: ForceAnswer,
) -> ForceAnswer {
    let name = COMMAND_LATENCY.name;
    let tracking = match examine_tracking(device, logs, torques, without) {
        Ok(tracking) => tracking,
        Err(why) => {
            if why != Untracked::NoCommands {
                let words = format!("the commands were not tested: {why}");
                answer.warnings.push(words);
            }
            let entry = Untestable::new(name, why.to_string());
            answer.untestable.push(entry);
            return answer;
        }
    };
    let words = Words::of_commands(device, &tracking.examined);
    let channels = words.gaps();
    if !channels.iter().any(|own| own.has_gap) {
        return answer;
    }
    answer.course = answer.course.or_else(|| words.course(&channels));
    answer.channels.extend(channels);
    if answer.findings.is_empty() {
        answer.unexplained_share = match words.is_adequate {
            true => tracking.examined.unexplained_share(),
            false => 1.0,
        };
    }
    answer.findings.extend(words.causes());
    answer.significant = true;
    answer.tested += tracking.examined.tried;
    if words.is_adequate {
        answer.warnings.push(format!(
            "the torques follow the commands by {}, its gains free; corrected.toml does not hold command-latency: delay the commands by hand",
            tracking.law
        ));
    }
    let others: Vec<String> = (tracking.others.iter())
        .map(|own| (own + 1).to_string())
        .collect();
    if !others.is_empty() {
        answer.warnings.push(format!(
            "of joint {} no controller's law gives the torque by the command: nothing is said of its delay",
            others.join(", ")
        ));
    }
    if let Some(second) = &mut answer.second {
        second.extend(words.on_second());
    }
    answer
}
