//! A problem that hands over a triangle is solved as the same problem row by row.

use haptical_identification::{
    Convergence, IdentificationError, Matrix, Method, Problem, Reduction, Settings, Triangle,
    TriangleProblem, solve,
};

/// Rounding, amplified by the condition number of the problem.
const SAME: f64 = 1e-9;

/// y = p0 exp(-p1 t) + p2 + p3 t + p4 sin(p5 t) + (p6 + `dependent`) / (1 + t)
struct Decay {
    t: Vec<f64>,
    y: Vec<f64>,
    dependent: bool,
}

const TRUTH: [f64; 8] = [2.0, 0.7, 0.3, -0.1, 0.5, 1.9, 0.8, 0.0];

fn value(p: &[f64], t: f64) -> f64 {
    let waves = p[4] * (p[5] * t).sin() + (p[6] + p[7]) / (1.0 + t);
    p[0] * (-p[1] * t).exp() + p[2] + p[3] * t + waves
}

fn decay(dependent: bool) -> Decay {
    let t: Vec<f64> = (0..60).map(|index| 0.1 * f64::from(index)).collect();
    let noise = |index: usize| 1e-3 * ((index * index) as f64).sin();
    let y = t
        .iter()
        .enumerate()
        .map(|(index, t)| value(&TRUTH, *t) + noise(index))
        .collect();
    Decay { t, y, dependent }
}

impl Problem for Decay {
    fn parameter_count(&self) -> usize {
        if self.dependent { 8 } else { 7 }
    }

    fn residual_count(&self) -> usize {
        self.t.len()
    }

    fn evaluate(
        &self,
        p: &[f64],
        residuals: &mut [f64],
        jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let mut all = [0.0; 8];
        all[..p.len()].copy_from_slice(p);
        for (row, (t, y)) in self.t.iter().zip(&self.y).enumerate() {
            residuals[row] = value(&all, *t) - y;
        }
        if let Some((free, matrix)) = jacobian {
            for (row, &t) in self.t.iter().enumerate() {
                let decay = (-p[1] * t).exp();
                let (sine, cosine) = (p[5] * t).sin_cos();
                let last = 1.0 / (1.0 + t);
                let own = [
                    decay,
                    -p[0] * t * decay,
                    1.0,
                    t,
                    sine,
                    p[4] * t * cosine,
                    last,
                    last,
                ];
                for (column, &index) in free.iter().enumerate() {
                    matrix[(row, column)] = own[index];
                }
            }
        }
        Ok(())
    }
}

/// The same, reduced before it is handed over, without the pivots' order.
struct Reduced(Decay);

impl TriangleProblem for Reduced {
    fn columns(&self) -> usize {
        self.0.parameter_count()
    }

    fn rows(&self) -> usize {
        self.0.residual_count()
    }

    fn reduce_into(
        &self,
        p: &[f64],
        free: &[usize],
        into: &mut Triangle,
    ) -> Result<(), IdentificationError> {
        let rows = self.0.residual_count();
        let mut all = vec![0.0; rows];
        let mut tall = Matrix::zeros(rows, free.len());
        self.0.evaluate(p, &mut all, Some((free, &mut tall)))?;
        let columns: Vec<&[f64]> = (0..free.len()).map(|column| tall.column(column)).collect();
        *into = Triangle::new(free.len());
        Ok(into.fold_rows(&columns, &all)?)
    }
}

#[test]
fn the_way_and_the_end_are_those_of_the_rows() {
    for method in [Method::GaussNewton, Method::LevenbergMarquardt] {
        // a strong damping, so that the damped step shows
        let settings = Settings {
            method,
            initial_damping: 0.3,
            ..Settings::default()
        };
        let free = [6, 0, 3, 1, 5, 2, 4];
        let start = [1.8, 0.8, 0.2, 0.0, 0.4, 1.8, 0.7];
        let by_rows = solve(&decay(false), &start, &free, &settings).unwrap();
        let by_triangle = solve(&Reduced(decay(false)), &start, &free, &settings).unwrap();
        assert!(
            by_rows.convergence.was_successful(),
            "{:?}",
            by_rows.convergence
        );
        assert!(by_triangle.convergence.was_successful());
        assert_eq!(by_rows.iterations, by_triangle.iterations, "{method:?}");
        for (a, b) in by_rows.parameters.iter().zip(&by_triangle.parameters) {
            assert!((a - b).abs() < SAME, "{method:?}: {a} {b}");
        }
        assert!((by_rows.cost / by_triangle.cost - 1.0).abs() < SAME);
        // one evaluation for each trial and one at the start
        assert!(by_triangle.evaluations < by_rows.evaluations);
    }
}

#[test]
fn one_damped_step_is_that_of_the_stacked_rows() {
    let settings = Settings {
        initial_damping: 0.05,
        max_iterations: 1,
        ..Settings::default()
    };
    let free: Vec<usize> = (0..7).collect();
    let start = [1.9, 0.75, 0.2, 0.0, 0.45, 1.85, 0.7];
    let by_rows = solve(&decay(false), &start, &free, &settings).unwrap();
    let by_triangle = solve(&Reduced(decay(false)), &start, &free, &settings).unwrap();
    assert_eq!(by_rows.convergence, Convergence::IterationLimit);
    for (a, b) in by_rows.parameters.iter().zip(&by_triangle.parameters) {
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
    // not the undamped step
    let undamped = Settings {
        method: Method::GaussNewton,
        ..settings
    };
    let other = solve(&decay(false), &start, &free, &undamped).unwrap();
    assert!((other.parameters[0] - by_rows.parameters[0]).abs() > 1e-6);
}

#[test]
fn dependent_parameters_are_left_to_the_pivots() {
    let free: Vec<usize> = (0..8).collect();
    let start = [1.9, 0.75, 0.2, 0.0, 0.45, 1.85, 0.7, 0.0];
    for method in [Method::GaussNewton, Method::LevenbergMarquardt] {
        let settings = Settings {
            method,
            ..Settings::default()
        };
        let by_rows = solve(&decay(true), &start, &free, &settings).unwrap();
        let by_triangle = solve(&Reduced(decay(true)), &start, &free, &settings).unwrap();
        assert_eq!(by_rows.convergence, Convergence::RankLost);
        assert_eq!(by_triangle.convergence, Convergence::RankLost);
    }
}

#[test]
fn the_reduction_of_the_fit_is_that_of_the_triangle() {
    let free: Vec<usize> = (0..7).collect();
    let start = [1.9, 0.75, 0.2, 0.0, 0.45, 1.85, 0.7];
    let settings = Settings::default();
    let by_rows = solve(&decay(false), &start, &free, &settings).unwrap();
    let by_triangle = solve(&Reduced(decay(false)), &start, &free, &settings).unwrap();
    let variance = |reduction: &Reduction| reduction.covariance(&free, 1e-13).unwrap()[(3, 3)];
    let ratio = variance(&by_rows.reduction) / variance(&by_triangle.reduction);
    assert!((ratio - 1.0).abs() < 1e-8, "{ratio}");
    assert_eq!(by_triangle.reduction.rows(), 8);
}
