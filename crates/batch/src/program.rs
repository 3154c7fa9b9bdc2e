//! The chain at one parameter vector, as a list of elementary motions for the sweeps.
//!
//! Motions that do nothing (a slide of 0, a turn by 0, nothing free) are left out. With v the vector
//! from a frame's origin to the handle in that frame, the way from the end to the base makes v; the
//! way back carries the gradient of the distance, as docs of the `sweep` module say.

use haptical_kinematics::{Motion, Parameter};

use crate::DistanceModel;

/// A coordinate of v: where it is, and the constant slides since.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Source {
    pub(crate) slot: usize,
    pub(crate) offset_m: f64,
}

/// The angle of a turn.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Angle {
    /// The same for every pose.
    Constant { sine: f64, cosine: f64 },
    /// Joint variable plus a constant, whose own sine and cosine are here.
    Joint {
        joint: usize,
        sine: f64,
        cosine: f64,
        /// Slot of the sine; that of the cosine is the next.
        slot: usize,
    },
}

/// What a step does to v.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Action {
    /// A slide by a constant, which is part of the [`Source`] that is read next.
    Constant,
    /// A slide by a joint variable: `from` plus the variable goes to slot `to`.
    Joint {
        joint: usize,
        from: Source,
        to: usize,
    },
    /// A turn: the coordinates of its plane go to slots `to` and `to + 1`.
    Turn {
        first: Source,
        second: Source,
        angle: Angle,
        to: usize,
    },
}

/// One elementary motion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    /// 0, 1 or 2 for x, y, z.
    pub(crate) axis: usize,
    pub(crate) action: Action,
    /// Column of the derivative matrix.
    pub(crate) column: Option<usize>,
}

/// All of it, from the base to the end.
#[derive(Debug, Default)]
pub(crate) struct Program {
    pub(crate) steps: Vec<Step>,
    /// Steps up to the last one whose derivative is asked for.
    pub(crate) differentiated: usize,
    /// Handle less anchor, in frame (-1).
    pub(crate) end: [Source; 3],
    /// Slots of coordinates; slot 0 holds zeros.
    pub(crate) slots: usize,
    /// Slots of sines and cosines.
    pub(crate) angle_slots: usize,
    /// Columns of the derivative matrix.
    pub(crate) columns: usize,
    values: Vec<[f64; 6]>,
    column_of: Vec<[Option<usize>; 6]>,
}

/// Axis of a parameter's elementary motion, and whether it is a turn.
const fn elementary(parameter: Parameter) -> (usize, bool) {
    match parameter {
        Parameter::A => (0, false),
        Parameter::B => (1, false),
        Parameter::D => (2, false),
        Parameter::Alpha => (0, true),
        Parameter::Beta => (1, true),
        Parameter::Theta => (2, true),
    }
}

/// The coordinates that a turn about an axis mixes, the first turning towards the second.
pub(crate) const fn plane(axis: usize) -> (usize, usize) {
    ((axis + 1) % 3, (axis + 2) % 3)
}

impl Program {
    /// Sets up the chain at a parameter vector; `free` names the columns. Allocates only the first
    /// time. Indices of `free` must have been checked.
    pub(crate) fn prepare(&mut self, model: &DistanceModel, parameters: &[f64], free: &[usize]) {
        self.values.clear();
        self.values.extend(
            model
                .links
                .iter()
                .map(|link| Parameter::ALL.map(|p| link.get(p))),
        );
        self.column_of.clear();
        self.column_of.resize(model.links.len(), [None; 6]);
        for (&(row, parameter), &value) in model.parameters.iter().zip(parameters) {
            self.values[row][parameter as usize] = value;
        }
        for (column, &index) in free.iter().enumerate() {
            if let Some(&(row, parameter)) = model.parameters.get(index) {
                self.column_of[row][parameter as usize] = Some(column);
            }
        }
        self.columns = free.len();
        self.steps.clear();
        // from the end to the base, as v is made; turned round below
        let mut at = [Source::default(); 3];
        let (mut slots, mut angle_slots) = (1, 0);
        let mut joint = model
            .motions
            .iter()
            .filter(|m| **m != Motion::Fixed)
            .count();
        for row in (0..model.links.len()).rev() {
            let variable = model.motions[row].variable();
            joint -= usize::from(variable.is_some());
            for parameter in model.convention.order().into_iter().rev() {
                let (axis, is_turn) = elementary(parameter);
                let value = self.values[row][parameter as usize];
                let column = self.column_of[row][parameter as usize];
                let moves = variable == Some(parameter);
                if value == 0.0 && column.is_none() && !moves {
                    continue;
                }
                let action = if is_turn {
                    let (sine, cosine) = libm::sincos(value);
                    let angle = if moves {
                        angle_slots += 2;
                        Angle::Joint {
                            joint,
                            sine,
                            cosine,
                            slot: angle_slots - 2,
                        }
                    } else {
                        Angle::Constant { sine, cosine }
                    };
                    let (p, q) = plane(axis);
                    let (first, second, to) = (at[p], at[q], slots);
                    at[p] = Source {
                        slot: to,
                        offset_m: 0.0,
                    };
                    at[q] = Source {
                        slot: to + 1,
                        offset_m: 0.0,
                    };
                    slots += 2;
                    Action::Turn {
                        first,
                        second,
                        angle,
                        to,
                    }
                } else {
                    at[axis].offset_m += value;
                    if moves {
                        let (from, to) = (at[axis], slots);
                        at[axis] = Source {
                            slot: to,
                            offset_m: 0.0,
                        };
                        slots += 1;
                        Action::Joint { joint, from, to }
                    } else {
                        Action::Constant
                    }
                };
                self.steps.push(Step {
                    axis,
                    action,
                    column,
                });
            }
        }
        self.steps.reverse();
        for (source, anchor_m) in at.iter_mut().zip(model.anchor_m) {
            source.offset_m -= anchor_m;
        }
        self.end = at;
        self.slots = slots;
        self.angle_slots = angle_slots;
        let last = self.steps.iter().rposition(|step| step.column.is_some());
        self.differentiated = last.map_or(0, |last| last + 1);
    }
}
