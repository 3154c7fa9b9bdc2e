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

pub use drum_eccentricity::SPEC as DRUM_ECCENTRICITY;
pub use input_drum_harmonic::SPEC as INPUT_DRUM_HARMONIC;
pub use ratio_error::SPEC as RATIO_ERROR;
