//! An effect at a place: what it adds to the measured streams, and its numbers.

use std::f64::consts::PI;
use std::fmt::Debug;

use haptical_calibration::Channel;

use crate::context::{Context, Stream, moves};
use crate::{Family, Hook, Need, Shape, Signal, Spec};

/// Relative step of a transition and the like.
const SHAPE_STEP: f64 = 0.02;
/// Step of a phase \[rad\].
const PHASE_STEP_RAD: f64 = 0.05;

/// One effect at one place.
pub trait Effect: Debug + Send + Sync {
    /// What is known of it without a recording.
    fn spec(&self) -> &'static Spec;

    /// Joint, from 0.
    fn joint(&self) -> Option<usize> {
        None
    }

    /// The other joint, from 0, whose angle its law is a function of.
    fn other_joint(&self) -> Option<usize> {
        None
    }

    /// The cable whose reading it changes, from 0, where that is not the first.
    fn further_cable(&self) -> Option<usize> {
        None
    }

    /// Grid of the one parameter that enters nonlinearly (a transition, an order, a time constant).
    fn shapes(&self, _context: &Context<'_>) -> Vec<f64> {
        self.spec().shape.grid()
    }

    /// Derivative of the signal with respect to each amplitude, at `amplitudes` (all zero for the score scan).
    fn derivative(&self, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<Signal>;

    /// What it adds to the measured streams; the derivative times the amplitudes where it is linear.
    fn signal(&self, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Signal {
        Signal::sum(&self.derivative(context, amplitudes, shape), amplitudes)
    }

    /// The reported parameters: the amplitudes, then the shape, as many as there are parameters, where nothing else is
    /// said.
    fn values(&self, _context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        self.spec().values_at(amplitudes, shape)
    }

    /// Amplitudes and shape that have these values: the inverse of [`Effect::values`].
    fn amplitudes(&self, _context: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        self.spec().amplitudes_at(values)
    }

    /// The numbers that its law has beside the reported ones, as many as [`Spec::further`] names.
    fn further(&self, _context: &Context<'_>, _amplitudes: &[f64], _shape: f64) -> Vec<f64> {
        Vec::new()
    }

    /// Amplitudes and shape that have these values and further numbers.
    fn whole(&self, context: &Context<'_>, values: &[f64], _further: &[f64]) -> (Vec<f64>, f64) {
        self.amplitudes(context, values)
    }

    /// What it adds to the measured streams, with the chain moved as far as it is: [`Effect::signal`] is that to first order.
    fn exact_signal(&self, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Signal {
        self.signal(context, amplitudes, shape)
    }

    /// Name of another effect that no reading of this recording tells from it, whatever its size.
    fn twin(&self, _context: &Context<'_>) -> Option<&'static str> {
        None
    }

    /// Whether nature allows these amplitudes.
    fn is_possible(&self, _context: &Context<'_>, amplitudes: &[f64]) -> bool {
        !self.spec().is_positive || amplitudes[0] > 0.0
    }
}

impl dyn Effect + '_ {
    /// Its name.
    pub fn name(&self) -> &'static str {
        self.spec().name
    }

    /// `backlash@3`, `cable-latency`, `cable-scale@cable2`.
    pub fn label(&self) -> String {
        match (self.joint(), self.further_cable()) {
            (Some(joint), _) => format!("{}@{}", self.name(), joint + 1),
            (None, Some(cable)) => format!("{}@cable{}", self.name(), cable + 1),
            (None, None) => self.name().to_owned(),
        }
    }

    /// Why it cannot be tested on a recording.
    pub fn untestable(&self, context: &Context<'_>) -> Option<String> {
        let joint = self.joint().unwrap_or(0);
        let mut needs = self.spec().needs.iter();
        needs
            .find_map(|need| need.missing(joint, context))
            .or_else(|| self.rests(context))
            .or_else(|| self.unseen(context))
    }

    /// Why what comes of a joint's motion cannot be there: the joint rests.
    fn rests(&self, context: &Context<'_>) -> Option<String> {
        let is_of_motion = matches!(self.spec().family, Family::Loop | Family::Lag);
        let joint = self.joint().filter(|_| is_of_motion)?;
        let moves = moves(context.device, context.recording, joint);
        (!moves).then(|| format!("joint {} does not move", joint + 1))
    }

    /// Why no measured stream can show it.
    fn unseen(&self, context: &Context<'_>) -> Option<String> {
        if self.spec().hook.is_on_drives() {
            return self.unseen_by_drives(context);
        }
        if let Some(index) = self.further_cable() {
            let channel = Channel::Cable { index };
            let is_seen = context.streams_of(channel).next().is_some();
            return (!is_seen).then(|| format!("no column {}_m", channel.name()));
        }
        let is_transmission = self.spec().hook == Hook::Transmission;
        let joint = self.joint().filter(|_| is_transmission)?;
        let is_seen = |stream: &Stream| stream.joint() == Some(joint) || stream.shows_handle();
        (!context.streams.iter().any(is_seen)).then(|| {
            let unit = context.device.joints[joint].unit();
            format!(
                "no column out{}_{unit}, and no distance, position or orientation, and no touch",
                joint + 1
            )
        })
    }

    /// Why no recorded torque can show it.
    fn unseen_by_drives(&self, context: &Context<'_>) -> Option<String> {
        let joints = match self.joint() {
            Some(joint) => joint..joint + 1,
            None => 0..context.device.joints.len(),
        };
        let column = match self.joint() {
            Some(joint) => {
                let column = context.device.joints[joint].torque_column(joint + 1);
                format!("no column {column}")
            }
            None => "no column torque1_nm, torque2_nm, ...".to_owned(),
        };
        let mut streams = joints.map(|joint| context.torque_stream(joint));
        streams.all(|stream| stream.is_none()).then_some(column)
    }

    /// Whether it cannot be tested for want of the covariate that drives it alone: what it shows on is recorded. An effect on drives
    /// shows on the torque of a motion: not without that torque, and not in postures without times.
    pub fn lacks_covariate(&self, context: &Context<'_>) -> bool {
        let joint = self.joint().unwrap_or(0);
        let is_on_drives = self.spec().hook.is_on_drives();
        let is_still = || context.recording.time_s.is_none();
        if is_on_drives && (is_still() || self.unseen_by_drives(context).is_some()) {
            return false;
        }
        let needs = self.spec().needs.iter();
        let mut lacking = needs
            .filter(|need| need.missing(joint, context).is_some())
            .peekable();
        let is_covariate =
            |need: &Need| need.is_covariate() && !(is_on_drives && *need == Need::Torque);
        lacking.peek().is_some() && lacking.all(is_covariate)
    }

    /// Whether another effect is of the same kind at the same place.
    pub fn is_kin_of(&self, other: &dyn Effect) -> bool {
        self.joint() == other.joint()
            && self.further_cable() == other.further_cable()
            && self.spec().is_kin_of(other.spec())
    }

    /// Relative step of the shape over which its signal is taken for straight.
    pub fn shape_step(&self, context: &Context<'_>, shape: f64) -> f64 {
        match self.spec().shape {
            // by which the phase at the ends of a run changes little
            Shape::Line => PHASE_STEP_RAD / (PI * shape * context.longest_run_s()).max(1.0),
            _ => SHAPE_STEP,
        }
    }

    /// Relative uncertainty that a covariate's scale adds to the first parameter.
    pub fn scale_uncertainty(&self, context: &Context<'_>) -> f64 {
        match self.joint() {
            Some(joint) if self.spec().scales_with_torque => {
                context.device.joints[joint].torque_scale_sd
            }
            _ => 0.0,
        }
    }

    /// Whether values are of a size that a sound device can show.
    pub fn is_plausible(&self, values: &[f64]) -> bool {
        let mut pairs = self.spec().parameters.iter().zip(values);
        pairs.all(|(parameter, value)| parameter.is_plausible(*value, 1.0))
    }
}
