//! Profile-likelihood intervals against closed forms.

use haptical_identification::{
    IdentificationError, NoiseScale, Problem, Profile, Settings, Uncertainty, profiles, solve,
    uncertainty,
};

use crate::support::{Closure, Evaluation};

/// Oxygen demand over time, Marske (1967), in Bates & Watts, *Nonlinear Regression Analysis* (1988), table A1.4: the
/// textbook's example of intervals that no parabola gives.
const DAYS: [f64; 6] = [1.0, 2.0, 3.0, 4.0, 5.0, 7.0];
const DEMAND: [f64; 6] = [8.3, 10.3, 19.0, 16.0, 15.6, 19.8];

/// demand = p0 (1 - exp(-p1 days)).
fn oxygen() -> Closure<impl Fn(&[f64]) -> Result<Evaluation, IdentificationError>> {
    let row = |p: &[f64], (days, demand): (f64, f64)| {
        let rest = (-p[1] * days).exp();
        let residual = p[0] * (1.0 - rest) - demand;
        (residual, vec![1.0 - rest, p[0] * days * rest])
    };
    Closure {
        parameters: 2,
        rows: DAYS.len(),
        evaluate: move |p: &[f64]| Ok(DAYS.into_iter().zip(DEMAND).map(|at| row(p, at)).unzip()),
    }
}

/// The least sum of squares at a rate: the amplitude is a linear fit.
fn at_rate(rate: f64) -> f64 {
    let rise = DAYS.map(|days| 1.0 - (-rate * days).exp());
    let product: f64 = rise.iter().zip(DEMAND).map(|(x, y)| x * y).sum();
    let amplitude = product / rise.iter().map(|x| x * x).sum::<f64>();
    let rests = rise.iter().zip(DEMAND).map(|(x, y)| amplitude * x - y);
    rests.map(|rest| rest * rest).sum()
}

/// The least sum of squares at an amplitude: the best of a fine grid of rates.
fn at_amplitude(amplitude: f64) -> f64 {
    let square = |rate: f64| -> f64 {
        let rests = DAYS.iter().zip(DEMAND);
        let rests = rests.map(|(days, y)| amplitude * (1.0 - (-rate * days).exp()) - y);
        rests.map(|rest| rest * rest).sum()
    };
    (1..40_000)
        .map(|step| square(f64::from(step) * 1e-4))
        .fold(f64::INFINITY, f64::min)
}

fn fitted<P: Problem>(
    problem: &P,
    start: &[f64],
    noise: NoiseScale,
) -> (Vec<f64>, f64, Uncertainty, Vec<Profile>) {
    let settings = Settings::default();
    let free: Vec<usize> = (0..start.len()).collect();
    let fit = solve(problem, start, &free, &settings).unwrap();
    let spread = uncertainty(&fit.reduction, &free, fit.cost, noise).unwrap();
    let half_width = spread.half_width_95(noise);
    let found = profiles(
        problem,
        &fit.parameters,
        fit.cost,
        &spread,
        half_width,
        &settings,
    )
    .unwrap();
    (fit.parameters, fit.cost, spread, found)
}

#[test]
fn oxygen_demand_ends_where_its_profile_does() {
    let (values, cost, spread, found) = fitted(&oxygen(), &[20.0, 0.3], NoiseScale::Estimated);
    // Bates & Watts, section 2.2
    assert!(
        (values[0] - 19.143).abs() < 1e-3 && (values[1] - 0.5311).abs() < 1e-4,
        "{values:?}"
    );
    let limit = (spread.half_width_95(NoiseScale::Estimated) * spread.noise_factor).powi(2);
    assert_eq!(found.len(), 2);
    let rises = |end: Option<f64>, of: &dyn Fn(f64) -> f64, value: f64| {
        (of(value + end.unwrap()) - cost) / limit
    };
    for end in found[0].ends {
        let rise = rises(end, &at_amplitude, values[0]);
        assert!((rise - 1.0).abs() < 0.02, "{rise}");
    }
    for end in found[1].ends {
        let rise = rises(end, &at_rate, values[1]);
        assert!((rise - 1.0).abs() < 0.02, "{rise}");
    }
    // the linearised one is symmetric: it would end at 12.2 and 26.1
    let [lower, upper] = found[0].ends.map(Option::unwrap);
    assert!(upper > 2.0 * -lower, "{lower} {upper}");
}

/// One residual of one parameter: `of` and its derivative.
fn curve(
    of: impl Fn(f64) -> [f64; 2],
) -> Closure<impl Fn(&[f64]) -> Result<Evaluation, IdentificationError>> {
    Closure {
        parameters: 1,
        rows: 1,
        evaluate: move |p: &[f64]| {
            let [value, slope] = of(p[0]);
            Ok((vec![value], vec![vec![slope]]))
        },
    }
}

#[test]
fn a_profile_that_stays_low_has_no_end() {
    // a rate of 3 that reads exp(-3), to half of that: no upper limit is seen, since nothing is left at all at infinity
    let decay = curve(|p| {
        let sd = 0.6 * (-3.0_f64).exp();
        [((-p).exp() - (-3.0_f64).exp()) / sd, -(-p).exp() / sd]
    });
    let (values, _, spread, found) = fitted(&decay, &[2.5], NoiseScale::Stated);
    let [lower, upper] = found[0].ends;
    assert_eq!(upper, None);
    let truth = -((-3.0_f64).exp() * (1.0 + 0.6 * spread.half_width_95(NoiseScale::Stated))).ln();
    assert!(
        (values[0] + lower.unwrap() - truth).abs() < 0.005 * (3.0 - truth),
        "{lower:?}"
    );
}

#[test]
fn straight_models_keep_their_intervals() {
    let line = curve(|p| [(p - 2.0) / 0.1, 10.0]);
    assert_eq!(fitted(&line, &[0.0], NoiseScale::Stated).3, []);
    // slightly curved: 1 % at the ends
    let bent = curve(|p| [(p - 2.0 + 0.05 * (p - 2.0).powi(2)) / 0.1, 10.0 + (p - 2.0)]);
    assert_eq!(fitted(&bent, &[1.8], NoiseScale::Stated).3, []);
}
