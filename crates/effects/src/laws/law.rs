//! A law: the error of one number, a joint's angle or torque or the first cable's length, that enters at the hook of its
//! effect; or what several numbers show of it.

use std::fmt::Debug;

use crate::context::Context;
use crate::signal::LocalMotion;
use crate::{Effect, Follows, Hook, Signal, Spec};

/// Runs after which a displacement is looked for at most.
const RUNS: usize = 8;

/// Inputs of a law.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Input<'c, 'a> {
    pub(crate) context: &'c Context<'a>,
    /// Joint whose number is wrong, from 0; none where it is the cable's length, or several numbers.
    pub(crate) joint: Option<usize>,
    pub(crate) spec: &'static Spec,
}

impl<'c> Input<'c, '_> {
    /// The angle as read, or the cable's length by the base model.
    pub(crate) fn reading(&self) -> Option<&'c [f64]> {
        match self.joint {
            Some(joint) => Some(&self.context.recording.joint[joint]),
            None => self
                .context
                .cable
                .as_ref()
                .map(|cable| cable.length_m.as_slice()),
        }
    }

    /// Its rates, where times are recorded.
    pub(crate) fn motion(&self) -> Option<&'c LocalMotion> {
        let motion = match self.joint {
            Some(joint) => self.context.motion.as_ref()?.get(joint),
            None => self.context.cable.as_ref().map(|cable| &cable.motion),
        };
        motion.filter(|motion| !motion.velocity.is_empty())
    }

    /// The joint's reading with rates as torques are compared with.
    pub(crate) fn drive_motion(&self) -> Option<LocalMotion> {
        self.context.drive_motion(self.joint?)
    }

    /// Every run but the first.
    fn later_runs(&self) -> Vec<f64> {
        let later = 1..self.context.runs.len().min(RUNS + 1);
        later.map(|run| run as f64).collect()
    }

    /// Smoothed torque of the joint \[N m\].
    pub(crate) fn torque_nm(&self) -> Option<&'c [f64]> {
        self.context.torque_nm.get(self.joint?)?.as_deref()
    }

    /// The joint's external encoder as read.
    pub(crate) fn output(&self) -> Option<&'c [f64]> {
        self.context.recording.output.get(self.joint?)?.as_deref()
    }

    /// Whether the calibration uses that encoder.
    pub(crate) fn has_output(&self) -> bool {
        let joint = self.joint;
        joint.is_some_and(|joint| self.context.output_stream(joint).is_some())
    }

    /// The joint in the device file.
    pub(crate) fn joint(&self) -> Option<&'c haptical_model::Joint> {
        self.context.device.joints.get(self.joint?)
    }
}

/// The error of one number, or of several.
pub(crate) trait Law: Debug + Send + Sync {
    /// Derivative of the error with respect to each amplitude; none where an input is missing.
    fn columns(&self, _: Input<'_, '_>, _amplitudes: &[f64], _shape: f64) -> Option<Vec<Vec<f64>>> {
        None
    }

    /// Derivative of the measured streams, where they do not show the error of one number.
    fn signals(&self, _: Input<'_, '_>, _shape: f64) -> Option<Vec<Signal>> {
        None
    }

    /// The error itself, where it is not linear.
    fn error(&self, _: Input<'_, '_>, _amplitudes: &[f64]) -> Option<Vec<f64>> {
        None
    }

    /// The other joint whose angle it is a function of.
    fn other_joint(&self) -> Option<usize> {
        None
    }

    /// The cable whose reading it changes, from 0, where that is not the first.
    fn further_cable(&self) -> Option<usize> {
        None
    }

    /// Shapes to try, where the recording or the place decides them: of what is there from a run on, the first run with it.
    fn shapes(&self, input: Input<'_, '_>) -> Option<Vec<f64>> {
        (input.spec.follows == Follows::Run).then(|| input.later_runs())
    }

    /// The reported parameters, as [`Effect::values`].
    fn values(&self, input: Input<'_, '_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        input.spec.values_at(amplitudes, shape)
    }

    /// Amplitudes (those left out are 0) and shape that have these values.
    fn amplitudes(&self, input: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        input.spec.amplitudes_at(values)
    }

    /// Further numbers, as [`Effect::further`].
    fn further(&self, _: Input<'_, '_>, _amplitudes: &[f64], _shape: f64) -> Vec<f64> {
        Vec::new()
    }

    /// As [`Effect::whole`], with amplitudes that are left out 0.
    fn whole(&self, input: Input<'_, '_>, values: &[f64], _further: &[f64]) -> (Vec<f64>, f64) {
        self.amplitudes(input, values)
    }

    /// Whether nature allows these amplitudes.
    fn is_possible(&self, _: Input<'_, '_>, _amplitudes: &[f64]) -> bool {
        true
    }
}

/// A law at its place.
#[derive(Debug)]
pub(crate) struct Placed<L> {
    pub(crate) spec: &'static Spec,
    /// None of the first cable and of the whole device.
    pub(crate) joint: Option<usize>,
    pub(crate) law: L,
}

impl<L> Placed<L> {
    fn input<'c, 'a>(&self, context: &'c Context<'a>) -> Input<'c, 'a> {
        Input {
            context,
            joint: self.joint,
            spec: self.spec,
        }
    }

    fn enter(&self, context: &Context<'_>, error: &[f64]) -> Signal {
        context.entering(self.spec.hook, self.joint, error)
    }
}

impl<L: Law> Effect for Placed<L> {
    fn spec(&self) -> &'static Spec {
        self.spec
    }

    fn joint(&self) -> Option<usize> {
        self.joint
    }

    fn other_joint(&self) -> Option<usize> {
        self.law.other_joint()
    }

    fn further_cable(&self) -> Option<usize> {
        self.law.further_cable()
    }

    fn shapes(&self, context: &Context<'_>) -> Vec<f64> {
        let own = self.law.shapes(self.input(context));
        own.unwrap_or_else(|| self.spec.shape.grid())
    }

    fn derivative(&self, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<Signal> {
        let input = self.input(context);
        let signals = self.law.signals(input, shape).or_else(|| {
            let columns = self.law.columns(input, amplitudes, shape)?.into_iter();
            Some(columns.map(|column| self.enter(context, &column)).collect())
        });
        signals.unwrap_or_default()
    }

    fn signal(&self, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Signal {
        match self.law.error(self.input(context), amplitudes) {
            Some(error) => self.enter(context, &error),
            None => {
                let columns = self.derivative(context, amplitudes, shape);
                Signal::sum(&columns, amplitudes)
            }
        }
    }

    fn values(&self, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        self.law.values(self.input(context), amplitudes, shape)
    }

    fn amplitudes(&self, context: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        let (mut amplitudes, shape) = self.law.amplitudes(self.input(context), values);
        amplitudes.resize(self.spec.amplitudes, 0.0);
        (amplitudes, shape)
    }

    fn further(&self, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        self.law.further(self.input(context), amplitudes, shape)
    }

    fn whole(&self, context: &Context<'_>, values: &[f64], further: &[f64]) -> (Vec<f64>, f64) {
        let (mut amplitudes, shape) = self.law.whole(self.input(context), values, further);
        amplitudes.resize(self.spec.amplitudes, 0.0);
        (amplitudes, shape)
    }

    fn exact_signal(&self, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Signal {
        let moves_chain = matches!(self.spec.hook, Hook::Transmission | Hook::Joint);
        let input = self.input(context);
        let error = || {
            let whole = self.law.error(input, amplitudes);
            whole.or_else(|| {
                let columns = self.law.columns(input, amplitudes, shape)?;
                let mut sum = vec![0.0; context.rows()];
                for (column, amplitude) in columns.iter().zip(amplitudes) {
                    for (sum, entry) in sum.iter_mut().zip(column) {
                        *sum += amplitude * entry;
                    }
                }
                Some(sum)
            })
        };
        let joint = self.joint.filter(|_| moves_chain);
        match joint.and_then(|joint| Some((joint, error()?))) {
            Some((joint, error)) => {
                let signal = self.enter(context, &error);
                context.exactly(signal, &[(joint, error.as_slice())])
            }
            None => self.signal(context, amplitudes, shape),
        }
    }

    fn is_possible(&self, context: &Context<'_>, amplitudes: &[f64]) -> bool {
        (!self.spec.is_positive || amplitudes[0] > 0.0)
            && self.law.is_possible(self.input(context), amplitudes)
    }
}
