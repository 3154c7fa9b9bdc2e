//! Integration tests of the simulator, one module per subject.

mod counts;
mod deviations;
mod device;
mod effect_file;
mod effects;
mod effects_of_structure;
mod errors;
mod forward;
mod golden;
mod hand;
mod hand_guided;
mod haptic7;
mod inertia;
mod motion;
mod noise;
mod poses;
mod postures;
mod predictions;
mod properties;
mod statistics;
mod streams;
