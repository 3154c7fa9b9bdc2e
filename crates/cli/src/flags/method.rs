//! The flags of `haptical identify` as what the library is asked for.

use std::path::Path;

use haptical::{Equipment, Identify, InputDrumDenominators};
use haptical_calibration::{CalibrationMethod, HeldOut, LossChoice, Options, Weighting};
use haptical_identification::Loss;

use crate::arguments::{IdentifyArguments, LossName, MethodName, NoiseName};

impl IdentifyArguments {
    /// What is asked for.
    pub(crate) fn request(&self) -> Identify {
        Identify {
            options: self.options(),
            with: self
                .with
                .iter()
                .filter(|word| !is_gap(word))
                .cloned()
                .collect(),
            with_causes: None,
            hold: self.hold.hold.clone(),
            deviations: self.hold.deviation.clone(),
        }
    }

    /// The gap.json whose causes are fitted too.
    pub(crate) fn causes(&self) -> Option<&Path> {
        let word = self.with.iter().find(|word| is_gap(word))?;
        Some(Path::new(word))
    }

    fn options(&self) -> Options {
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

    /// What the device is read with.
    pub(crate) fn equipment(&self) -> Equipment {
        Equipment {
            denominators: match self.input_drum_denominator_m {
                Some(length_m) => InputDrumDenominators::Same(length_m),
                None if self.paper_preset => InputDrumDenominators::Paper,
                None => InputDrumDenominators::Stated,
            },
            ..self.device_options.equipment()
        }
    }
}

/// Whether what is to be fitted is named by a file.
fn is_gap(word: &str) -> bool {
    Path::new(word)
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
}

impl LossName {
    pub(crate) fn choice(self) -> LossChoice {
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
