//! Points that links carry along, from where they are when all joint values are 0.

use haptical_kinematics::ChainConstants;

use super::structure::Place;
use crate::{DeviceError, Effect, Motion, RowDrive};

/// The row that a joint turns, its only one.
const fn own_row<const ROWS: usize>(
    drives: &[RowDrive; ROWS],
    joint: usize,
    effect: usize,
) -> Result<usize, DeviceError> {
    let (mut own, mut count, mut row) = (0, 0, 0);
    while row < ROWS {
        if drives[row].joint == joint {
            own = row;
            count += match drives[row].motion {
                Motion::Revolute => 1,
                Motion::Prismatic => 2,
            };
        }
        row += 1;
    }
    if count == 1 {
        return Ok(own);
    }
    Err(DeviceError::EffectAxis {
        effect: effect + 1,
        joint: joint + 1,
    })
}

/// The place of an effect; `index` is its position in the list.
pub(super) const fn place_of<const ROWS: usize>(
    chain: &ChainConstants<ROWS>,
    drives: &[RowDrive; ROWS],
    effect: &Effect,
    index: usize,
) -> Result<Place, DeviceError> {
    match effect {
        Effect::LateralCompliance {
            joint, origin_m, ..
        }
        | Effect::AxisWobble {
            joint, origin_m, ..
        } => {
            let row = match own_row(drives, *joint, index) {
                Ok(row) => row,
                Err(error) => return Err(error),
            };
            Ok(Place {
                row,
                local_m: chain.local_m(row, *origin_m),
                joint_before: match row {
                    0 => None,
                    row => Some(drives[row - 1].joint),
                },
            })
        }
        Effect::Weight { row, place_m, .. } => Ok(Place {
            row: *row,
            local_m: chain.local_m(*row + 1, *place_m),
            joint_before: None,
        }),
        _ => Ok(Place::NONE),
    }
}
