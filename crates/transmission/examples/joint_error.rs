//! Prints the error of a capstan-driven parallelogram over its range, and the inverse.
#![allow(clippy::print_stdout, reason = "an example prints its result")]

use haptical_transmission::{Capstan, CapstanError, CapstanParallelogram, LawError, Parallelogram};

fn main() -> Result<(), LawError> {
    let joint = CapstanParallelogram {
        capstan: Capstan::new(12.0, 0.0975, 0.0975)?,
        parallelogram: Parallelogram::new([0.18, 0.076, 0.18, 0.076])?,
    };
    let (beta_o_rad, beta_i_rad) = (-40f64.to_radians(), -120f64.to_radians());
    let p = CapstanError::from_polar(0.0, 0.02, 1e-4, beta_o_rad, 2e-6, beta_i_rad);
    let deviations_m = [-0.0005, -0.0007, 0.0, 0.0];

    println!("encoder  joint error  of the loop  encoder for that joint angle");
    println!("    deg         mrad         mrad                           deg");
    for degrees in (-45..=45).step_by(15) {
        let encoder_rad = f64::from(degrees).to_radians();
        let total_rad = joint.error(&p, &deviations_m, encoder_rad)?;
        let loop_rad = total_rad - joint.capstan.error(&p, encoder_rad)?;
        let back_deg = joint
            .invert(&p, &deviations_m, encoder_rad + total_rad, [-1.0, 1.0])?
            .to_degrees();
        println!(
            "{degrees:7}  {:11.4}  {:11.4}  {back_deg:28.9}",
            1e3 * total_rad,
            1e3 * loop_rad
        );
    }
    Ok(())
}
