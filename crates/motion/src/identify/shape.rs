//! Bodies about a nominal one: ten coordinates, every one of whose values is a body.
//!
//! The pseudo-inertia is `P = L U U^T L^T` (Wensing, Kim and Slotine 2018; Rucker and Wensing 2022), `L L^T` the nominal one and U lower
//! triangular with an exponential diagonal: 0 is the nominal body.

use haptical_dynamics::Inertia;
use haptical_dynamics::nalgebra::{Matrix3, Matrix4};

use crate::arm::PARAMETERS;
use crate::thresholds::identify::FLATTEST_BODY;

/// Places below the diagonal of U, behind its diagonal.
const BELOW: [(usize, usize); 6] = [(1, 0), (2, 0), (2, 1), (3, 0), (3, 1), (3, 2)];
/// A nominal body about which ten coordinates turn.
#[derive(Debug, Clone)]
pub(crate) struct Shape {
    root: Matrix4<f64>,
    /// Standard deviation of a diagonal coordinate.
    sd: f64,
}

impl Shape {
    /// Of a nominal body with a mass; a flat one is thickened.
    pub(crate) fn new(nominal: &Inertia, sd: f64) -> Option<Self> {
        let centre_m = nominal.centre_of_mass_m()?;
        let about = nominal.about_centre_kgm2();
        let second = Matrix3::from_diagonal_element(0.5 * about.trace()) - about;
        let eigen = ((second + second.transpose()) * 0.5).symmetric_eigen();
        let sum: f64 = eigen.eigenvalues.iter().map(|own| own.max(0.0)).sum();
        let least = (FLATTEST_BODY * sum).max(nominal.mass_kg * 1e-8);
        let values = eigen.eigenvalues.map(|own| own.max(least));
        let second =
            eigen.eigenvectors * Matrix3::from_diagonal(&values) * eigen.eigenvectors.transpose();
        let about = Matrix3::from_diagonal_element(second.trace()) - second;
        let sound = Inertia::about_centre(nominal.mass_kg, &centre_m, &about);
        let root = sound.pseudo_inertia().cholesky()?.l();
        Some(Self { root, sd })
    }

    fn triangle(coordinates: &[f64]) -> Matrix4<f64> {
        let mut own = Matrix4::zeros();
        (0..4).for_each(|k| own[(k, k)] = coordinates[k].exp());
        for (value, place) in coordinates[4..].iter().zip(BELOW) {
            own[place] = *value;
        }
        own
    }

    /// The ten inertial parameters of a body.
    pub(crate) fn parameters(&self, coordinates: &[f64]) -> [f64; PARAMETERS] {
        let half = self.root * Self::triangle(coordinates);
        parameters_of(&(half * half.transpose()))
    }

    /// How they change with the coordinates, one row a coordinate.
    pub(crate) fn slopes(&self, coordinates: &[f64]) -> [[f64; PARAMETERS]; PARAMETERS] {
        let own = Self::triangle(coordinates);
        let place = |k: usize| if k < 4 { (k, k) } else { BELOW[k - 4] };
        std::array::from_fn(|k| {
            let mut change = Matrix4::zeros();
            change[place(k)] = if k < 4 { coordinates[k].exp() } else { 1.0 };
            let product = self.root * change * own.transpose() * self.root.transpose();
            parameters_of(&(product + product.transpose()))
        })
    }

    /// Standard deviation of a coordinate: those below the diagonal count half in the distance between bodies.
    pub(crate) fn coordinate_sd(&self, k: usize) -> f64 {
        match k < 4 {
            true => self.sd,
            false => self.sd * std::f64::consts::SQRT_2,
        }
    }

    /// Standard deviations that the inertial parameters have by what is known beforehand.
    pub(crate) fn known_sd(&self) -> [f64; PARAMETERS] {
        let slopes = self.slopes(&[0.0; PARAMETERS]);
        std::array::from_fn(|entry| {
            let squares =
                (0..PARAMETERS).map(|k| (self.coordinate_sd(k) * slopes[k][entry]).powi(2));
            squares.sum::<f64>().sqrt()
        })
    }
}

/// The ten numbers of a pseudo-inertia.
fn parameters_of(own: &Matrix4<f64>) -> [f64; PARAMETERS] {
    let trace = own[(0, 0)] + own[(1, 1)] + own[(2, 2)];
    [
        own[(3, 3)],
        own[(0, 3)],
        own[(1, 3)],
        own[(2, 3)],
        trace - own[(0, 0)],
        trace - own[(1, 1)],
        trace - own[(2, 2)],
        -own[(0, 1)],
        -own[(0, 2)],
        -own[(1, 2)],
    ]
}
