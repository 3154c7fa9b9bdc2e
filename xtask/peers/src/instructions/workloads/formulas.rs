//! Closed formulas: capstan, pose and Jacobian, a step of the control loop.

use std::hint::black_box;

use anyhow::Result;
use haptical_batch::PoseLanes;
use haptical_model::kinematics::{Chain, PreparedChain, Twist};
use haptical_model::transmission::{Capstan, CapstanError};
use haptical_runtime::Inputs;
use xtask_blind::rows;
use xtask_paper::nominal_device;

use super::{Job, Workload, spread};

/// As `haptical export --format rust` writes it, joint 4 a polynomial.
#[allow(
    unreachable_pub,
    dead_code,
    reason = "an exported module is public, and not all of it is used here"
)]
mod exported {
    include!("../../../../../crates/runtime/tests/fixtures/identified.rs");
}

/// The same with a play, a cable that stretches and a harmonic of the motor at each of three joints.
#[allow(
    unreachable_pub,
    dead_code,
    reason = "an exported module is public, and not all of it is used here"
)]
mod exported_effects {
    include!("../../../../../crates/runtime/tests/fixtures/effects.rs");
}

const JOINTS: usize = 7;
/// Calls of one formula, all at other arguments.
const CALLS: usize = 1000;

pub(crate) const WORKLOADS: [Workload; 6] = rows! {
    Workload {name what unit units is_long prepare}
    "capstan-error", "error of a capstan with slope and six derivatives, eq. (1)", "call", CALLS as u64, false, capstan_error;
    "capstan-inverse", "encoder angle for an angle of the output", "call", CALLS as u64, false, capstan_inverse;
    "pose-and-jacobian", "PreparedChain, 7 joints, one posture after the other", "pose", CALLS as u64, false, pose_and_jacobian;
    "pose-lanes", "PoseLanes, 7 joints, all postures at once", "pose", CALLS as u64, false, pose_lanes;
    "runtime-step", "one step of the control loop of the 7-joint device, with torques", "step", CALLS as u64, false, runtime_step;
    "runtime-step-effects", "the same of the device with three effects at each of three joints", "step", CALLS as u64, false, runtime_step_effects;
};

fn drive() -> Result<(Capstan, CapstanError)> {
    Ok((
        Capstan::new(8.0, 0.0675, 0.0675)?,
        CapstanError::from_polar(0.001, -0.02, 2e-4, -0.2, 2.5e-6, 2.4),
    ))
}

fn capstan_error() -> Result<Job> {
    let (drive, error) = drive()?;
    let angles_rad: Vec<f64> = (0..CALLS).map(|index| 1.5 * spread(index)).collect();
    Ok(Box::new(move || {
        for angle_rad in &angles_rad {
            black_box(drive.evaluate(&error, *angle_rad)?);
        }
        Ok(())
    }))
}

fn capstan_inverse() -> Result<Job> {
    let (drive, error) = drive()?;
    let outputs_rad: Vec<f64> = (0..CALLS).map(|index| 1.4 * spread(index)).collect();
    Ok(Box::new(move || {
        for output_rad in &outputs_rad {
            black_box(drive.invert(&error, *output_rad, [-1.6, 1.6])?);
        }
        Ok(())
    }))
}

/// Joint angles \[rad\], all of size `size_rad` at most.
fn postures(size_rad: f64) -> Vec<[f64; JOINTS]> {
    let angle = |index, joint| size_rad * spread(JOINTS * index + joint);
    (0..CALLS)
        .map(|index| std::array::from_fn(|joint| angle(index, joint)))
        .collect()
}

fn pose_and_jacobian() -> Result<Job> {
    let device = nominal_device(None)?;
    let (links, motions) = (device.chain_links(), device.motions());
    let chain = PreparedChain::<JOINTS>::new(&Chain::new(device.convention, &links, &motions)?)?;
    let mut jacobian = [Twist::default(); JOINTS];
    let postures = postures(1.2);
    Ok(Box::new(move || {
        for posture in &postures {
            black_box(chain.pose_and_jacobian(posture, &mut jacobian)?);
            black_box(&jacobian);
        }
        Ok(())
    }))
}

fn pose_lanes() -> Result<Job> {
    let device = nominal_device(None)?;
    let (links, motions) = (device.chain_links(), device.motions());
    let mut lanes = PoseLanes::<JOINTS>::new(&Chain::new(device.convention, &links, &motions)?)?;
    let postures = postures(1.2);
    let joints: [Vec<f64>; JOINTS] =
        std::array::from_fn(|joint| postures.iter().map(|posture| posture[joint]).collect());
    // makes room
    lanes.evaluate(&joints)?;
    Ok(Box::new(move || {
        lanes.evaluate(black_box(&joints))?;
        black_box(lanes.blocks());
        Ok(())
    }))
}

fn runtime_step() -> Result<Job> {
    // the polynomial of joint 4 is known within its range alone
    let readings = postures(0.6);
    Ok(Box::new(move || {
        for reading in &readings {
            let state = exported::MODEL.step(reading)?;
            black_box(state.reading_torques_nm(black_box([1.0, -2.0, 3.0]), [0.0; 3])?);
        }
        Ok(())
    }))
}

fn runtime_step_effects() -> Result<Job> {
    let inputs: Vec<Inputs<JOINTS>> = postures(0.6)
        .into_iter()
        .map(|readings| Inputs {
            torque_nm: readings,
            ..Inputs::at(readings)
        })
        .collect();
    let mut state = exported_effects::COMPENSATED.start();
    Ok(Box::new(move || {
        for inputs in &inputs {
            let device = exported_effects::COMPENSATED.forward(inputs, &mut state)?;
            black_box(device.drive_torques_nm(black_box([1.0, -2.0, 3.0]), [0.0; 3])?);
        }
        Ok(())
    }))
}
