//! One millisecond of a haptic device's controller on the runtime: readings in, motor torques out.
#![no_std]
#![forbid(unsafe_code)]

use haptical_runtime::{EffectState, Inputs, Model, Pose, RuntimeError};

/// Joints of the device.
pub const JOINTS: usize = 7;

/// The device, as `haptical export --format rust` wrote it.
pub mod device {
    include!("../../../crates/runtime/tests/fixtures/parallelogram.rs");
}

/// Torques that the readings see for a force that the hand shall feel, in frame (-1).
///
/// # Errors
/// [`RuntimeError`] names the joint: the controller then lets go.
#[inline(never)]
pub fn torques_nm(
    model: &Model<JOINTS>,
    readings_rad: &[f64; JOINTS],
    force_n: [f64; 3],
) -> Result<[f64; JOINTS], RuntimeError> {
    model
        .step(readings_rad)?
        .reading_torques_nm(force_n, [0.0; 3])
}

/// The same with the exported device.
///
/// # Errors
/// As [`torques_nm`].
#[inline(never)]
pub fn device_torques_nm(
    readings_rad: &[f64; JOINTS],
    force_n: [f64; 3],
) -> Result<[f64; JOINTS], RuntimeError> {
    torques_nm(&device::MODEL, readings_rad, force_n)
}

/// The same device with effects, as `haptical export --format rust` wrote it.
pub mod device_with_effects {
    include!("../../../crates/runtime/tests/fixtures/effects.rs");
}

/// A device with an effect of every kind.
pub mod every_effect {
    include!("../../../crates/runtime/tests/fixtures/every_effect.rs");
}

/// What the effects of the device remember, from one millisecond to the next.
pub type Memory = EffectState<{ device_with_effects::EFFECTS }>;

/// Torques that the drives must read for a force that the hand shall feel, effects included.
///
/// # Errors
/// As [`torques_nm`].
#[inline(never)]
pub fn compensated_torques_nm(
    inputs: &Inputs<JOINTS>,
    memory: &mut Memory,
    force_n: [f64; 3],
) -> Result<[f64; JOINTS], RuntimeError> {
    device_with_effects::COMPENSATED
        .forward(inputs, memory)?
        .drive_torques_nm(force_n, [0.0; 3])
}

/// Readings that the motors must be told for joint values.
///
/// # Errors
/// As [`torques_nm`]; where no reading gives a value.
#[inline(never)]
pub fn commands_rad(
    outputs_rad: &[f64; JOINTS],
    inputs: &Inputs<JOINTS>,
    memory: &Memory,
) -> Result<[f64; JOINTS], RuntimeError> {
    device_with_effects::COMPENSATED.inverse(outputs_rad, inputs, memory)
}

/// Readings that the motors must be told for a pose of the handle.
///
/// # Errors
/// As [`torques_nm`]; where no readings give the pose.
#[inline(never)]
pub fn commands_of_pose_rad(
    pose: &Pose,
    inputs: &Inputs<JOINTS>,
    memory: &Memory,
) -> Result<[f64; JOINTS], RuntimeError> {
    device_with_effects::COMPENSATED.inverse_pose(pose, inputs, memory)
}

/// Torques of the device with every effect.
///
/// # Errors
/// As [`torques_nm`].
#[inline(never)]
pub fn torques_with_every_effect(
    inputs: &Inputs<{ every_effect::JOINTS }>,
    memory: &mut EffectState<{ every_effect::EFFECTS }>,
    force_n: [f64; 3],
) -> Result<[f64; every_effect::JOINTS], RuntimeError> {
    every_effect::COMPENSATED
        .forward(inputs, memory)?
        .drive_torques_nm(force_n, [0.0; 3])
}

/// What a step must not contain.
#[cfg(feature = "panic-path")]
#[inline(never)]
pub fn indexed(readings_rad: &[f64], joint: usize) -> f64 {
    readings_rad[joint]
}

/// Stops: nothing here leads to it, but a program without std needs one.
#[panic_handler]
fn stop(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
