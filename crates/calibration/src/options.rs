//! Options of a calibration.

use haptical_identification::{IdentifiabilityRules, Loss, Settings};

use crate::HeldOut;

/// Order of the identification.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CalibrationMethod {
    /// The paper's: transmissions from external encoders, then kinematics.
    TwoStep,
    /// All at once.
    Joint,
}

/// Degree of the polynomial that stands for a parallelogram.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Degree {
    /// As given; the paper takes 10.
    Fixed(usize),
    /// The degree from 2 to this one that the evidence (BIC) favours.
    UpTo(usize),
}

/// Where the sizes of the noise come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weighting {
    /// The device file.
    Stated,
    /// The device file first, then each channel's residuals.
    Estimated,
}

/// What large residuals cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LossChoice {
    /// Always this one; [`Loss::Squares`] is least squares.
    Fixed(Loss),
    /// Least squares, unless readings lie so far out that noise does not explain them: then Tukey's.
    #[default]
    Auto,
}

/// Options of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Two steps or all at once.
    pub method: CalibrationMethod,
    /// Polynomial degree.
    pub degree: Degree,
    /// Hold the constant offset of equation (1) at zero, as the paper's tables do: the encoders
    /// were zeroed at home.
    pub zeroed_at_home: bool,
    /// Noise sizes.
    pub weighting: Weighting,
    /// What large residuals cost.
    pub loss: LossChoice,
    /// Rows that the fit does not see.
    pub held_out: HeldOut,
    /// Search settings; their `interrupt` stops the whole calibration.
    pub search: Settings,
    /// Random places that are tried where the search from the device's own values fails or ends where no good
    /// fit ends; 0 for none.
    pub starts: usize,
    /// Take a search that ends elsewhere than at a minimum for an answer too; its `convergence` says so.
    pub unfinished: bool,
    /// Identifiability thresholds.
    pub rules: IdentifiabilityRules,
}

/// Share of the cost that a step of a slow search lowers it by at least, where its weights are not known yet: a valley that bends
/// for many steps belongs to parameters that the right weights hold.
const ROUGH: f64 = 0.01;

impl Options {
    /// The same with searches of a first round, from which weights follow.
    pub(crate) fn to_weigh(&self) -> Self {
        let mut rough = self.to_compare();
        rough.search.least_fall = rough.search.least_fall.map(|share| share.max(ROUGH));
        rough
    }

    /// The same with searches whose ends others are only compared with.
    pub(crate) fn to_compare(&self) -> Self {
        Self {
            search: self.search.to_compare(),
            ..self.clone()
        }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            method: CalibrationMethod::Joint,
            degree: Degree::UpTo(14),
            zeroed_at_home: false,
            weighting: Weighting::Estimated,
            loss: LossChoice::Fixed(Loss::Squares),
            held_out: HeldOut::default(),
            search: Settings::default(),
            starts: 12,
            unfinished: false,
            rules: IdentifiabilityRules::default(),
        }
    }
}
