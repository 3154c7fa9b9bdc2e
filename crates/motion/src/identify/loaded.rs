//! Friction that grows with what a joint carries: which joints have it.

use std::rc::Rc;

use crate::MotionError;
use crate::arm::Arm;
use crate::fit::problem::Problem;
use crate::fit::system::System;
use crate::identify::bias::Known;
use crate::identify::friction::by_load;
use crate::thresholds::identify::LOADED_NATS;

/// Joints whose friction is asked for its share of the load, and the arm whose bodies are the load.
#[derive(Debug, Clone, Default)]
pub(crate) struct Loaded {
    pub(crate) arm: Option<Rc<Arm>>,
    pub(crate) joints: Vec<usize>,
}

impl Loaded {
    /// Joints of which a fit without it shows that friction grows with their load; `inflation`: variance by rows with a memory over that
    /// by independent ones.
    pub(crate) fn shown(
        known: &Known<'_>,
        problem: &Problem,
        arm: Arm,
        inflation: f64,
    ) -> Result<Self, MotionError> {
        let mut problem = problem.clone();
        problem.carry(&arm)?;
        let columns = known.columns(&problem);
        let system = System::new(&columns, &vec![None; columns.len()]);
        let target = problem.recorded(known.settled.early_s);
        let solved = system.solve(&target, &[]);
        let is_shown = |joint: &usize| {
            let side = known.settled.friction[*joint].side(&problem, *joint);
            let column = problem.of_joint(*joint, &by_load(&problem, *joint, &side));
            column.is_some_and(|own| {
                let own = [Rc::new(own)];
                let gain = solved.gain(&own, &system.across(&own));
                gain.coefficients[0] > 0.0 && gain.nats > LOADED_NATS * inflation.max(1.0)
            })
        };
        let joints: Vec<usize> = problem.channels.iter().copied().filter(is_shown).collect();
        Ok(Self {
            arm: Some(Rc::new(arm)),
            joints,
        })
    }
}
