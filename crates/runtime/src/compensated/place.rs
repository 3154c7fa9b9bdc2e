//! Points that links carry along, from where they are when all joint values are 0.

use haptical_kinematics::ChainConstants;

use super::structure::Place;
use crate::{DeviceError, Effect, Motion, RowDrive};

/// A frame of a chain as plain numbers.
#[derive(Clone, Copy)]
struct Walker {
    axes: [[f64; 3]; 3],
    origin: [f64; 3],
}

impl Walker {
    /// The first axis turns towards the second.
    const fn turn(&mut self, first: usize, second: usize, sine: f64, cosine: f64) {
        let (one, other) = (self.axes[first], self.axes[second]);
        self.axes[first] = sum(one, cosine, other, sine);
        self.axes[second] = sum(other, cosine, one, -sine);
    }

    const fn slide(&mut self, axis: usize, length_m: f64) {
        self.origin = sum(self.origin, 1.0, self.axes[axis], length_m);
    }

    /// Coordinates of a point of frame (-1).
    const fn local(&self, point_m: [f64; 3]) -> [f64; 3] {
        let way = sum(point_m, 1.0, self.origin, -1.0);
        let [x, y, z] = self.axes;
        [dot(x, way), dot(y, way), dot(z, way)]
    }
}

const fn sum([a, b, c]: [f64; 3], s: f64, [d, e, f]: [f64; 3], t: f64) -> [f64; 3] {
    [a * s + d * t, b * s + e * t, c * s + f * t]
}

const fn dot([a, b, c]: [f64; 3], [d, e, f]: [f64; 3]) -> f64 {
    a * d + b * e + c * f
}

/// Where a point is in the frame in front of a row, or behind it.
const fn carried<const ROWS: usize>(
    chain: &ChainConstants<ROWS>,
    row: usize,
    is_behind: bool,
    point_m: [f64; 3],
) -> [f64; 3] {
    let [origin] = chain.start.position_m.data.0;
    let mut walker = Walker {
        axes: chain.start.rotation.data.0,
        origin,
    };
    let mut index = 0;
    while index < row + is_behind as usize {
        let joint = &chain.joints[index];
        let (sine, cosine) = haptical_kinematics::trigonometry::sine_cosine(joint.offset_rad);
        walker.turn(0, 1, sine, cosine);
        walker.slide(0, joint.x_m);
        walker.slide(1, joint.y_m);
        walker.turn(1, 2, joint.twist_sine, joint.twist_cosine);
        index += 1;
    }
    walker.local(point_m)
}

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
                local_m: carried(chain, row, false, *origin_m),
                joint_before: match row {
                    0 => None,
                    row => Some(drives[row - 1].joint),
                },
            })
        }
        Effect::Weight { row, place_m, .. } => Ok(Place {
            row: *row,
            local_m: carried(chain, *row, true, *place_m),
            joint_before: None,
        }),
        _ => Ok(Place::NONE),
    }
}
