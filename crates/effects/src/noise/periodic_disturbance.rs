//! A disturbance of one frequency in what one channel reads, whatever moves: a fan, a pump, mains, a stand that
//! vibrates. A harmonic of a drum follows the angle; this follows the time.

use haptical_calibration::Channel;
use haptical_model::{Device, JointType};

use crate::context::Context;
use crate::{Effect, Family, Hook, Need, Parameter, Shape, Signal, Spec};

const RADIANS: &[Parameter] = &[
    Parameter::size("amplitude_rad", 0.0, 0.1),
    Parameter::number("frequency_hz", 1e5),
];
const METRES: &[Parameter] = &[
    Parameter::size("amplitude_m", 0.0, 0.1),
    Parameter::number("frequency_hz", 1e5),
];

/// A channel's readings oscillate at one frequency.
const COMMON: Spec = Spec {
    name: "periodic-disturbance",
    meaning: "the readings of one channel oscillate at one frequency, whatever moves",
    inspect: "what turns or hums near that sensor (fans, pumps, mains), its stand and its shielding",
    adds: "A cos(2 pi f t - phase), each axis and each run with its own phase",
    parameters: METRES,
    amplitudes: 2,
    shape: Shape::Line,
    ..Spec::of(Family::Periodic)
};
/// The same of the external encoder of a turning joint.
pub(crate) const ENCODER: Spec = Spec {
    hook: Hook::ExternalEncoder,
    needs: &[Need::Time, Need::Motion, Need::Output],
    parameters: RADIANS,
    ..COMMON
};
/// The same of a sliding joint.
pub(crate) const SLIDE: Spec = Spec {
    parameters: METRES,
    ..ENCODER
};
/// The same of the measuring cable.
pub(crate) const CABLE: Spec = Spec {
    hook: Hook::CableSensor,
    needs: &[Need::Time, Need::Motion, Need::Cable],
    ..COMMON
};
/// The same of a tracker's positions, on all axes at once.
pub(crate) const POSITION: Spec = Spec {
    hook: Hook::Tracker,
    needs: &[Need::Time, Need::Motion, Need::Position],
    amplitudes: 6,
    ..COMMON
};
/// The same of a tracker's orientations.
pub(crate) const ORIENTATION: Spec = Spec {
    hook: Hook::Tracker,
    needs: &[Need::Time, Need::Motion, Need::Orientation],
    parameters: RADIANS,
    amplitudes: 6,
    ..COMMON
};

/// By channel.
pub(crate) const SPECS: [Spec; 5] = [ENCODER, SLIDE, CABLE, POSITION, ORIENTATION];

#[derive(Debug)]
pub(crate) struct PeriodicDisturbance {
    channel: Channel,
    spec: &'static Spec,
}

/// On every channel of a device that reads a position, an angle or a distance at its own instants.
pub(crate) fn on_channels(device: &Device) -> Vec<Box<dyn Effect>> {
    let encoders = device.joints.iter().enumerate().map(|(joint, own)| {
        let slides = own.joint_type == JointType::Prismatic;
        let spec = if slides { &SLIDE } else { &ENCODER };
        (Channel::Output { joint }, spec)
    });
    let others: [(Channel, &'static Spec); 3] = [
        (Channel::Cable { index: 0 }, &CABLE),
        (Channel::Position, &POSITION),
        (Channel::Orientation, &ORIENTATION),
    ];
    let all = encoders.chain(others);
    all.map(|(channel, spec)| Box::new(PeriodicDisturbance { channel, spec }) as Box<dyn Effect>)
        .collect()
}

impl Effect for PeriodicDisturbance {
    fn spec(&self) -> &'static Spec {
        self.spec
    }

    fn joint(&self) -> Option<usize> {
        match self.channel {
            Channel::Output { joint } => Some(joint),
            _ => None,
        }
    }

    fn shapes(&self, context: &Context<'_>) -> Vec<f64> {
        context.lines_of(self.channel)
    }

    /// Cosine and sine on each axis.
    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        let waves = context.oscillation(self.channel, shape);
        let on_axis = |stream: usize| {
            let columns = waves.iter().map(move |wave| vec![(stream, wave.clone())]);
            columns.map(|parts| Signal { parts })
        };
        context.streams_of(self.channel).flat_map(on_axis).collect()
    }

    /// The largest excursion: the long half axis of the ellipse that all axes describe.
    fn values(&self, _: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        let (mut cosine, mut sine, mut both) = (0.0, 0.0, 0.0);
        for pair in amplitudes.chunks_exact(2) {
            cosine += pair[0] * pair[0];
            sine += pair[1] * pair[1];
            both += pair[0] * pair[1];
        }
        let largest = 0.5 * (cosine + sine) + (0.5 * (cosine - sine)).hypot(both);
        vec![largest.sqrt(), shape]
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        let mut amplitudes = vec![0.0; self.spec.amplitudes];
        amplitudes[0] = values[0];
        (amplitudes, values[1])
    }
}
