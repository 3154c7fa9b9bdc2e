//! Laws of a controller: the torque that it computes of command and position, up to its gains.

use std::rc::Rc;

use super::Untracked;
use super::rows::Rows;
use crate::fit::column::Column;

/// What a controller adds to its gains' part without having seen an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ahead {
    Nothing,
    /// The weights of the nominal bodies where the arm is.
    Gravity,
    /// What the nominal bodies ask for along the command.
    Command,
    /// What they ask for where the arm is, errors being accelerations (computed torque), with that of the command or without.
    Computed {
        accelerates: bool,
    },
}

/// What damping acts on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rate {
    /// The command's speed less the arm's.
    OfError,
    /// The arm's alone.
    OfPosition,
    /// Both, by any weight that is not negative: a law that makes up for a delay in a slow motion.
    Weighted,
}

/// A law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Law {
    pub(super) ahead: Ahead,
    pub(super) rate: Rate,
}

/// Whitened rows of a joint's torque and of what its gains multiply.
pub(super) struct Equations {
    pub(super) target: Vec<f64>,
    pub(super) columns: Vec<Rc<Column>>,
    /// Columns whose number is not negative.
    pub(super) positive: Vec<bool>,
}

/// What laws are worked out of, at the fine steps and joint by joint.
pub(super) struct Signals {
    gravity: Vec<Vec<f64>>,
    along_command: Vec<Vec<f64>>,
    /// Weights with centrifugal torques, and the mass matrix (row by row), where the arm is.
    bias: Vec<Vec<f64>>,
    mass: Vec<Vec<f64>>,
}

impl Law {
    /// Laws of single joints, and of the arm as a whole.
    pub(super) fn of_joints() -> Vec<Self> {
        [Ahead::Gravity, Ahead::Nothing, Ahead::Command]
            .into_iter()
            .flat_map(Self::rates)
            .collect()
    }

    pub(super) fn of_arm() -> Vec<Self> {
        [true, false]
            .into_iter()
            .flat_map(|accelerates| Self::rates(Ahead::Computed { accelerates }))
            .collect()
    }

    fn rates(ahead: Ahead) -> [Self; 2] {
        [Rate::OfError, Rate::OfPosition].map(|rate| Self { ahead, rate })
    }

    pub(super) fn is_of_arm(self) -> bool {
        matches!(self.ahead, Ahead::Computed { .. })
    }

    /// The same with any weight of the command's speed.
    pub(super) fn weighted(self) -> Self {
        Self {
            rate: Rate::Weighted,
            ..self
        }
    }

    /// In words.
    pub(super) fn words(self) -> &'static str {
        match self.ahead {
            Ahead::Nothing => "stiffness and damping",
            Ahead::Gravity => "stiffness and damping beside the weights of the model",
            Ahead::Command => "stiffness and damping beside the model's torques along the command",
            Ahead::Computed { .. } => "computed torque",
        }
    }
}

impl Signals {
    pub(super) fn of(rows: &Rows) -> Result<Self, Untracked> {
        let states = &rows.states;
        let (steps, joints) = (states.steps(), rows.arm.joints());
        let new = |count: usize| vec![vec![0.0; steps]; count];
        let mut own = Self {
            gravity: new(joints),
            along_command: new(joints),
            bias: new(joints),
            mass: new(joints * joints),
        };
        let bodies = &rows.arm.bodies;
        let mut work = rows.arm.work();
        let still = vec![0.0; joints];
        let mut torque = vec![0.0; joints];
        let mut matrix = vec![0.0; joints * joints];
        for step in 0..steps {
            let at = |signals: &[Vec<f64>]| -> Vec<f64> {
                signals.iter().map(|own| own[step]).collect()
            };
            let (q, dq) = (at(&states.motor.q), at(&states.motor.dq));
            let put = |into: &mut [Vec<f64>], torque: &[f64]| {
                for (into, value) in into.iter_mut().zip(torque) {
                    into[step] = *value;
                }
            };
            let done = bodies.bias(&q, &still, &mut work, &mut torque);
            put(&mut own.gravity, &torque);
            let done = done.and_then(|()| bodies.bias(&q, &dq, &mut work, &mut torque));
            put(&mut own.bias, &torque);
            let [c, dc, ddc] =
                [&states.link.q, &states.link.dq, &states.link.ddq].map(|own| at(own));
            let done = done.and_then(|()| bodies.torques(&c, &dc, &ddc, &mut work, &mut torque));
            put(&mut own.along_command, &torque);
            let done = done.and_then(|()| bodies.mass_matrix(&q, &mut work, &mut matrix));
            put(&mut own.mass, &matrix);
            done.map_err(|_| Untracked::Short)?;
        }
        Ok(own)
    }

    /// A joint's equations (by its index among the rows' joints) under a law that hears its command late.
    pub(super) fn equations(
        &self,
        rows: &Rows,
        index: usize,
        (law, delay_s): (Law, f64),
    ) -> Equations {
        let (joint, joints) = (rows.joints[index], rows.arm.joints());
        let states = &rows.states;
        let ones = vec![1.0; states.steps()];
        let ahead = match law.ahead {
            Ahead::Nothing => vec![0.0; states.steps()],
            Ahead::Gravity => self.gravity[joint].clone(),
            Ahead::Command => rows.late(&self.along_command[joint], delay_s),
            Ahead::Computed { accelerates } => {
                let mut own = self.bias[joint].clone();
                for other in (0..joints).filter(|_| accelerates) {
                    let mass = &self.mass[joint * joints + other];
                    let late = rows.late(&states.link.ddq[other], delay_s);
                    let both = mass.iter().zip(&late);
                    (own.iter_mut().zip(both)).for_each(|(own, (mass, ddc))| *own += mass * ddc);
                }
                own
            }
        };
        let sources: Vec<(usize, &[f64])> = match law.is_of_arm() {
            true => (0..joints)
                .map(|other| (other, self.mass[joint * joints + other].as_slice()))
                .collect(),
            false => vec![(joint, ones.as_slice())],
        };
        let sd = rows.noise[index];
        let whitened = |signal: &[f64]| -> Vec<f64> {
            let filtered = states.filtered(signal);
            filtered.into_iter().map(|own| own / sd).collect()
        };
        let mut columns = vec![(ones.clone(), false)];
        for (other, mass) in sources {
            let late = |signal: &[f64]| rows.late(signal, delay_s);
            let command = late(&states.link.q[other]);
            let speed = late(&states.link.dq[other]);
            let [q, dq, ddq] = [&states.motor.q, &states.motor.dq, &states.motor.ddq];
            let less = |a: &[f64], b: &[f64]| -> Vec<f64> {
                a.iter().zip(b).map(|(a, b)| a - b).collect()
            };
            let minus = |a: &[f64]| -> Vec<f64> { a.iter().map(|a| -a).collect() };
            let mut own = vec![(less(&command, &q[other]), false)];
            match law.rate {
                Rate::OfError => own.push((less(&speed, &dq[other]), false)),
                Rate::OfPosition => own.push((minus(&dq[other]), false)),
                Rate::Weighted => own.extend([(minus(&dq[other]), false), (speed, true)]),
            }
            // a speed by a filtered difference lags: damping times the lag times the acceleration
            own.push((ddq[other].clone(), true));
            let scaled = own.into_iter().map(|(mut signal, is_positive)| {
                (signal.iter_mut().zip(mass)).for_each(|(own, mass)| *own *= mass);
                (signal, is_positive)
            });
            columns.extend(scaled);
        }
        let ahead = whitened(&ahead);
        let torque = rows.torque[index].iter();
        Equations {
            target: torque
                .zip(ahead)
                .map(|(own, ahead)| own / sd - ahead)
                .collect(),
            positive: columns.iter().map(|own| own.1).collect(),
            columns: (columns.iter())
                .map(|own| Rc::new(Column::All(whitened(&own.0))))
                .collect(),
        }
    }
}
