//! Two parameters that act alike: what is said of them, and the fit without one of them.
//!
//! A joint's encoder has an offset and the link that it turns has a mounting angle; a protractor reads
//! their sum. A gravity term bends the link. Readings y = offset + mounting + ratio x + bend sin(x).
#![allow(clippy::print_stdout, reason = "an example prints its answer")]

use haptical_identification::{
    IdentifiabilityRules, IdentificationError, Matrix, NoiseScale, ParameterInfo, Problem,
    Reduction, Settings, analyse, estimates, evaluate_jacobian, solve, uncertainty,
};

/// Standard deviation of one reading.
const SIGMA_RAD: f64 = 1e-3;

struct Protractor {
    motor_rad: Vec<f64>,
    reading_rad: Vec<f64>,
}

impl Problem for Protractor {
    fn parameter_count(&self) -> usize {
        5
    }

    fn residual_count(&self) -> usize {
        self.motor_rad.len()
    }

    fn evaluate(
        &self,
        p: &[f64],
        residuals: &mut [f64],
        mut jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        for (row, (x, y)) in self.motor_rad.iter().zip(&self.reading_rad).enumerate() {
            residuals[row] = (p[0] + p[1] + p[2] * x + p[3] * x.sin() - y) / SIGMA_RAD;
            // The last parameter, a play in the gear, is not excited: the motor never turns back.
            let slopes = [1.0, 1.0, *x, x.sin(), 0.0];
            if let Some((free, matrix)) = &mut jacobian {
                for (column, &parameter) in free.iter().enumerate() {
                    matrix[(row, column)] = slopes[parameter] / SIGMA_RAD;
                }
            }
        }
        Ok(())
    }
}

fn main() -> Result<(), IdentificationError> {
    let motor_rad: Vec<f64> = (0..25).map(|k| -3.0 + 0.25 * f64::from(k)).collect();
    // Truth: offset 0.02, mounting 0.01, ratio 0.1, bend 0.004; a regular stand-in for noise.
    let reading_rad = motor_rad
        .iter()
        .map(|x| 0.03 + 0.1 * x + 0.004 * x.sin() + SIGMA_RAD * (37.0 * x).cos())
        .collect();
    let problem = Protractor {
        motor_rad,
        reading_rad,
    };
    let parameters = [
        ParameterInfo::new("encoder_offset", "rad", 0.1),
        ParameterInfo::new("mounting_angle", "rad", 0.1),
        ParameterInfo::new("transmission_ratio", "1", 0.01),
        ParameterInfo::new("bend", "rad", 0.01),
        ParameterInfo::new("gear_play", "rad", 0.01),
    ];
    let start = [0.0, 0.0, 0.09, 0.0, 0.0];

    // Which of them can these postures fix? Of a dependent set the first in the order is kept.
    let order = [0, 1, 2, 3, 4];
    let (jacobian, residuals) = evaluate_jacobian(&problem, &start, &order)?;
    let reduction = Reduction::new(&jacobian, &residuals)?;
    let rules = IdentifiabilityRules::default();
    let judged = analyse(&reduction, &parameters, &order, &rules)?;
    println!("rank {} of {}", judged.rank, parameters.len());
    for index in order {
        if let Some(reason) = judged.reason(index) {
            println!("left out: {reason}");
        }
    }

    let fit = solve(&problem, &start, &judged.independent, &Settings::default())?;
    println!("{}, S = {:.2}", fit.convergence, fit.cost);

    // All columns once more at the solution, for the variances of those that were kept.
    let (jacobian, residuals) = evaluate_jacobian(&problem, &fit.parameters, &order)?;
    let reduction = Reduction::new(&jacobian, &residuals)?;
    let noise = NoiseScale::Estimated;
    let spread = uncertainty(&reduction, &judged.independent, fit.cost, noise)?;
    for row in estimates(&parameters, &fit.parameters, &judged, &spread, noise) {
        match (row.value, row.ci95) {
            (Some(value), Some([low, high])) => println!(
                "{:20} {value:9.5} {}, 95 % from {low:.5} to {high:.5}",
                row.name, row.unit
            ),
            _ => println!("{:20} not fixed by these data", row.name),
        }
    }
    Ok(())
}
