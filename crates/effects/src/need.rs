//! Columns and motion that an effect needs in a recording to be tested.

use haptical_calibration::Channel;
use haptical_model::{Recording, varies};

use crate::clock::OtherClock;
use crate::context::{Context, Stream};

/// A column, a number of the device file, or a property of the recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// Times.
    Time,
    /// Rows that follow a motion, so that reversals can be seen.
    Motion,
    /// Rows in the order in which the device came to them, so that the side that each joint came from is known: a motion, or
    /// single postures as they were visited.
    Order,
    /// The joint's torque, recorded or by masses and gravity.
    Torque,
    /// The current of the joint's motor.
    Current,
    /// The hand's force.
    Force,
    /// The moment of hand and weights about the base.
    BaseMoment,
    /// A temperature.
    Temperature,
    /// The joint's external encoder.
    Output,
    /// The first cable.
    Cable,
    /// A cable after the first; each such effect says which column it lacks.
    FurtherCable,
    /// Radius of the first cable's drum.
    DrumRadius,
    /// Positions of a tracker.
    Position,
    /// Orientations of a tracker.
    Orientation,
    /// An external encoder or a cable: a clock beside those of the motor encoders and the tracker.
    FurtherClock,
    /// A distance, position, orientation or touch.
    Chain,
    /// Two runs.
    Runs,
    /// One place of the tracker for all runs.
    OneBase,
    /// The direction of gravity.
    Gravity,
    /// A motion at 20 rows a second or more, and the mass and inertia of every link.
    Inertia,
    /// Commanded positions.
    Command,
    /// Counts of the joint's motor-side encoder.
    Counts,
    /// A model identified earlier.
    EarlierModel,
}

impl Need {
    /// In words: `external encoder`.
    pub fn words(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Motion => "motion",
            Self::Order => "motion or postures in order",
            Self::Torque => "torque",
            Self::Current => "motor current",
            Self::Force => "force",
            Self::BaseMoment => "force or masses with gravity",
            Self::Temperature => "temperature",
            Self::Output => "external encoder",
            Self::Cable => "cable",
            Self::FurtherCable => "another cable",
            Self::DrumRadius => "drum radius",
            Self::Position => "position",
            Self::Orientation => "orientation",
            Self::FurtherClock => "external encoder or cable",
            Self::Chain => "distance or pose",
            Self::Runs => "two runs",
            Self::OneBase => "one tracker place",
            Self::Gravity => "gravity",
            Self::Inertia => "motion, masses and inertias",
            Self::Command => "commands",
            Self::Counts => "counts",
            Self::EarlierModel => "an earlier model",
        }
    }

    /// Whether it drives effects, rather than shows them.
    pub fn is_covariate(self) -> bool {
        matches!(
            self,
            Self::Time | Self::Temperature | Self::Motion | Self::Order | Self::Torque
        )
    }

    /// Why a recording lacks it at a joint (from 0; 0 for an effect of the device).
    pub fn missing(self, joint: usize, context: &Context<'_>) -> Option<String> {
        let (device, recording) = (context.device, context.recording);
        let number = joint + 1;
        let lacks = |is_lacking: bool, why: &str| is_lacking.then(|| why.to_owned());
        let cable = device.cables.first();
        match self {
            Self::Time => lacks(recording.time_s.is_none(), "no column t_s"),
            Self::Motion => lacks(
                !context.ordered,
                "the rows are single postures, not a motion",
            ),
            // of touches without times nobody says which was first
            Self::Order => lacks(
                !context.ordered
                    && recording.time_s.is_none()
                    && context.streams.iter().any(Stream::is_touch),
                "the touches are in no stated order: no column t_s",
            ),
            Self::Torque => match context.torque_nm.get(joint).and_then(Option::as_ref) {
                None => Some(format!(
                    "no column {}, and no masses with gravity",
                    device.joints[joint].torque_column(number)
                )),
                Some(values) if !varies(values) => {
                    let column = device.joints[joint].torque_column(number);
                    Some(format!("{column} is constant"))
                }
                Some(_) => None,
            },
            Self::Current => lacks(
                recording.current(joint).is_none(),
                &format!("no column current{number}_a"),
            ),
            Self::Force => force_is_missing(recording),
            Self::BaseMoment => lacks(
                context.base_moment_nm.is_none(),
                "neither forces nor masses and gravity are known",
            ),
            Self::Temperature => match &context.warming_k {
                None => Some("no column temp_degc".to_owned()),
                Some(values) => lacks(!varies(values), "temp_degc is constant"),
            },
            Self::Output => context
                .output_stream(joint)
                .is_none()
                .then(|| format!("no column out{number}_{}", device.joints[joint].unit())),
            Self::Cable => lacks(context.cable.is_none(), "no column cable_m"),
            Self::FurtherCable => None,
            Self::DrumRadius => lacks(
                cable.is_none_or(|cable| cable.drum_radius_m.is_none()),
                "no drum_radius_m in the device file",
            ),
            Self::Position => lacks(
                context.streams_of(Channel::Position).next().is_none(),
                "no columns x_m, y_m, z_m",
            ),
            Self::Orientation => lacks(
                context.streams_of(Channel::Orientation).next().is_none(),
                "no columns qw, qx, qy, qz",
            ),
            Self::FurtherClock => lacks(
                OtherClock::only(context.streams.iter().map(|own| own.channel)).is_some(),
                "no external encoder and no cable: it is one with encoder-latency of the other sign",
            ),
            Self::Chain => lacks(
                !context.streams.iter().any(Stream::shows_handle),
                "no distance, position or orientation, and no touch",
            ),
            Self::Runs => lacks(context.runs.len() < 2, "one run only"),
            Self::OneBase => lacks(
                device.has_run_bases(),
                "each run has a tracker place of its own, which is fitted and takes up such a move",
            ),
            Self::Command => lacks(
                recording.command(joint).is_none(),
                &format!("no column command{number}_{}", device.joints[joint].unit()),
            ),
            Self::Counts => lacks(
                device.joints[joint].encoder_counts_per_rev.is_none(),
                "no encoder_counts_per_rev in the device file",
            ),
            Self::Gravity => lacks(
                device.gravity_mps2.is_none(),
                "no [gravity] in the device file",
            ),
            Self::Inertia => lacks(
                device
                    .bodies
                    .iter()
                    .skip(1)
                    .flatten()
                    .all(|body| body.inertia_kgm2.is_none()),
                "no inertia_kgm2 in the device file",
            ),
            Self::EarlierModel => None,
        }
    }
}

fn force_is_missing(recording: &Recording) -> Option<String> {
    match &recording.force_n {
        None => Some("no columns fx_n, fy_n, fz_n".to_owned()),
        Some(axes) => (!axes.iter().any(|axis| varies(axis)))
            .then(|| "the hand's force is constant".to_owned()),
    }
}
