//! One millisecond of a haptic device's controller on the runtime: readings in, motor torques out.
#![no_std]
#![forbid(unsafe_code)]

use haptical_runtime::{Model, RuntimeError};

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
