//! Least squares by normal equations: columns, some with a coefficient that is known within a standard deviation.
//!
//! The columns are of rows that were whitened, and the numbers that the rows say little of are known beforehand, so that the
//! products of scaled columns are well conditioned; which combinations a motion fixes at all is for the guarded QR of
//! `haptical-linalg` to say, where somebody asks.

use std::rc::Rc;

use haptical_linalg::{Information, dot};
use nalgebra::DMatrix;

use crate::fit::column::Column;

/// Columns and their products.
#[derive(Debug, Clone)]
pub(crate) struct System {
    pub(crate) columns: Vec<Rc<Column>>,
    /// Inverse square of the standard deviation that is known of each coefficient; 0 where nothing is.
    known: Vec<f64>,
    products: DMatrix<f64>,
}

/// A solution of a system.
#[derive(Debug, Clone)]
pub(crate) struct Solved {
    /// Columns that are free, in the order of the factor.
    free: Vec<usize>,
    information: Information,
    /// Coefficients of all columns.
    pub(crate) solution: Vec<f64>,
    /// What is left of the target.
    pub(crate) rest: Vec<f64>,
    /// Half its square, and that of what is known of the free coefficients.
    pub(crate) energy: f64,
}

/// Coefficients of a system, before what they leave of a target is worked out.
#[derive(Debug, Clone)]
pub(crate) struct Coefficients {
    free: Vec<usize>,
    information: Information,
    /// Of all columns.
    pub(crate) solution: Vec<f64>,
}

impl Coefficients {
    /// The solution, with what it leaves of the target.
    pub(crate) fn solved(self, system: &System, target: &[f64]) -> Solved {
        let mut rest = target.to_vec();
        for (column, value) in system.columns.iter().zip(&self.solution) {
            if *value != 0.0 {
                column.add_to(&mut rest, -value);
            }
        }
        let known = self.free.iter();
        let known = known.map(|index| system.known[*index] * self.solution[*index].powi(2));
        Solved {
            energy: 0.5 * (dot(&rest, &rest) + known.sum::<f64>()),
            free: self.free,
            information: self.information,
            solution: self.solution,
            rest,
        }
    }
}

/// What columns would explain beside a solution.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Gain {
    /// Half the square that they take off.
    pub(crate) nats: f64,
    /// How many of them are told apart from the system and each other.
    pub(crate) rank: usize,
    /// Their coefficients, 0 of those that are not told apart.
    pub(crate) coefficients: Vec<f64>,
    /// Half the square that the last one takes off beside the others.
    pub(crate) last_nats: f64,
}

impl System {
    /// A system of columns; `known_sd`: of each coefficient, where something is known.
    pub(crate) fn new(columns: &[Rc<Column>], known_sd: &[Option<f64>]) -> Self {
        let empty = Self {
            columns: Vec::new(),
            known: Vec::new(),
            products: DMatrix::zeros(0, 0),
        };
        empty.with(columns, known_sd)
    }

    /// The same with further columns.
    pub(crate) fn with(&self, further: &[Rc<Column>], known_sd: &[Option<f64>]) -> Self {
        let mut columns = self.columns.clone();
        columns.extend(further.iter().cloned());
        let (before, count) = (self.columns.len(), columns.len());
        let mut products = DMatrix::zeros(count, count);
        products
            .view_mut((0, 0), (before, before))
            .copy_from(&self.products);
        for a in before..count {
            for b in 0..=a {
                let product = columns[a].times(&columns[b]);
                products[(a, b)] = product;
                products[(b, a)] = product;
            }
        }
        let mut known = self.known.clone();
        known.extend(known_sd.iter().map(|sd| sd.map_or(0.0, |sd| sd.powi(-2))));
        known.resize(count, 0.0);
        Self {
            columns,
            known,
            products,
        }
    }

    /// Puts another column in the place of one.
    pub(crate) fn replace(&mut self, index: usize, column: Rc<Column>) {
        self.columns[index] = column;
        for other in 0..self.columns.len() {
            let product = self.columns[index].times(&self.columns[other]);
            self.products[(index, other)] = product;
            self.products[(other, index)] = product;
        }
    }

    /// The same with what is known counted so many times.
    pub(crate) fn counting_known(mut self, times: f64) -> Self {
        self.known.iter_mut().for_each(|own| *own *= times);
        self
    }

    /// How some columns' coefficients of a solution would scatter over recordings and devices, where what is known was counted so many
    /// times: with `A = X'X + t K`, `A^-1 (m X'X + t^2 K) A^-1`, of noise whose square is `m` and of numbers that are known as
    /// `K` says.
    pub(crate) fn scatter(
        &self,
        solved: &Solved,
        columns: &[usize],
        (noise, times): (f64, f64),
    ) -> DMatrix<f64> {
        let rows = solved.inverse(columns);
        let covariance = solved.covariance(columns);
        DMatrix::from_fn(columns.len(), columns.len(), |a, b| {
            let known = (solved.free.iter().zip(rows[a].iter().zip(&rows[b])))
                .map(|(index, (a, b))| self.known[*index] * a * b)
                .sum::<f64>();
            // the system's own has the factor already
            noise * covariance[(a, b)] + (times - noise) * known
        })
    }

    /// Least squares for a target, some coefficients at given values.
    pub(crate) fn solve(&self, target: &[f64], fixed: &[Option<f64>]) -> Solved {
        self.coefficients(&self.along(target), fixed)
            .solved(self, target)
    }

    /// Products of the columns with a target.
    pub(crate) fn along(&self, target: &[f64]) -> Vec<f64> {
        self.columns.iter().map(|own| own.dot(target)).collect()
    }

    /// The coefficients of least squares, some at given values, for a target whose products with the columns are given.
    pub(crate) fn coefficients(&self, along: &[f64], fixed: &[Option<f64>]) -> Coefficients {
        let count = self.columns.len();
        let fixed_at = |index: usize| fixed.get(index).copied().flatten();
        let free: Vec<usize> = (0..count)
            .filter(|index| fixed_at(*index).is_none())
            .collect();
        let mut solution: Vec<f64> = (0..count)
            .map(|index| fixed_at(index).unwrap_or(0.0))
            .collect();
        let entry = |a: usize, b: usize| {
            let known = if a == b { self.known[free[a]] } else { 0.0 };
            self.products[(free[a], free[b])] + known
        };
        let information = Information::new(free.len(), entry);
        let held: Vec<usize> = (0..count).filter(|index| solution[*index] != 0.0).collect();
        let along = information.along(|a| {
            let of_held = held.iter();
            let of_held = of_held.map(|own| self.products[(free[a], *own)] * solution[*own]);
            along[free[a]] - of_held.sum::<f64>()
        });
        for (index, value) in free.iter().zip(information.coefficients(along)) {
            solution[*index] = value;
        }
        Coefficients {
            free,
            information,
            solution,
        }
    }

    /// Products of columns with those of the system.
    pub(crate) fn across(&self, columns: &[Rc<Column>]) -> Vec<Vec<f64>> {
        let along =
            |column: &Rc<Column>| self.columns.iter().map(|own| own.times(column)).collect();
        columns.iter().map(along).collect()
    }
}

impl Solved {
    /// Whether it determines the prediction at a row of `columns`, which are those of its system in other rows; none of those that
    /// are nothing there (A245). Columns that are fixed are known.
    pub(crate) fn determines(&self, columns: &[Option<Rc<Column>>], row: usize) -> bool {
        let entry = |at: usize| {
            columns[self.free[at]]
                .as_ref()
                .map(|column| column.at_row(row))
        };
        self.information.determines(|at| entry(at).unwrap_or(0.0))
    }

    /// Rows of the inverse of the free columns' products with what is known; zero of a column that is fixed or adds nothing.
    fn inverse(&self, columns: &[usize]) -> Vec<Vec<f64>> {
        let row = |column: &usize| match self.free.binary_search(column) {
            Ok(at) => self.information.inverse(at),
            Err(_) => vec![0.0; self.free.len()],
        };
        columns.iter().map(row).collect()
    }

    /// Covariance of some columns' coefficients, one row each; zero of those that are fixed or add nothing.
    pub(crate) fn covariance(&self, columns: &[usize]) -> DMatrix<f64> {
        let rows = self.inverse(columns);
        DMatrix::from_fn(columns.len(), columns.len(), |a, b| {
            let at = self.free.binary_search(&columns[b]);
            at.map_or(0.0, |at| rows[a][at])
        })
    }

    /// What columns would explain, `across` their products with the system's.
    pub(crate) fn gain(&self, columns: &[Rc<Column>], across: &[Vec<f64>]) -> Gain {
        self.gain_of_clear(columns, across, Information::DEPENDENT)
    }

    /// The same of columns of which the fit leaves more than the share `dependent` of their square.
    pub(crate) fn gain_of_clear(
        &self,
        columns: &[Rc<Column>],
        across: &[Vec<f64>],
        dependent: f64,
    ) -> Gain {
        let along: Vec<Vec<f64>> = (across.iter())
            .map(|products| self.information.along(|a| products[self.free[a]]))
            .collect();
        let squares: Vec<f64> = columns.iter().map(|column| column.times(column)).collect();
        let rests = Information::of_rests(&squares, dependent, |a, b| {
            let whole = if a == b {
                squares[a]
            } else {
                columns[a].times(&columns[b])
            };
            whole - dot(&along[a], &along[b])
        });
        let values = rests.along(|a| columns[a].dot(&self.rest));
        let kept = || (0..columns.len()).filter(|column| rests.is_independent(*column));
        Gain {
            nats: 0.5 * dot(&values, &values),
            rank: kept().count(),
            last_nats: kept()
                .next_back()
                .map_or(0.0, |last| 0.5 * values[last].powi(2)),
            coefficients: rests.coefficients(values),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(values: &[f64]) -> Rc<Column> {
        Rc::new(Column::All(values.to_vec()))
    }

    #[test]
    fn coefficients_and_covariances_are_those_of_least_squares() {
        let slope = Rc::new(Column::Part {
            first: 1,
            values: vec![1.0, 2.0, 3.0],
        });
        let columns = [all(&[1.0; 4]), all(&[3.0; 4]), slope];
        let system = System::new(&columns, &[None; 3]);
        // a line through 1, 2, 3, 5: 0.8 + 1.3 t, of 8.75 squares about the mean 0.3 are left
        let solved = system.solve(&[1.0, 2.0, 3.0, 5.0], &[]);
        for (found, wanted) in solved.solution.iter().zip([0.8, 0.0, 1.3]) {
            assert!((found - wanted).abs() < 1e-12, "{found}");
        }
        assert!((solved.energy - 0.15).abs() < 1e-12);
        // (X'X)^-1 of 1 and 0 to 3: 0.7, -0.3, 0.2
        let covariance = solved.covariance(&[0, 2]);
        for ((a, b), wanted) in [((0, 0), 0.7), ((0, 1), -0.3), ((1, 1), 0.2)] {
            assert!((covariance[(a, b)] - wanted).abs() < 1e-12, "{covariance}");
        }
    }

    #[test]
    fn what_is_known_counts_as_one_more_row() {
        // 1 with deviation 1 twice, and 0 with deviation 1/2: (1 + 1) / (1 + 1 + 4)
        let solved = System::new(&[all(&[1.0; 2])], &[Some(0.5)]).solve(&[1.0; 2], &[]);
        assert!((solved.solution[0] - 1.0 / 3.0).abs() < 1e-12);
        // squares 2 (2/3)^2 and 4 (1/3)^2
        assert!((solved.energy - 2.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn a_gain_is_what_a_fit_takes_off() {
        let one = all(&[1.0; 4]);
        let system = System::new(&[one], &[None]);
        let solved = system.solve(&[1.0, 2.0, 3.0, 5.0], &[]);
        let columns = [all(&[0.0, 1.0, 2.0, 3.0]), all(&[3.0, 2.0, 1.0, 0.0])];
        let found = solved.gain(&columns, &system.across(&columns));
        assert_eq!(found.rank, 1);
        assert!((found.nats - 0.5 * (8.75 - 0.3)).abs() < 1e-12, "{found:?}");
        assert!((found.coefficients[0] - 1.3).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn a_solution_scatters_by_noise_and_by_what_is_known() {
        let system = System::new(&[all(&[1.0; 4])], &[Some(0.5)]).counting_known(3.0);
        let solved = system.solve(&[1.0, 2.0, 3.0, 5.0], &[]);
        // (4 + 3 4) b = 11
        assert!((solved.solution[0] - 11.0 / 16.0).abs() < 1e-12);
        // (2 4 + 3^2 4) / 16^2
        let found = system.scatter(&solved, &[0], (2.0, 3.0))[(0, 0)];
        assert!((found - 44.0 / 256.0).abs() < 1e-12, "{found}");
        // a number that the rows fix has the covariance of least squares
        let free = System::new(&[all(&[1.0; 4])], &[None]).counting_known(3.0);
        let solved = free.solve(&[1.0, 2.0, 3.0, 5.0], &[]);
        let found = free.scatter(&solved, &[0], (2.0, 3.0))[(0, 0)];
        assert!((found - 0.5).abs() < 1e-12, "{found}");
    }

    #[test]
    fn a_column_in_the_place_of_another_is_fitted_as_if_it_had_been_there() {
        let columns = [[1.0, 1.0, 1.0], [0.0, 1.0, 2.0], [1.0, 0.0, 3.0]];
        let [one, two, three] = columns.map(|own| all(&own));
        let mut system = System::new(&[one.clone(), two], &[None, Some(2.0)]);
        system.replace(1, three.clone());
        let wanted = System::new(&[one, three], &[None, Some(2.0)]);
        let target = [1.0, 2.0, 4.0];
        assert_eq!(
            system.solve(&target, &[]).solution,
            wanted.solve(&target, &[]).solution
        );
    }

    #[test]
    fn what_is_known_pulls_and_what_is_fixed_stays() {
        let (one, two) = (all(&[1.0, 1.0]), all(&[1.0, -1.0]));
        let system = System::new(&[one, two], &[Some(0.5), None]);
        // (2 + 4) b = 6
        let solved = system.solve(&[4.0, 2.0], &[]);
        assert!(
            (solved.solution[0] - 1.0).abs() < 1e-12 && (solved.solution[1] - 1.0).abs() < 1e-12
        );
        assert!((solved.energy - 0.5 * (8.0 + 4.0)).abs() < 1e-12);
        let solved = system.solve(&[4.0, 2.0], &[Some(3.0)]);
        assert!(solved.rest.iter().all(|own| own.abs() < 1e-12));
        assert!(solved.energy.abs() < 1e-12);
    }
}
