//! Two joints whose columns changed places: each follows the other's command.

use super::dead::stretches;
use super::scale::median;
use super::{EpisodeFinding, EpisodeLog, Fault};
use crate::thresholds::{SWAP_ROWS, SWAPPED_SHARE, SWAPPED_USUAL};

/// Of each joint the swaps that it is in.
pub(super) fn swaps(log: &EpisodeLog<'_>) -> Vec<Vec<EpisodeFinding>> {
    let joints = log.joints.len();
    let mut found = vec![Vec::new(); joints];
    let commands: Vec<Option<&[f64]>> = log.joints.iter().map(|joint| joint.command).collect();
    let error = |episode: usize, position: usize, command: usize| -> f64 {
        let Some(commands) = commands[command] else {
            return f64::INFINITY;
        };
        let rows = &log.episodes[episode];
        let some = rows.clone().step_by(rows.len().div_ceil(SWAP_ROWS).max(1));
        let errors = some.map(|row| log.joints[position].position[row] - commands[row]);
        let (sum, count) = (errors.filter(|error| error.is_finite()))
            .fold((0.0, 0.0), |(sum, count), error| {
                (sum + error * error, count + 1.0)
            });
        (sum / f64::max(count, 1.0)).sqrt()
    };
    let episodes = log.episodes.len();
    let to_command: Vec<Vec<f64>> = (0..joints)
        .map(|joint| {
            (0..episodes)
                .map(|episode| error(episode, joint, joint))
                .collect()
        })
        .collect();
    // how far each joint's reading is from its command as a rule
    let usual: Vec<f64> = to_command
        .iter()
        .map(|errors| median(&mut errors.clone()))
        .collect();
    for first in 0..joints {
        for second in first + 1..joints {
            let moves = |episode: usize, joint: usize| {
                let mut pairs =
                    log.joints[joint].position[log.episodes[episode].clone()].windows(2);
                pairs.any(|pair| pair[0] != pair[1])
            };
            // nearer to the other's command by so many times, both; and how near that is as a rule
            let is_swapped = |episode: usize, share: f64| {
                let [a, b] = [to_command[first][episode], to_command[second][episode]];
                // both are far from their commands before the dearer question is asked
                a > log.least_offset
                    && b > log.least_offset
                    && error(episode, first, second)
                        < (share * a).min(SWAPPED_USUAL * usual[second])
                    && error(episode, second, first) < (share * b).min(SWAPPED_USUAL * usual[first])
                    && moves(episode, first)
                    && moves(episode, second)
            };
            if !(0..episodes).any(|episode| is_swapped(episode, SWAPPED_SHARE)) {
                continue;
            }
            // next to one that is clear, others count that are nearer at all: joints that move alike hardly show it
            let maybe: Vec<bool> = (0..episodes)
                .map(|episode| is_swapped(episode, 1.0))
                .collect();
            let mut swapped = stretches(&maybe);
            swapped.retain(|[since, last]| {
                (*since..=*last).any(|episode| is_swapped(episode, SWAPPED_SHARE))
            });
            for [since, last] in swapped {
                for (joint, with) in [(first, second), (second, first)] {
                    found[joint].push(EpisodeFinding {
                        fault: Fault::Swapped { with },
                        since,
                        until: (last + 1 < episodes).then_some(last),
                        probability: 0.99,
                    });
                }
            }
        }
    }
    found
}
