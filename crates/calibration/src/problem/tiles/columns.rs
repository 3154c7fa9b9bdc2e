//! How each free parameter moves the handle: the rows of the chain that move with it.

use haptical_batch::{Lane, ScrewTile, TwistLanes};
use haptical_model::{DeviceChain, Drive, JointType, Parameter, ParameterId};

/// What a free parameter does to the handle.
pub(super) struct Column {
    pub(super) parameter: ParameterId,
    /// Row of the chain, which of its numbers moves, and by how much per unit; none for a number of the surroundings or of
    /// another branch.
    terms: Vec<(usize, Parameter, f64)>,
}

impl Column {
    pub(super) fn new(parameter: ParameterId, chain: &DeviceChain) -> Self {
        let terms = match parameter {
            ParameterId::Link { row, parameter } => {
                let place = chain.place(row).into_iter();
                place.map(|row| (row, parameter, 1.0)).collect()
            }
            ParameterId::Transmission { joint, .. } | ParameterId::Compliance { joint } => {
                let drives = chain.drives().iter().zip(1..);
                let own = drives.filter(|(drive, _)| drive.joint == joint);
                own.map(|(drive, row)| (row, moved(drive), drive.multiplier))
                    .collect()
            }
            ParameterId::Surrounding(_) | ParameterId::Effect { .. } => Vec::new(),
        };
        Self { parameter, terms }
    }

    /// Screws that the column is made of.
    pub(super) fn wanted(&self) -> impl Iterator<Item = (usize, Parameter)> {
        self.terms
            .iter()
            .map(|&(row, parameter, _)| (row, parameter))
    }

    /// Whether it moves the handle.
    pub(super) fn is_of_chain(&self) -> bool {
        !matches!(
            self.parameter,
            ParameterId::Surrounding(_) | ParameterId::Effect { .. }
        )
    }

    /// Whether the base moves with it.
    pub(super) fn is_of_base(&self) -> bool {
        matches!(self.parameter, ParameterId::Link { row: 0, .. })
    }

    /// Twists of the handle per unit, times each posture's factor.
    pub(super) fn twist(
        &self,
        tile: &ScrewTile,
        factors: Option<&Lane>,
        room: &mut TwistLanes,
        into: &mut TwistLanes,
    ) {
        match self.terms.as_slice() {
            [(row, parameter, factor)] if *factor == 1.0 => tile.twist(*row, *parameter, into),
            terms => {
                *into = TwistLanes::default();
                for &(row, parameter, factor) in terms {
                    tile.twist(row, parameter, room);
                    into.add(room, factor);
                }
            }
        }
        if let Some(factors) = factors {
            into.scale(factors);
        }
    }
}

/// Which number of its row a drive moves.
pub(super) fn moved(drive: &Drive) -> Parameter {
    match drive.motion {
        JointType::Revolute => Parameter::Theta,
        JointType::Prismatic => Parameter::D,
    }
}
