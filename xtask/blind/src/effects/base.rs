//! Errors that the base model knows: larger ratios, eccentricities, bars and lengths than a good device has.

use haptical_model::transmission::CapstanError;
use haptical_model::{Device, TransmissionError};

use crate::effects::{Act, Draw, Effect, Facts, fixed};

/// An error of the joint's drums, or of its bars, where it has any.
fn of_base(
    draw: &Draw<'_>,
    name: &'static str,
    facts: Facts,
    change: impl Fn(&mut CapstanError, Option<&mut [f64; 4]>) + Send + Sync + 'static,
) -> Effect {
    let joint = draw.joint;
    let act = move |device: &mut Device| match &mut device.joints[joint].transmission_error {
        TransmissionError::Capstan(capstan) => change(capstan, None),
        TransmissionError::Parallelogram {
            capstan,
            length_deviations_m,
        } => change(capstan, Some(length_deviations_m)),
        TransmissionError::Chebyshev { .. } => {}
    };
    let info = draw.at_joint(name, &[name]);
    Effect::new(info, fixed(facts), Act::Device(Box::new(act)))
}

/// The ratio is off by more than one would machine.
pub(crate) fn ratio_error(draw: &mut Draw<'_>) -> Effect {
    let relative = draw.signed(6e-3);
    let facts = Facts::default().law("relative", relative);
    let ratio = draw.device.joints[draw.joint].transmission_ratio;
    of_base(draw, "ratio-error", facts, move |capstan, _| {
        capstan.ratio_deviation += ratio * relative;
    })
}

/// The output drum is off its axis.
pub(crate) fn drum_eccentricity(draw: &mut Draw<'_>) -> Effect {
    let (sin, cos) = libm::sincos(draw.random.phase_rad());
    let size_m = draw.amplitude(0.4e-3);
    let [x_m, y_m] = [size_m * cos, size_m * sin];
    let facts = Facts::default().law("x_m", x_m).law("y_m", y_m);
    of_base(draw, "drum-eccentricity", facts, move |capstan, _| {
        capstan.output_drum_xy_m[0] += x_m;
        capstan.output_drum_xy_m[1] += y_m;
    })
}

/// The bars of a parallelogram are not pairwise equal.
pub(crate) fn parallelogram_error(draw: &mut Draw<'_>) -> Effect {
    let lengths_m = [(); 4].map(|()| draw.signed(0.4e-3));
    let facts = Facts::default().law("bar_2_m", lengths_m[1]);
    of_base(draw, "parallelogram-error", facts, move |_, bars| {
        for (value, extra) in bars.into_iter().flatten().zip(lengths_m) {
            *value += extra;
        }
    })
}
