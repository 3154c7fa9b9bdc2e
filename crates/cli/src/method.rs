//! From flags to the calibration's options, and back to words.

use haptical_calibration::{CalibrationMethod, HeldOut, Options, Weighting};

use crate::arguments::{IdentifyArguments, MethodName, NoiseName};
use crate::inputs::InputDrumDenominators;

impl IdentifyArguments {
    /// The calibration's options.
    pub(crate) fn options(&self) -> Options {
        Options {
            method: match self.method {
                MethodName::TwoStep => CalibrationMethod::TwoStep,
                MethodName::Joint => CalibrationMethod::Joint,
            },
            degree: self.degree,
            weighting: match self.noise {
                NoiseName::Stated => Weighting::Stated,
                NoiseName::Estimated => Weighting::Estimated,
            },
            held_out: if self.held_out > 0.0 {
                HeldOut::Share(self.held_out)
            } else {
                HeldOut::None
            },
            ..Options::default()
        }
    }

    /// Which input drum denominators hold.
    pub(crate) fn denominators(&self) -> InputDrumDenominators {
        match self.input_drum_denominator_m {
            Some(length_m) => InputDrumDenominators::Same(length_m),
            None if self.paper_preset => InputDrumDenominators::Paper,
            None => InputDrumDenominators::Stated,
        }
    }
}
