//! Effects between motor encoder and external encoder of a joint: that encoder and the chain see them.

pub(crate) mod backlash;
pub(crate) mod cable_pitch;
pub(crate) mod capstan_compliance;
pub(crate) mod capstan_creep;
pub(crate) mod capstan_slip;
pub(crate) mod coupled_backlash;
pub(crate) mod cross_coupling;
pub(crate) mod drum_eccentricity;
pub(crate) mod drum_out_of_round;
pub(crate) mod hysteresis;
pub(crate) mod input_drum_harmonic;
pub(crate) mod joint_drift;
pub(crate) mod ratio_error;
pub(crate) mod viscous_lag;

pub use capstan_compliance::SPEC as CAPSTAN_COMPLIANCE;
pub use drum_eccentricity::SPEC as DRUM_ECCENTRICITY;
pub use input_drum_harmonic::SPEC as INPUT_DRUM_HARMONIC;
pub use ratio_error::SPEC as RATIO_ERROR;

/// What tells a play, a spring and a late encoder of a link from each other.
pub(crate) const HOLD_THE_MOTOR: &str = "to confirm {name}: hold the motor still and load its link slowly from both sides; a play \
                                         shows as a step, a spring as a slope, and a delay not at all";
