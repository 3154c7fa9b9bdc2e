//! Torques from which what gravity asks of the links was taken off: by a simulator's compensation, or by a controller's own model.

use std::rc::Rc;

use crate::fit::problem::Problem;
use crate::select::Fitted;
use crate::thresholds::examine::{GRAVITY_EXPLAINS, GRAVITY_OFF};

/// Whether what a fit leaves is gravity's part of the nominal bodies, with the other sign and in full.
pub(crate) fn lacks_gravity(problem: &Problem, fitted: &Fitted) -> bool {
    let (states, joints) = (&problem.states, problem.arm.joints());
    let mut signals = vec![vec![0.0; states.steps()]; joints];
    let mut work = problem.arm.work();
    let (mut at, still) = (vec![0.0; joints], vec![0.0; joints]);
    let mut torques = vec![0.0; joints];
    for step in 0..states.steps() {
        for (joint, angle) in at.iter_mut().enumerate() {
            *angle = states.link.q[joint][step];
        }
        let bodies = &problem.arm.bodies;
        if bodies
            .torques(&at, &still, &still, &mut work, &mut torques)
            .is_err()
        {
            return false;
        }
        for (signal, torque) in signals.iter_mut().zip(&torques) {
            signal[step] = *torque;
        }
    }
    let columns = [Rc::new(problem.of_joints(&signals))];
    let gain = fitted
        .solved
        .gain(&columns, &fitted.system.across(&columns));
    let share = gain.coefficients.first().copied().unwrap_or(0.0);
    GRAVITY_OFF.contains(&share) && gain.nats > GRAVITY_EXPLAINS * fitted.excess
}
