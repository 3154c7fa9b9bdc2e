//! Integration tests of `haptical-calibration`, in one binary.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "clippy.toml allows them in test functions; helpers of tests are meant too"
)]

mod added;
mod agreement;
mod chain;
mod conventions;
mod counts;
mod dense;
mod derivatives;
mod deviations;
mod evidence;
mod force_direction;
mod frame_origins;
mod hands;
mod haptic;
mod held_out;
mod held_partners;
mod in_bulk;
mod incomplete;
mod intervals;
mod invariance;
mod joint_lanes;
mod known_distance;
mod length_scale;
mod measured;
mod mistaken_columns;
mod multi_start;
mod null_space;
mod parallel_joints;
mod planted;
mod postures;
mod profiled;
mod recovery;
mod refusals;
mod rig;
mod rig_rank;
mod rig_recovery;
mod rig_scene;
mod robust;
mod scale;
mod short_logs;
mod statistics;
mod warnings;
mod work;
