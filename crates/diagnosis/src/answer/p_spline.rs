//! Curves with a penalty on their bends (P-splines, Eilers & Marx 1996): the smoothness that predicts rows best that the fit did
//! not see (docs/diagnosis-corrections.md).

use haptical_judge::closed_share;
use haptical_linalg::{NormalEquations, NormalSolution};

use crate::thresholds::answer::{FOLDS, PARTS, PENALTIES, PULL};

/// Second differences of the coefficients are penalised.
const DIFFERENCE: [f64; 3] = [1.0, -2.0, 1.0];

/// Products of a curve's whitened columns with each other and with the readings, part by part.
pub(crate) struct Normal {
    parts: Vec<Part>,
}

#[derive(Clone)]
struct Part {
    sums: NormalEquations,
    rows: f64,
}

/// A curve that predicts unseen rows best.
pub(crate) struct Smooth {
    pub(crate) coefficients: Vec<f64>,
    /// Numbers that the data decide of them: the trace of the smoother (Eilers & Marx 1996, eq. 30).
    pub(crate) effective: f64,
    /// Squares of the rows that the fits did not see, over their noise, without the curve and with it; part by part.
    pub(crate) unseen: Vec<[f64; 2]>,
    /// Number of those rows.
    pub(crate) rows: f64,
}

impl Part {
    fn empty(size: usize) -> Self {
        Self {
            sums: NormalEquations::new(size),
            rows: 0.0,
        }
    }

    /// Every coefficient, fitted with a penalty on the second differences; `scale` is what the data say of one.
    fn fit(&self, scale: f64, penalty: f64) -> NormalSolution {
        let mut sums = self.sums.clone();
        let size = sums.columns();
        let weight = (penalty * scale).sqrt();
        for first in 0..(size + 1).saturating_sub(DIFFERENCE.len()) {
            let mut row = vec![0.0; size + 1];
            for (place, factor) in DIFFERENCE.iter().enumerate() {
                row[first + place] = weight * factor;
            }
            sums.add_row(&row);
        }
        sums.solve(&(0..size).collect::<Vec<_>>(), |_| PULL * scale)
    }

    /// Squares of what coefficients leave.
    fn left(&self, coefficients: &[f64]) -> f64 {
        let all: Vec<usize> = (0..coefficients.len()).collect();
        self.sums.left(&all, coefficients)
    }
}

impl Normal {
    /// Of a curve of so many coefficients.
    pub(crate) fn new(size: usize) -> Self {
        Self {
            parts: vec![Part::empty(size); PARTS],
        }
    }

    /// Adds a reading of a part with its row of all columns.
    pub(crate) fn add(&mut self, part: usize, row: &[f64], reading: f64) {
        let part = &mut self.parts[part.min(PARTS - 1)];
        let whole: Vec<f64> = row.iter().copied().chain([reading]).collect();
        part.sums.add_row(&whole);
        part.rows += 1.0;
    }

    /// The sum of the parts that are picked.
    fn sum(&self, is_in: impl Fn(usize) -> bool) -> Part {
        let mut sum = Part::empty(self.parts[0].sums.columns());
        let parts = self.parts.iter().enumerate();
        for (_, part) in parts.filter(|(index, _)| is_in(*index)) {
            sum.sums.add(&part.sums, 1.0);
            sum.rows += part.rows;
        }
        sum
    }

    /// The curve whose penalty predicts unseen rows best; none where nothing decides it.
    pub(crate) fn smooth(&self) -> Option<Smooth> {
        let whole = self.sum(|_| true);
        let size = whole.sums.columns();
        let trace: f64 = (0..size).map(|at| whole.sums.product(at, at)).sum();
        let scale = trace / size as f64;
        if !(scale > 0.0 && scale.is_finite()) {
            return None;
        }
        let folds: Vec<Part> = (0..FOLDS)
            .map(|fold| self.sum(|part| part % FOLDS != fold))
            .collect();
        let unseen = |penalty: f64| {
            let solved: Vec<_> = folds.iter().map(|seen| seen.fit(scale, penalty)).collect();
            let parts = self.parts.iter().enumerate();
            let left = parts.map(|(index, part)| part.left(solved[index % FOLDS].coefficients()));
            left.collect::<Vec<f64>>()
        };
        let penalties = (0..=PENALTIES).map(|step| 10.0_f64.powf(0.5 * f64::from(step) - 4.0));
        let tried = penalties.map(|penalty| (penalty, unseen(penalty)));
        let total = |left: &[f64]| left.iter().sum::<f64>();
        let (penalty, with) = tried.min_by(|a, b| total(&a.1).total_cmp(&total(&b.1)))?;
        let fit = whole.fit(scale, penalty);
        let inverse = fit.inverse();
        let row = |a: usize| (0..size).map(move |b| (a, b));
        let smoother = (0..size)
            .flat_map(row)
            .map(|(a, b)| inverse[(a, b)] * whole.sums.product(a, b));
        let without = self.parts.iter().map(|part| part.sums.target_square());
        Some(Smooth {
            coefficients: fit.coefficients().to_vec(),
            effective: smoother.sum(),
            unseen: without.zip(with).map(|(a, b)| [a, b]).collect(),
            rows: whole.rows,
        })
    }
}

impl Smooth {
    /// The sum of what the parts gain over the root of its squares: standard normal at most, were the signs of the gains those of
    /// coins (sign flips; Fisher 1935).
    pub(crate) fn gain_sd(&self) -> f64 {
        let gains = || self.unseen.iter().map(|[without, with]| without - with);
        let squares: f64 = gains().map(|gain| gain * gain).sum();
        self.gain() / squares.sqrt().max(f64::MIN_POSITIVE)
    }

    /// Squares that unseen rows lose.
    pub(crate) fn gain(&self) -> f64 {
        self.unseen
            .iter()
            .map(|[without, with]| without - with)
            .sum()
    }

    /// Share of the squares beyond noise that they lose; 0 where there are none beyond noise.
    pub(crate) fn share(&self) -> f64 {
        let [before, after] =
            [0, 1].map(|of| self.unseen.iter().map(|own| own[of]).collect::<Vec<_>>());
        match before.iter().sum::<f64>() > self.rows {
            true => closed_share(&before, &after, self.rows).share,
            false => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use haptical_model::transmission::spline::{Splines, curve};

    use super::*;

    /// Numbers that pass for normal deviates, from a linear congruence (Lehmer 1951).
    struct Deviates(u64);

    impl Deviates {
        fn next(&mut self) -> f64 {
            let mut sum = -6.0;
            for _ in 0..12 {
                self.0 = self
                    .0
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                sum += (self.0 >> 11) as f64 / (1u64 << 53) as f64;
            }
            sum
        }
    }

    const COUNT: usize = 43;

    /// 4000 readings of a law with unit noise along a path to and fro.
    fn read(law: impl Fn(f64) -> f64) -> Smooth {
        let mut normal = Normal::new(COUNT);
        let mut noise = Deviates(7);
        for row in 0..4000 {
            let place = (0.011 * f64::from(row)).sin();
            let splines = Splines::at(place, -1.0, 1.0, COUNT).unwrap();
            let mut columns = vec![0.0; COUNT];
            columns[splines.first..splines.first + 4].copy_from_slice(&splines.values);
            let part = row as usize * PARTS / 4000;
            normal.add(part, &columns, law(place) + noise.next());
        }
        normal.smooth().unwrap()
    }

    #[test]
    fn a_dent_is_found_back_and_closes_on_unseen_rows() {
        let dent = |place: f64| 3.0 * (-0.5 * ((place - 0.2) / 0.1).powi(2)).exp();
        let smooth = read(dent);
        assert!(smooth.gain_sd() > 3.0, "{}", smooth.gain_sd());
        assert!(smooth.share() > 0.9, "{}", smooth.share());
        assert!(
            (6.0..30.0).contains(&smooth.effective),
            "{}",
            smooth.effective
        );
        let at = |place| curve(place, -1.0, 1.0, &smooth.coefficients).unwrap().0;
        for place in [-0.3, 0.1, 0.2, 0.3, 0.6] {
            let error = at(place) - dent(place);
            // of 4000 readings some 100 lie in a spline's reach
            assert!(error.abs() < 0.4, "{place}: {error}");
        }
    }

    #[test]
    fn noise_alone_is_no_curve() {
        let smooth = read(|_| 0.0);
        assert!(smooth.gain_sd() < 3.0, "{}", smooth.gain_sd());
        // of 4000 squares of noise a curve that follows some of it loses a few at most
        assert!(smooth.gain() < 20.0, "{}", smooth.gain());
    }
}
