//! Errors that the base model knows: larger ratios, eccentricities, bars and lengths than a good device has.

use haptical_model::{Device, TransmissionError};

use crate::effects::{Draw, Effect, Facts, Info};
use crate::rig::scene::Scene;

/// A base error of one joint.
#[derive(Debug, Clone, Copy)]
enum BaseError {
    Ratio { relative: f64 },
    OutputDrum { xy_m: [f64; 2] },
    Bars { lengths_m: [f64; 4] },
}

/// A base error as an effect.
#[derive(Debug)]
struct OfBase {
    info: Info,
    joint: usize,
    error: BaseError,
}

impl Effect for OfBase {
    fn info(&self) -> &Info {
        &self.info
    }

    fn facts(&self, _scene: &Scene<'_>) -> Facts {
        match self.error {
            BaseError::Ratio { relative } => Facts::default().law("relative", relative),
            BaseError::OutputDrum { xy_m: [x_m, y_m] } => {
                Facts::default().law("x_m", x_m).law("y_m", y_m)
            }
            BaseError::Bars { lengths_m } => Facts::default().law("bar_2_m", lengths_m[1]),
        }
    }

    fn device(&self, device: &mut Device) {
        let joint = &mut device.joints[self.joint];
        let ratio = joint.transmission_ratio;
        let (capstan, bars) = match &mut joint.transmission_error {
            TransmissionError::Capstan(capstan) => (capstan, None),
            TransmissionError::Parallelogram {
                capstan,
                length_deviations_m,
            } => (capstan, Some(length_deviations_m)),
            TransmissionError::Chebyshev { .. } => return,
        };
        match self.error {
            BaseError::Ratio { relative } => capstan.ratio_deviation += ratio * relative,
            BaseError::OutputDrum { xy_m } => {
                for (value, extra) in capstan.output_drum_xy_m.iter_mut().zip(xy_m) {
                    *value += extra;
                }
            }
            BaseError::Bars { lengths_m } => {
                for (value, extra) in bars.into_iter().flatten().zip(lengths_m) {
                    *value += extra;
                }
            }
        }
    }
}

/// The ratio is off by more than one would machine.
pub(crate) fn ratio_error(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let error = BaseError::Ratio {
        relative: draw.signed(6e-3),
    };
    let info = draw.at_joint("ratio-error", &["ratio-error"]);
    let joint = draw.joint;
    Box::new(OfBase { info, joint, error })
}

/// The output drum is off its axis.
pub(crate) fn drum_eccentricity(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let (sin, cos) = libm::sincos(draw.random.phase_rad());
    let size_m = draw.amplitude(0.4e-3);
    let error = BaseError::OutputDrum {
        xy_m: [size_m * cos, size_m * sin],
    };
    let info = draw.at_joint("drum-eccentricity", &["drum-eccentricity"]);
    let joint = draw.joint;
    Box::new(OfBase { info, joint, error })
}

/// The bars of a parallelogram are not pairwise equal.
pub(crate) fn parallelogram_error(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let lengths_m = [(); 4].map(|()| draw.signed(0.4e-3));
    let error = BaseError::Bars { lengths_m };
    let info = draw.at_joint("parallelogram-error", &["parallelogram-error"]);
    let joint = draw.joint;
    Box::new(OfBase { info, joint, error })
}
