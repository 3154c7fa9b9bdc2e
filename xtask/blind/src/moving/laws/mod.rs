//! What the effects share: where in an arm, its controller and its log they can act.

pub(crate) mod contact;
pub(crate) mod drives;
pub(crate) mod friction;
pub(crate) mod masses;
pub(crate) mod sensing;
pub(crate) mod torques;

use std::collections::BTreeMap;

use haptical_model::kinematics::nalgebra::Vector3;

use crate::moving::arms::Arm;
use crate::moving::motion::log::Ticks;
use crate::moving::motion::rigid::At;
use crate::moving::motion::specimen::Specimen;
use crate::random::Random;

/// Entries per second of what an effect is drawn from.
pub(crate) const ANGLES_PER_S: f64 = 20.0;

/// A drive whose friction is looked at.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sliding {
    pub(crate) joint: usize,
    pub(crate) time_s: f64,
    /// Angle and speed of the motor, at the joint.
    pub(crate) angle: f64,
    pub(crate) speed: f64,
    /// What the motor exerts \[N m\].
    pub(crate) drive: f64,
}

/// Levels of friction that a law may change.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Levels {
    pub(crate) coulomb: f64,
    pub(crate) viscous: f64,
}

#[derive(Debug)]
pub(crate) struct Instant<'a> {
    pub(crate) time_s: f64,
    /// Of the links.
    pub(crate) angle: &'a [f64],
    /// Of the motors, at the joints.
    pub(crate) motor: &'a [f64],
    pub(crate) at: &'a At,
}

/// A change of something that an effect acts on.
type Change<T> = Box<dyn Fn(&mut T) + Send + Sync>;
type ChangeOfLevels = Box<dyn Fn(&Sliding, &mut Levels) + Send + Sync>;
type AddedTorque = Box<dyn Fn(&Instant<'_>, &mut [f64]) + Send + Sync>;
type ChangeOfRows = Box<dyn Fn(&mut Vec<usize>, &mut Random) + Send + Sync>;

/// An effect that was drawn: what it changes, at which joint (from 0), and the numbers of its law.
pub(crate) struct Drawn {
    /// Sets what the arm has with or without the effect: levels that its user does not know anyway.
    pub(crate) prepare: Change<Specimen>,
    /// Changes the arm before it moves.
    pub(crate) build: Change<Specimen>,
    pub(crate) friction: ChangeOfLevels,
    pub(crate) torque: AddedTorque,
    pub(crate) command_delay_s: f64,
    /// Factors of the controller's stiffness and damping, by time.
    pub(crate) gains: Box<dyn Fn(f64) -> [f64; 2] + Send + Sync>,
    /// Changes what is logged, at the controller's rate.
    pub(crate) readings: Change<Ticks>,
    /// Changes which of the ticks are logged: entry i is the tick that row i shows.
    pub(crate) rows: ChangeOfRows,
    pub(crate) joint: Option<usize>,
    pub(crate) numbers: BTreeMap<String, f64>,
}

impl Drawn {
    /// An effect that changes only what `set` sets.
    fn new(set: impl FnOnce(&mut Self)) -> Self {
        let mut drawn = Self {
            prepare: Box::new(|_| {}),
            build: Box::new(|_| {}),
            friction: Box::new(|_, _| {}),
            torque: Box::new(|_, _| {}),
            command_delay_s: 0.0,
            gains: Box::new(|_| [1.0; 2]),
            readings: Box::new(|_| {}),
            rows: Box::new(|_, _| {}),
            joint: None,
            numbers: BTreeMap::new(),
        };
        set(&mut drawn);
        drawn
    }

    fn at(mut self, joint: usize) -> Self {
        self.joint = Some(joint);
        self
    }

    fn with_all<const N: usize>(mut self, numbers: [(&str, f64); N]) -> Self {
        let named = numbers.map(|(name, value)| (name.to_owned(), value));
        self.numbers.extend(named);
        self
    }

    fn with(mut self, name: &str, value: f64) -> Self {
        self.numbers.insert(name.to_owned(), value);
        self
    }
}

/// What is at hand when an effect is drawn.
#[derive(Debug)]
pub(crate) struct Draw<'a> {
    pub(crate) arm: &'a Arm,
    /// Joint that it may act at.
    pub(crate) joint: usize,
    /// Size over that of a strong one.
    pub(crate) size: f64,
    pub(crate) duration_s: f64,
    /// Torques that the drives need along the first command, joint by joint.
    pub(crate) loads: &'a [Vec<f64>],
    /// Angles along it.
    pub(crate) angles: &'a [Vec<f64>],
    /// Places of the flange along it.
    pub(crate) flange_m: &'a [Vector3<f64>],
    pub(crate) random: &'a mut Random,
}

impl Draw<'_> {
    /// A share of the range of the joint's drive, times the size.
    pub(crate) fn of_range(&mut self, low: f64, high: f64) -> f64 {
        self.size * self.arm.axes[self.joint].range * self.random.uniform(low, high)
    }

    /// The value below which a share of the joint's angles lie.
    pub(crate) fn angle_at(&self, share: f64) -> f64 {
        let mut angles = self.angles[self.joint].clone();
        angles.sort_by(f64::total_cmp);
        angles[((angles.len() - 1) as f64 * share) as usize]
    }

    /// Largest speed of the joint.
    pub(crate) fn top_speed(&self) -> f64 {
        let steps = self.angles[self.joint].windows(2);
        let largest = steps.fold(0.0_f64, |most, pair| most.max((pair[1] - pair[0]).abs()));
        largest * ANGLES_PER_S
    }

    /// Largest torque that the joint's drive needs.
    pub(crate) fn peak(&self) -> f64 {
        let loads = self.loads[self.joint].iter();
        loads.fold(0.0, |largest, load| load.abs().max(largest))
    }
}
