//! The library from outside: every example holds, what is written is what the command writes, errors have three parts.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test that cannot go on fails there"
)]

mod absent_effects;
mod bent_base;
mod budget;
#[path = "../../examples/capstan.rs"]
mod capstan;
mod commands_and_outputs;
#[path = "../../examples/control_loop.rs"]
mod control_loop;
#[path = "../../examples/diagnosis.rs"]
mod diagnosis;
mod errors;
mod exports;
mod exports_control;
mod exports_listed;
mod fast_counts;
#[path = "../../examples/fleet.rs"]
mod fleet;
mod forward;
mod forward_drives;
mod late_encoders;
mod lost_counts;
mod moved;
mod moving_sets;
#[path = "../../examples/next_poses.rs"]
mod next_poses;
#[path = "../../examples/own_effect.rs"]
mod own_effect;
mod replay;
mod simulated_rigs;
mod so101;
#[path = "../../examples/tracker.rs"]
mod tracker;
mod tracker_scale;
#[path = "../../examples/two_step.rs"]
mod two_step;
mod watch;

#[test]
fn a_capstan_is_identified_from_its_external_encoder() {
    capstan::main().unwrap();
}

#[test]
fn a_control_loop_runs_on_the_calibrated_model() {
    control_loop::main().unwrap();
}

#[test]
fn a_stretching_cable_is_named() {
    diagnosis::main().unwrap();
}

#[test]
fn many_devices_give_the_same_numbers_in_parallel() {
    fleet::main().unwrap();
}

#[test]
fn the_next_poses_are_better_than_random_ones() {
    next_poses::main().unwrap();
}

#[test]
fn an_effect_of_the_caller_is_named() {
    own_effect::main().unwrap();
}

#[test]
fn a_tracker_at_an_unknown_place_calibrates_a_device() {
    tracker::main().unwrap();
}

#[test]
fn two_steps_calibrate_transmissions_and_kinematics() {
    two_step::main().unwrap();
}
