//! Simulates recordings of a device whose every number is known, to try identification on.
//!
//! The truth is itself a [`model::Device`]: [`apply_deviations`] makes it out of a nominal one,
//! [`simulate`] records random poses of it, [`simulate_transmission`] one transmission alone, and
//! [`true_poses`] says where the handle is at given readings. [`simulate_motion`] and [`record_motion`]
//! record a device that a hand moves through time, with [`Effects`] that its model leaves out.
//! [`PostureSimulation`] records single postures, at which the handle may touch points and planes or a fixture hold links.
//! [`ForwardModel`] moves a device under torques or under a [`Controller`].
//!
//! # What a seed means
//!
//! The generator is ChaCha with 8 rounds, seeded by `SeedableRng::seed_from_u64`. Its stream number
//! is kind times 2^32 plus the index of the joint or cable, from 0:
//!
//! | kind | random numbers of |
//! |---|---|
//! | 0 | poses; row k starts at word k 2^36 and draws its joints in order, again where rejected |
//! | 1 | none: kept for random noise of motor-side readings |
//! | 2 | external encoders, four words a row |
//! | 3 | cable encoders, four words a row |
//! | 4 | poses of [`simulate_transmission`], rows as for kind 0 |
//! | 5 | external encoders of [`simulate_transmission`], four words a row |
//! | 6 | targets of a hand-guided joint, two words a target, then those drawn again |
//! | 7 | external encoders of [`simulate_motion`], four words a row |
//! | 8 | cable encoders of [`simulate_motion`], four words a row |
//! | 9 | the hand's force along an axis, four words for each of its sines |
//! | 10 | roughness of a joint's drums, as kind 9; of the device's seed, not the recording's |
//! | 11 | torques, four words a row |
//! | 12 | an axis of the force sensor, four words a row |
//! | 13 | thermometer, four words a row |
//! | 14 | where a tracker stands and what it sees, where neither is known |
//! | 15, 16 | positions and orientations of [`add_tracker`] |
//! | 17, 18 | where a tracker stands in each run, where each named tool is on the hand |
//! | 19 | known distances, then known angles between touched things |
//! | 20 | touches, twelve words a posture |
//! | 21 | homing fixtures, four words a posture |
//! | 22, 23 | external encoders and cable encoders of [`PostureSimulation`], four words a row |
//! | 24, 25 | positions and orientations of [`PostureSimulation`], twelve words a row |
//! | 26 | deviations of [`draw_deviations`], in the order of the parameters |
//!
//! So one noise can be switched off, a cable added or the number of rows changed without any change
//! to the other numbers, and one seed may serve every recording of a device.
//!
//! # What is guaranteed
//!
//! The same device, settings, rows and seed give the same bits on every machine whose `f64`
//! arithmetic is IEEE 754 without excess precision (all Rust targets but 32-bit x86 without SSE2),
//! whatever other crates are compiled: integers come from ChaCha, uniform numbers are multiples of
//! 2^-53, and every function that IEEE 754 does not fix (logarithm, sine, cosine, arctangent,
//! hypot) is `libm`'s, here and in the model. Normal numbers are Box & Muller's, not `rand_distr`'s:
//! that crate calls the platform's `exp` and `ln` as soon as another crate of the build turns on
//! `num-traits/std`, as faer, nalgebra and proptest do. The test `golden` compares with committed
//! bits. A new minor version of this crate may change what a seed means; a patch may not.

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;

mod effect;
mod error;
mod forward;
mod motion;
mod poses;
mod postures;
mod sampling;
mod sensor;
mod settings;
mod simulate;
mod streams;
mod track;
mod truth;
mod waves;

pub use haptical_model as model;

pub use effect::error::EffectError;
pub use effect::names::{simulated_effects, simulated_keys};
pub use effect::{Driver, Effect, Effects};
pub use error::{Part, SimulatorError};
pub use forward::controller::{Command, Controller, ControllerFile, ControllerState};
pub use forward::step::{ForwardState, ForwardWork};
pub use forward::{ForwardModel, LONGEST_STEP_S};
pub use motion::hand_path::{JointMotion, Motion};
pub use motion::settings::{Encoders, HandMotion, MotionSettings, Temperature};
pub use motion::simulate::{MotionSimulation, record_motion, simulate_motion};
pub use postures::PostureSimulation;
pub use postures::places::with_places_of;
pub use postures::sensors::PostureSensors;
pub use settings::{CableSigma, Noise, Sampling, Settings};
pub use simulate::{simulate, simulate_transmission};
pub use track::{UNSTATED_TRACKER_SD, add_tracker};
pub use truth::{apply_deviations, draw_deviations, true_poses};
