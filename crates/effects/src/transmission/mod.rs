//! Effects between motor encoder and external encoder of a joint: that encoder and the chain see them.

pub(crate) mod backlash;
pub(crate) mod cable_pitch;
pub(crate) mod capstan_compliance;
pub(crate) mod capstan_creep;
pub(crate) mod capstan_slip;
pub(crate) mod cross_coupling;
pub(crate) mod drum_eccentricity;
pub(crate) mod drum_out_of_round;
pub(crate) mod hysteresis;
pub(crate) mod input_drum_harmonic;
pub(crate) mod joint_drift;
pub(crate) mod joint_warming;
pub(crate) mod ratio_error;
pub(crate) mod viscous_lag;

pub use backlash::SPEC as BACKLASH;
pub use cable_pitch::SPEC as CABLE_PITCH;
pub use capstan_compliance::SPEC as CAPSTAN_COMPLIANCE;
pub use capstan_creep::SPEC as CAPSTAN_CREEP;
pub use capstan_slip::SPEC as CAPSTAN_SLIP;
pub use cross_coupling::SPEC as CROSS_COUPLING;
pub use drum_eccentricity::SPEC as DRUM_ECCENTRICITY;
pub use drum_out_of_round::SPEC as DRUM_OUT_OF_ROUND;
pub use hysteresis::SPEC as HYSTERESIS;
pub use input_drum_harmonic::SPEC as INPUT_DRUM_HARMONIC;
pub use joint_drift::SPEC as JOINT_DRIFT;
pub use joint_warming::SPEC as JOINT_WARMING;
pub use ratio_error::SPEC as RATIO_ERROR;
pub use viscous_lag::SPEC as VISCOUS_LAG;
