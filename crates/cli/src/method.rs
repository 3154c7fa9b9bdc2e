//! From flags to the calibration's options, and back to words.

use haptical_calibration::{CalibrationMethod, Degree, HeldOut, LossChoice, Options, Weighting};
use haptical_identification::Loss;

use crate::arguments::{IdentifyArguments, LossName, MethodName, NoiseName};
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
            loss: self.loss.choice(),
            held_out: match self.folds {
                Some(folds) => HeldOut::Folds(folds as usize),
                None if self.held_out > 0.0 => HeldOut::Share(self.held_out),
                None => HeldOut::None,
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

impl LossName {
    fn choice(self) -> LossChoice {
        LossChoice::Fixed(match self {
            Self::Auto => return LossChoice::Auto,
            Self::Squares => Loss::Squares,
            Self::Huber => Loss::Huber,
            Self::Cauchy => Loss::Cauchy,
            Self::Tukey => Loss::Tukey,
            Self::StudentT => Loss::StudentT,
        })
    }
}

/// A loss as the flag takes it.
pub(crate) fn loss_text(loss: LossName) -> String {
    match loss.choice() {
        LossChoice::Auto => "auto".to_owned(),
        LossChoice::Fixed(loss) => loss.to_string(),
    }
}

/// A degree as the flag takes it.
pub(crate) fn degree_text(degree: Degree) -> String {
    match degree {
        Degree::Fixed(degree) => degree.to_string(),
        Degree::UpTo(_) => "evidence".to_owned(),
    }
}
