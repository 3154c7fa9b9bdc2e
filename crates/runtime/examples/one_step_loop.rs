//! Runs many steps of the 7-DOF device, so that a counter can say what one step costs.
//!
//! ```text
//! cargo build --release -p haptical-runtime --example one_step_loop
//! valgrind --tool=callgrind target/release/examples/one_step_loop 1000
//! valgrind --tool=callgrind target/release/examples/one_step_loop 11000
//! ```
//!
//! (or `perf stat -e instructions:u` with more steps). The difference of the two counts over 10 000 is the cost of one step with its torques, the loop
//! and the change of the readings included. A second argument chooses the device: `polynomial` (joint
//! 4 as identified from a log, the default), `parallelogram` (joint 4 by equation (2)), `costliest`
//! (a capstan and a parallelogram at every joint: no device of seven joints takes more), `effects` (a play, a cable that
//! stretches and a harmonic of the motor at each of three joints).
#![allow(
    clippy::print_stdout,
    unreachable_pub,
    dead_code,
    reason = "an example prints, and an exported module is public"
)]

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use haptical_runtime::{
    Capstan, Convention, Inputs, Joint, Link, Model, Motion, Parallelogram, Transmission,
};

/// As `haptical export --format rust` writes it.
mod polynomial {
    include!("../tests/fixtures/identified.rs");
}
/// The same device with a parallelogram at joint 4.
mod parallelogram {
    include!("../tests/fixtures/parallelogram.rs");
}
/// The same device with three effects at three joints.
mod effects {
    include!("../tests/fixtures/effects.rs");
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let steps: u32 = match arguments.next() {
        Some(steps) => steps.parse()?,
        None => 1_000_000,
    };
    let device = arguments.next().unwrap_or_else(|| "polynomial".to_owned());
    if device == "effects" {
        return with_effects(steps);
    }
    let costliest = seven_parallelograms()?;
    let model: &Model<7> = match device.as_str() {
        "polynomial" => &polynomial::MODEL,
        "parallelogram" => &parallelogram::MODEL,
        "costliest" => &costliest,
        other => return Err(format!("there is no device `{other}`").into()),
    };
    let start = Instant::now();
    let mut readings = [0.3, -0.2, 0.4, -0.5, 0.6, -0.7, 0.8];
    let mut sum_nm = 0.0;
    for _ in 0..steps {
        for reading in &mut readings {
            *reading = 1e-7 - *reading;
        }
        let state = model.step(black_box(&readings))?;
        let torques_nm = state.reading_torques_nm(black_box([1.0, -2.0, 3.0]), [0.0; 3])?;
        sum_nm += black_box(&torques_nm)[0];
    }
    println!(
        "{device}: {steps} steps, mean torque of joint 1 {:.6} Nm, {:.0} ns per step",
        sum_nm / f64::from(steps),
        start.elapsed().as_secs_f64() * 1e9 / f64::from(steps)
    );
    Ok(())
}

/// Steps of the device with effects.
fn with_effects(steps: u32) -> Result<(), Box<dyn Error>> {
    let model = &effects::COMPENSATED;
    let mut state = model.start();
    let mut inputs = Inputs::at([0.3, -0.2, 0.4, -0.5, 0.6, -0.7, 0.8]);
    inputs.torque_nm = [0.5; 7];
    let start = Instant::now();
    let mut sum_nm = 0.0;
    for _ in 0..steps {
        for reading in &mut inputs.readings {
            *reading = 1e-7 - *reading;
        }
        let device = model.forward(black_box(&inputs), &mut state)?;
        let torques_nm = device.drive_torques_nm(black_box([1.0, -2.0, 3.0]), [0.0; 3])?;
        sum_nm += black_box(&torques_nm)[0];
    }
    println!(
        "effects: {steps} steps, mean torque of joint 1 {:.6} Nm, {:.0} ns per step",
        sum_nm / f64::from(steps),
        start.elapsed().as_secs_f64() * 1e9 / f64::from(steps)
    );
    Ok(())
}

fn seven_parallelograms() -> Result<Model<7>, haptical_runtime::DeviceError> {
    let capstan = Capstan {
        transmission_ratio: 12.0,
        drum_distance_m: 0.0975,
        input_drum_denominator_m: 0.0975,
        offset: 1e-5,
        ratio_deviation: 0.02,
        output_drum_xy_m: [1e-4, -2e-4],
        input_drum_xy_m: [3e-6, 2e-6],
    };
    let joint = Joint {
        motion: Motion::Revolute,
        home: 0.2,
        transmission: Transmission::Parallelogram(Parallelogram {
            capstan,
            lengths_m: [0.18, 0.0755, 0.1793, 0.076],
        }),
    };
    let row = Link {
        a_m: 0.1,
        alpha_rad: 1.5,
        d_m: 0.2,
        theta_rad: 0.0,
        beta_rad: 0.01,
        b_m: 0.0,
    };
    Model::new(Convention::Standard, row, [row; 7], [joint; 7])
}
