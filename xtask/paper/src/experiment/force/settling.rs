//! The loop at rest when the controller's model is wrong: the model's error M is part of the loop's gain.

use haptical_model::kinematics::nalgebra::{Complex, Matrix6, SMatrix};

use super::closed_loop::{Axis, Law};

/// Eigenvalues of M within this of 1 settle at half the largest gain: a test goes round the circle.
const NEAR_ONE: f64 = 0.25;

/// Whether the proportional loop settles with the error M between wanted and exerted wrenches.
///
/// Along an eigenvector of M the loop is that of one axis with the eigenvalue in front of the command; a complex
/// one is written as the real matrix of twice the size.
pub(crate) fn settles(axis: &Axis, transmission: &Matrix6<f64>, gain: f64) -> bool {
    transmission
        .complex_eigenvalues()
        .iter()
        .filter(|value| (**value - Complex::new(1.0, 0.0)).norm() > NEAR_ONE)
        .all(|value| radius(axis, *value, gain) < 1.0)
}

/// Spectral radius of one axis whose commands come out multiplied by `factor`.
fn radius(axis: &Axis, factor: Complex<f64>, gain: f64) -> f64 {
    let plain = axis.closed(&Law::proportional(gain));
    let mut all = SMatrix::<f64, 8, 8>::zeros();
    for (row, column) in (0..4).flat_map(|row| (0..4).map(move |column| (row, column))) {
        let entry = plain[(row, column)];
        // the column of the waiting command is multiplied; a real factor leaves two equal copies
        let (real, imaginary) = if column == 3 {
            (entry * factor.re, entry * factor.im)
        } else {
            (entry, 0.0)
        };
        all[(row, column)] = real;
        all[(row + 4, column + 4)] = real;
        all[(row, column + 4)] = -imaginary;
        all[(row + 4, column)] = imaginary;
    }
    let values = all.complex_eigenvalues();
    values.iter().map(|value| value.norm()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use haptical_model::kinematics::nalgebra::Vector6;

    use super::*;
    use crate::experiment::force::closed_loop::{DAMPING, FIXTURE_N_PER_M, run};

    #[test]
    fn close_to_one_half_the_largest_gain_settles() {
        let axis = Axis::new(FIXTURE_N_PER_M, DAMPING);
        let gain = 0.5 * axis.largest_gain();
        for degree in 0..360 {
            for distance in [0.5 * NEAR_ONE, NEAR_ONE] {
                let off = Complex::from_polar(distance, f64::from(degree).to_radians());
                assert!(radius(&axis, off + 1.0, gain) < 1.0, "{degree}");
            }
        }
        // a real factor is a factor of the gain
        let double = radius(&axis, Complex::new(2.0, 0.0), 0.3);
        assert!((double - axis.spectral_radius(&Law::proportional(0.6))).abs() < 1e-9);
    }

    /// Against the loop in time, with an M whose eigenvalues are real, negative and complex.
    #[test]
    fn the_verdict_is_that_of_the_loop_in_time() {
        let axis = Axis::new(FIXTURE_N_PER_M, DAMPING);
        let gain = 0.5 * axis.largest_gain();
        let wanted = vec![Vector6::new(0.0, 0.0, 2.0, 0.5, 0.0, 0.0); 20_000];
        let quiet = vec![Vector6::zeros(); wanted.len()];
        let mut seen = [0, 0];
        for (real, imaginary) in [
            (1.0, 0.0),
            (1.9, 0.0),
            (2.1, 0.0),
            (-0.5, 0.0),
            (-3.0, 0.0),
            (1.0, 0.8),
            (1.0, 1.9),
            (0.2, 0.4),
        ] {
            let mut matrix = Matrix6::identity();
            matrix[(2, 2)] = real;
            matrix[(3, 3)] = real;
            matrix[(2, 3)] = -imaginary;
            matrix[(3, 2)] = imaginary;
            let law = Law::proportional(gain);
            let forces = run(&axis, &matrix, &law, &wanted, &quiet).measured;
            let settled = (forces[19_999] - forces[19_000]).norm() < 1e-6;
            let predicted = settles(&axis, &matrix, gain);
            assert_eq!(settled, predicted, "{real} {imaginary}");
            seen[usize::from(predicted)] += 1;
        }
        assert!(seen[0] >= 2 && seen[1] >= 3, "{seen:?}");
    }
}
