//! Facts of an effect that need no recording.

use crate::{Further, Need, Parameter};

/// Where an effect enters the chain from motor encoder to measured streams (docs/diagnosis.md).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hook {
    /// Between motor encoder and external encoder of a joint: that encoder and the chain see it.
    Transmission,
    /// An external encoder: nothing else sees it.
    ExternalEncoder,
    /// A joint behind its external encoder: the chain alone sees it.
    Joint,
    /// Links, base or handle: the chain alone sees it.
    Structure,
    /// The cable encoder: the cable alone sees it.
    CableSensor,
    /// The tracker: nothing else sees it.
    Tracker,
    /// The sampling of all motor encoders: everything sees it.
    Timing,
    /// The torques of the drives.
    Torque,
    /// The force sensor of the handle.
    ForceSensor,
    /// The readings of any channel, not the device.
    Readings,
    /// A number of the base model, found against an earlier model.
    BaseModel,
    /// How a joint follows its command: its position alone shows it.
    Command,
}

impl Hook {
    /// In words: `external encoder`.
    pub fn words(self) -> &'static str {
        match self {
            Self::Transmission => "transmission",
            Self::ExternalEncoder => "external encoder",
            Self::Joint => "joint",
            Self::Structure => "structure",
            Self::CableSensor => "cable sensor",
            Self::Tracker => "tracker",
            Self::Timing => "timing",
            Self::Torque => "torque",
            Self::ForceSensor => "force sensor",
            Self::Readings => "readings",
            Self::BaseModel => "base model",
            Self::Command => "answer to the command",
        }
    }

    /// Whether the torques of the drives show it, and nothing else.
    pub fn is_on_drives(self) -> bool {
        matches!(self, Self::Torque | Self::ForceSensor)
    }
}

/// Effects of one kind: of each kind a place shows at most one, because what a second one explains there
/// is what the first one's law gets wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Functions of the joint's own angle.
    Shape,
    /// Loops over reversals.
    Loop,
    /// Steps.
    Step,
    /// Delays.
    Lag,
    /// Proportional to a load.
    Load,
    /// Slow changes.
    Drift,
    /// Of one joint by another.
    Coupling,
    /// Where the cable leaves its guide.
    Exit,
    /// Of a joint's axis.
    Wobble,
    /// Of the handle.
    Tool,
    /// Of one frequency in time.
    Periodic,
    /// Of a sensor's place.
    Place,
    /// Numbers of a sensor or of the device file.
    Stated,
}

/// What a law gets wrong on a real device: a step and a delay are what they are, a spring hardens and a loop has
/// no single form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LawError {
    /// Share of the effect's energy.
    pub share: f64,
    /// Relative standard deviation of its amplitude.
    pub amplitude: f64,
}

impl LawError {
    /// Of the laws of a kind; none of those that the scan does not test.
    pub const fn of(family: Family) -> Self {
        let (share, amplitude) = match family {
            Family::Stated => (0.0, 0.0),
            Family::Step => (0.003, 0.006),
            Family::Lag => (0.015, 0.015),
            Family::Shape | Family::Coupling | Family::Periodic => (0.02, 0.01),
            Family::Exit => (0.03, 0.02),
            Family::Wobble | Family::Tool | Family::Place => (0.03, 0.015),
            Family::Loop => (0.05, 0.05),
            Family::Drift => (0.06, 0.02),
            Family::Load => (0.09, 0.06),
        };
        Self { share, amplitude }
    }
}

/// The mathematics of an effect's law. Together with [`Hook`] it says what a control loop, a simulated model or a device file takes
/// of an effect. Nothing outside the effect's file then asks for its name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// One that recordings alone show.
    Other,
    /// In proportion to the load of a joint.
    Spring,
    /// In proportion to the moment about the base.
    BaseSpring,
    /// In proportion to the force on the handle.
    ToolSpring,
    /// A play over reversals.
    Play,
    /// A play of another joint.
    CoupledPlay,
    /// Dahl's loop over reversals.
    Loop,
    /// In proportion to the loaded travel.
    Creep,
    /// What was true a delay ago.
    Delay,
    /// A constant from an instant or a run on.
    Step,
    /// A wave of the angle, with so many periods in a turn of the joint. Without a number the law's shape is that of periods in a turn
    /// of the motor.
    Harmonic(Option<f64>),
    /// Square and cube of the angle.
    Polynomial,
    /// In proportion to the reading itself.
    Scale,
    /// In proportion to another joint's reading, or to other axes of a sensor.
    Coupling,
    /// In proportion to time, or until it settles.
    Drift,
    /// In proportion to the warming: an angle, or all lengths.
    Warming,
    /// An axis that tilts with the angle.
    Wobble,
    /// A displacement of the handle.
    Shift,
    /// Coulomb's, viscous and Stribeck's friction.
    Friction,
    /// A constant.
    Offset,
    /// A mass that is carried.
    Mass,
    /// In proportion to a drive's acceleration.
    Armature,
    /// Another direction of gravity.
    Tilt,
    /// A free curve.
    Curve,
}

/// The one number that enters an effect's law nonlinearly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// One of these.
    Listed(&'static [f64]),
    /// Any number; the search starts from these.
    Continuous(&'static [f64]),
    /// The side that drives it: both are refitted.
    Sides,
    /// The first row after an event: it is searched over all rows, and belongs to one recording.
    Event,
    /// The frequency of a spectral line \[Hz\], any number: all frequencies are searched before, once for all effects
    /// ([`crate::Line`]).
    Line,
    /// Given by the device or the recording.
    Given,
}

impl Shape {
    /// Of a law that is linear in its amplitudes.
    pub const NONE: Self = Self::Listed(&[0.0]);

    /// Shapes that a scan tries where the recording does not decide them.
    pub fn grid(self) -> Vec<f64> {
        match self {
            Self::Listed(shapes) | Self::Continuous(shapes) => shapes.to_vec(),
            Self::Sides | Self::Event | Self::Line | Self::Given => vec![0.0],
        }
    }

    /// Whether shapes between those of the grid exist.
    pub fn is_continuous(self) -> bool {
        matches!(self, Self::Continuous(_) | Self::Line)
    }
}

/// What an effect's law is a function of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Follows {
    /// The joint's own angle.
    Angle,
    /// Another joint's angle.
    OtherAngle,
    /// The joint's speed.
    Speed,
    /// The joint's torque.
    Torque,
    /// The force on the handle.
    Force,
    /// Temperature.
    Temperature,
    /// Time.
    Time,
    /// The number of the run.
    Run,
    /// The cable's length.
    Length,
    /// The cable's angle where it leaves its guide.
    ExitAngle,
    /// The cable's speed.
    CableSpeed,
}

/// What of the base model takes an effect up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Absorbed {
    /// Nothing.
    Never,
    /// Fitted numbers of the joint's transmission: the same term.
    ByTransmission,
    /// The same, under another name: the centre of the input drum.
    ByInputDrum,
    /// A fitted compliance of the joint.
    ByCompliance,
    /// The scale of all lengths.
    ByLengths,
    /// The scale of the joint's torque, as far as the device file allows.
    ByTorqueScale,
}

/// What a log has wrong by an effect that is no part of the device: it can be set right in the log.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LogFault {
    /// Readings from an event on are off by a constant.
    Step,
    /// Readings are late.
    Late,
    /// Readings of a sensor drift.
    Drift,
    /// Single readings are wild.
    Wild,
}

/// What is known of an effect without a recording. Of two effects with one name the parameters differ, or the
/// place where they enter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spec {
    /// Name: `backlash`.
    pub name: &'static str,
    /// What happens, a clause without a full stop.
    pub meaning: &'static str,
    /// What to look at on the device.
    pub inspect: &'static str,
    /// What tells whether it is there, where torques alone have shown it, with `{name}` for its name; empty where a motion under
    /// other loads and speeds does.
    pub confirm: &'static str,
    /// What it adds to a reading; empty where docs/diagnosis-force.md derives it.
    pub adds: &'static str,
    /// Its number in the study of effects; empty for one without.
    pub source: &'static str,
    /// Where it enters.
    pub hook: Hook,
    /// Kind.
    pub family: Family,
    /// Its law.
    pub form: Form,
    /// What must have been recorded for it to be tested.
    pub needs: &'static [Need],
    /// Reported numbers, the size first.
    pub parameters: &'static [Parameter],
    /// Numbers that its law has besides: an effect of a device file has them too.
    pub further: &'static [Further],
    /// Number of amplitudes that its law is fitted with.
    pub amplitudes: usize,
    /// What else its law is fitted with.
    pub shape: Shape,
    /// What its law is a function of.
    pub follows: Follows,
    /// Whether nature allows positive amplitudes alone (a stiffness, a delay of a drive).
    pub is_positive: bool,
    /// Whether the scale of the recorded torque is that of the first parameter.
    pub scales_with_torque: bool,
    /// Whether an event happens under a load that few rows exceed.
    pub under_load: bool,
    /// Whether it is looked for beside other effects of its joint alone: by itself it would pass for too many others.
    pub is_found_beside: bool,
    /// What of the base model takes it up.
    pub absorbed_by: Absorbed,
    /// Effects with the same course where their covariate does not vary.
    pub look_alikes: &'static [&'static str],
    /// Logarithm of its prior odds against a common effect.
    pub log_prior: f64,
    /// What its law gets wrong.
    pub law_error: LawError,
    /// What the log has wrong by it; none for what the device has.
    pub log_fault: Option<LogFault>,
}

impl Spec {
    /// What most effects have in common, for `..Spec::COMMON`.
    pub const COMMON: Self = Self {
        name: "",
        meaning: "",
        inspect: "",
        confirm: "",
        adds: "",
        source: "",
        hook: Hook::Transmission,
        family: Family::Stated,
        form: Form::Other,
        needs: &[],
        parameters: &[],
        further: &[],
        amplitudes: 1,
        shape: Shape::NONE,
        follows: Follows::Time,
        is_positive: false,
        scales_with_torque: false,
        under_load: false,
        is_found_beside: false,
        absorbed_by: Absorbed::Never,
        look_alikes: &[],
        log_prior: 0.0,
        law_error: LawError::of(Family::Stated),
        log_fault: None,
    };

    /// What the effects of a kind have in common, with what laws of that kind get wrong.
    pub const fn of(family: Family) -> Self {
        Self {
            family,
            law_error: LawError::of(family),
            ..Self::COMMON
        }
    }

    /// Whether another effect at the same place is of the same kind: another law of what happens there.
    pub fn is_kin_of(&self, other: &Self) -> bool {
        self.family == other.family
            && (self.hook == other.hook || self.family == Family::Drift)
            && !matches!(self.family, Family::Coupling | Family::Periodic)
    }

    /// Amplitudes and shape as parameters: in this order, as many as there are parameters.
    pub(crate) fn values_at(&self, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        let numbers = amplitudes.iter().copied().chain([shape]);
        let pairs = self.parameters.iter().zip(numbers);
        pairs.map(|(own, number)| own.turned(number)).collect()
    }

    /// The inverse of [`Spec::values_at`]; what no parameter says is 0.
    pub(crate) fn amplitudes_at(&self, values: &[f64]) -> (Vec<f64>, f64) {
        let pairs = self.parameters.iter().zip(values);
        let mut numbers = pairs.map(|(own, value)| own.turned(*value));
        let amplitudes = (0..self.amplitudes).map(|_| numbers.next().unwrap_or(0.0));
        (amplitudes.collect(), numbers.next().unwrap_or(0.0))
    }

    /// The parameter of a name.
    pub fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.parameters
            .iter()
            .find(|parameter| parameter.name == name)
    }
}
