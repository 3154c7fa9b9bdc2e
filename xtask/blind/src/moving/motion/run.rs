//! One recording: controller and arm tick by tick.

use crate::moving::arms::Arm;
use crate::moving::laws::Drawn;
use crate::moving::motion::control::{Asked, Controller, Design, TICKS_PER_S};
use crate::moving::motion::course::Course;
use crate::moving::motion::log::Ticks;
use crate::moving::motion::plant::Plant;
use crate::moving::motion::specimen::Specimen;

/// Time at rest before the first row \[s\].
const BEFORE_S: f64 = 0.4;

pub(crate) struct Rig<'a> {
    pub(crate) arm: &'a Arm,
    pub(crate) specimen: &'a Specimen,
    pub(crate) design: &'a Design,
    pub(crate) effects: &'a [Drawn],
    /// Steps of the integration in a tick.
    pub(crate) steps: usize,
}

/// Step of an encoder at the joint.
pub(crate) fn count(arm: &Arm, joint: usize) -> f64 {
    let axis = &arm.axes[joint];
    std::f64::consts::TAU / axis.counts / axis.ratio
}

impl Rig<'_> {
    /// Runs a course. The logged torque of a tick is the mean of those held before and after it, as a filtered current is.
    pub(crate) fn run(&self, course: &Course) -> Ticks {
        let joints = self.arm.count();
        let mut plant = Plant::new(self.specimen, self.effects, &course.about);
        let mut controller = Controller::new(self.design);
        let delays_s = self.effects.iter().map(|effect| effect.command_delay_s);
        let delay_s: f64 = delays_s.sum();
        let mut ticks = Ticks::new(joints);
        let (mut held, mut torque) = (vec![0.0; joints], vec![0.0; joints]);
        let mut read = vec![0.0; joints];
        let entries = plant.state.angle.len();
        let (mut before, mut after) = (vec![0.0; entries], vec![0.0; entries]);
        let step_s = 1.0 / TICKS_PER_S / self.steps as f64;
        let lead = (BEFORE_S * TICKS_PER_S) as i64;
        let rows = (course.duration_s * TICKS_PER_S) as i64;
        for tick in -lead..rows {
            let time_s = tick as f64 / TICKS_PER_S;
            for (joint, read) in read.iter_mut().enumerate() {
                let count = count(self.arm, joint);
                *read = libm::round(plant.motor(&plant.state.angle, joint) / count) * count;
            }
            let heard: Asked = course.at(time_s - delay_s);
            let mut factors = [1.0; 2];
            for effect in self.effects {
                let gains = (effect.gains)(time_s);
                factors = [factors[0] * gains[0], factors[1] * gains[1]];
            }
            controller.tick(&heard, &read, factors, &mut torque);
            if tick >= 0 {
                let state = plant.state.clone();
                plant.accelerations(time_s, &state, &held, &mut before);
                plant.accelerations(time_s, &state, &torque, &mut after);
                ticks.time_s.push(time_s);
                for joint in 0..joints {
                    ticks.angle[joint].push(plant.motor(&state.angle, joint));
                    ticks.rate[joint].push(plant.motor(&state.rate, joint));
                    let mean = |entries: &[f64], others: &[f64]| {
                        0.5 * (plant.motor(entries, joint) + plant.motor(others, joint))
                    };
                    ticks.acceleration[joint].push(mean(&before, &after));
                    ticks.output[joint].push(state.angle[joint]);
                    ticks.torque[joint].push(0.5 * (held[joint] + torque[joint]));
                }
                ticks.push_command(&course.at(time_s));
            }
            held.copy_from_slice(&torque);
            for step in 0..self.steps {
                plant.step(time_s + step as f64 * step_s, step_s, &held);
            }
        }
        ticks
    }
}
