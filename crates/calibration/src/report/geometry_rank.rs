//! The rank of a device's geometry in a recording, without the parameters of its surroundings.

use haptical_identification::{Identifiability, Status};
use haptical_model::{Device, ParameterId};
use serde::Serialize;

use crate::{Channel, ParameterFit};

/// Numbers of the rows alone: places of trackers, sockets and planes are not counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct GeometryRank {
    /// Numbers that the recording fixes to a useful size: the strong directions.
    pub fixed: usize,
    /// Further independent numbers, fixed no better than they are plausibly large.
    pub weak: usize,
    /// Numbers that could matter: all candidates of the rows but those without any effect, and, where a general
    /// last row ends in a point that no orientation is seen of, but the three turns of the tool.
    pub parameters: usize,
}

impl GeometryRank {
    /// Counts the rows' parameters of a judgement.
    ///
    /// "Rank 23 of 45" for a seven-joint arm with general rows that touches sockets: seven times six numbers
    /// from the base to the last joint and three of the tool's tip, of which 23 are fixed; judged at the solution,
    /// since at a nominal geometry with parallel and crossing axes other directions are special.
    pub fn new(
        device: &Device,
        channels: &[Channel],
        parameters: &[ParameterId],
        judged: &Identifiability,
    ) -> Self {
        let (mut fixed, mut weak, mut count) = (0, 0, 0_usize);
        for (parameter, status) in parameters.iter().zip(&judged.statuses) {
            if !matches!(parameter, ParameterId::Link { .. }) {
                continue;
            }
            count += 1;
            match status {
                Status::Identifiable { .. } => fixed += 1,
                Status::Weak { .. } => weak += 1,
                Status::Dependent { .. } => {}
                Status::Invisible => count -= 1,
            }
        }
        let last = device.links.len().saturating_sub(1);
        if device.is_general_row(last) && !channels.contains(&Channel::Orientation) {
            count = count.saturating_sub(3);
        }
        Self {
            fixed,
            weak,
            parameters: count,
        }
    }
}

impl ParameterFit {
    /// What the fit's recording fixes of the rows, judged at the solution; `channels` are those of the fit.
    pub fn geometry_rank(&self, channels: &[Channel]) -> GeometryRank {
        let judged = &self.identifiability;
        GeometryRank::new(&self.device, channels, &self.parameters, judged)
    }
}
