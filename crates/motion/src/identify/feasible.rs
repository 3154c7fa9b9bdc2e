//! The set of masses, centres and inertias that some bodies can have, nearest to the nominal one, that has the base parameters.
//!
//! Gauss and Newton over the coordinates of `shape`; docs/equations.md, Identification of a moving arm.

use haptical_dynamics::Inertia;
use nalgebra::{DMatrix, DVector, Matrix4};

use crate::MotionError;
use crate::arm::PARAMETERS;
use crate::identify::shape::Shape;
use crate::thresholds::identify::{
    COORDINATE_TOLERANCE, EIGENVALUE_ROUNDING, GAUSS_NEWTON_STEPS, MOMENT_ROUNDING,
};

/// What a number is to the search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    /// A body's inertial parameter.
    Body { shape: usize, entry: usize },
    /// A number of its own: its deviation is no less than this, and known with this standard deviation where it is.
    Own { least: f64, known_sd: Option<f64> },
}

/// A feasible set.
#[derive(Debug, Clone)]
pub(crate) struct Feasible {
    /// Deviations of all numbers from the nominal ones.
    pub(crate) values: Vec<f64>,
    /// Standard deviations, by the rows and what is known beforehand.
    pub(crate) sd: Vec<f64>,
}

/// Coordinates of the search: ten of each shape, then one of each number of its own.
struct Search<'a> {
    shapes: &'a [Shape],
    nominal: &'a [[f64; PARAMETERS]],
    kinds: &'a [Kind],
    own: Vec<usize>,
    /// `root * map`: what squares are by deviations of all numbers.
    rows: DMatrix<f64>,
    right: DVector<f64>,
}

/// The feasible set nearest to the nominal one that has the base parameters `map x = values`, whose squares are those of `root`.
///
/// # Errors
/// [`MotionError::Fit`] where no step is found.
pub(crate) fn nearest(
    (shapes, nominal): (&[Shape], &[[f64; PARAMETERS]]),
    kinds: &[Kind],
    map: &DMatrix<f64>,
    (root, values): (&DMatrix<f64>, &DVector<f64>),
) -> Result<Feasible, MotionError> {
    let own = (0..kinds.len()).filter(|k| matches!(kinds[*k], Kind::Own { .. }));
    let search = Search {
        shapes,
        nominal,
        kinds,
        own: own.collect(),
        rows: root * map,
        right: root * values,
    };
    let mut held = vec![false; search.count()];
    let mut at = DVector::zeros(search.count());
    loop {
        at = search.descend(at, &held)?;
        let below: Vec<usize> = (0..search.own.len())
            .filter(|k| match kinds[search.own[*k]] {
                Kind::Own { least, .. } => at[PARAMETERS * shapes.len() + k] < least,
                Kind::Body { .. } => false,
            })
            .collect();
        if below.is_empty() {
            break;
        }
        // a number that would be below its least is there
        for k in below {
            let place = PARAMETERS * shapes.len() + k;
            if let Kind::Own { least, .. } = kinds[search.own[k]] {
                at[place] = least;
                held[place] = true;
            }
        }
    }
    search.finished(&at, &held)
}

impl Search<'_> {
    fn count(&self) -> usize {
        PARAMETERS * self.shapes.len() + self.own.len()
    }

    fn coordinates<'c>(&self, at: &'c DVector<f64>, shape: usize) -> &'c [f64] {
        &at.as_slice()[PARAMETERS * shape..][..PARAMETERS]
    }

    /// Deviations of all numbers, and how they change with the coordinates.
    fn deviations(&self, at: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let mut values = DVector::zeros(self.kinds.len());
        let mut slopes = DMatrix::zeros(self.kinds.len(), self.count());
        let all: Vec<_> = (0..self.shapes.len())
            .map(|k| {
                let own = self.coordinates(at, k);
                (self.shapes[k].parameters(own), self.shapes[k].slopes(own))
            })
            .collect();
        for (number, kind) in self.kinds.iter().enumerate() {
            if let Kind::Body { shape, entry } = *kind {
                let (parameters, changes) = &all[shape];
                values[number] = parameters[entry] - self.nominal[shape][entry];
                for k in 0..PARAMETERS {
                    slopes[(number, PARAMETERS * shape + k)] = changes[k][entry];
                }
            }
        }
        for (k, number) in self.own.iter().enumerate() {
            let place = PARAMETERS * self.shapes.len() + k;
            values[*number] = at[place];
            slopes[(*number, place)] = 1.0;
        }
        (values, slopes)
    }

    /// Inverse standard deviation of what is known of a coordinate.
    fn known(&self, place: usize) -> f64 {
        let bodies = PARAMETERS * self.shapes.len();
        if place < bodies {
            let shape = &self.shapes[place / PARAMETERS];
            return 1.0 / shape.coordinate_sd(place % PARAMETERS);
        }
        match self.kinds[self.own[place - bodies]] {
            Kind::Own { known_sd, .. } => known_sd.map_or(0.0, |sd| 1.0 / sd),
            Kind::Body { .. } => 0.0,
        }
    }

    /// Infinite where rounding leaves no body of one of the shapes; but for rounding every coordinate has one.
    fn cost(&self, at: &DVector<f64>) -> f64 {
        let are_bodies = (0..self.shapes.len())
            .all(|k| is_body(self.shapes[k].parameters(self.coordinates(at, k))));
        if !are_bodies {
            return f64::INFINITY;
        }
        let (values, _) = self.deviations(at);
        let known: f64 = (0..at.len()).map(|k| (self.known(k) * at[k]).powi(2)).sum();
        (&self.rows * values - &self.right).norm_squared() + known
    }

    /// Normal matrix and slope of the cost at coordinates.
    fn normal(&self, at: &DVector<f64>, held: &[bool]) -> (DMatrix<f64>, DVector<f64>) {
        let (values, slopes) = self.deviations(at);
        let jacobian = &self.rows * slopes;
        let rest = &self.rows * values - &self.right;
        let mut normal = jacobian.transpose() * &jacobian;
        let mut slope = jacobian.transpose() * rest;
        for k in 0..at.len() {
            let known = self.known(k).powi(2);
            normal[(k, k)] += known;
            slope[k] += known * at[k];
        }
        for k in (0..at.len()).filter(|k| held[*k]) {
            normal.row_mut(k).fill(0.0);
            normal.column_mut(k).fill(0.0);
            normal[(k, k)] = 1.0;
            slope[k] = 0.0;
        }
        (normal, slope)
    }

    /// Gauss and Newton, damped (Marquardt 1963).
    fn descend(&self, start: DVector<f64>, held: &[bool]) -> Result<DVector<f64>, MotionError> {
        let mut at = start;
        let mut cost = self.cost(&at);
        let mut damping = 1e-6;
        for _ in 0..GAUSS_NEWTON_STEPS {
            let (normal, slope) = self.normal(&at, held);
            let mut step = None;
            while damping < 1e12 {
                let mut damped = normal.clone();
                (0..at.len()).for_each(|k| damped[(k, k)] *= 1.0 + damping);
                let tried = solved(&damped, &slope).map(|own| (&at - &own, own));
                let tried = tried.map(|(next, own)| (self.cost(&next), next, own));
                if let Some(found) = tried.filter(|own| own.0 <= cost) {
                    damping = (damping * 0.1).max(1e-12);
                    step = Some(found);
                    break;
                }
                damping *= 10.0;
            }
            let Some((less, next, moved)) = step else {
                break;
            };
            let bodies = &moved.as_slice()[..PARAMETERS * self.shapes.len()];
            let largest = bodies.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
            let is_settled = largest < COORDINATE_TOLERANCE
                && cost - less <= COORDINATE_TOLERANCE * (1.0 + cost);
            (at, cost) = (next, less);
            if is_settled {
                break;
            }
        }
        match cost.is_finite() {
            true => Ok(at),
            false => Err(MotionError::Fit("no feasible bodies were found".to_owned())),
        }
    }

    fn finished(&self, at: &DVector<f64>, held: &[bool]) -> Result<Feasible, MotionError> {
        let (values, mut slopes) = self.deviations(at);
        let (normal, _) = self.normal(at, held);
        for k in (0..at.len()).filter(|k| held[*k]) {
            slopes.column_mut(k).fill(0.0);
        }
        let scale: Vec<f64> = (0..at.len())
            .map(|k| normal[(k, k)].sqrt().max(1e-300))
            .collect();
        let scaled = DMatrix::from_fn(at.len(), at.len(), |a, b| {
            normal[(a, b)] / (scale[a] * scale[b])
        });
        let inverse = scaled
            .cholesky()
            .ok_or_else(|| MotionError::Fit("no interval of the bodies was found".to_owned()))?
            .inverse();
        let sd = |number: usize| {
            let own = DVector::from_fn(at.len(), |k, _| slopes[(number, k)] / scale[k]);
            (&inverse * &own).dot(&own).max(0.0).sqrt()
        };
        Ok(Feasible {
            sd: (0..self.kinds.len()).map(sd).collect(),
            values: values.as_slice().to_vec(),
        })
    }
}

/// Whether ten numbers are a body's, with room for their rounding: its pseudo-inertia, scaled to a unit diagonal, is positive definite.
fn is_body(parameters: [f64; PARAMETERS]) -> bool {
    let mut pseudo = Inertia::from_parameters(parameters).pseudo_inertia();
    let moments = pseudo[(0, 0)] + pseudo[(1, 1)] + pseudo[(2, 2)];
    (0..3).for_each(|axis| pseudo[(axis, axis)] -= MOMENT_ROUNDING * moments);
    let scale = pseudo.diagonal().map(f64::sqrt);
    let scaled = Matrix4::from_fn(|a, b| {
        let own = pseudo[(a, b)] / (scale[a] * scale[b]);
        if a == b {
            own - EIGENVALUE_ROUNDING
        } else {
            own
        }
    });
    scaled.iter().all(|own| own.is_finite()) && scaled.cholesky().is_some()
}

/// A symmetric system, scaled to a unit diagonal.
fn solved(matrix: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    let count = right.len();
    let scale: Vec<f64> = (0..count)
        .map(|k| matrix[(k, k)].sqrt().max(1e-300))
        .collect();
    let scaled = DMatrix::from_fn(count, count, |a, b| matrix[(a, b)] / (scale[a] * scale[b]));
    let right = DVector::from_fn(count, |k, _| right[k] / scale[k]);
    let mut found = scaled.cholesky()?.solve(&right);
    (0..count).for_each(|k| found[k] /= scale[k]);
    Some(found)
}

#[cfg(test)]
mod tests {
    use haptical_dynamics::nalgebra::{Matrix3, Vector3};
    use proptest::prelude::*;

    use super::*;
    use crate::thresholds::identify::GIVEN_BODY_SD;

    fn nominal() -> Inertia {
        let about = Matrix3::new(0.03, 0.002, 0.0, 0.002, 0.05, 0.001, 0.0, 0.001, 0.04);
        Inertia::about_centre(2.5, &Vector3::new(0.1, -0.05, 0.2), &about)
    }

    fn is_positive(parameters: [f64; PARAMETERS]) -> bool {
        let body = Inertia::from_parameters(parameters);
        body.mass_kg > 0.0 && body.pseudo_inertia().cholesky().is_some()
    }

    proptest! {
        #[test]
        fn every_vector_of_coordinates_is_a_body(at in prop::array::uniform10(-1.5..1.5_f64)) {
            let shape = Shape::new(&nominal(), GIVEN_BODY_SD).unwrap();
            prop_assert!(is_positive(shape.parameters(&at)));
        }

        #[test]
        fn slopes_are_those_of_finite_differences(at in prop::array::uniform10(-0.8..0.8_f64)) {
            let shape = Shape::new(&nominal(), GIVEN_BODY_SD).unwrap();
            let slopes = shape.slopes(&at);
            for k in 0..PARAMETERS {
                let moved = |by: f64| {
                    let mut at = at;
                    at[k] += by;
                    shape.parameters(&at)
                };
                let (ahead, behind) = (moved(1e-6), moved(-1e-6));
                for entry in 0..PARAMETERS {
                    let wanted = (ahead[entry] - behind[entry]) / 2e-6;
                    prop_assert!((slopes[k][entry] - wanted).abs() < 1e-6 * (1.0 + wanted.abs()));
                }
            }
        }

        /// Whatever is asked for, in whatever combinations: negative masses and inertias too.
        #[test]
        fn what_is_found_is_a_body_and_no_further_than_asked(
            wanted in prop::array::uniform4(-5.0..5.0_f64),
            mix in prop::collection::vec(-1.0..1.0_f64, 40),
        ) {
            let shape = Shape::new(&nominal(), GIVEN_BODY_SD).unwrap();
            let nominal = nominal().parameters();
            let map = DMatrix::from_fn(4, PARAMETERS, |row, column| mix[PARAMETERS * row + column]);
            let kinds: Vec<Kind> = (0..PARAMETERS).map(|entry| Kind::Body { shape: 0, entry }).collect();
            let root = DMatrix::identity(4, 4) * 100.0;
            let wanted = DVector::from_column_slice(&wanted);
            let found = nearest((&[shape], &[nominal]), &kinds, &map, (&root, &wanted)).unwrap();
            let values: [f64; PARAMETERS] = std::array::from_fn(|k| nominal[k] + found.values[k]);
            prop_assert!(is_positive(values), "{values:?}");
            let left = &map * DVector::from_vec(found.values) - &wanted;
            prop_assert!(left.norm() <= wanted.norm() * (1.0 + 1e-9));
        }
    }

    #[test]
    fn nothing_asked_for_is_the_nominal_body() {
        let shape = Shape::new(&nominal(), GIVEN_BODY_SD).unwrap();
        for (found, wanted) in shape
            .parameters(&[0.0; 10])
            .iter()
            .zip(nominal().parameters())
        {
            assert!((found - wanted).abs() < 1e-14, "{found}, {wanted}");
        }
    }

    #[test]
    fn what_a_body_can_have_is_realised_and_an_armature_is_not_negative() {
        let shape = Shape::new(&nominal(), GIVEN_BODY_SD).unwrap();
        let nominal = nominal().parameters();
        let mut kinds: Vec<Kind> = (0..PARAMETERS)
            .map(|entry| Kind::Body { shape: 0, entry })
            .collect();
        kinds.push(Kind::Own {
            least: -0.1,
            known_sd: Some(0.1),
        });
        // mass, and the inertia about z with the armature: of the latter far less than the armature has
        let map = DMatrix::from_fn(2, 11, |row, column| match (row, column) {
            (0, 0) | (1, 6 | 10) => 1.0,
            _ => 0.0,
        });
        let root = DMatrix::identity(2, 2) * 1e5;
        let wanted = DVector::from_column_slice(&[0.4, -0.12]);
        let found = nearest((&[shape], &[nominal]), &kinds, &map, (&root, &wanted)).unwrap();
        assert!((found.values[0] - 0.4).abs() < 1e-6, "{:?}", found.values);
        assert!((found.values[6] + found.values[10] + 0.12).abs() < 1e-6);
        assert!(found.values[10] >= -0.1);
    }
}
