//! What effects of the device's file add to the torques of its bodies.

use std::rc::Rc;

use haptical_model::{AddedBy, Recording};

use crate::fit::base::{BaseColumn, Term};
use crate::fit::problem::Problem;

/// Effects of the device's file as the base model takes them. They are not taken off the readings, because late positions make them
/// late too.
#[derive(Debug, Clone, Default)]
pub(crate) struct FileEffects {
    /// Friction: joint, and place among what effects add. Its share is free, in addition to the friction of the base model.
    friction: Vec<(usize, usize)>,
    /// All others, at the sizes of the file: joint, and torque at the fine steps.
    pub(crate) known: Vec<(usize, Vec<f64>)>,
}

impl FileEffects {
    /// Of the recording of a problem.
    pub(crate) fn new(problem: &Problem, recording: &Recording) -> Self {
        let mut found = Self::default();
        for (effect, added) in recording.added.iter().enumerate() {
            let mut columns = problem.arm.torque_columns.iter();
            let joint = columns.position(|column| *column == added.channel);
            let Some(joint) = joint.filter(|joint| problem.channel_of(*joint).is_some()) else {
                continue;
            };
            match added.by {
                AddedBy::Friction => found.friction.push((joint, effect)),
                AddedBy::Motion => {
                    let torque_nm = problem.states.smoothed_added(&problem.samples, effect);
                    found.known.push((joint, torque_nm));
                }
                // off the readings already
                AddedBy::Reading => {}
            }
        }
        found
    }

    /// Columns of the friction.
    pub(crate) fn columns(&self, problem: &Problem) -> Vec<BaseColumn> {
        let column = |&(joint, effect): &(usize, usize)| {
            Some(BaseColumn {
                term: Term::FileFriction { joint, effect },
                known_sd: None,
                column: Rc::new(problem.of_added(joint, effect)?),
            })
        };
        self.friction.iter().filter_map(column).collect()
    }
}
