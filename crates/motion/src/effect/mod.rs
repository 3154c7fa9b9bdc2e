//! What the base model of a moving arm may lack: one effect a file, each with the torques that it adds.

pub(crate) mod armature;
pub(crate) mod contact;
mod cross_coupling;
pub(crate) mod delay;
mod friction;
pub(crate) mod gravity_direction;
pub(crate) mod gravity_spring;
pub(crate) mod joint_compliance;
mod joint_offset;
mod link_inertia;
mod motor_cogging;
mod payload;
pub(crate) mod torque_gain;
mod torque_offset;
mod torque_saturation;

use std::rc::Rc;

use nalgebra::Vector3;

pub(crate) use self::joint_offset::candidates as zeros;
pub(crate) use self::torque_saturation::ends_at;
use crate::arm::Arm;
use crate::change::Change;
use crate::fit::base::Base;
use crate::fit::column::Column;
use crate::fit::problem::Problem;
use crate::thresholds::effect::UNFELT;

/// Numbers of an effect from the coefficients of its columns.
pub(crate) type Numbers = Rc<dyn Fn(&[f64]) -> Vec<(&'static str, f64)>>;

/// An effect at a place, with a shape.
#[derive(Clone)]
pub(crate) struct Candidate<'c> {
    pub(crate) effect: &'static str,
    /// Joint, from 0.
    pub(crate) joint: Option<usize>,
    /// Numbers of its shape, which its columns are not linear in.
    pub(crate) shape: Vec<(&'static str, f64)>,
    pub(crate) columns: Vec<Rc<Column>>,
    /// How many of them any torque feels.
    pub(crate) felt: usize,
    pub(crate) numbers: Numbers,
    /// Which of its effect's laws it is.
    pub(crate) kind: usize,
    /// What it is linear about, if anything.
    pub(crate) about: Vec<f64>,
    /// Whether it belongs to its recording alone.
    pub(crate) is_of_recording: bool,
    /// What it explains of noise alone besides what its numbers do \[nats\].
    pub(crate) of_noise: f64,
    /// Whether its last column has to explain something beside the others.
    pub(crate) needs_last: bool,
    /// What no law of the catalogue is, and its law has to explain more than.
    pub(crate) plain: Option<Rc<Column>>,
    /// Whether coefficients are those of such an effect.
    pub(crate) is_sound: fn(&[f64]) -> bool,
    /// Between what each of them has to be.
    pub(crate) within: [f64; 2],
    /// Standard deviation of its numbers for the law's own sake, as a share of them: no friction is a law to the last digit.
    pub(crate) law_sd: f64,
    /// Standard deviation of the logarithm of its shape's number for the law's own sake.
    pub(crate) shape_law_sd: f64,
    /// Standard deviation of the number of its shape, where it is known beforehand.
    pub(crate) shape_sd: Option<f64>,
    pub(crate) finer: Finer<'c>,
}

/// A candidate from a number, or from coefficients.
pub(crate) type Made<'c, A> = Rc<dyn Fn(A) -> Option<Candidate<'c>> + 'c>;
/// A candidate that is linear about coefficients.
pub(crate) type MadeAbout<'c> = Rc<dyn Fn(&[f64]) -> Option<Candidate<'c>> + 'c>;

/// How a candidate is made nearer to what the rows show.
#[derive(Clone)]
pub(crate) enum Finer<'c> {
    /// There is nothing to settle.
    Settled,
    /// The same effect with another first number of its shape, from 1 / `ratio` to `ratio` times its own.
    Shape { ratio: f64, at: Made<'c, f64> },
    /// The same effect linear about its coefficients.
    About(MadeAbout<'c>),
    /// The same, where it corrects the law a little: most of what it explains was explained before.
    Correction(MadeAbout<'c>),
}

/// What effects are worked out of.
#[derive(Clone, Copy)]
pub(crate) struct Context<'c> {
    pub(crate) problem: &'c Problem,
    pub(crate) base: &'c Base,
    /// Torques of the base model as it was fitted, at the fine steps.
    pub(crate) torque: &'c [Vec<f64>],
}

/// An effect of the catalogue.
pub(crate) struct Effect {
    pub(crate) name: &'static str,
    pub(crate) candidates: Candidates,
    /// Whether its law is exact, and not one of many that describe the same thing: friction has many, a weight has one.
    is_exact: bool,
    /// Whether it changes the torque of its joint alone.
    is_of_own_joint: bool,
    /// What it changes of a device's numbers.
    change: fn(&Found<'_>) -> Option<Change>,
}

/// What was found of an effect.
pub(crate) struct Found<'p> {
    pub(crate) arm: &'p Arm,
    pub(crate) joint: Option<usize>,
    /// Numbers with standard deviations.
    pub(crate) numbers: &'p [(&'static str, f64, f64)],
    /// The coefficients that its numbers are read off.
    pub(crate) read_off: &'p [f64],
}

impl Found<'_> {
    fn number(&self, name: &str) -> Option<f64> {
        let own = self.numbers.iter().find(|own| own.0 == name);
        own.map(|own| own.1)
    }

    /// Three numbers; what no torque feels stays as it is.
    fn vector(&self, names: [&str; 3]) -> Vector3<f64> {
        names.map(|name| self.number(name).unwrap_or(0.0)).into()
    }
}

impl Effect {
    const fn new(
        name: &'static str,
        candidates: for<'c> fn(Context<'c>) -> Vec<Candidate<'c>>,
    ) -> Self {
        Self {
            name,
            candidates: Candidates::Given(candidates),
            is_exact: false,
            is_of_own_joint: false,
            change: |_| None,
        }
    }

    const fn exact(mut self) -> Self {
        self.is_exact = true;
        self
    }

    const fn of_own_joint(mut self) -> Self {
        self.is_of_own_joint = true;
        self
    }

    const fn changing(mut self, change: fn(&Found<'_>) -> Option<Change>) -> Self {
        self.change = change;
        self
    }
}

/// How its candidates are found.
pub(crate) enum Candidates {
    /// From the motion.
    Given(for<'c> fn(Context<'c>) -> Vec<Candidate<'c>>),
    /// From what is left as well, row by row.
    ByRest(for<'c> fn(Context<'c>, &[f64]) -> Vec<Candidate<'c>>),
}

/// All effects. Order matters: of those that explain equally much the first is taken.
pub(crate) const EFFECTS: &[Effect] = &[
    payload::EFFECT,
    delay::ENCODER_LATENCY,
    torque_gain::OF_ALL,
    torque_gain::EFFECT,
    torque_offset::EFFECT,
    friction::STRIBECK,
    friction::LOAD,
    friction::ASYMMETRY,
    friction::DRIFT,
    friction::PRESLIDING,
    motor_cogging::EFFECT,
    armature::EFFECT,
    joint_offset::EFFECT,
    link_inertia::EFFECT,
    gravity_direction::EFFECT,
    gravity_spring::EFFECT,
    torque_saturation::EFFECT,
    joint_compliance::EFFECT,
    cross_coupling::EFFECT,
    contact::EFFECT,
    delay::OF_ONE_ENCODER,
    delay::TORQUE_LATENCY,
];

/// Those of a name.
fn named(name: &str) -> impl Iterator<Item = &'static Effect> {
    EFFECTS.iter().filter(move |own| own.name == name)
}

/// Whether an effect's law is exact.
pub(crate) fn is_exact(name: &str) -> bool {
    named(name).any(|own| own.is_exact)
}

/// Whether an effect is a joint's zero that is off.
pub(crate) fn is_zero(name: &str) -> bool {
    name == joint_offset::EFFECT.name
}

/// Whether an effect of this size may be that of a sound arm.
pub(crate) fn is_calibration(name: &str, numbers: &[(&'static str, f64, f64)]) -> bool {
    name == joint_offset::EFFECT.name && joint_offset::is_calibration(numbers)
}

/// Whether an effect is a constant of its torque.
pub(crate) fn is_constant(name: &str) -> bool {
    name == torque_offset::EFFECT.name
}

/// Whether an effect is a torque in another scale.
pub(crate) fn is_scale(name: &str) -> bool {
    name == torque_gain::EFFECT.name
}

/// Whether an effect is what an arm of other lengths and masses has at a joint, next to torques in another scale.
pub(crate) fn is_of_an_arm(name: &str) -> bool {
    let all = [
        &armature::EFFECT,
        &gravity_spring::EFFECT,
        &link_inertia::EFFECT,
    ];
    is_scale(name) || all.iter().any(|own| own.name == name)
}

/// Whether an effect is a body that is off.
pub(crate) fn is_of_bodies(name: &str) -> bool {
    [payload::EFFECT.name, link_inertia::EFFECT.name].contains(&name)
}

/// Whether an effect is late positions of all joints.
pub(crate) fn is_delay_of_all(name: &str, joint: Option<usize>) -> bool {
    name == delay::ENCODER_LATENCY.name && joint.is_none()
}

/// Whether an effect at a joint changes the torque of that joint alone.
pub(crate) fn is_of_own_joint(name: &str) -> bool {
    named(name).any(|own| own.is_of_own_joint)
}

/// What an effect changes of a device's numbers; none where a device file has no such number.
pub(crate) fn change(name: &str, found: &Found<'_>) -> Option<Change> {
    named(name).find_map(|own| (own.change)(found))
}

/// Names of all effects.
pub fn effect_names() -> Vec<&'static str> {
    let mut names: Vec<&str> = EFFECTS.iter().map(|own| own.name).collect();
    names.push(crate::tracking::NAME);
    names.dedup();
    names
}

impl<'c> Context<'c> {
    /// One candidate or several a joint with torques.
    pub(crate) fn at_joints(
        self,
        make: impl Fn(usize) -> Vec<Candidate<'c>>,
    ) -> Vec<Candidate<'c>> {
        self.problem
            .channels
            .iter()
            .flat_map(|joint| make(*joint))
            .collect()
    }

    /// A candidate whose columns are signals of one joint at the fine steps.
    pub(crate) fn of_signals(
        self,
        effect: &'static str,
        joint: usize,
        signals: &[Vec<f64>],
        numbers: Numbers,
    ) -> Option<Candidate<'c>> {
        let columns = signals.iter().map(|own| self.problem.of_joint(joint, own));
        Some(Candidate::new(
            effect,
            Some(joint),
            columns.collect::<Option<_>>()?,
            numbers,
        ))
    }

    /// Coulomb friction's direction of a joint at the fine steps.
    pub(crate) fn sign(self, joint: usize) -> Vec<f64> {
        self.base.sign(self.problem, joint)
    }

    /// Speed of a joint's motor at the fine steps.
    pub(crate) fn speed(self, joint: usize) -> &'c [f64] {
        &self.problem.states.motor.dq[joint]
    }
}

impl<'c> Candidate<'c> {
    /// A candidate whose shape is settled.
    pub(crate) fn new(
        effect: &'static str,
        joint: Option<usize>,
        columns: Vec<Column>,
        numbers: Numbers,
    ) -> Self {
        let square = |own: &Column| own.times(own);
        let largest = columns.iter().map(square).fold(0.0, f64::max);
        // what no torque feels is nothing, and not the rounding of it
        let is_felt = |own: &Column| square(own) > UNFELT * largest;
        let felt = columns.iter().filter(|own| is_felt(own)).count();
        let columns = columns.into_iter().map(|own| match is_felt(&own) {
            true => own,
            false => own.masked(|_| false),
        });
        Self {
            effect,
            joint,
            shape: Vec::new(),
            columns: columns.map(Rc::new).collect(),
            felt,
            numbers,
            kind: 0,
            about: Vec::new(),
            is_of_recording: false,
            of_noise: 0.0,
            needs_last: false,
            plain: None,
            is_sound: |_| true,
            within: [f64::NEG_INFINITY, f64::INFINITY],
            law_sd: 0.0,
            shape_law_sd: 0.0,
            shape_sd: None,
            finer: Finer::Settled,
        }
    }

    /// With columns that are zero but for a few rows.
    pub(crate) fn in_spans(mut self) -> Self {
        let of = |own: Rc<Column>| Rc::new(Rc::unwrap_or_clone(own).in_spans());
        self.columns = self.columns.into_iter().map(of).collect();
        self
    }

    pub(crate) fn of_kind(mut self, kind: usize) -> Self {
        self.kind = kind;
        self
    }

    /// Whether it is the one whose size is settled by shifting all torques.
    pub(crate) fn is_delay_of_all(&self) -> bool {
        is_delay_of_all(self.effect, self.joint)
    }

    /// With a law that is not to the last digit the arm's.
    pub(crate) fn about_to(mut self, law_sd: f64) -> Self {
        self.law_sd = law_sd;
        self
    }

    /// With a shape that is not to the last digit the arm's.
    pub(crate) fn shape_about_to(mut self, law_sd: f64) -> Self {
        self.shape_law_sd = law_sd;
        self
    }

    /// Whether coefficients are possible for it.
    pub(crate) fn is_possible(&self, coefficients: &[f64]) -> bool {
        let [low, high] = self.within;
        (self.is_sound)(coefficients) && coefficients.iter().all(|own| (low..=high).contains(own))
    }

    /// Sound only with a first coefficient above zero.
    pub(crate) fn if_positive(mut self) -> Self {
        self.is_sound = |own| own[0] > 0.0;
        self
    }

    /// With a number of its shape, which may be settled between 1 / `ratio` and `ratio` times its own.
    pub(crate) fn shaped(
        mut self,
        shape: (&'static str, f64),
        ratio: f64,
        at: Made<'c, f64>,
    ) -> Self {
        self.shape = vec![shape];
        self.finer = Finer::Shape { ratio, at };
        self
    }
}

/// Least and largest of a signal.
fn ends(signal: &[f64]) -> [f64; 2] {
    signal
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], own| {
            [low.min(*own), high.max(*own)]
        })
}

/// A product of two signals.
fn product(a: &[f64], b: impl Iterator<Item = f64>) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

/// The first coefficient under a name.
fn first(name: &'static str) -> Numbers {
    Rc::new(move |own| vec![(name, own[0])])
}
