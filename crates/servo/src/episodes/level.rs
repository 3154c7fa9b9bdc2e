//! Offsets: another constant between position and command.

use std::ops::Range;

use haptical_linalg::NormalEquations;

use super::change_points::{Step, change_points};
use super::dead::stretches;
use super::scale::{deviation, median, scatter};
use super::series::Joint;
use super::{EpisodeFinding, Fault, Side, verdict::probability};
use crate::thresholds::{
    NEIGHBOURS, ODD_SCATTERS, ODD_SPREAD, POSE_LEAVES, SIDE_RATIO, STANDING_SCATTERS, WRONG_SIDE,
};

/// Offsets from an episode on, of odd episodes, and of all of them; episodes are places among those that show the joint.
pub(super) fn faults(joint: &Joint, least: f64) -> Vec<EpisodeFinding> {
    let mut levels = joint.levels();
    let steps = change_points(&levels, least);
    let mut found = match steps.is_empty() || is_pose(joint, &levels, &steps) {
        true => Vec::new(),
        false => pieces(joint, &levels, &steps, least),
    };
    // what else there is shows once the steps are out
    for finding in &found {
        let Fault::Offset { size, .. } = finding.fault else {
            continue;
        };
        let end = finding.until.map_or(levels.len(), |last| last + 1);
        levels[finding.since..end]
            .iter_mut()
            .for_each(|level| *level -= size);
    }
    match standing(&levels, least) {
        Some(standing) => found.push(standing),
        None => found.extend(odd(joint, &levels, least)),
    }
    found
}

/// Whether where the arm is explains the levels as well as the steps do: what gravity and friction leave depends on it.
fn is_pose(joint: &Joint, levels: &[f64], steps: &[Step]) -> bool {
    let poses: Vec<f64> = (joint.episodes.iter())
        .map(|(_, rows)| {
            median(
                &mut joint
                    .rows(rows)
                    .map(|row| joint.command[row])
                    .collect::<Vec<_>>(),
            )
        })
        .collect();
    let middle = median(&mut poses.clone());
    let mut sums = NormalEquations::new(3);
    let row = |pose: f64| [1.0, pose - middle, (pose - middle).powi(2)];
    for (pose, level) in poses.iter().zip(levels) {
        let [a, b, c] = row(*pose);
        sums.add_row(&[a, b, c, *level]);
    }
    let fit = sums.solve(&[0, 1, 2], |_| 0.0);
    let left: Vec<f64> = (poses.iter().zip(levels))
        .map(|(pose, level)| {
            level
                - row(*pose)
                    .iter()
                    .zip(fit.coefficients())
                    .map(|(a, b)| a * b)
                    .sum::<f64>()
        })
        .collect();
    let mut borders: Vec<usize> = steps.iter().map(|step| step.at).collect();
    borders.insert(0, 0);
    borders.push(levels.len());
    let stepped: f64 = borders
        .windows(2)
        .map(|pair| deviation(&levels[pair[0]..pair[1]]))
        .sum();
    stepped > POSE_LEAVES * left.iter().map(|value| value.abs()).sum::<f64>()
}

/// A finding for each stretch of episodes at another level than the one that is taken for right: the first, or one that is nearer to
/// no offset by about as much as they differ.
fn pieces(joint: &Joint, levels: &[f64], steps: &[Step], least: f64) -> Vec<EpisodeFinding> {
    let mut borders: Vec<usize> = steps.iter().map(|step| step.at).collect();
    borders.insert(0, 0);
    borders.push(levels.len());
    let stretches: Vec<Range<usize>> = borders.windows(2).map(|pair| pair[0]..pair[1]).collect();
    let level = |stretch: &Range<usize>| median(&mut levels[stretch.clone()].to_vec());
    let first = level(&stretches[0]);
    let is_right = |other: &f64| first.abs() - other.abs() >= WRONG_SIDE * (first - other).abs();
    let others = stretches[1..].iter().map(level).filter(is_right);
    let right = others.fold(first, |best, other| {
        if other.abs() < best.abs() {
            other
        } else {
            best
        }
    });
    let found = stretches.iter().enumerate().map(|(place, stretch)| {
        let step = &steps[place.saturating_sub(1)];
        EpisodeFinding {
            fault: Fault::Offset {
                size: level(stretch) - right,
                sd: step.sd,
                side: side(joint, step),
            },
            since: stretch.start,
            until: (stretch.end < levels.len()).then(|| stretch.end - 1),
            probability: probability(0.5 * (step.size / step.sd).powi(2), levels.len()),
        }
    });
    let is_wrong = |found: &EpisodeFinding| matches!(found.fault, Fault::Offset { size, .. } if size.abs() >= 0.5 * least);
    found.filter(is_wrong).collect()
}

/// Which column moved: the hands of who leads go where the task is, so the true positions stay.
fn side(joint: &Joint, step: &Step) -> Option<Side> {
    let moved = |column: &[f64]| {
        let middles: Vec<f64> = (joint.episodes.iter())
            .map(|(_, rows)| {
                median(&mut joint.rows(rows).map(|row| column[row]).collect::<Vec<_>>())
            })
            .collect();
        let (before, after) = middles.split_at(step.at);
        let shift = median(&mut after.to_vec()) - median(&mut before.to_vec());
        let parts = 1.0 / before.len() as f64 + 1.0 / after.len() as f64;
        (
            shift,
            scatter(&middles) * (std::f64::consts::FRAC_PI_2 * parts).sqrt(),
        )
    };
    let ([position, sd], [command, _]) =
        (moved(&joint.position).into(), moved(&joint.command).into());
    // one of them moved by the step, the other by nothing, and the tasks scatter by less than that
    let is_known = step.size.abs() >= SIDE_RATIO * sd;
    match position.abs() > command.abs() {
        _ if !is_known => None,
        true => ((command / step.size).abs() < 0.25).then_some(Side::Position),
        false => ((position / step.size).abs() < 0.25).then_some(Side::Command),
    }
}

/// Episodes of another level than those about them.
fn odd(joint: &Joint, levels: &[f64], least: f64) -> Vec<EpisodeFinding> {
    let least = (2.0 * least).max(ODD_SCATTERS * scatter(levels));
    let middle = |place: usize| {
        let near =
            place.saturating_sub(2 * NEIGHBOURS)..(place + 2 * NEIGHBOURS + 1).min(levels.len());
        median(&mut levels[near].to_vec())
    };
    let sizes_of: Vec<f64> = levels
        .iter()
        .enumerate()
        .map(|(place, level)| level - middle(place))
        .collect();
    // an offset is there from the first row to the last; a joint that is held or late is elsewhere for a while
    let is_constant = |place: usize| {
        let rows = &joint.episodes[place].1;
        let errors = joint
            .rows(rows)
            .map(|row| joint.position[row] - joint.command[row] - levels[place]);
        let mut sizes: Vec<f64> = errors.map(f64::abs).collect();
        median(&mut sizes) < ODD_SPREAD * sizes_of[place].abs()
    };
    let holds: Vec<bool> = (0..levels.len())
        .map(|place| sizes_of[place].abs() >= least && is_constant(place))
        .collect();
    let stretches = stretches(&holds).into_iter();
    stretches
        .map(|[since, last]| EpisodeFinding {
            fault: Fault::Offset {
                size: median(&mut sizes_of[since..=last].to_vec()),
                sd: scatter(levels),
                side: None,
            },
            since,
            until: (last + 1 < levels.len()).then_some(last),
            probability: probability(0.5 * ODD_SCATTERS.powi(2), levels.len()),
        })
        .collect()
}

/// One offset of all episodes: beyond what droop and friction scatter by.
fn standing(levels: &[f64], least: f64) -> Option<EpisodeFinding> {
    let middle = median(&mut levels.to_vec());
    let spread = deviation(levels) / levels.len() as f64;
    let is_one = middle.abs() >= (2.0 * least).max(STANDING_SCATTERS * spread);
    is_one.then(|| EpisodeFinding {
        fault: Fault::Offset {
            size: middle,
            sd: spread / (levels.len() as f64).sqrt(),
            side: None,
        },
        // but the first one or two without it
        since: levels
            .iter()
            .take_while(|level| level.abs() < 0.5 * middle.abs())
            .count(),
        until: None,
        probability: probability(0.5 * STANDING_SCATTERS.powi(2), levels.len()),
    })
}
