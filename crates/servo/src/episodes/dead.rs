//! A joint that stays where it is while its command moves, for whole episodes.

use super::series::Joint;
use super::{EpisodeFinding, Fault};
use crate::thresholds::{DEAD_COUNTS, DEAD_SHARE, FOLLOWS_SHARE};

/// Stretches of episodes in which the joint is dead.
pub(super) fn faults(joint: &Joint, ranges: &[[f64; 2]], least: f64) -> Vec<EpisodeFinding> {
    let count = joint.count();
    let moved_ranges: Vec<[f64; 2]> = joint
        .episodes
        .iter()
        .map(|(episode, _)| ranges[*episode])
        .collect();
    let start = |place: usize| joint.position[joint.episodes[place].1.start];
    let is_still = |[position, command]: [f64; 2]| {
        position <= DEAD_SHARE * command && position <= DEAD_COUNTS * count && command > 0.0
    };
    // it follows as small a motion in another episode, or no joint rests through so large a one
    let follows = |least: f64| {
        moved_ranges
            .iter()
            .any(|[position, command]| *position >= FOLLOWS_SHARE * command && *command <= least)
    };
    let mut dead: Vec<bool> = (moved_ranges.iter())
        .map(|ranges| is_still(*ranges) && (ranges[1] >= 4.0 * least || follows(ranges[1])))
        .collect();
    // the episodes next to a dead one that stay at its value, or at one to the last digit, are dead, too, however little was asked
    let stays = |place: usize, next: usize| {
        let is_near = (start(place) - start(next)).abs() <= DEAD_COUNTS * count;
        moved_ranges[place][0] <= DEAD_COUNTS * count && (is_near || moved_ranges[place][0] == 0.0)
    };
    for place in 1..dead.len() {
        dead[place] |= dead[place - 1] && stays(place, place - 1);
    }
    for place in (1..dead.len()).rev() {
        dead[place - 1] |= dead[place] && stays(place - 1, place);
    }
    let found = stretches(&dead).into_iter();
    found
        .map(|[first, last]| EpisodeFinding {
            fault: Fault::Dead { at: start(first) },
            since: joint.episodes[first].0,
            until: (last + 1 < dead.len()).then(|| joint.episodes[last].0),
            probability: 0.99,
        })
        .collect()
}

/// First and last place of each stretch that holds.
pub(super) fn stretches(holds: &[bool]) -> Vec<[usize; 2]> {
    let mut found: Vec<[usize; 2]> = Vec::new();
    for place in (0..holds.len()).filter(|place| holds[*place]) {
        match found.last_mut().filter(|last| last[1] + 1 == place) {
            Some(last) => last[1] = place,
            None => found.push([place; 2]),
        }
    }
    found
}
