//! What to do with each episode, and how sure a finding is.

use super::{EpisodeLog, Fault, JointEpisodes, RowFault, RowFaultKind};
use crate::thresholds::{LEAVE_OUT_SHARE, MOST_PROBABILITY, NEIGHBOURS, PRIOR_ODDS};

/// Whether an episode is fit for use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Use {
    /// Nothing was found in it.
    Use,
    /// What was found may not matter, or can be mended.
    Look,
    /// Its numbers are wrong.
    LeaveOut,
}

/// An episode and why.
#[derive(Debug, Clone, PartialEq)]
pub struct EpisodeVerdict {
    /// What to do.
    pub verdict: Use,
    /// Indices of the joints and of their findings that are in it.
    pub findings: Vec<[usize; 2]>,
    /// Indices of its faults of rows.
    pub rows: Vec<usize>,
}

pub(super) fn of_episodes(
    log: &EpisodeLog<'_>,
    joints: &[JointEpisodes],
    rows: &[RowFault],
) -> Vec<EpisodeVerdict> {
    let of = |episode: usize| {
        let in_it = joints.iter().enumerate().flat_map(|(joint, joint_report)| {
            let has = move |(index, found): (usize, &super::EpisodeFinding)| {
                let last = found.until.unwrap_or(usize::MAX);
                (found.since..=last)
                    .contains(&episode)
                    .then_some([joint, index])
            };
            joint_report.findings.iter().enumerate().filter_map(has)
        });
        let findings: Vec<[usize; 2]> = in_it.collect();
        let rows_of: Vec<usize> = (0..rows.len())
            .filter(|row| rows[*row].episode == episode)
            .collect();
        let by_joints =
            findings.iter().map(
                |[joint, index]| match joints[*joint].findings[*index].fault {
                    Fault::Latency { .. } | Fault::Clipped { .. } => Use::Look,
                    // one constant in all episodes is taken out, or learnt
                    Fault::Offset { .. } if joints[*joint].findings[*index].is_standing() => {
                        Use::Look
                    }
                    Fault::Offset { .. }
                    | Fault::Gain { .. }
                    | Fault::Dead { .. }
                    | Fault::Swapped { .. } => Use::LeaveOut,
                },
            );
        let by_rows = rows_of.iter().map(|row| {
            let fault = &rows[*row];
            let share = fault.rows as f64 / fault.of as f64;
            match fault.kind {
                RowFaultKind::Lost | RowFaultKind::Jump | RowFaultKind::Short
                    if share >= LEAVE_OUT_SHARE =>
                {
                    Use::LeaveOut
                }
                _ => Use::Look,
            }
        });
        EpisodeVerdict {
            verdict: by_joints.chain(by_rows).max().unwrap_or(Use::Use),
            findings,
            rows: rows_of,
        }
    };
    (0..log.episodes.len()).map(of).collect()
}

impl super::EpisodeFinding {
    /// Whether all episodes have it, but one or two at the beginning.
    pub fn is_standing(&self) -> bool {
        // an odd one or two at the beginning do not make the others wrong
        self.since < NEIGHBOURS && self.until.is_none()
    }
}

/// Probability of a change that gains so many nats over none, at any of so many places, one joint in a hundred having one.
pub(super) fn probability(nats: f64, places: usize) -> f64 {
    let odds = (nats - (places as f64).ln()).exp() * PRIOR_ODDS;
    (odds / (1.0 + odds)).min(MOST_PROBABILITY)
}
